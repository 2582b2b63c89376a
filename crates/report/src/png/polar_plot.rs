//! Luminous intensity distribution curves, as in the data sheets of luminaires.

use crate::png::axis::{AxisScale, PlotAxis, Ticks};
use crate::png::canvas::{Canvas, Ink, Pen};
use crate::png::geometry::{Point, Rect};
use crate::png::layout::{Header, Legend, LegendSample, MARGIN, remark, write};
use crate::png::marked_axis::{MarkedAxis, with_factor};
use crate::png::palette::{GRID, INK, PAPER, SOFT_INK, SeriesInk, series_ink};
use crate::png::text::{Align, LABEL, TICK};
use lumiduct_base::error::Result;

/// Curves of a value over an angle from the axis.
#[derive(Debug, Clone)]
pub(crate) struct PolarPlot {
    /// What is shown.
    pub title: String,
    /// How it was found; may be empty.
    pub subtitle: String,
    /// Unit of the values: "cd".
    pub unit: String,
    /// The curves, usually one per pair of C half-planes.
    pub curves: Vec<PolarCurve>,
}

/// One curve.
#[derive(Debug, Clone)]
pub(crate) struct PolarCurve {
    /// Its name in the legend: "C0 / C180".
    pub name: String,
    /// Gamma in degrees and its value, in the order in which they are joined. Positive gamma is
    /// drawn on the right (C0), negative gamma on the left (C180).
    pub points: Vec<(f64, f64)>,
    /// Standard error of each value, drawn as a band; empty for none.
    pub std_errors: Vec<f64>,
}

const WIDTH: f64 = 760.0;
/// Radius of the outermost circle, pixels.
const RADIUS: f64 = 270.0;
/// Room for the angles around it, pixels.
const ANGLE_ROOM: f64 = 30.0;
/// Degrees between spokes.
const SPOKES: usize = 30;

/// Which part of the circle is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CirclePart {
    /// Gamma from −90° to 90°: there is no data beyond.
    Half,
    Whole,
}

/// The place of a polar plot on the canvas.
struct Dial {
    centre: Point,
    part: CirclePart,
    /// Value at the outermost circle.
    outer: f64,
    ticks: Ticks,
}

/// Draws curves over the angle in concentric circles, only the half circle where no data lies
/// beyond 90°.
pub(crate) fn polar_plot(plot: &PolarPlot) -> Result<Vec<u8>> {
    let header = Header::new(&plot.title, &plot.subtitle, WIDTH - 2.0 * MARGIN)?;
    let entries: Vec<(LegendSample, &str)> = plot
        .curves
        .iter()
        .enumerate()
        .map(|(index, curve)| (LegendSample::Line(pen(series_ink(index))), curve.name.as_str()))
        .collect();
    let legend = Legend::new(&entries, WIDTH - 2.0 * MARGIN)?;
    let (outer, ticks) = rings(&plot.curves);
    let part = part(&plot.curves);
    let top = MARGIN + header.height() + legend.height();
    let (above, below) = match part {
        CirclePart::Whole => (RADIUS + ANGLE_ROOM, RADIUS + ANGLE_ROOM),
        CirclePart::Half => (RADIUS + ANGLE_ROOM, 2.0 * TICK.line_step()),
    };
    let centre = [0.5 * WIDTH + 0.5, (top + above).round() + 0.5];
    let dial = Dial { centre, part, outer, ticks };

    let bottom = (centre[1] + below + MARGIN - 8.0).floor();

    let mut canvas = Canvas::new(WIDTH as usize, bottom as usize);
    header.draw(&mut canvas, MARGIN, MARGIN - 4.0)?;
    legend.draw(&mut canvas, MARGIN, MARGIN + header.height() - 8.0)?;
    dial.draw_grid(&mut canvas)?;
    for (index, curve) in plot.curves.iter().enumerate() {
        dial.draw_band(&mut canvas, curve, series_ink(index));
    }
    for (index, curve) in plot.curves.iter().enumerate() {
        let points: Vec<Point> =
            curve.points.iter().map(|&(gamma, value)| dial.place(gamma, value)).collect();
        canvas.line(&points, &pen(series_ink(index)));
    }
    dial.draw_values(&mut canvas)?;
    let circles = with_factor(&format!("circles in {}", plot.unit), dial.ticks.exponent);
    let at = [MARGIN, bottom - MARGIN + 4.0];
    remark(&mut canvas, &circles, at)?;
    if !plot.curves.iter().flat_map(|curve| &curve.points).any(|point| point.1 > 0.0) {
        let at = [centre[0], centre[1] - 0.5 * RADIUS];
        write(&mut canvas, "No values above zero.", at, LABEL, Align::Centre)?;
    }
    canvas.into_png()
}

