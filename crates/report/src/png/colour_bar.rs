//! The colour bar of a map.
//!
//! Chooses the values at the ends of the bar; knows nothing of cells and places.

use crate::png::axis::{AxisScale, PlotAxis, Ticks};
use crate::png::canvas::{Canvas, Ink, Pen};
use crate::png::geometry::Rect;
use crate::png::layout::write;
use crate::png::marked_axis::MarkedAxis;
use crate::png::palette::{ColourMap, INK, NEUTRAL, Rgb};
use crate::png::text::{Align, LABEL, TICK};
use lumiduct_base::error::Result;

/// Width of the bar without its numbers, pixels.
pub(crate) const BAR_WIDTH: f64 = 20.0;
/// Height of the tips that represent values beyond the bar, pixels.
pub(crate) const TIP: f64 = 12.0;

/// Fewer values than these have no outliers.
const FEWEST: usize = 64;

/// What a bar is made from.
pub(crate) struct Colouring<'a> {
    /// The finite values, in ascending order.
    pub(crate) values: &'a [f64],
    /// Their unit; may be empty.
    pub(crate) unit: &'a str,
    /// How values become fractions of the bar.
    pub(crate) scale: AxisScale,
    /// How fractions become colours.
    pub(crate) colours: ColourMap,
    /// Values at the ends of the bar; `None` takes them from the values.
    pub(crate) limits: Option<[f64; 2]>,
}

/// The mapping of colours to values: the description shared by pictures and pages.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BarScale {
    /// From values to fractions of the bar; its label is the unit.
    pub(crate) axis: MarkedAxis,
    /// From fractions to colours.
    pub(crate) colours: ColourMap,
    /// Whether there are values below and above the bar.
    pub(crate) beyond: [bool; 2],
}

impl BarScale {
    /// The scale of a bar of a height in pixels.
    pub(crate) fn new(colouring: &Colouring<'_>, height: f64) -> Self {
        let Colouring { values, scale, colours, .. } = *colouring;
        let [low, high] = colouring.limits.unwrap_or_else(|| limits(values, scale, colours));
        let axis = PlotAxis::new(low, high, scale);
        let slack = 1e-9 * (axis.max() - axis.min());
        let beyond = [
            values.first().is_some_and(|&least| least < axis.min() - slack),
            values.last().is_some_and(|&greatest| greatest > axis.max() + slack),
        ];
        let ticks = bar_ticks(&axis, values, height);
        Self { axis: MarkedAxis::new(axis, ticks, colouring.unit), colours, beyond }
    }
}

/// A colour bar.
pub(crate) struct ColourBar {
    scale: BarScale,
    width: f64,
}

impl ColourBar {
    /// A bar of a scale.
    pub(crate) fn new(scale: BarScale) -> Result<Self> {
        let mut numbers = 0.0f64;
        for tick in &scale.axis.ticks.major {
            numbers = numbers.max(TICK.width(&tick.label)?);
        }
        let width = (BAR_WIDTH + 10.0 + numbers).max(LABEL.width(&scale.axis.label)?).ceil();
        Ok(Self { scale, width })
    }

    /// Width with the numbers, pixels.
    pub(crate) fn width(&self) -> f64 {
        self.width
    }

    /// The colour of a value; neutral if non-finite.
    pub(crate) fn colour_of(&self, value: f64) -> Rgb {
        let BarScale { axis, colours, .. } = &self.scale;
        if value.is_finite() { colours.colour(axis.axis.fraction(value)) } else { NEUTRAL }
    }

    /// Draws the bar there, with its unit above and its numbers on the right.
    pub(crate) fn draw(&self, canvas: &mut Canvas, bar: Rect) -> Result<()> {
        let BarScale { axis: MarkedAxis { axis, ticks, label }, colours, beyond } = &self.scale;
        let ink = Ink::opaque(INK);
        let height = bar.height();
        canvas.bitmap(bar, |_, y| colours.colour(1.0 - (y as f64 + 0.5) / height));
        canvas.border(bar, ink);
        self.draw_tips(canvas, bar);
        let row = |value: f64| {
            let y = bar.bottom - axis.fraction(value) * height;
            y.floor().clamp(bar.top, bar.bottom - 1.0)
        };
        for &value in &ticks.minor {
            canvas.rect(Rect::new(bar.right + 1.0, row(value), 2.0, 1.0), ink);
        }
        for tick in &ticks.major {
            let y = row(tick.value);
            canvas.rect(Rect::new(bar.right + 1.0, y, 4.0, 1.0), ink);
            let at = [bar.right + 9.0, y + 0.5 + 0.5 * TICK.cap_height()];
            write(canvas, &tick.label, at, TICK, Align::Left)?;
        }
        let tip = if beyond[1] { TIP } else { 0.0 };
        let at = [bar.left - 1.0, bar.top - tip - 8.0];
        write(canvas, label, at, LABEL, Align::Left)
    }

