//! Measured maps and intensities from CSV files: columns of places and values, the matrix of a report, or a plain matrix of
//! numbers.

use crate::diff::edges;
use crate::measured::computed::Comparable;
use crate::measured::directions::Directions;
use crate::measured::points::{GridPoints, expect_size};
use crate::measured::resample::MeasuredGrid;
use crate::measured::sphere_cells::{LEAST_CELLS, listed_cells, whole_circle};
use crate::measured::table::TextTable;
use crate::png::AxisScale;
use lumiduct_base::error::Result;
use ndarray::Array2;

/// Least columns and rows of a map.
const LEAST_LINES: [usize; 2] = [2, 2];
/// Difference of edges that is rounding, mm or deg.
const SAME_EDGE: f64 = 1e-6;
/// Why a map of rings is refused.
const RINGS_REFUSED: &str = "a map of rings, which is not compared with a measurement; give the sensor rows and columns (`cells`), and \
                             the measured values at them";

/// Which side of a plain matrix its first row is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FirstRow {
    /// The top, where v is largest, as in a picture.
    Top,
    /// The bottom, where v is smallest.
    Bottom,
}

/// What the command line says of a plain matrix.
#[derive(Debug, Clone, Copy, Default)]
pub struct MatrixPlace {
    /// Width along u, mm.
    pub width_mm: Option<f64>,
    /// Height along v, mm.
    pub height_mm: Option<f64>,
    /// The side of the first row.
    pub first_row: Option<FirstRow>,
}

/// A measured map or distribution of intensity.
#[derive(Debug)]
pub(crate) struct MeasuredMap {
    /// Its values and their places.
    pub(crate) values: MeasuredValues,
    /// Unit of its values, where the file gives one.
    pub(crate) unit: Option<String>,
}

/// Values by the places that a file gives.
#[derive(Debug)]
pub(crate) enum MeasuredValues {
    /// Cells around zero, mm: the file gives a size alone, and the middle is that of the sensor.
    Centred(MeasuredGrid),
    /// Cells at u and v, mm.
    Surface(MeasuredGrid),
    /// Cells of an image, deg.
    Image(MeasuredGrid),
    /// Cells of a goniometer, once around C, deg.
    Sphere(MeasuredGrid),
    /// Intensities in single directions.
    Directions(Directions),
}

impl MeasuredValues {
    /// What they can be compared with.
    pub(crate) fn comparable(&self) -> Comparable {
        match self {
            Self::Centred(_) | Self::Surface(_) => Comparable::Surfaces,
            Self::Image(_) => Comparable::Images,
            Self::Sphere(_) | Self::Directions(_) => Comparable::Intensities,
        }
    }

    fn has_light(&self) -> bool {
        match self {
            Self::Centred(grid) | Self::Surface(grid) | Self::Image(grid) | Self::Sphere(grid) => {
                grid.values.iter().any(|value| *value > 0.0)
            }
            Self::Directions(own) => own.peak() > 0.0,
        }
    }
}

/// The map of a table.
///
/// # Errors
///
/// `Error::Usage` with file and line if the table is not one of a map, or `place` does not fit it.
pub(crate) fn measured_map(table: &TextTable, place: MatrixPlace) -> Result<MeasuredMap> {
    let (line, head) = &table.rows[0];
    let is_plain = head.iter().all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok());
    if !is_plain && (place.width_mm, place.height_mm, place.first_row) != (None, None, None) {
        return Err(table.refuse(
            "the file gives its own places; --width-mm, --height-mm and --rows are for a plain matrix of numbers",
        ));
    }
    let map = match head.get(1).and_then(|cell| cell.split_once(" from in ")) {
        Some(axis) => report_matrix(table, axis)?,
        None if is_plain => plain_matrix(table, place)?,
        None => columns(table, *line, head)?,
    };
    if !map.values.has_light() {
        return Err(table.refuse("all values are zero or missing"));
    }
    Ok(map)
}

/// Columns with a header: places and a value.
fn columns(table: &TextTable, line: usize, head: &[String]) -> Result<MeasuredMap> {
    let names: Vec<&str> = head.iter().map(String::as_str).collect();
    let (values, name) = match names[..] {
        ["u_mm", "v_mm", name, ..] | ["x_mm", "y_mm", name, ..] => {
            (MeasuredValues::Surface(middles(table)?), name)
        }
        ["u_deg", "v_deg", name, ..] => (MeasuredValues::Image(middles(table)?), name),
        ["c_deg", "gamma_deg", name, ..] => {
            (MeasuredValues::Directions(Directions::read(table)?), name)
        }
        ["c_from_deg", "c_to_deg", "gamma_from_deg", "gamma_to_deg", name, ..] => {
            (MeasuredValues::Sphere(listed_cells(table)?), name)
        }
        ["sector_deg", ..] => return Err(table.refuse_line(line, RINGS_REFUSED)),
        _ => {
            let why = "not a map; expected the columns `x_mm,y_mm,illuminance_lx` (or `u_deg,v_deg,...`), \
                       `c_deg,gamma_deg,intensity_cd`, the table or matrix of a report, or a matrix of numbers alone";
            return Err(table.refuse_line(line, why));
        }
    };
    let unit = table.comment("unit").map(|(unit, _)| unit.to_owned());
    let unit = unit.or_else(|| name.rsplit_once('_').map(|(_, unit)| unit.to_owned()));
    Ok(MeasuredMap { values, unit })
}