fn pen(ink: SeriesInk) -> Pen {
    Pen { ink: Ink::opaque(ink.colour), width: 2.2, dash: ink.dash }
}

/// The value at the outermost circle and the marks up to it.
fn rings(curves: &[PolarCurve]) -> (f64, Ticks) {
    let values = curves.iter().flat_map(|curve| &curve.points).map(|point| point.1);
    let greatest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
    let axis = PlotAxis::new(0.0, greatest, AxisScale::Linear);
    let ticks = axis.ticks(6);
    let step = match ticks.major.as_slice() {
        [first, second, ..] => second.value - first.value,
        [_] | [] => axis.max(),
    };
    // The curve may extend slightly beyond a circle, but not beyond the last one.
    let outer = (axis.max() / step - 1e-6).ceil().max(1.0) * step;
    (outer, PlotAxis::new(0.0, outer, AxisScale::Linear).ticks(7))
}

/// Range of a logarithmic dial: values below it are at the centre.
const DECADES: f64 = 1e4;

/// The axis from the centre to the outermost circle: the description shared by pictures and pages.
pub(crate) fn dial_axis(plot: &PolarPlot, scale: AxisScale) -> MarkedAxis {
    let (outer, ticks) = rings(&plot.curves);
    let label = format!("intensity in {}", plot.unit);
    match scale {
        AxisScale::Linear | AxisScale::Tangent => {
            MarkedAxis::new(PlotAxis::new(0.0, outer, AxisScale::Linear), ticks, &label)
        }
        AxisScale::Log => {
            let axis = PlotAxis::new(outer / DECADES, outer, AxisScale::Log);
            MarkedAxis::new(axis, axis.ticks(7), &label)
        }
    }
}

fn part(curves: &[PolarCurve]) -> CirclePart {
    let mut points = curves.iter().flat_map(|curve| &curve.points);
    let beyond = points.any(|&(gamma, value)| gamma.abs() > 90.0 + 1e-6 && value > 0.0);
    if beyond { CirclePart::Whole } else { CirclePart::Half }
}

impl Dial {
    /// Where a value lies on the canvas; NaN where it has no place.
    fn place(&self, gamma_deg: f64, value: f64) -> Point {
        let value = if value.is_finite() { value } else { f64::NAN };
        // Bands may extend slightly beyond the outermost circle.
        self.at(gamma_deg, RADIUS * (value / self.outer).clamp(0.0, 1.05))
    }

    fn at(&self, gamma_deg: f64, radius: f64) -> Point {
        let (sin, cos) = gamma_deg.to_radians().sin_cos();
        [self.centre[0] + radius * sin, self.centre[1] - radius * cos]
    }

    /// Largest |gamma| that is drawn, degrees.
    fn widest(&self) -> usize {
        match self.part {
            CirclePart::Half => 90,
            CirclePart::Whole => 180,
        }
    }

    fn draw_grid(&self, canvas: &mut Canvas) -> Result<()> {
        let widest = self.widest();
        let circle = |radius: f64| -> Vec<Point> {
            let steps = (0..=2 * widest).map(|step| step as f64 - widest as f64);
            steps.map(|gamma| self.at(gamma, radius)).collect()
        };
        let thin = Pen { ink: Ink::opaque(GRID), width: 1.0, dash: &[] };
        let edge = Pen { ink: Ink::opaque(SOFT_INK), width: 1.0, dash: &[] };
        for tick in self.ticks.major.iter().filter(|tick| tick.value > 0.0) {
            canvas.line(&circle(RADIUS * tick.value / self.outer), &thin);
        }
        for gamma in (0..=widest).step_by(SPOKES) {
            for side in [-1.0, 1.0] {
                let gamma = side * gamma as f64;
                canvas.line(&[self.centre, self.at(gamma, RADIUS)], &thin);
            }
        }
        canvas.line(&circle(RADIUS), &edge);
        if self.part == CirclePart::Half {
            canvas.line(&[self.at(-90.0, RADIUS), self.at(90.0, RADIUS)], &edge);
        }
        self.draw_angles(canvas)
    }

    fn draw_angles(&self, canvas: &mut Canvas) -> Result<()> {
        for gamma in (0..=self.widest()).step_by(SPOKES) {
            let sides: &[f64] = if gamma % 180 == 0 { &[1.0] } else { &[-1.0, 1.0] };
            for side in sides {
                let text = format!("{gamma}°");
                let [x, y] = self.at(side * gamma as f64, RADIUS + 8.0);
                let (sin, cos) = (side * gamma as f64).to_radians().sin_cos();
                // The label is pushed outward by as much as it extends inward.
                let half_width = 0.5 * TICK.width(&text)?;
                let at = [x + half_width * sin, y + 0.5 * TICK.cap_height() * (1.0 - cos)];
                write(canvas, &text, at, TICK, Align::Centre)?;
            }
        }
        Ok(())
    }

