//! Common parts of pictures: heading, legend, frame with axes, and the size of a plot in
//! millimetres.

use crate::png::axis::{PlotAxis, Ticks};
use crate::png::canvas::{Canvas, Ink, Pen};
use crate::png::geometry::{Point, Rect};
use crate::png::marked_axis::MarkedAxis;
use crate::png::palette::{GRID, INK, Rgb, SOFT_INK};
use crate::png::text::{Align, Direction, Font, LABEL, Label, TICK, TITLE};
use lumiduct_base::error::Result;

/// White space around everything, pixels.
pub(crate) const MARGIN: f64 = 24.0;
/// Space between title and subtitle, pixels.
const TITLE_GAP: f64 = 3.0;
/// Length of the marks at an axis, pixels.
const TICK_LENGTH: f64 = 5.0;
/// Length of the marks without a number, pixels.
const MINOR_LENGTH: f64 = 3.0;
/// Space between a mark and its label, pixels.
const TICK_GAP: f64 = 4.0;

/// Writes a horizontal label in the usual dark grey.
pub(crate) fn write(
    canvas: &mut Canvas,
    text: &str,
    at: Point,
    font: Font,
    align: Align,
) -> Result<()> {
    canvas.text(&Label { text, at, font, align, direction: Direction::Level, colour: INK })
}

/// Writes a remark in small grey letters that begins there.
pub(crate) fn remark(canvas: &mut Canvas, text: &str, at: Point) -> Result<()> {
    let (align, direction) = (Align::Left, Direction::Level);
    canvas.text(&Label { text, at, font: TICK, align, direction, colour: SOFT_INK })
}

/// Title and subtitle, broken into lines.
pub(crate) struct Header {
    title: Vec<String>,
    subtitle: Vec<String>,
}

impl Header {
    /// A heading of at most two lines of title and three of subtitle, `width` pixels wide.
    pub(crate) fn new(title: &str, subtitle: &str, width: f64) -> Result<Self> {
        Ok(Self { title: TITLE.wrap(title, width, 2)?, subtitle: LABEL.wrap(subtitle, width, 3)? })
    }

    /// Height with the space below, pixels.
    pub(crate) fn height(&self) -> f64 {
        let lines = self.title.len() as f64 * TITLE.line_step()
            + self.subtitle.len() as f64 * LABEL.line_step();
        if lines > 0.0 { lines + TITLE_GAP + 12.0 } else { 0.0 }
    }

    /// Writes it with its upper left corner there.
    pub(crate) fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) -> Result<()> {
        let mut y = top;
        for (lines, font, colour) in [(&self.title, TITLE, INK), (&self.subtitle, LABEL, SOFT_INK)]
        {
            for text in lines {
                let at = [left, (y + 0.95 * font.size).round()];
                let direction = Direction::Level;
                canvas.text(&Label { text, at, font, align: Align::Left, direction, colour })?;
                y += font.line_step();
            }
            y += TITLE_GAP;
        }
        Ok(())
    }
}

/// The sample before a name in a legend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LegendSample {
    /// A piece of line.
    Line(Pen),
    /// A dot of a radius in pixels.
    Dot(Rgb, f64),
    /// A line that ends in a mark.
    MarkedLine(Pen, EndMark),
}

/// The mark at the end of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EndMark {
    /// A filled circle.
    Dot,
    /// Two crossing strokes.
    Cross,
    /// An open circle.
    Ring,
    /// A filled square.
    Square,
}

/// Names with samples, in rows.
pub(crate) struct Legend {
    entries: Vec<(Point, LegendSample, String)>,
    height: f64,
}

/// Further names are only counted.
const MOST_ENTRIES: usize = 24;
/// Width of the sample and its space, pixels.
const SAMPLE_WIDTH: f64 = 34.0;

impl Legend {
    /// A legend of the entries that have a name, in rows of at most `width` pixels.
    pub(crate) fn new(entries: &[(LegendSample, &str)], width: f64) -> Result<Self> {
        const SPACE: f64 = 26.0;
        let (mut x, mut y) = (0.0, 0.0);
        let mut placed = Vec::new();
        let named: Vec<&(LegendSample, &str)> =
            entries.iter().filter(|(_, name)| !name.is_empty()).collect();
        for (index, (sample, name)) in named.iter().take(MOST_ENTRIES).enumerate() {
            let left_out = named.len().saturating_sub(MOST_ENTRIES - 1);
            let name = if index + 1 == MOST_ENTRIES && left_out > 1 {
                format!("and {left_out} more")
            } else {
                LABEL.fit(name, 0.7 * width)?
            };
            let needed = SAMPLE_WIDTH + LABEL.width(&name)?;
            if x > 0.0 && x + needed > width {
                (x, y) = (0.0, y + LABEL.line_step() + 2.0);
            }
            placed.push(([x, y], *sample, name));
            x += needed + SPACE;
        }
        let height = if placed.is_empty() { 0.0 } else { y + LABEL.line_step() + 10.0 };
        Ok(Self { entries: placed, height })
    }

