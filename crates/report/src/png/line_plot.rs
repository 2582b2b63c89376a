//! Curves over an axis: sections of maps, radial profiles, histograms.

mod range;
#[cfg(test)]
mod tests;

use crate::png::axis::{AxisScale, PlotAxis};
use crate::png::canvas::{Canvas, Ink, Pen};
use crate::png::geometry::{Point, Rect};
use crate::png::layout::{Header, Legend, LegendSample, MARGIN, PlotAxes, write};
use crate::png::marked_axis::MarkedAxis;
use crate::png::palette::{SOFT_INK, SeriesInk, paired_colour, series_ink};
use crate::png::text::{Align, LABEL};
use lumiduct_base::error::Result;
use range::{Padding, range};

/// Curves over an axis.
#[derive(Debug, Clone)]
pub(crate) struct LinePlot {
    /// What is shown.
    pub title: String,
    /// How it was found; may be empty.
    pub subtitle: String,
    /// Name and unit of the horizontal axis: "r in mm".
    pub x_label: String,
    /// Name and unit of the vertical axis.
    pub y_label: String,
    /// Scale of both axes; points at zero and below have no place on a logarithmic one.
    pub scale: AxisScale,
    /// The curves; those without a name are not in the legend.
    pub series: Vec<PlotSeries>,
}

/// One curve.
#[derive(Debug, Clone)]
pub(crate) struct PlotSeries {
    /// Its name in the legend; may be empty.
    pub name: String,
    /// Its points, in the order in which they are joined; non-finite values interrupt it.
    pub points: Vec<SeriesPoint>,
    /// How the points are joined.
    pub form: SeriesForm,
    /// How the standard errors are shown.
    pub errors: ErrorForm,
    /// How it is distinguished from the others.
    pub look: Look,
}

impl PlotSeries {
    /// A curve that is distinguished by its index.
    pub(crate) fn new(
        name: impl Into<String>,
        points: Vec<SeriesPoint>,
        form: SeriesForm,
        errors: ErrorForm,
    ) -> Self {
        Self { name: name.into(), points, form, errors, look: Look::InTurn }
    }
}

/// How a curve is distinguished from the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Look {
    /// By the colour and dashes of its index among all.
    InTurn,
    /// Solid, in the colour of a number.
    Solid(usize),
    /// Dashed, in the colour of a number.
    Dashed(usize),
    /// A thin dotted grey line, for a bound, not a result.
    Bound,
}

/// A point with a standard error, in the units of the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SeriesPoint {
    /// Where.
    pub x: f64,
    /// How much.
    pub y: f64,
    /// Standard error of y; zero or non-finite where there is none.
    pub std_error: f64,
}

/// How points are joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SeriesForm {
    /// By straight lines.
    Line,
    /// Each is a horizontal step that extends half way to its neighbours, as in a histogram.
    Steps,
    /// Not at all: each is a dot.
    Dots,
}

/// How standard errors are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ErrorForm {
    /// Not at all.
    Hidden,
    /// A bar at each point, one standard error to either side.
    Bars,
    /// A band along the curve, one standard error to either side.
    Band,
}

/// How far dots and error bars reach beyond the frame, pixels.
const OVERHANG: f64 = 4.0;
/// Width of the picture, pixels.
const WIDTH: f64 = 900.0;
/// Height of the frame, pixels.
const HEIGHT: f64 = 400.0;

/// Draws curves over two axes, with a legend above the frame.
pub(crate) fn line_plot(plot: &LinePlot) -> Result<Vec<u8>> {
    stacked_plots(std::slice::from_ref(plot))
}

/// Draws plots of curves in one picture, the first on top.
pub(crate) fn stacked_plots(plots: &[LinePlot]) -> Result<Vec<u8>> {
    let panels = plots.iter().map(Panel::new).collect::<Result<Vec<Panel<'_>>>>()?;
    let height: f64 = panels.iter().map(Panel::height).sum();
    let mut canvas = Canvas::new(WIDTH as usize, height as usize);
    let mut top = 0.0;
    for panel in &panels {
        panel.draw(&mut canvas, top)?;
        top += panel.height();
    }
    canvas.into_png()
}

