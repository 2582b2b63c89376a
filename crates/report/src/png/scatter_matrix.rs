//! Scatter matrices: several quantities of the same items, each against each.

use crate::png::axis::{AxisScale, PlotAxis};
use crate::png::canvas::{Canvas, Ink, Pen};
use crate::png::geometry::{Point, Rect};
use crate::png::layout::{EndMark, Header, Legend, LegendSample, MARGIN, draw_mark, write};
use crate::png::palette::{GRID, INK, Rgb, series_ink};
use crate::png::text::{Align, LABEL, TICK};
use lumiduct_base::error::Result;
use lumiduct_base::number::format_value;

/// Several quantities of the same items.
#[derive(Debug, Clone)]
pub(crate) struct ScatterMatrix {
    /// What is shown.
    pub title: String,
    /// How it was found; may be empty.
    pub subtitle: String,
    /// The quantities; the first eight are drawn.
    pub columns: Vec<ScatterColumn>,
    /// The kind of each item, as an index into `kinds`.
    pub kind_of: Vec<usize>,
    /// Names of the kinds; at most three are distinguished.
    pub kinds: Vec<String>,
}

/// One quantity.
#[derive(Debug, Clone)]
pub(crate) struct ScatterColumn {
    /// Name and unit.
    pub label: String,
    /// A value for each item; non-finite ones are left out.
    pub values: Vec<f64>,
}

const MOST: usize = 8;
/// Width of the whole picture, pixels.
const WIDTH: f64 = 900.0;
/// Space between two panels, pixels.
const GAP: f64 = 8.0;
/// Room for the numbers left of the panels, pixels.
const LEFT: f64 = 62.0;
/// Share of a range that is left free at each end.
const PADDING: f64 = 0.06;

/// Draws every quantity against every other; names and ranges are on the diagonal.
pub(crate) fn scatter_matrix(matrix: &ScatterMatrix) -> Result<Vec<u8>> {
    let columns = &matrix.columns[..matrix.columns.len().min(MOST)];
    let header = Header::new(&matrix.title, &matrix.subtitle, WIDTH - 2.0 * MARGIN)?;
    let entries: Vec<(LegendSample, &str)> = matrix
        .kinds
        .iter()
        .enumerate()
        .filter(|_| matrix.kinds.len() > 1)
        .map(|(kind, name)| (sample(kind), name.as_str()))
        .collect();
    let legend = Legend::new(&entries, WIDTH - 2.0 * MARGIN)?;
    let count = columns.len().max(1) as f64;
    let size = ((WIDTH - 2.0 * MARGIN - LEFT - (count - 1.0) * GAP) / count).min(260.0).floor();
    let top = (MARGIN + header.height() + legend.height()).round();
    let height = top + count * (size + GAP) + TICK.line_step() + MARGIN;

    let mut canvas = Canvas::new(WIDTH as usize, height as usize);
    header.draw(&mut canvas, MARGIN, MARGIN - 4.0)?;
    legend.draw(&mut canvas, MARGIN, MARGIN + header.height() - 8.0)?;
    let axes: Vec<PlotAxis> = columns.iter().map(axis).collect();
    for row in 0..columns.len() {
        for column in 0..columns.len() {
            let left = MARGIN + LEFT + column as f64 * (size + GAP);
            let area = Rect::new(left, top + row as f64 * (size + GAP), size, size);
            if column == 0 {
                numbers_beside(&mut canvas, area, &columns[row])?;
            }
            if row + 1 == columns.len() {
                numbers_below(&mut canvas, area, &columns[column])?;
            }
            if row == column {
                name(&mut canvas, area, &columns[row])?;
                continue;
            }
            let place = |thing: usize| -> Point {
                let [x, y] = [(column, axes[column]), (row, axes[row])]
                    .map(|(own, axis)| axis.fraction(columns[own].values[thing]));
                [area.left + x * size, area.bottom - y * size]
            };
            canvas.border(area, Ink::opaque(GRID));
            canvas.clip_to(area.grown(3.0));
            for (thing, kind) in matrix.kind_of.iter().enumerate() {
                let at = place(thing);
                if at.iter().all(|coordinate| coordinate.is_finite()) {
                    draw_mark(&mut canvas, look(*kind).1, at, look(*kind).0);
                }
            }
            canvas.clip_to_all();
        }
    }
    canvas.into_png()
}

