//! The cells of a map on a page. Large maps are coarsened; the tables have all cells.

use crate::png::{MapCells, MapColours};
use glam::DVec3;
use ndarray::Array2;

/// Most cells of a map on a page; more would make it slow to open.
const MOST_CELLS: usize = 40_000;

/// How many cells along each side are shown as one; 1 for small maps.
pub(crate) fn joined(cells: &Array2<f64>) -> usize {
    ((cells.len() as f64 / MOST_CELLS as f64).sqrt().ceil() as usize).max(1)
}

/// Averages blocks of `side` by `side` cells. Cells without a value are left out; cells of an image
/// or a goniometer have equal weight, which is close enough for a picture.
pub(crate) fn coarse(cells: &MapCells, side: usize) -> MapCells {
    let (rows, columns) = cells.values.dim();
    let shape = (rows.div_ceil(side), columns.div_ceil(side));
    let of = |row: usize, column: usize| {
        let rows = side * row..rows.min(side * (row + 1));
        let columns = side * column..columns.min(side * (column + 1));
        let all = rows.flat_map(move |row| columns.clone().map(move |column| (row, column)));
        all.filter(|at| cells.values[*at].is_finite())
    };
    let mean = |table: &Array2<f64>| {
        Array2::from_shape_fn(shape, |(row, column)| {
            of(row, column).map(|at| table[at]).sum::<f64>() / of(row, column).count() as f64
        })
    };
    let mean_colours = |colours: &MapColours| MapColours {
        stimuli: Array2::from_shape_fn(shape, |(row, column)| {
            let sum: DVec3 = of(row, column).map(|at| colours.stimuli[at]).sum();
            sum / of(row, column).count() as f64
        }),
        uv_errors: None,
    };
    let errors = Array2::from_shape_fn(shape, |(row, column)| {
        let variance: f64 = of(row, column).map(|at| cells.errors[at].powi(2)).sum();
        variance.sqrt() / of(row, column).count() as f64
    });
    MapCells {
        x: coarse_edges(&cells.x, side),
        y: coarse_edges(&cells.y, side),
        values: mean(&cells.values),
        errors,
        // A bias does not average out.
        biases: cells.biases.as_ref().map(mean),
        colours: cells.colours.as_ref().map(mean_colours),
    }
}

fn coarse_edges(edges: &[f64], side: usize) -> Vec<f64> {
    let mut kept: Vec<f64> = edges.iter().copied().step_by(side).collect();
    if !(edges.len() - 1).is_multiple_of(side) {
        kept.extend(edges.last());
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_cells_keep_the_mean_and_cells_without_a_value_do_not_count() {
        let cells = MapCells {
            x: vec![0.0, 1.0, 2.0, 3.0],
            y: vec![0.0, 1.0, 2.0],
            values: Array2::from_shape_vec((2, 3), vec![1.0, 2.0, 7.0, f64::NAN, 6.0, 9.0])
                .unwrap(),
            errors: Array2::from_elem((2, 3), 3.0),
            biases: None,
            colours: None,
        };
        let coarse = coarse(&cells, 2);
        assert_eq!((coarse.x, coarse.y), (vec![0.0, 2.0, 3.0], vec![0.0, 2.0]));
        assert_eq!(coarse.values.into_raw_vec_and_offset().0, [3.0, 8.0]);
        let [three, two] = [3.0 / 3f64.sqrt(), 3.0 / 2f64.sqrt()];
        let errors = coarse.errors.into_raw_vec_and_offset().0;
        assert!((errors[0] - three).abs() < 1e-15 && (errors[1] - two).abs() < 1e-15);
    }

    #[test]
    fn only_very_many_cells_are_joined() {
        let sides =
            [(200, 200), (201, 200), (1000, 1000)].map(|shape| joined(&Array2::zeros(shape)));
        assert_eq!(sides, [1, 2, 5]);
    }
}
