//! Axes with their marks and labels: the description shared by pictures and pages.
//!
//! The number of marks on an axis follows from its length in a picture. A page omits labels without
//! room; it adds none.

use crate::png::axis::{AxisScale, PlotAxis, Ticks};
use crate::png::text::TICK;
use lumiduct_base::number::superscript;

/// An axis with its marks and its label.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MarkedAxis {
    /// From values to fractions.
    pub(crate) axis: PlotAxis,
    /// Its marks.
    pub(crate) ticks: Ticks,
    /// Name and unit, with the power of ten of the labels.
    pub(crate) label: String,
}

/// Space between two adjacent numbers, pixels.
const GAP: f64 = 18.0;
/// Width of a digit over the font size: the characters of a number are hardly wider on average.
const DIGIT_EM: f64 = 0.64;

impl MarkedAxis {
    /// A horizontal axis of a length in pixels, with as many marks as fit side by side.
    pub(crate) fn level(axis: PlotAxis, label: &str, length: f64) -> Self {
        let mut most = (length / 50.0).clamp(3.0, 12.0) as usize;
        let mut ticks = axis.ticks(most);
        while most > 1 && !have_room(&axis, &ticks, length) {
            most -= 1;
            ticks = axis.ticks(most);
        }
        Self::new(axis, ticks, label)
    }

    /// A vertical axis of a length in pixels.
    pub(crate) fn upright(axis: PlotAxis, label: &str, length: f64) -> Self {
        Self::new(axis, axis.ticks((length / 38.0).clamp(3.0, 12.0) as usize), label)
    }

    /// An axis with these marks.
    pub(crate) fn new(axis: PlotAxis, ticks: Ticks, label: &str) -> Self {
        let label = with_factor(label, ticks.exponent);
        Self { axis, ticks, label }
    }

    /// The axes of a path of any length up to `longest`: each is half as long as the one before.
    pub(crate) fn of_lengths(longest: f64, pixels: f64) -> Vec<Self> {
        /// Number of axes: a path shorter than the last is a point on any map.
        const COUNT: i32 = 10;
        let lengths = (0..COUNT).map(|halvings| longest * 0.5f64.powi(halvings));
        lengths
            .map(|length| Self::level(PlotAxis::new(0.0, length, AxisScale::Linear), "", pixels))
            .collect()
    }
}

/// Whether labels side by side along `length` pixels do not touch.
fn have_room(axis: &PlotAxis, ticks: &Ticks, length: f64) -> bool {
    let places: Vec<f64> =
        ticks.major.iter().map(|tick| axis.fraction(tick.value) * length).collect();
    let step = places.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let letters = ticks.major.iter().map(|tick| tick.label.chars().count()).max().unwrap_or(0);
    letters as f64 * DIGIT_EM * TICK.size + GAP <= step
}

/// A label with the factor that multiplies the numbers.
pub(crate) fn with_factor(label: &str, exponent: i32) -> String {
    match (exponent, label.is_empty()) {
        (0, _) => label.to_string(),
        (_, true) => format!("×10{}", superscript(exponent)),
        (_, false) => format!("{label}, ×10{}", superscript(exponent)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_a_level_axis_have_room() {
        for (min, max) in [(0.0, 1.0), (-1e-7, 3e-7), (99_990.0, 99_999.0), (1e-3, 1e5)] {
            for scale in [AxisScale::Linear, AxisScale::Log] {
                let axis = MarkedAxis::level(PlotAxis::new(min, max, scale), "r in mm", 400.0);
                assert!(!axis.ticks.major.is_empty(), "{axis:?}");
                let widths = axis.ticks.major.iter().map(|tick| TICK.width(&tick.label).unwrap());
                let widest = widths.fold(0.0, f64::max);
                let places = axis.ticks.major.iter().map(|tick| axis.axis.fraction(tick.value));
                let places: Vec<f64> = places.map(|place| 400.0 * place).collect();
                assert!(places.windows(2).all(|pair| pair[1] - pair[0] > widest), "{axis:?}");
            }
        }
    }

    #[test]
    fn large_numbers_are_multiples_of_a_power_in_the_label() {
        let axis =
            MarkedAxis::upright(PlotAxis::new(0.0, 4e5, AxisScale::Linear), "E in lx", 400.0);
        assert_eq!(axis.label, "E in lx, ×10⁵");
        assert_eq!(axis.ticks.major[1].label, "0.5");
    }

    #[test]
    fn a_path_of_any_length_has_an_axis_at_most_twice_as_long() {
        let axes = MarkedAxis::of_lengths(30.0, 400.0);
        assert_eq!(axes[0].axis.max(), 30.0);
        assert!(axes.windows(2).all(|pair| pair[0].axis.max() == 2.0 * pair[1].axis.max()));
    }
}
