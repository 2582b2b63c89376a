//! The forms of a measured table, known by its first row.

use crate::measured::cells::{LEAST_CELLS, listed_cells, whole_circle};
use crate::measured::data::{
    FirstRow, MeasuredGrid, MeasuredMap, MeasuredValues, PlainMatrix, StatedFirstRow, StatedSize,
    StatedUnit,
};
use crate::measured::directions::MeasuredDirections;
use crate::measured::error::MeasuredError;
use crate::measured::points::{GridPoints, edges, expect_size};
use crate::measured::table::{TextRow, TextTable, expect_gamma, number, value};
use crate::measured::unit::unit_of_column;
use ndarray::Array2;
use std::borrow::Cow;

/// Least columns and rows of a map.
const LEAST_LINES: [usize; 2] = [2, 2];
/// Rows of names and edges before the values of a matrix of a report.
const HEADER_ROWS: usize = 3;
/// Difference of edges that is rounding, mm or deg.
const SAME_EDGE: f64 = 1e-6;
/// Why a map of rings is refused.
const RINGS_REFUSED: &str = "a map of rings, which is not compared with a measurement; give the sensor rows and columns (`cells`), and \
                             the measured values at them";

/// What a matrix of a report holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum MatrixKind {
    Surface,
    Image,
    Sphere,
}

/// The map of a table.
///
/// # Errors
///
/// [`MeasuredError`] if the table is not one of a map.
pub(super) fn measured_map(table: &TextTable<'_>) -> Result<MeasuredMap, MeasuredError> {
    let TextRow { line, cells: head } = &table.rows[0];
    let is_plain = head.iter().all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok());
    let (map, header_rows) = match head.get(1).and_then(|cell| cell.split_once(" from in ")) {
        Some(axis) => (report_matrix(table, axis)?, HEADER_ROWS),
        None if is_plain => (plain_matrix(table)?, 0),
        None => (columns(table, *line, head)?, 1),
    };
    if !map.values.has_light() {
        let why = "all values from here on are zero or missing";
        return Err(MeasuredError::of_line(table.line(header_rows), why));
    }
    Ok(map)
}

