//! Measured values as means over the cells of a computed map.
//!
//! Within each of its cells the measured map is linear in both coordinates, with the mean of the cell and the slope between its
//! neighbours. The mean of that over each computed cell is exact: it averages a finer map, interpolates a coarser one, and keeps a
//! map of the same cells as it is.

use lumiduct_files::measured::MeasuredGrid;
use ndarray::{Array2, ArrayView1};

/// Reach beyond the measured map that is rounding, as a share of a cell.
const ROUNDING: f64 = 1e-6;
/// Measured cells in a computed one that suffice: finer maps are averaged once before the search.
const CELLS_PER_CELL: f64 = 8.0;

/// The part of some numbers in a mean.
#[derive(Debug)]
struct CellWeights {
    first: usize,
    weights: Vec<f64>,
}

impl CellWeights {
    /// The weights of the cells between edges in the mean from `from` to `to`; `None` if they do not cover it.
    fn new(edges: &[f64], [from, to]: [f64; 2]) -> Option<Self> {
        let count = edges.len() - 1;
        let width = to - from;
        if from < edges[0] - ROUNDING * width || to > edges[count] + ROUNDING * width {
            return None;
        }
        let cell_of = |at: f64| edges.partition_point(|edge| *edge <= at).clamp(1, count) - 1;
        let (low, high) = (cell_of(from), cell_of(to));
        let first = low.saturating_sub(1);
        let last = (high + 1).min(count - 1);
        let mut weights = vec![0.0; last + 1 - first];
        let middle = |cell: usize| 0.5 * (edges[cell] + edges[cell + 1]);
        for cell in low..=high {
            let part = [edges[cell].max(from), edges[cell + 1].min(to)];
            let share = (part[1] - part[0]) / width;
            if share <= ROUNDING {
                continue;
            }
            weights[cell - first] += share;
            let offset = 0.5 * (part[0] + part[1]) - middle(cell);
            let [before, after] = [cell.saturating_sub(1), (cell + 1).min(count - 1)];
            if offset.abs() > ROUNDING * width && before < after {
                let slope = share * offset / (middle(after) - middle(before));
                weights[after - first] += slope;
                weights[before - first] -= slope;
            }
        }
        Some(Self { first, weights })
    }

    /// The mean. Only numbers with a weight count, so missing ones beside them do no harm.
    fn mean(&self, numbers: ArrayView1<'_, f64>) -> f64 {
        let own = self.weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
        own.map(|(place, weight)| weight * numbers[self.first + place]).sum()
    }
}

/// The means over cells between edges x and y, each moved by `shift` in the measured map; NaN where it does not cover them.
pub(crate) fn resampled(grid: &MeasuredGrid, [x, y]: [&[f64]; 2], shift: [f64; 2]) -> Array2<f64> {
    let weights = |source: &[f64], edges: &[f64], shift: f64| -> Vec<Option<CellWeights>> {
        let cell = |ends: &[f64]| CellWeights::new(source, [ends[0] + shift, ends[1] + shift]);
        edges.windows(2).map(cell).collect()
    };
    let across = weights(&grid.x, x, shift[0]);
    let up = weights(&grid.y, y, shift[1]);
    let mean = |weights: &Option<CellWeights>, numbers: ArrayView1<'_, f64>| {
        weights.as_ref().map_or(f64::NAN, |weights| weights.mean(numbers))
    };
    let rows = grid.values.nrows();
    let narrow = Array2::from_shape_fn((rows, across.len()), |(row, column)| {
        mean(&across[column], grid.values.row(row))
    });
    Array2::from_shape_fn((up.len(), across.len()), |(row, column)| {
        mean(&up[row], narrow.column(column))
    })
}

/// The map averaged to a few cells in each cell between edges x and y, if it is finer.
pub(crate) fn coarsened(grid: &MeasuredGrid, [x, y]: [&[f64]; 2]) -> MeasuredGrid {
    let coarser = |own: &[f64], edges: &[f64]| -> Vec<f64> {
        let size = |edges: &[f64]| edges[edges.len() - 1] - edges[0];
        let width = size(edges) / (edges.len() - 1) as f64 / CELLS_PER_CELL;
        let count = (size(own) / width).ceil();
        if count >= (own.len() - 1) as f64 {
            return own.to_vec();
        }
        let edge = |place: usize| own[0] + size(own) * place as f64 / count;
        (0..=count as usize).map(edge).collect()
    };
    let [x, y] = [coarser(&grid.x, x), coarser(&grid.y, y)];
    let values = resampled(grid, [&x, &y], [0.0; 2]);
    MeasuredGrid { x, y, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn linear(x: Vec<f64>, y: Vec<f64>) -> MeasuredGrid {
        let middle = |edges: &[f64], place: usize| 0.5 * (edges[place] + edges[place + 1]);
        let values = Array2::from_shape_fn((y.len() - 1, x.len() - 1), |(row, column)| {
            5.0 + 2.0 * middle(&x, column) - 3.0 * middle(&y, row)
        });
        MeasuredGrid { x, y, values }
    }

    #[test]
    fn a_linear_map_is_exact_on_any_cells() {
        let steps = |count: usize| (0..=count).map(|n| n as f64 / count as f64).collect::<Vec<_>>();
        for count in [2, 5, 8, 100] {
            let grid = linear(steps(count), steps(count + 1));
            let (x, y) = ([0.1, 0.3, 0.35], [0.2, 0.9]);
            let means = resampled(&grid, [&x, &y], [0.05, -0.1]);
            for (at, middle) in [(0, 0.25), (1, 0.375)] {
                let expected = 5.0 + 2.0 * middle - 3.0 * 0.45;
                assert!((means[[0, at]] - expected).abs() < 1e-12, "{count}");
            }
        }
    }

    #[test]
    fn the_same_cells_keep_their_values_and_holes_spread_only_where_they_are_used() {
        let edges = vec![0.0, 1.0, 2.0, 3.0];
        let mut grid = linear(edges.clone(), edges.clone());
        grid.values[[1, 1]] = f64::NAN;
        let same = resampled(&grid, [&edges, &edges], [0.0; 2]);
        assert!(same.iter().zip(&grid.values).all(|(a, b)| a == b || a.is_nan() && b.is_nan()));
        let moved = resampled(&grid, [&edges, &edges], [0.5, 0.0]);
        assert!(moved.column(2).iter().all(|value| value.is_nan()), "beyond the map");
        assert!(moved[[0, 0]].is_finite() && moved[[1, 0]].is_nan());
    }

    #[test]
    fn a_fine_map_keeps_its_means() {
        let fine: Vec<f64> = (0..=64).map(|n| f64::from(n) / 64.0).collect();
        let cells = [0.0, 0.5, 1.0];
        let coarse = coarsened(&linear(fine.clone(), fine), [&cells, &cells]);
        assert_eq!(coarse.values.dim(), (16, 16));
        assert!((resampled(&coarse, [&cells, &cells], [0.0; 2])[[0, 0]] - 4.75).abs() < 1e-12);
    }
}