/// Colour and mark of a kind.
fn look(kind: usize) -> (Rgb, EndMark) {
    const MARKS: [EndMark; 3] = [EndMark::Dot, EndMark::Cross, EndMark::Ring];
    (series_ink(kind % MARKS.len()).colour, MARKS[kind % MARKS.len()])
}

fn sample(kind: usize) -> LegendSample {
    let (colour, mark) = look(kind);
    LegendSample::MarkedLine(Pen { ink: Ink::opaque(colour), width: 0.0, dash: &[] }, mark)
}

fn finite(column: &ScatterColumn) -> [f64; 2] {
    let values = || column.values.iter().copied().filter(|value| value.is_finite());
    [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
}

fn axis(column: &ScatterColumn) -> PlotAxis {
    let [min, max] = finite(column);
    let padding = PADDING * (max - min);
    PlotAxis::new(min - padding, max + padding, AxisScale::Linear)
}

/// Name and range of a quantity, in its panel of the diagonal.
fn name(canvas: &mut Canvas, area: Rect, column: &ScatterColumn) -> Result<()> {
    canvas.border(area, Ink::opaque(INK));
    let lines = LABEL.wrap(&column.label, area.width() - 12.0, 4)?;
    let step = LABEL.line_step();
    let mut y = area.middle()[1] - 0.5 * step * lines.len() as f64 + LABEL.size;
    for line in lines {
        write(canvas, &line, [area.middle()[0], y], LABEL, Align::Centre)?;
        y += step;
    }
    Ok(())
}

/// The ends of a range left of a panel.
fn numbers_beside(canvas: &mut Canvas, area: Rect, column: &ScatterColumn) -> Result<()> {
    let [min, max] = finite(column);
    let right = area.left - 6.0;
    write(canvas, &format_value(max), [right, area.top + TICK.size], TICK, Align::Right)?;
    write(canvas, &format_value(min), [right, area.bottom - 2.0], TICK, Align::Right)
}

/// The ends of a range below a panel.
fn numbers_below(canvas: &mut Canvas, area: Rect, column: &ScatterColumn) -> Result<()> {
    let [min, max] = finite(column);
    let below = area.bottom + TICK.size + 6.0;
    write(canvas, &format_value(min), [area.left, below], TICK, Align::Left)?;
    write(canvas, &format_value(max), [area.right, below], TICK, Align::Right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::tests::Decoded;

    fn matrix(values: Vec<Vec<f64>>) -> ScatterMatrix {
        let things = values[0].len();
        ScatterMatrix {
            title: "Designs".into(),
            subtitle: String::new(),
            columns: values
                .into_iter()
                .map(|values| ScatterColumn { label: "length in mm".into(), values })
                .collect(),
            kind_of: (0..things).map(|thing| thing % 2).collect(),
            kinds: vec!["passed".into(), "failed".into()],
        }
    }

    #[test]
    fn every_kind_is_drawn_in_its_colour() {
        let picture = Decoded::new(
            &scatter_matrix(&matrix(vec![vec![0.0, 1.0, 2.0, 3.0], vec![5.0, 1.0, 3.0, 2.0]]))
                .unwrap(),
        );
        assert!(picture.places(look(0).0).len() > 20 && picture.places(look(1).0).len() > 10);
    }

    #[test]
    fn values_that_are_missing_or_all_alike_are_no_trouble() {
        for values in [vec![f64::NAN; 3], vec![1.0; 3], vec![f64::INFINITY, 0.0, -1.0]] {
            assert!(scatter_matrix(&matrix(vec![values.clone(), values])).is_ok());
        }
        assert!(
            scatter_matrix(&ScatterMatrix { columns: Vec::new(), ..matrix(vec![vec![]]) }).is_ok()
        );
    }
}
