//! Measured maps from CSV files: columns of places and values, the matrix of a report, or a plain matrix of numbers.

use crate::diff::edges;
use crate::measured::resample::MeasuredGrid;
use crate::measured::table::TextTable;
use crate::png::AxisScale;
use lumiduct_base::error::Result;
use ndarray::Array2;

/// Most cells of a measured map.
const MOST_CELLS: usize = 1 << 24;
/// Coordinates closer than this share of their range are the same: files have few digits.
const SAME_PLACE: f64 = 1e-6;

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

/// A measured map.
#[derive(Debug)]
pub(crate) struct MeasuredMap {
    /// Its cells; those of a plain matrix lie around zero.
    pub(crate) grid: MeasuredGrid,
    /// Unit of its places: `mm` or `deg`.
    pub(crate) place_unit: &'static str,
    /// Unit of its values, where the file gives one.
    pub(crate) unit: Option<String>,
    /// Whether the file gives a size alone: the middle is then that of the sensor.
    pub(crate) is_centred: bool,
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
        Some((_, unit)) => report_matrix(table, unit)?,
        None if is_plain => plain_matrix(table, place)?,
        None => columns(table, *line, head)?,
    };
    if map.grid.values.iter().all(|value| value.is_nan() || *value == 0.0) {
        return Err(table.refuse("all values are zero or missing"));
    }
    Ok(map)
}

/// Columns with a header: two places and a value.
fn columns(table: &TextTable, line: usize, head: &[String]) -> Result<MeasuredMap> {
    let names: Vec<&str> = head.iter().map(String::as_str).collect();
    let place_unit = match names[..] {
        ["u_mm", "v_mm", _, ..] | ["x_mm", "y_mm", _, ..] => "mm",
        ["u_deg", "v_deg", _, ..] => "deg",
        ["c_from_deg", ..] => {
            let why = "a table of intensities; compare the .ies or .ldt file of the goniometer";
            return Err(table.refuse_line(line, why));
        }
        ["sector_deg", ..] => {
            let why = "a map of rings, which is not compared; use a sensor with rows and columns";
            return Err(table.refuse_line(line, why));
        }
        _ => {
            let why = "not a map; expected the columns `x_mm,y_mm,illuminance_lx` (or `u_deg,v_deg,...`), the matrix of a \
                       report, or a matrix of numbers alone";
            return Err(table.refuse_line(line, why));
        }
    };
    let mut points = Vec::new();
    for (line, cells) in &table.rows[1..] {
        let [x, y, value, ..] = &cells[..] else {
            return Err(table.refuse_line(*line, "fewer than three cells"));
        };
        let place = [table.number(*line, x)?, table.number(*line, y)?];
        points.push((*line, place, table.value(*line, value)?));
    }
    let [x, y] = [0, 1].map(|axis| lines(points.iter().map(|(_, place, _)| place[axis])));
    expect_size(table, [x.len(), y.len()])?;
    if 2 * points.len() < x.len() * y.len() {
        let why = format!(
            "{} points have {} different x and {} different y, so they are no rows and columns; \
             interpolate them to a grid before",
            points.len(),
            x.len(),
            y.len()
        );
        return Err(table.refuse(why));
    }
    let mut values = Array2::from_elem((y.len(), x.len()), f64::NAN);
    let mut is_set = Array2::from_elem(values.dim(), false);
    for (line, place, value) in points {
        let at = [nearest(&y, place[1]), nearest(&x, place[0])];
        if std::mem::replace(&mut is_set[at], true) {
            return Err(table.refuse_line(line, "a second value at the same place"));
        }
        values[at] = value;
    }
    let [x, y] = [x, y].map(|middles| edges(&middles, AxisScale::Linear));
    let unit = table.comment("unit").map(|(unit, _)| unit.to_owned());
    let unit = unit.or_else(|| names[2].rsplit_once('_').map(|(_, unit)| unit.to_owned()));
    Ok(MeasuredMap { grid: MeasuredGrid { x, y, values }, place_unit, unit, is_centred: false })
}

/// A matrix as in a report, `NAME.matrix.csv`: edges in two rows and two columns.
fn report_matrix(table: &TextTable, unit: &str) -> Result<MeasuredMap> {
    let [(first, lower), (second, upper), _, rows @ ..] = &table.rows[..] else {
        return Err(table.refuse("a matrix of a report has three header rows and values"));
    };
    let is_flat = lower[1].starts_with("u from") || lower[1].starts_with("right from");
    let place_unit = match unit {
        "mm" if is_flat => "mm",
        "deg" if is_flat => "deg",
        _ => {
            let why =
                "not a matrix of rows and columns; compare intensities with an .ies or .ldt file";
            return Err(table.refuse_line(*first, why));
        }
    };
    let numbers = |line: &usize, cells: &[String]| -> Result<Vec<f64>> {
        cells.iter().map(|cell| table.number(*line, cell)).collect()
    };
    let mut x = numbers(first, lower.get(2..).unwrap_or_default())?;
    expect_size(table, [x.len(), rows.len()])?;
    x.extend(numbers(second, upper.get(x.len() + 1..).unwrap_or_default())?);
    let (mut y, mut values) = (Vec::new(), Vec::new());
    // The top row is the first.
    for (line, cells) in rows.iter().rev() {
        let ends = numbers(line, cells.get(..2).unwrap_or_default())?;
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
    Ok(MeasuredMap { grid: MeasuredGrid { x, y, values }, place_unit, unit, is_centred: false })
}

/// Numbers alone; size and direction come from comments or options.
fn plain_matrix(table: &TextTable, place: MatrixPlace) -> Result<MeasuredMap> {
    let (rows, columns) = (table.rows.len(), table.rows[0].1.len());
    expect_size(table, [columns, rows])?;
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
    let grid = MeasuredGrid { x, y, values };
    Ok(MeasuredMap { grid, place_unit: "mm", unit, is_centred: true })
}

fn expect_size(table: &TextTable, [columns, rows]: [usize; 2]) -> Result<()> {
    if columns < 2 || rows < 2 || columns.saturating_mul(rows) > MOST_CELLS {
        return Err(table.refuse(format!(
            "{columns} by {rows} values; expected at least 2 by 2, and at most {MOST_CELLS} in all"
        )));
    }
    Ok(())
}

/// The different coordinates, in ascending order.
fn lines(all: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut lines: Vec<f64> = all.collect();
    lines.sort_by(f64::total_cmp);
    let range = lines.last().zip(lines.first()).map_or(0.0, |(last, first)| last - first);
    lines.dedup_by(|next, kept| *next - *kept <= SAME_PLACE * range);
    lines
}

fn nearest(lines: &[f64], at: f64) -> usize {
    let above = lines.partition_point(|line| *line < at).min(lines.len() - 1);
    let is_below = above > 0 && at - lines[above - 1] < lines[above] - at;
    if is_below { above - 1 } else { above }
}
