//! The forms of a measured table, known by its first row.

use crate::measured::cells::{LEAST_CELLS, listed_cells, whole_circle};
use crate::measured::data::{
    FirstRow, MeasuredGrid, MeasuredMap, MeasuredValues, PlainMatrix, StatedSize,
};
use crate::measured::directions::MeasuredDirections;
use crate::measured::error::MeasuredError;
use crate::measured::points::{GridPoints, edges, expect_size};
use crate::measured::table::{TextRow, TextTable, number, value};
use ndarray::Array2;
use std::borrow::Cow;

/// Least columns and rows of a map.
const LEAST_LINES: [usize; 2] = [2, 2];
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
    let map = match head.get(1).and_then(|cell| cell.split_once(" from in ")) {
        Some(axis) => report_matrix(table, axis)?,
        None if is_plain => plain_matrix(table)?,
        None => columns(table, *line, head)?,
    };
    if !map.values.has_light() {
        return Err(MeasuredError::of_file("all values are zero or missing"));
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
    let unit = table.comment("unit").map(|(unit, _)| unit.to_owned());
    let unit = unit.or_else(|| name.rsplit_once('_').map(|(_, unit)| unit.to_owned()));
    Ok(MeasuredMap { values, unit, remarks })
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
        return Err(MeasuredError::of_file(
            "a matrix of a report has three header rows and values",
        ));
    };
    let what = match axis {
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
    let numbers = |line: usize, cells: &[Cow<'_, str>]| -> Result<Vec<f64>, MeasuredError> {
        cells.iter().map(|cell| number(line, cell)).collect()
    };
    let mut x = numbers(lower.line, lower.cells.get(2..).unwrap_or_default())?;
    let least = if what == MatrixKind::Sphere { LEAST_CELLS } else { LEAST_LINES };
    expect_size([x.len(), rows.len()], least)?;
    x.extend(numbers(upper.line, upper.cells.get(x.len() + 1..).unwrap_or_default())?);
    let (mut y, mut values) = (Vec::<f64>::new(), Vec::new());
    // The top row of a map is the first; γ grows downwards.
    let mut rows: Vec<&TextRow<'_>> = rows.iter().collect();
    if what != MatrixKind::Sphere {
        rows.reverse();
    }
    for TextRow { line, cells } in &rows {
        let ends = numbers(*line, cells.get(..2).unwrap_or_default())?;
        let gap = y.last().zip(ends.first()).map_or(0.0, |(last, next)| next - last);
        if gap.abs() > SAME_EDGE {
            let why = "the row does not begin where its neighbour ends; give all rows, with empty cells where nothing was measured";
            return Err(MeasuredError::of_line(*line, why));
        }
        y.extend(if y.is_empty() { &ends[..] } else { ends.get(1..).unwrap_or_default() });
        for cell in cells.get(2..).unwrap_or_default() {
            values.push(value(*line, cell)?);
        }
    }
    let is_rising = |edges: &[f64]| edges.windows(2).all(|pair| pair[0] < pair[1]);
    let values = Array2::from_shape_vec((rows.len(), x.len() - 1), values);
    let Ok(values) = values.map_err(|_| ()).and_then(|values| {
        if is_rising(&x) && is_rising(&y) && y.len() == values.nrows() + 1 {
            Ok(values)
        } else {
            Err(())
        }
    }) else {
        return Err(MeasuredError::of_file(
            "the edges and values of the matrix do not fit together",
        ));
    };
    let unit = lower.cells[0].split_once(" in ").map(|(_, unit)| unit.to_owned());
    let grid = MeasuredGrid { x, y, values };
    let values = match what {
        MatrixKind::Surface => MeasuredValues::Surface(grid),
        MatrixKind::Image => MeasuredValues::Image(grid),
        MatrixKind::Sphere => MeasuredValues::Sphere(whole_circle(grid)?),
    };
    Ok(MeasuredMap { values, unit, remarks: Vec::new() })
}

/// Numbers alone; comments may give size and direction.
fn plain_matrix(table: &TextTable<'_>) -> Result<MeasuredMap, MeasuredError> {
    let (rows, columns) = (table.rows.len(), table.rows[0].cells.len());
    expect_size([columns, rows], LEAST_LINES)?;
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
        Some(("top", _)) => Some(FirstRow::Top),
        Some(("bottom", _)) => Some(FirstRow::Bottom),
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
    let unit = table.comment("unit").map(|(unit, _)| unit.to_owned());
    let matrix = PlainMatrix { values, width, height, first_row };
    Ok(MeasuredMap { values: MeasuredValues::Matrix(matrix), unit, remarks: Vec::new() })
}