/// A plot with its place for everything.
struct Panel<'a> {
    plot: &'a LinePlot,
    header: Header,
    legend: Legend,
    frame: PlotAxes,
    /// Place of the frame below the top of the plot, pixels.
    area: Rect,
}

impl<'a> Panel<'a> {
    fn new(plot: &'a LinePlot) -> Result<Self> {
        let header = Header::new(&plot.title, &plot.subtitle, WIDTH - 2.0 * MARGIN)?;
        let entries: Vec<(LegendSample, &str)> = plot
            .series
            .iter()
            .enumerate()
            .map(|(index, series)| (sample(series, ink(series, index)), series.name.as_str()))
            .collect();
        let legend = Legend::new(&entries, WIDTH - 2.0 * MARGIN)?;
        let top = MARGIN + header.height() + legend.height();
        let frame = PlotAxes::new(line_axes(plot, plot.scale), [WIDTH - 4.0 * MARGIN, HEIGHT])?;
        let left = MARGIN + frame.left_margin();
        let area = Rect::new(left, top.round(), WIDTH - MARGIN - 6.0 - left, HEIGHT);
        Ok(Self { plot, header, legend, frame, area })
    }

    /// Whole pixels.
    fn height(&self) -> f64 {
        (self.area.bottom + self.frame.bottom_margin() + MARGIN - 6.0).floor()
    }

    fn draw(&self, canvas: &mut Canvas, top: f64) -> Result<()> {
        let Self { plot, header, legend, frame, area } = self;
        let area = Rect { top: top + area.top, bottom: top + area.bottom, ..*area };
        canvas.clip_to_all();
        header.draw(canvas, MARGIN, top + MARGIN - 4.0)?;
        legend.draw(canvas, MARGIN, top + MARGIN + header.height() - 8.0)?;
        frame.draw_grid(canvas, area);
        for (index, series) in plot.series.iter().enumerate() {
            draw_errors(canvas, frame, area, series, ink(series, index));
        }
        for (index, series) in plot.series.iter().enumerate() {
            draw_curve(canvas, frame, area, series, ink(series, index));
        }
        canvas.clip_to_all();
        frame.draw(canvas, area)?;
        if !plot.series.iter().flat_map(|series| &series.points).any(is_drawn) {
            write(canvas, "No values.", area.middle(), LABEL, Align::Centre)?;
        }
        Ok(())
    }
}

/// The axes of curves, the vertical one with this scale: the description shared by pictures and
/// pages.
pub(crate) fn line_axes(plot: &LinePlot, y_scale: AxisScale) -> [MarkedAxis; 2] {
    let [x, y] = data_axes(plot, y_scale);
    let x = MarkedAxis::level(x, &plot.x_label, WIDTH - 4.0 * MARGIN);
    [x, MarkedAxis::upright(y, &plot.y_label, HEIGHT)]
}

/// How a curve is drawn, by its index among all.
pub(crate) fn ink(series: &PlotSeries, index: usize) -> SeriesInk {
    match series.look {
        Look::InTurn => series_ink(index),
        Look::Solid(number) => SeriesInk { colour: paired_colour(number), dash: &[] },
        Look::Dashed(number) => SeriesInk { colour: paired_colour(number), dash: &[6.0, 5.0] },
        Look::Bound => SeriesInk { colour: SOFT_INK, dash: &[2.0, 4.0] },
    }
}

fn is_drawn(point: &SeriesPoint) -> bool {
    point.x.is_finite() && point.y.is_finite()
}

fn error_of(point: &SeriesPoint) -> f64 {
    if point.std_error.is_finite() { point.std_error.abs() } else { 0.0 }
}

fn sample(series: &PlotSeries, ink: SeriesInk) -> LegendSample {
    match series.form {
        SeriesForm::Line | SeriesForm::Steps => LegendSample::Line(pen(ink)),
        SeriesForm::Dots => LegendSample::Dot(ink.colour, 3.0),
    }
}

fn pen(ink: SeriesInk) -> Pen {
    Pen { ink: Ink::opaque(ink.colour), width: 2.0, dash: ink.dash }
}