    /// Height with the space below, pixels.
    pub(crate) fn height(&self) -> f64 {
        self.height
    }

    /// Draws it with its upper left corner there.
    pub(crate) fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) -> Result<()> {
        for (place, sample, name) in &self.entries {
            let x = left + place[0];
            let baseline = (top + place[1] + LABEL.size).round();
            let middle = (baseline - 0.5 * LABEL.cap_height()).floor() + 0.5;
            let ends = [[x + 1.0, middle], [x + SAMPLE_WIDTH - 9.0, middle]];
            match *sample {
                LegendSample::Line(pen) => canvas.line(&ends, &pen),
                LegendSample::Dot(colour, radius) => {
                    let centre = [0.5 * (ends[0][0] + ends[1][0]), middle];
                    canvas.dot(centre, radius, Ink::opaque(colour));
                }
                LegendSample::MarkedLine(pen, mark) => {
                    canvas.line(&ends, &pen);
                    draw_mark(canvas, mark, ends[1], pen.ink.colour);
                }
            }
            write(canvas, name, [x + SAMPLE_WIDTH, baseline], LABEL, Align::Left)?;
        }
        Ok(())
    }
}

/// Draws the mark at the end of a line.
pub(crate) fn draw_mark(canvas: &mut Canvas, mark: EndMark, at: Point, colour: Rgb) {
    let ink = Ink::opaque(colour);
    let pen = Pen { ink, width: 1.4, dash: &[] };
    let corner = |dx: f64, dy: f64| [at[0] + dx, at[1] + dy];
    match mark {
        EndMark::Dot => canvas.dot(at, 2.8, ink),
        EndMark::Cross => {
            canvas.line(&[corner(-3.0, -3.0), corner(3.0, 3.0)], &pen);
            canvas.line(&[corner(-3.0, 3.0), corner(3.0, -3.0)], &pen);
        }
        EndMark::Ring => {
            let circle: Vec<Point> = (0..=24)
                .map(|step| (f64::from(step) * std::f64::consts::TAU / 24.0).sin_cos())
                .map(|(sin, cos)| corner(3.0 * cos, 3.0 * sin))
                .collect();
            canvas.line(&circle, &pen);
        }
        EndMark::Square => canvas.rect(Rect::new(at[0] - 2.8, at[1] - 2.8, 5.6, 5.6), ink),
    }
}

/// The two axes of a plot, with marks and labels.
pub(crate) struct PlotAxes {
    x: PlotAxis,
    y: PlotAxis,
    x_ticks: Ticks,
    y_ticks: Ticks,
    x_label: String,
    y_label: String,
    tick_width: f64,
}

impl PlotAxes {
    /// Axes for a plot of a width and height in pixels.
    pub(crate) fn new([x, y]: [MarkedAxis; 2], [width, height]: [f64; 2]) -> Result<Self> {
        let mut tick_width = 0.0f64;
        for tick in &y.ticks.major {
            tick_width = tick_width.max(TICK.width(&tick.label)?);
        }
        let x_label = LABEL.fit(&x.label, width.max(260.0))?;
        let y_label = LABEL.fit(&y.label, height.max(160.0))?;
        let (x_ticks, y_ticks) = (x.ticks, y.ticks);
        Ok(Self { x: x.axis, y: y.axis, x_ticks, y_ticks, x_label, y_label, tick_width })
    }

    /// Room that is needed left of the plot, pixels.
    pub(crate) fn left_margin(&self) -> f64 {
        let label = if self.y_label.is_empty() { 0.0 } else { LABEL.line_step() + 4.0 };
        (label + self.tick_width + TICK_GAP + TICK_LENGTH + 1.0).ceil()
    }

    /// Room that is needed below the plot, pixels.
    pub(crate) fn bottom_margin(&self) -> f64 {
        let label = if self.x_label.is_empty() { 0.0 } else { LABEL.line_step() + 6.0 };
        TICK_LENGTH + TICK_GAP + TICK.line_step() + label
    }

    /// Where a point of the data lies on the canvas; NaN where it has no place.
    pub(crate) fn place(&self, area: Rect, [x, y]: Point) -> Point {
        [
            area.left + self.x.fraction(x) * area.width(),
            area.bottom - self.y.fraction(y) * area.height(),
        ]
    }

