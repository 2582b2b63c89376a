//! Measured intensities from the cells of a goniometer: from their list to means over the rings of another goniometer.

use crate::measured::computed::ComputedCells;
use crate::measured::intensities::sector_edges;
use crate::measured::resample::resampled;
use lumiduct_files::measured::MeasuredGrid;
use ndarray::Array2;

/// Means over the rings of a goniometer by solid angle, over three turns or more. Cells like those of the goniometer keep their
/// values.
pub(crate) fn sphere_of_cells(cells: &MeasuredGrid, computed: &ComputedCells) -> MeasuredGrid {
    let (rows, columns) = cells.values.dim();
    let start = cells.x[0].rem_euclid(360.0) - cells.x[0];
    let turned = |turn: f64| cells.x[..columns].iter().map(move |edge| edge + start + turn);
    let mut x: Vec<f64> = [-720.0, -360.0, 0.0, 360.0].into_iter().flat_map(turned).collect();
    x.push(cells.x[0] + start + 720.0);
    let values = Array2::from_shape_fn((rows, x.len() - 1), |(row, column)| {
        cells.values[[row, column % columns]]
    });
    let sectors = sector_edges(computed);
    let gamma = computed.edges()[1];
    let own = MeasuredGrid { x, y: cell_heights(&cells.y), values };
    let is_finer = columns > (sectors.len() - 1) / 3;
    let x = if is_finer { sectors } else { own.x.clone() };
    let values = resampled(&own, [&x, &cell_heights(gamma)], [0.0; 2]);
    MeasuredGrid { x, y: gamma.to_vec(), values }
}

/// Heights on a unit sphere from its pole, 1 - cos γ: their differences are solid angles over 2π.
fn cell_heights(gamma_deg: &[f64]) -> Vec<f64> {
    gamma_deg.iter().map(|gamma| 2.0 * (0.5 * gamma.to_radians()).sin().powi(2)).collect()
}