/// Cells around points, which are their middles.
fn middles(table: &TextTable) -> Result<MeasuredGrid> {
    let GridPoints { x, y, values } = GridPoints::read(table, LEAST_LINES)?;
    let [x, y] = [x, y].map(|middles| edges(&middles, AxisScale::Linear));
    Ok(MeasuredGrid { x, y, values })
}

/// A matrix as in a report, `NAME.matrix.csv`: edges in two rows and two columns. The axis is the name and unit of its columns.
fn report_matrix(table: &TextTable, axis: (&str, &str)) -> Result<MeasuredMap> {
    let [(first, lower), (second, upper), _, rows @ ..] = &table.rows[..] else {
        return Err(table.refuse("a matrix of a report has three header rows and values"));
    };
    let what = match axis {
        ("u" | "right", "mm") => Comparable::Surfaces,
        ("u" | "right", "deg") => Comparable::Images,
        ("c", "deg") => Comparable::Intensities,
        ("sector", _) => return Err(table.refuse_line(*first, RINGS_REFUSED)),
        _ => return Err(table.refuse_line(*first, "not a matrix of a map or of intensities")),
    };
    let numbers = |line: &usize, cells: &[String]| -> Result<Vec<f64>> {
        cells.iter().map(|cell| table.number(*line, cell)).collect()
    };
    let mut x = numbers(first, lower.get(2..).unwrap_or_default())?;
    let least = if what == Comparable::Intensities { LEAST_CELLS } else { LEAST_LINES };
    expect_size(table, [x.len(), rows.len()], least)?;
    x.extend(numbers(second, upper.get(x.len() + 1..).unwrap_or_default())?);
    let (mut y, mut values) = (Vec::<f64>::new(), Vec::new());
    // The top row of a map is the first; γ grows downwards.
    let mut rows: Vec<&(usize, Vec<String>)> = rows.iter().collect();
    if what != Comparable::Intensities {
        rows.reverse();
    }
    for (line, cells) in &rows {
        let ends = numbers(line, cells.get(..2).unwrap_or_default())?;
        let gap = y.last().zip(ends.first()).map_or(0.0, |(last, next)| next - last);
        if gap.abs() > SAME_EDGE {
            let why = "the row does not begin where its neighbour ends; give all rows, with empty cells where nothing was measured";
            return Err(table.refuse_line(*line, why));
        }
        y.extend(if y.is_empty() { &ends[..] } else { ends.get(1..).unwrap_or_default() });
        for cell in cells.get(2..).unwrap_or_default() {
            values.push(table.value(*line, cell)?);
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
        return Err(table.refuse("the edges and values of the matrix do not fit together"));
    };
    let unit = lower[0].split_once(" in ").map(|(_, unit)| unit.to_owned());
    let grid = MeasuredGrid { x, y, values };
    let values = match what {
        Comparable::Surfaces => MeasuredValues::Surface(grid),
        Comparable::Images => MeasuredValues::Image(grid),
        Comparable::Intensities => MeasuredValues::Sphere(whole_circle(table, grid)?),
    };
    Ok(MeasuredMap { values, unit })
}

/// Numbers alone; size and direction come from comments or options.
fn plain_matrix(table: &TextTable, place: MatrixPlace) -> Result<MeasuredMap> {
    let (rows, columns) = (table.rows.len(), table.rows[0].1.len());
    expect_size(table, [columns, rows], LEAST_LINES)?;
    let size = |key: &str, option: Option<f64>| -> Result<f64> {
        let flag = format!("--{}", key.replace('_', "-"));
        let own = match table.comment(key) {
            None => None,
            Some((text, line)) => Some((table.number(line, text)?, line)),
        };
        match (own, option) {
            (Some((size, line)), None) if size <= 0.0 => {
                Err(table.refuse_line(line, format!("{key} is not above 0")))
            }
            (Some((own, line)), Some(option)) if own != option => {
                Err(table.refuse_line(line, format!("{key} is {own} here, but {option} in {flag}")))
            }
            (Some((size, _)), _) | (None, Some(size)) => Ok(size),
            (None, None) => Err(table.refuse(format!(
                "a matrix of numbers without its size; add the line `# {key} = ...`, or use {flag}"
            ))),
        }
    };
    let [width, height] = [size("width_mm", place.width_mm)?, size("height_mm", place.height_mm)?];
    let own = match table.comment("rows") {
        None => None,
        Some(("top", _)) => Some(FirstRow::Top),
        Some(("bottom", _)) => Some(FirstRow::Bottom),
        Some((_, line)) => {
            return Err(table.refuse_line(line, "rows must be `top` or `bottom`: the first row"));
        }
    };
    if own.is_some() && place.first_row.is_some() && own != place.first_row {
        return Err(table.refuse("`# rows = ...` of the file and --rows differ"));
    }
    let first_row = place.first_row.or(own).unwrap_or(FirstRow::Top);
    let mut values = Array2::from_elem((rows, columns), f64::NAN);
    for (place, (line, cells)) in table.rows.iter().enumerate() {
        if cells.len() != columns {
            let why = format!("{} cells, but the first row has {columns}", cells.len());
            return Err(table.refuse_line(*line, why));
        }
        let row = if first_row == FirstRow::Top { rows - 1 - place } else { place };
        for (column, cell) in cells.iter().enumerate() {
            values[[row, column]] = table.value(*line, cell)?;
        }
    }
    let [x, y] = [(width, columns), (height, rows)].map(|(size, count)| {
        (0..=count).map(|edge| size * (edge as f64 / count as f64 - 0.5)).collect()
    });
    let unit = table.comment("unit").map(|(unit, _)| unit.to_owned());
    Ok(MeasuredMap { values: MeasuredValues::Centred(MeasuredGrid { x, y, values }), unit })
}