    /// The lines of the grid, to be drawn before the data.
    pub(crate) fn draw_grid(&self, canvas: &mut Canvas, area: Rect) {
        for tick in &self.x_ticks.major {
            let x = self.column(area, tick.value);
            canvas.rect(Rect::new(x, area.top, 1.0, area.height()), Ink::opaque(GRID));
        }
        for tick in &self.y_ticks.major {
            let y = self.row(area, tick.value);
            canvas.rect(Rect::new(area.left, y, area.width(), 1.0), Ink::opaque(GRID));
        }
    }

    /// The frame with marks, numbers and labels, to be drawn after the data.
    pub(crate) fn draw(&self, canvas: &mut Canvas, area: Rect) -> Result<()> {
        let ink = Ink::opaque(INK);
        canvas.border(area, ink);
        for (value, length) in marks(&self.x_ticks) {
            let x = self.column(area, value);
            canvas.rect(Rect::new(x, area.bottom + 1.0, 1.0, length), ink);
        }
        for (value, length) in marks(&self.y_ticks) {
            let y = self.row(area, value);
            canvas.rect(Rect::new(area.left - 1.0 - length, y, length, 1.0), ink);
        }
        self.draw_numbers(canvas, area)?;
        self.draw_labels(canvas, area)
    }

    fn draw_numbers(&self, canvas: &mut Canvas, area: Rect) -> Result<()> {
        let below = area.bottom + TICK_LENGTH + TICK_GAP + TICK.size;
        for tick in &self.x_ticks.major {
            let at = [self.column(area, tick.value) + 0.5, below];
            write(canvas, &tick.label, at, TICK, Align::Centre)?;
        }
        let right = area.left - 1.0 - TICK_LENGTH - TICK_GAP;
        for tick in &self.y_ticks.major {
            let y = self.row(area, tick.value) + 0.5 + 0.5 * TICK.cap_height();
            write(canvas, &tick.label, [right, y], TICK, Align::Right)?;
        }
        Ok(())
    }

    fn draw_labels(&self, canvas: &mut Canvas, area: Rect) -> Result<()> {
        let middle = area.middle();
        let below = area.bottom + self.bottom_margin() - 4.0;
        write(canvas, &self.x_label, [middle[0], below], LABEL, Align::Centre)?;
        canvas.text(&Label {
            text: &self.y_label,
            at: [area.left - self.left_margin() + LABEL.size - 2.0, middle[1]],
            font: LABEL,
            align: Align::Centre,
            direction: Direction::Upward,
            colour: INK,
        })
    }

    /// The column of pixels of a mark: inside the plot also at its ends.
    fn column(&self, area: Rect, value: f64) -> f64 {
        let x = area.left + self.x.fraction(value) * area.width();
        x.floor().clamp(area.left, area.right - 1.0)
    }

    /// The row of pixels of a mark: inside the plot also at its ends.
    fn row(&self, area: Rect, value: f64) -> f64 {
        let y = area.bottom - self.y.fraction(value) * area.height();
        y.floor().clamp(area.top, area.bottom - 1.0)
    }
}

/// All marks of an axis with their lengths in pixels.
fn marks(ticks: &Ticks) -> impl Iterator<Item = (f64, f64)> {
    let major = ticks.major.iter().map(|tick| (tick.value, TICK_LENGTH));
    major.chain(ticks.minor.iter().map(|&value| (value, MINOR_LENGTH)))
}

/// The size in pixels at which a plot is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlotSize {
    /// Width, whole pixels.
    pub(crate) width: f64,
    /// Height, whole pixels.
    pub(crate) height: f64,
    /// Whether a millimetre is equally long in both directions.
    pub(crate) aspect: Aspect,
}

/// Whether a unit is equally long in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Aspect {
    /// It is.
    True,
    /// One direction is squeezed, for the plot would be too narrow to read.
    Squeezed,
}

/// Remark below a plot whose aspect is not true.
pub(crate) const SQUEEZED_REMARK: &str = "The axes are not to the same scale.";

/// The largest size within `most` pixels of a plot of these ranges, at true aspect unless that
/// exceeds `longest`.
pub(crate) fn plot_size([x, y]: [PlotAxis; 2], most: [f64; 2], longest: f64) -> PlotSize {
    let ratio = x.extent() / y.extent();
    let aspect =
        if (1.0 / longest..=longest).contains(&ratio) { Aspect::True } else { Aspect::Squeezed };
    let ratio = ratio.clamp(1.0 / longest, longest);
    let width = most[0].min(most[1] * ratio);
    PlotSize { width: width.round(), height: (width / ratio).round(), aspect }
}
