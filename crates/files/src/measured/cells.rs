//! Cells of a goniometer, as in the tables of a report.

use crate::measured::data::MeasuredGrid;
use crate::measured::error::MeasuredError;
use crate::measured::points::{expect_size, lines, nearest};
use crate::measured::table::{TextRow, TextTable, expect_gamma, number, value};
use ndarray::Array2;

/// Least columns and rows of cells; a goniometer may have one sector.
pub(super) const LEAST_CELLS: [usize; 2] = [1, 2];
/// Angles closer than this are the same, deg.
const SAME_ANGLE: f64 = 1e-6;

/// The cells of a table with the columns `c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg` and an intensity.
///
/// # Errors
///
/// [`MeasuredError`] if they are no rows and columns of cells.
pub(super) fn listed_cells(table: &TextTable<'_>) -> Result<MeasuredGrid, MeasuredError> {
    let mut cells = Vec::new();
    for TextRow { line, cells: row } in &table.rows[1..] {
        let [c_from, c_to, gamma_from, gamma_to, light, ..] = &row[..] else {
            return Err(MeasuredError::of_line(*line, "fewer than five cells"));
        };
        let c = [number(*line, c_from)?, number(*line, c_to)?];
        let gamma = [number(*line, gamma_from)?, number(*line, gamma_to)?];
        expect_gamma(*line, gamma)?;
        cells.push((*line, [c, gamma], value(*line, light)?));
    }
    let [x, y] = [0, 1].map(|axis| lines(cells.iter().flat_map(|(_, ends, _)| ends[axis])));
    let [columns, rows] = [&x, &y].map(|edges| edges.len().saturating_sub(1));
    expect_size(table.line(1), [columns, rows], LEAST_CELLS)?;
    let beyond = cells.iter().find(|(_, [c, _], _)| c[1] > x[0] + 360.0 + SAME_ANGLE);
    let last_line = beyond.map_or(table.line(1), |(line, ..)| *line);
    let mut values = Array2::from_elem((rows, columns), f64::NAN);
    let mut is_set = Array2::from_elem(values.dim(), false);
    let place = |edges: &[f64], [from, to]: [f64; 2]| {
        let own = nearest(edges, from);
        (nearest(edges, to) == own + 1).then_some(own)
    };
    for (line, [c, gamma], value) in cells {
        let (Some(column), Some(row)) = (place(&x, c), place(&y, gamma)) else {
            let why = "the cell is not one step of C and γ from its lower to its upper edges; cells must be rows and columns";
            return Err(MeasuredError::of_line(line, why));
        };
        if std::mem::replace(&mut is_set[[row, column]], true) {
            return Err(MeasuredError::of_line(line, "a second value of the same cell"));
        }
        values[[row, column]] = value;
    }
    whole_circle(MeasuredGrid { x, y, values }, last_line)
}

/// Cells around the whole axis; where C is not covered, nothing was measured. The last edge of C is in a line.
///
/// # Errors
///
/// [`MeasuredError::WrongLine`] if the cells are more than a circle.
pub(super) fn whole_circle(grid: MeasuredGrid, line: usize) -> Result<MeasuredGrid, MeasuredError> {
    let MeasuredGrid { mut x, y, values } = grid;
    let c = [x[0], x[x.len() - 1]];
    if c[1] - c[0] > 360.0 + SAME_ANGLE {
        let why =
            format!("C from {} to {} deg is more than a circle; give each cell once", c[0], c[1]);
        return Err(MeasuredError::of_line(line, why));
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
