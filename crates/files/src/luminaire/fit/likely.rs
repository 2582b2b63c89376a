//! The table whose interpolation most likely gives the means over cells.

use crate::luminaire::fit::limit::{CellsOfTable, limited};
use crate::luminaire::fit::nodes::{NodeGrid, Planes};
use ndarray::{Array2, ArrayView2};

/// Steps of the maximisation. The slowest deviation alternates in both angles: with two cells a segment it loses 1/16 in each step.
const STEPS: usize = 200;
/// Share of the peak below which a value is zero, 1.
const ROUNDING: f64 = 1e-9;

/// The most likely values within what neighbouring cells support, planes by angles.
pub(crate) fn most_likely(
    candela: ArrayView2<'_, f64>,
    std_errors: ArrayView2<'_, f64>,
    grid: &NodeGrid,
    planes: &Planes,
) -> Array2<f64> {
    let candela = candela.mapv(|value| value.max(0.0));
    let solid_angles = grid.shared(|_| 1.0);
    let spread = grid.shared(|cell| candela[cell]) / &solid_angles;
    let mut values = spread.clone();
    for _ in 0..STEPS {
        let ratio = |cell: [usize; 2]| {
            let own = grid.mean(&values, cell);
            if own > 0.0 { candela[cell] / own } else { 0.0 }
        };
        values *= &(grid.shared(ratio) / &solid_angles);
    }
    let cells = CellsOfTable { candela: &candela, std_errors, grid, planes };
    let mut values = limited(&values, spread, &solid_angles, cells);
    // Dark nodes beside bright ones shrink with every step and never reach zero.
    let peak = values.iter().copied().fold(0.0, f64::max);
    values.mapv_inplace(|value| if value < ROUNDING * peak { 0.0 } else { value });
    values
}
