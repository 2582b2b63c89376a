//! Rows of a measured table with two places and a value each, as rows and columns of a grid.

use crate::measured::error::MeasuredError;
use crate::measured::table::{TextRow, TextTable, number, value};
use ndarray::Array2;

/// Most cells of a measured map.
const MOST_CELLS: usize = 1 << 24;
/// Coordinates closer than this share of their range are the same: files have few digits.
const SAME_PLACE: f64 = 1e-6;

/// Values at single places.
#[derive(Debug)]
pub(super) struct GridPoints {
    /// Places of the columns, in ascending order.
    pub(super) x: Vec<f64>,
    /// Places of the rows, in ascending order.
    pub(super) y: Vec<f64>,
    /// Values, `[[row, column]]`; NaN where nothing was measured.
    pub(super) values: Array2<f64>,
}

impl GridPoints {
    /// The first three columns of a table with a header, of at least so many columns and rows of a grid.
    ///
    /// # Errors
    ///
    /// [`MeasuredError`] if the cells are no numbers, or the points no grid.
    pub(super) fn read(table: &TextTable<'_>, least: [usize; 2]) -> Result<Self, MeasuredError> {
        let mut points = Vec::new();
        for TextRow { line, cells } in &table.rows[1..] {
            let [x, y, light, ..] = &cells[..] else {
                return Err(MeasuredError::of_line(*line, "fewer than three cells"));
            };
            let place = [number(*line, x)?, number(*line, y)?];
            points.push((*line, place, value(*line, light)?));
        }
        let [x, y] = [0, 1].map(|axis| lines(points.iter().map(|(_, place, _)| place[axis])));
        let first_line = table.line(1);
        expect_size(first_line, [x.len(), y.len()], least)?;
        if 2 * points.len() < x.len() * y.len() {
            let why = format!(
                "the {} points from here on have {} different places in the first column and {} in the second, so they are no rows \
                 and columns; interpolate them to a grid before",
                points.len(),
                x.len(),
                y.len()
            );
            return Err(MeasuredError::of_line(first_line, why));
        }
        let mut values = Array2::from_elem((y.len(), x.len()), f64::NAN);
        let mut is_set = Array2::from_elem(values.dim(), false);
        for (line, place, value) in points {
            let at = [nearest(&y, place[1]), nearest(&x, place[0])];
            if std::mem::replace(&mut is_set[at], true) {
                return Err(MeasuredError::of_line(line, "a second value at the same place"));
            }
            values[at] = value;
        }
        Ok(Self { x, y, values })
    }
}

/// Refuses too few columns and rows, and too many cells, of values that begin in a line.
///
/// # Errors
///
/// [`MeasuredError::WrongLine`] with their numbers.
pub(super) fn expect_size(
    line: usize,
    [columns, rows]: [usize; 2],
    least: [usize; 2],
) -> Result<(), MeasuredError> {
    if columns < least[0] || rows < least[1] || columns.saturating_mul(rows) > MOST_CELLS {
        let plural = |count: usize| if count == 1 { "" } else { "s" };
        let why = format!(
            "the values from here on make {columns} column{} and {rows} row{}; expected at least {} by {}, and at most {MOST_CELLS} values in all",
            plural(columns),
            plural(rows),
            least[0],
            least[1]
        );
        return Err(MeasuredError::of_line(line, why));
    }
    Ok(())
}

/// The different coordinates, in ascending order.
pub(super) fn lines(all: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut lines: Vec<f64> = all.collect();
    lines.sort_by(f64::total_cmp);
    let range = lines.last().zip(lines.first()).map_or(0.0, |(last, first)| last - first);
    lines.dedup_by(|next, kept| *next - *kept <= SAME_PLACE * range);
    lines
}

/// The nearest of some lines in ascending order.
pub(super) fn nearest(lines: &[f64], at: f64) -> usize {
    let above = lines.partition_point(|line| *line < at).min(lines.len() - 1);
    let is_below = above > 0 && at - lines[above - 1] < lines[above] - at;
    if is_below { above - 1 } else { above }
}

/// Edges of cells: halfway between their middles, of which there are at least two.
pub(super) fn edges(middles: &[f64]) -> Vec<f64> {
    let last = middles.len() - 1;
    let between = middles.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let first = middles[0] - 0.5 * (middles[1] - middles[0]);
    let end = middles[last] + 0.5 * (middles[last] - middles[last - 1]);
    [first].into_iter().chain(between).chain([end]).collect()
}