    /// The tips of the bar where there are values beyond it.
    fn draw_tips(&self, canvas: &mut Canvas, bar: Rect) {
        let BarScale { colours, beyond, .. } = &self.scale;
        let pen = Pen { ink: Ink::opaque(INK), width: 1.0, dash: &[] };
        let below = (beyond[0], bar.bottom + 1.0, 1.0, 0.0);
        let above = (beyond[1], bar.top - 1.0, -1.0, 1.0);
        for (_, base, direction, fraction) in [below, above].into_iter().filter(|tip| tip.0) {
            let tip = [0.5 * (bar.left + bar.right), base + direction * (TIP - 2.0)];
            let corners = [[bar.left - 1.0, base], [bar.right + 1.0, base], tip];
            canvas.area(&corners, Ink::opaque(colours.colour(fraction)));
            canvas.line(&[corners[0], tip, corners[1]], &pen);
        }
    }
}

/// The marks of the bar; none where there is nothing to read.
fn bar_ticks(axis: &PlotAxis, values: &[f64], height: f64) -> Ticks {
    if values.is_empty() {
        return Ticks { major: Vec::new(), minor: Vec::new(), exponent: 0 };
    }
    axis.ticks((height / 46.0).clamp(3.0, 10.0) as usize)
}

/// The values at the ends of the colour bar, from values in ascending order.
fn limits(values: &[f64], scale: AxisScale, colours: ColourMap) -> [f64; 2] {
    let (Some(&least), Some(&greatest)) = (values.first(), values.last()) else {
        return [0.0, 1.0];
    };
    match (colours, scale) {
        (ColourMap::Diverging, AxisScale::Linear | AxisScale::Log | AxisScale::Tangent) => {
            let far = least.abs().max(greatest.abs());
            if far > 0.0 { [-far, far] } else { [-1.0, 1.0] }
        }
        (ColourMap::Sequential, AxisScale::Log) => {
            let high = without_outliers(values);
            let positive: Vec<f64> = values.iter().copied().filter(|&value| value > 0.0).collect();
            let inverse: Vec<f64> = positive.iter().rev().map(|value| 1.0 / value).collect();
            let low = if inverse.is_empty() { 0.0 } else { 1.0 / without_outliers(&inverse) };
            [low.max(high * 1e-6), high]
        }
        (ColourMap::Sequential, AxisScale::Linear | AxisScale::Tangent) => {
            let high = without_outliers(values);
            // Values that differ by less than a half are shown in full contrast. A value slightly
            // below zero is noise and looks like zero.
            if least.abs() <= 0.5 * high { [0.0, high] } else { [least, high] }
        }
    }
}

/// The greatest value, except at most one in a thousand (at least one, of [`FEWEST`] or more) that
/// exceeds all others tenfold.
fn without_outliers(values: &[f64]) -> f64 {
    let last = values.len() - 1;
    let most = if values.len() < FEWEST { 0 } else { (values.len() / 1000).max(1) };
    let gap = (0..most)
        .map(|index| (values[last - index], values[last - index - 1]))
        .find(|(above, below)| *below > 0.0 && *above > 10.0 * below);
    gap.map_or(values[last], |(_, below)| below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wild_cell_does_not_stretch_the_bar_but_a_beam_does() {
        let mut values: Vec<f64> = (0..1000).map(|index| 1.0 + f64::from(index) / 1000.0).collect();
        values.push(1e9);
        assert_eq!(limits(&values, AxisScale::Linear, ColourMap::Sequential), [1.0, 1.999]);
        let beam: Vec<f64> = (0..400).rev().map(|r| (-f64::from(r) / 20.0).exp()).collect();
        assert_eq!(
            limits(&[1.0, 1.0, 100.0], AxisScale::Linear, ColourMap::Sequential),
            [0.0, 100.0]
        );
        assert_eq!(limits(&beam, AxisScale::Linear, ColourMap::Sequential), [0.0, 1.0]);
    }

    #[test]
    fn the_bar_suits_the_values() {
        let sequential = |values: &[f64], scale| limits(values, scale, ColourMap::Sequential);
        assert_eq!(sequential(&[2.0, 3.0, 5.0], AxisScale::Linear), [0.0, 5.0]);
        assert_eq!(sequential(&[4.0, 5.0], AxisScale::Linear), [4.0, 5.0]);
        assert_eq!(sequential(&[-1.0, 5.0], AxisScale::Linear), [0.0, 5.0]);
        assert_eq!(sequential(&[-4.0, 5.0], AxisScale::Linear), [-4.0, 5.0]);
        assert_eq!(sequential(&[0.0, 0.5, 5.0], AxisScale::Log), [0.5, 5.0]);
        assert_eq!(sequential(&[0.0, 1e-3, 1.0, 1e4], AxisScale::Log), [1e-2, 1e4]);
        assert_eq!(limits(&[-2.0, 5.0], AxisScale::Linear, ColourMap::Diverging), [-5.0, 5.0]);
        assert_eq!(limits(&[], AxisScale::Linear, ColourMap::Diverging), [0.0, 1.0]);
    }
}