    fn draw_band(&self, canvas: &mut Canvas, curve: &PolarCurve, ink: SeriesInk) {
        let band = Ink { colour: ink.colour, opacity: 0.22 };
        let places: Vec<[Point; 2]> = curve
            .points
            .iter()
            .zip(&curve.std_errors)
            .map(|(&(gamma, value), error)| {
                [self.place(gamma, value - error), self.place(gamma, value + error)]
            })
            .collect();
        for pair in places.windows(2) {
            let corners = [pair[0][0], pair[0][1], pair[1][1], pair[1][0]];
            if corners.iter().flatten().all(|coordinate| coordinate.is_finite()) {
                canvas.area(&corners, band);
            }
        }
    }

    /// The values of the circles: along the straight edge of a half circle, on the right spoke of a
    /// whole one.
    fn draw_values(&self, canvas: &mut Canvas) -> Result<()> {
        let y = match self.part {
            CirclePart::Half => self.centre[1] + 10.0 + TICK.cap_height(),
            CirclePart::Whole => self.centre[1] - 9.0,
        };
        for tick in self.ticks.major.iter().filter(|tick| tick.value > 0.0) {
            let width = TICK.width(&tick.label)?;
            let middle = RADIUS * tick.value / self.outer;
            // The last one of a whole circle stays inside.
            let middle = match self.part {
                CirclePart::Half => middle,
                CirclePart::Whole => middle.min(RADIUS - 0.5 * width - 5.0),
            };
            let left = (self.centre[0] + middle - 0.5 * width).round();
            if self.part == CirclePart::Whole {
                let height = TICK.cap_height() + 4.0;
                let back = Rect::new(left - 2.0, y - TICK.cap_height() - 2.0, width + 4.0, height);
                canvas.rect(back, Ink { colour: PAPER, opacity: 0.8 });
            }
            write(canvas, &tick.label, [left, y], TICK, Align::Left)?;
        }
        canvas.dot(self.centre, 2.0, Ink::opaque(INK));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::png::tests::Decoded;

    fn plot(points: &[(f64, f64)]) -> Decoded {
        let curve =
            PolarCurve { name: String::new(), points: points.to_vec(), std_errors: Vec::new() };
        let plot = PolarPlot {
            title: "Luminous intensity".to_string(),
            subtitle: String::new(),
            unit: "cd".to_string(),
            curves: vec![curve],
        };
        Decoded::new(&polar_plot(&plot).unwrap())
    }

    /// A lobe around gamma = 45 deg whose greatest value lies on the outermost circle.
    fn lobe(side: f64, shift: f64) -> Vec<(f64, f64)> {
        (0..=90)
            .map(f64::from)
            .map(|gamma| (side * (gamma + shift), 10.0 * (2.0 * gamma).to_radians().sin()))
            .collect()
    }

    #[test]
    fn positive_gamma_is_right_and_zero_is_at_the_top() {
        let colour = series_ink(0).colour;
        let right = plot(&lobe(1.0, 0.0));
        let [left_edge, top, right_edge, bottom] = right.bounds(colour);
        let centre = right.width / 2;
        assert!(left_edge + 3 > centre && right_edge > centre + 190, "{left_edge} {right_edge}");
        let left = plot(&lobe(-1.0, 0.0));
        assert!(left.bounds(colour)[2] < centre + 5 && left.bounds(colour)[0] + 190 < centre);
        let narrow: Vec<(f64, f64)> = (0..=20).map(|gamma| (f64::from(gamma), 10.0)).collect();
        let zero = plot(&narrow).bounds(colour);
        assert!(zero[1] < top && zero[3] < bottom, "{zero:?}");
    }

    #[test]
    fn the_lower_half_is_drawn_only_where_there_is_something() {
        let half = plot(&lobe(1.0, 0.0));
        let whole = plot(&lobe(1.0, 60.0));
        assert!(whole.height > half.height + 200);
    }

    #[test]
    fn no_value_lies_beyond_the_outermost_circle() {
        let value = |top: f64| PolarCurve {
            name: String::new(),
            points: vec![(0.0, top)],
            std_errors: Vec::new(),
        };
        for top in [1e-9, 0.31, 1.0, 7.2, 99.0, 1e9] {
            let (outer, ticks) = rings(&[value(top)]);
            assert!(top <= outer * (1.0 + 1e-9) && outer <= 2.0 * top, "{top} {outer}");
            assert!((3..=8).contains(&ticks.major.len()), "{ticks:?}");
        }
    }
}
