//! Measured intensities from the cells of a goniometer, as in the tables of a report: from their list to means over the rings of
//! another goniometer.

use crate::measured::computed::ComputedCells;
use crate::measured::intensities::sector_edges;
use crate::measured::points::{expect_size, lines, nearest};
use crate::measured::resample::{MeasuredGrid, resampled};
use crate::measured::table::TextTable;
use lumiduct_base::error::Result;
use ndarray::Array2;

/// Least columns and rows of cells; a goniometer may have one sector.
pub(crate) const LEAST_CELLS: [usize; 2] = [1, 2];
/// Angles closer than this are the same, deg.
const SAME_ANGLE: f64 = 1e-6;

/// The cells of a table with the columns `c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg` and an intensity.
///
/// # Errors
///
/// `Error::Usage` with file and line if they are no rows and columns of cells.
pub(crate) fn listed_cells(table: &TextTable) -> Result<MeasuredGrid> {
    let mut cells = Vec::new();
    for (line, row) in &table.rows[1..] {
        let [c_from, c_to, gamma_from, gamma_to, value, ..] = &row[..] else {
            return Err(table.refuse_line(*line, "fewer than five cells"));
        };
        let number = |cell: &String| table.number(*line, cell);
        let c = [number(c_from)?, number(c_to)?];
        let gamma = [number(gamma_from)?, number(gamma_to)?];
        cells.push((*line, [c, gamma], table.value(*line, value)?));
    }
    let [x, y] = [0, 1].map(|axis| lines(cells.iter().flat_map(|(_, ends, _)| ends[axis])));
    let [columns, rows] = [&x, &y].map(|edges| edges.len().saturating_sub(1));
    expect_size(table, [columns, rows], LEAST_CELLS)?;
    let mut values = Array2::from_elem((rows, columns), f64::NAN);
    let mut is_set = Array2::from_elem(values.dim(), false);
    let place = |edges: &[f64], [from, to]: [f64; 2]| {
        let own = nearest(edges, from);
        (nearest(edges, to) == own + 1).then_some(own)
    };
    for (line, [c, gamma], value) in cells {
        let (Some(column), Some(row)) = (place(&x, c), place(&y, gamma)) else {
            let why = "the cell is not one step of C and γ from its lower to its upper edges; cells must be rows and columns";
            return Err(table.refuse_line(line, why));
        };
        if std::mem::replace(&mut is_set[[row, column]], true) {
            return Err(table.refuse_line(line, "a second value of the same cell"));
        }
        values[[row, column]] = value;
    }
    whole_circle(table, MeasuredGrid { x, y, values })
}

/// Cells around the whole axis; where C is not covered, nothing was measured.
///
/// # Errors
///
/// `Error::Usage` with the file if the cells are more than a circle or γ leaves its range.
pub(crate) fn whole_circle(table: &TextTable, grid: MeasuredGrid) -> Result<MeasuredGrid> {
    let MeasuredGrid { mut x, y, values } = grid;
    let [c, gamma] = [&x, &y].map(|edges| [edges[0], edges[edges.len() - 1]]);
    if c[1] - c[0] > 360.0 + SAME_ANGLE || gamma[0] < 0.0 || gamma[1] > 180.0 + SAME_ANGLE {
        let why = format!(
            "C from {} to {} deg and γ from {} to {} deg; expected a circle of C, and γ from 0 to 180 deg",
            c[0], c[1], gamma[0], gamma[1]
        );
        return Err(table.refuse(why));
    }
    if c[1] - c[0] >= 360.0 - SAME_ANGLE {
        return Ok(MeasuredGrid { x, y, values });
    }
    x.push(c[0] + 360.0);
    let (rows, columns) = values.dim();
    let values = Array2::from_shape_fn((rows, columns + 1), |at| {
        values.get(at).copied().unwrap_or(f64::NAN)
    });
    Ok(MeasuredGrid { x, y, values })
}

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