/// Columns with a header: places and a value.
fn columns(
    table: &TextTable<'_>,
    line: usize,
    head: &[Cow<'_, str>],
) -> Result<MeasuredMap, MeasuredError> {
    let names: Vec<&str> = head.iter().map(|cell| &**cell).collect();
    let mut remarks = Vec::new();
    let (values, name) = match names[..] {
        ["u_mm", "v_mm", name, ..] | ["x_mm", "y_mm", name, ..] => {
            (MeasuredValues::Surface(middles(table)?), name)
        }
        ["u_deg", "v_deg", name, ..] => (MeasuredValues::Image(middles(table)?), name),
        ["c_deg", "gamma_deg", name, ..] => {
            let own = MeasuredDirections::read(table)?;
            remarks.extend(own.remark());
            (MeasuredValues::Directions(own), name)
        }
        ["c_from_deg", "c_to_deg", "gamma_from_deg", "gamma_to_deg", name, ..] => {
            (MeasuredValues::Sphere(listed_cells(table)?), name)
        }
        ["sector_deg", ..] => return Err(MeasuredError::of_line(line, RINGS_REFUSED)),
        _ => {
            let why = "not a map; expected the columns `x_mm,y_mm,illuminance_lx` (or `u_deg,v_deg,...`), \
                       `c_deg,gamma_deg,intensity_cd`, the table or matrix of a report, or a matrix of numbers alone";
            return Err(MeasuredError::of_line(line, why));
        }
    };
    let of_name = || unit_of_column(name).map(|unit| StatedUnit { unit: unit.to_owned(), line });
    let unit = stated_unit(table).or_else(of_name);
    Ok(MeasuredMap { values, unit, remarks })
}

/// The unit that a comment gives.
fn stated_unit(table: &TextTable<'_>) -> Option<StatedUnit> {
    table.comment("unit").map(|(unit, line)| StatedUnit { unit: unit.to_owned(), line })
}

/// Cells around points, which are their middles.
fn middles(table: &TextTable<'_>) -> Result<MeasuredGrid, MeasuredError> {
    let GridPoints { x, y, values } = GridPoints::read(table, LEAST_LINES)?;
    let [x, y] = [x, y].map(|middles| edges(&middles));
    Ok(MeasuredGrid { x, y, values })
}

/// A matrix as in a report, `NAME.matrix.csv`: edges in two rows and two columns. The axis is the name and unit of its columns.
fn report_matrix(table: &TextTable<'_>, axis: (&str, &str)) -> Result<MeasuredMap, MeasuredError> {
    let [lower, upper, _, rows @ ..] = &table.rows[..] else {
        let why = "a matrix of a report has three header rows and values, and the file ends here";
        return Err(MeasuredError::of_line(table.line(usize::MAX), why));
    };
    let kind = match axis {
        ("u" | "right", "mm") => MatrixKind::Surface,
        ("u" | "right", "deg") => MatrixKind::Image,
        ("c", "deg") => MatrixKind::Sphere,
        ("sector", _) => return Err(MeasuredError::of_line(lower.line, RINGS_REFUSED)),
        _ => {
            return Err(MeasuredError::of_line(
                lower.line,
                "not a matrix of a map or of intensities",
            ));
        }
    };
    let least = if kind == MatrixKind::Sphere { LEAST_CELLS } else { LEAST_LINES };
    let columns = lower.cells.len().saturating_sub(2);
    expect_size(table.line(HEADER_ROWS), [columns, rows.len()], least)?;
    let x = column_edges(lower, upper)?;
    let (y, values) = matrix_rows(rows, columns, kind)?;
    let unit = lower.cells[0].split_once(" in ");
    let unit = unit.map(|(_, unit)| StatedUnit { unit: unit.to_owned(), line: lower.line });
    let grid = MeasuredGrid { x, y, values };
    let values = match kind {
        MatrixKind::Surface => MeasuredValues::Surface(grid),
        MatrixKind::Image => MeasuredValues::Image(grid),
        MatrixKind::Sphere => MeasuredValues::Sphere(whole_circle(grid, upper.line)?),
    };
    Ok(MeasuredMap { values, unit, remarks: Vec::new() })
}

/// The edges of the columns of a matrix, from the rows of their lower and upper ones.
fn column_edges(lower: &TextRow<'_>, upper: &TextRow<'_>) -> Result<Vec<f64>, MeasuredError> {
    if upper.cells.len() != lower.cells.len() {
        let why =
            format!("{} cells, but the row before has {}", upper.cells.len(), lower.cells.len());
        return Err(MeasuredError::of_line(upper.line, why));
    }
    let mut edges = numbers(lower.line, &lower.cells[2..])?;
    edges.push(number(upper.line, &upper.cells[upper.cells.len() - 1])?);
    match edges.windows(2).position(|pair| pair[0] >= pair[1]) {
        None => Ok(edges),
        Some(place) => {
            let line = if place + 2 == edges.len() { upper.line } else { lower.line };
            let why =
                format!("the edge {} follows {}: they must ascend", edges[place + 1], edges[place]);
            Err(MeasuredError::of_line(line, why))
        }
    }
}

/// The edges of the rows of a matrix, ascending, and its values.
fn matrix_rows(
    rows: &[TextRow<'_>],
    columns: usize,
    kind: MatrixKind,
) -> Result<(Vec<f64>, Array2<f64>), MeasuredError> {
    // The top row of a map is the first; γ grows downwards.
    let mut rows: Vec<&TextRow<'_>> = rows.iter().collect();
    if kind != MatrixKind::Sphere {
        rows.reverse();
    }
    let mut edges = Vec::<f64>::new();
    let mut values = Array2::from_elem((rows.len(), columns), f64::NAN);
    for (TextRow { line, cells }, mut own) in rows.iter().copied().zip(values.rows_mut()) {
        let refuse = |why: String| Err(MeasuredError::of_line(*line, why));
        if cells.len() != columns + 2 {
            return refuse(format!("{} cells, but the first row has {}", cells.len(), columns + 2));
        }
        let ends = numbers(*line, &cells[..2])?;
        if kind == MatrixKind::Sphere {
            expect_gamma(*line, ends.iter().copied())?;
        }
        let last = *edges.last().unwrap_or(&ends[0]);
        if (ends[0] - last).abs() > SAME_EDGE {
            let why = "the row does not begin where its neighbour ends; give all rows, with empty cells where nothing was measured";
            return refuse(why.to_owned());
        }
        if ends[1] <= f64::max(ends[0], last) {
            return refuse(format!("the edge {} follows {}: they must ascend", ends[1], ends[0]));
        }
        if edges.is_empty() {
            edges.push(ends[0]);
        }
        edges.push(ends[1]);
        for (value, cell) in own.iter_mut().zip(&cells[2..]) {
            *value = self::value(*line, cell)?;
        }
    }
    Ok((edges, values))
}

fn numbers(line: usize, cells: &[Cow<'_, str>]) -> Result<Vec<f64>, MeasuredError> {
    cells.iter().map(|cell| number(line, cell)).collect()
}

/// Numbers alone; comments may give size and direction.
fn plain_matrix(table: &TextTable<'_>) -> Result<MeasuredMap, MeasuredError> {
    let (rows, columns) = (table.rows.len(), table.rows[0].cells.len());
    expect_size(table.line(0), [columns, rows], LEAST_LINES)?;
    let size = |key: &str| -> Result<Option<StatedSize>, MeasuredError> {
        let Some((text, line)) = table.comment(key) else { return Ok(None) };
        let size_mm = number(line, text)?;
        if size_mm <= 0.0 {
            return Err(MeasuredError::of_line(line, format!("{key} is not above 0")));
        }
        Ok(Some(StatedSize { size_mm, line }))
    };
    let [width, height] = [size("width_mm")?, size("height_mm")?];
    let first_row = match table.comment("rows") {
        None => None,
        Some(("top", line)) => Some(StatedFirstRow { side: FirstRow::Top, line }),
        Some(("bottom", line)) => Some(StatedFirstRow { side: FirstRow::Bottom, line }),
        Some((_, line)) => {
            let why = "rows must be `top` or `bottom`: the first row";
            return Err(MeasuredError::of_line(line, why));
        }
    };
    let mut values = Array2::from_elem((rows, columns), f64::NAN);
    for (row, TextRow { line, cells }) in table.rows.iter().enumerate() {
        if cells.len() != columns {
            let why = format!("{} cells, but the first row has {columns}", cells.len());
            return Err(MeasuredError::of_line(*line, why));
        }
        for (column, cell) in cells.iter().enumerate() {
            values[[row, column]] = value(*line, cell)?;
        }
    }
    let unit = stated_unit(table);
    let matrix = PlainMatrix { values, width, height, first_row };
    Ok(MeasuredMap { values: MeasuredValues::Matrix(matrix), unit, remarks: Vec::new() })
}