/// The points of a curve as they are joined, in units of the axes.
fn outline(series: &PlotSeries) -> Vec<Point> {
    let points = &series.points;
    match series.form {
        SeriesForm::Line | SeriesForm::Dots => points.iter().map(|p| [p.x, p.y]).collect(),
        SeriesForm::Steps => points
            .iter()
            .enumerate()
            .flat_map(|(index, point)| {
                let before = index.checked_sub(1).map(|before| points[before].x);
                let after = points.get(index + 1).map(|after| after.x);
                let [left, right] = step_edges(point.x, before, after);
                [[left, point.y], [right, point.y]]
            })
            .collect(),
    }
}

/// The edges of a step: half way to its neighbours; symmetric where there is only one, half a unit
/// where there is none.
fn step_edges(x: f64, before: Option<f64>, after: Option<f64>) -> [f64; 2] {
    let halves = [before.map(|before| 0.5 * (x - before)), after.map(|after| 0.5 * (after - x))];
    let left = halves[0].or(halves[1]).unwrap_or(0.5);
    let right = halves[1].or(halves[0]).unwrap_or(0.5);
    [x - left, x + right]
}

/// Axes around all curves and their error bars.
fn data_axes(plot: &LinePlot, y_scale: AxisScale) -> [PlotAxis; 2] {
    let mut xs = Vec::new();
    let mut ys = Vec::new();
    for series in &plot.series {
        xs.extend(outline(series).into_iter().filter(|p| p[1].is_finite()).map(|p| p[0]));
        for point in series.points.iter().filter(|point| is_drawn(point)) {
            ys.push(point.y);
            match series.errors {
                ErrorForm::Hidden => {}
                ErrorForm::Bars | ErrorForm::Band => {
                    ys.extend([point.y - error_of(point), point.y + error_of(point)]);
                }
            }
        }
    }
    [range(&xs, plot.scale, Padding::None), range(&ys, y_scale, Padding::Around)]
}

fn draw_errors(
    canvas: &mut Canvas,
    frame: &PlotAxes,
    area: Rect,
    series: &PlotSeries,
    ink: SeriesInk,
) {
    match series.errors {
        ErrorForm::Hidden => {}
        ErrorForm::Bars => {
            canvas.clip_to(area.grown(OVERHANG));
            for point in series.points.iter().filter(|p| is_drawn(p) && error_of(p) > 0.0) {
                let low = frame.place(area, [point.x, point.y - error_of(point)]);
                let high = frame.place(area, [point.x, point.y + error_of(point)]);
                let pen = Pen { ink: Ink::opaque(ink.colour), width: 1.2, dash: &[] };
                canvas.line(&[low, high], &pen);
                for end in [low, high] {
                    canvas.line(&[[end[0] - 3.5, end[1]], [end[0] + 3.5, end[1]]], &pen);
                }
            }
        }
        ErrorForm::Band => {
            canvas.clip_to(area);
            let shifted = |sign: f64| {
                let points = series.points.iter().map(move |point| SeriesPoint {
                    y: point.y + sign * error_of(point),
                    ..*point
                });
                outline(&PlotSeries { points: points.collect(), ..series.clone() })
            };
            let (lower, upper) = (shifted(-1.0), shifted(1.0));
            let band = Ink { colour: ink.colour, opacity: 0.22 };
            // Piece by piece, so that gaps of the curve are preserved.
            for (low, high) in lower.windows(2).zip(upper.windows(2)) {
                let corners = [low[0], low[1], high[1], high[0]].map(|p| frame.place(area, p));
                if corners.iter().flatten().all(|coordinate| coordinate.is_finite()) {
                    canvas.area(&corners, band);
                }
            }
        }
    }
}

fn draw_curve(
    canvas: &mut Canvas,
    frame: &PlotAxes,
    area: Rect,
    series: &PlotSeries,
    ink: SeriesInk,
) {
    let places: Vec<Point> =
        outline(series).into_iter().map(|point| frame.place(area, point)).collect();
    match series.form {
        SeriesForm::Line | SeriesForm::Steps => {
            canvas.clip_to(area);
            canvas.line(&places, &pen(ink));
        }
        SeriesForm::Dots => {
            canvas.clip_to(area.grown(OVERHANG));
            for place in places {
                canvas.dot(place, 3.0, Ink::opaque(ink.colour));
            }
        }
    }
}
