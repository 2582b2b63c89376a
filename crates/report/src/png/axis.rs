//! Axes: from values to fractions of a length, and the round numbers at the marks.
//!
//! Knows nothing of pixels.

use lumiduct_base::number::{format_fixed, format_value, superscript};

/// Whether equal lengths are equal differences or equal ratios.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AxisScale {
    /// Equal differences.
    Linear,
    /// Equal ratios; values of zero and below are beyond the lower end.
    Log,
    /// Equal differences of the tangent of an angle in deg, within ±89: the plane of an image.
    Tangent,
}

/// A range of values mapped to a length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlotAxis {
    min: f64,
    max: f64,
    scale: AxisScale,
}

/// The marks of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    /// Marks with a label.
    pub(crate) major: Vec<Tick>,
    /// Marks without a label, between the others.
    pub(crate) minor: Vec<f64>,
    /// Power of ten that multiplies the labels.
    pub(crate) exponent: i32,
}

/// A mark with a label.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    /// Its position.
    pub(crate) value: f64,
    /// Its text.
    pub(crate) label: String,
}

/// Values beyond this are clamped to it.
const LARGEST: f64 = 1e290;
/// Ranges narrower than this share of their values are rounding noise.
const NARROWEST: f64 = 1e-9;
/// Fractions beyond this are far outside of every picture.
const FARTHEST: f64 = 1e4;
/// Most decades that a logarithmic axis shows.
const MOST_DECADES: i32 = 12;

impl PlotAxis {
    /// The axis from `min` to `max`. An empty, inverted or non-finite range is replaced by a
    /// sensible one; a logarithmic axis without positive values becomes linear.
    pub(crate) fn new(min: f64, max: f64, scale: AxisScale) -> Self {
        let finite = |value: f64, other: f64| {
            let value = if value.is_finite() { value } else { other };
            if value.is_finite() { value.clamp(-LARGEST, LARGEST) } else { 0.0 }
        };
        let (one, other) = (finite(min, max), finite(max, min));
        let (low, high) = (one.min(other), one.max(other));
        match scale {
            AxisScale::Log if high > 1.0 / LARGEST => {
                let lowest = high * 10f64.powi(-MOST_DECADES);
                let low = if low > 0.0 { low.max(lowest) } else { high * 1e-3 };
                let low = if low < high * (1.0 - NARROWEST) { low } else { high * 0.1 };
                Self { min: low, max: high, scale }
            }
            AxisScale::Tangent => {
                let (min, max) = widened(low.clamp(-89.0, 88.0), high.clamp(-88.0, 89.0));
                Self { min, max, scale }
            }
            AxisScale::Log | AxisScale::Linear => {
                let (min, max) = widened(low, high);
                Self { min, max, scale: AxisScale::Linear }
            }
        }
    }

    /// How values become fractions.
    pub(crate) fn scale(&self) -> AxisScale {
        self.scale
    }

    /// Lower end.
    pub(crate) fn min(&self) -> f64 {
        self.min
    }

    /// Upper end.
    pub(crate) fn max(&self) -> f64 {
        self.max
    }

    /// The difference of its ends, as drawn.
    pub(crate) fn extent(&self) -> f64 {
        match self.scale {
            AxisScale::Linear | AxisScale::Log => self.max - self.min,
            AxisScale::Tangent => self.max.to_radians().tan() - self.min.to_radians().tan(),
        }
    }

    /// Where a value lies: 0 at the lower end, 1 at the upper; NaN stays NaN.
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        let fraction = match self.scale {
            AxisScale::Linear => (value - self.min) / (self.max - self.min),
            AxisScale::Tangent => {
                let [tangent, min, max] =
                    [value, self.min, self.max].map(|angle| angle.to_radians().tan());
                (tangent - min) / (max - min)
            }
            AxisScale::Log if value <= 0.0 => f64::NEG_INFINITY,
            AxisScale::Log => (value / self.min).ln() / (self.max / self.min).ln(),
        };
        fraction.clamp(-FARTHEST, FARTHEST)
    }

    /// At most `most` labelled marks (at least two where possible) on round values.
    pub(crate) fn ticks(&self, most: usize) -> Ticks {
        match self.scale {
            AxisScale::Linear | AxisScale::Tangent => self.linear_ticks(most),
            AxisScale::Log => self.log_ticks(most).unwrap_or_else(|| self.linear_ticks(most)),
        }
    }

    fn linear_ticks(&self, most: usize) -> Ticks {
        let range = self.max - self.min;
        let step = round_step(range / most.max(1) as f64, self.min, self.max, most.max(1));
        let largest = self.min.abs().max(self.max.abs());
        let power = decade(largest);
        let exponent = if (-2..=4).contains(&power) { 0 } else { power };
        let decimals = (exponent - decade(step * 1.001)).max(0);
        let unit = 10f64.powi(exponent);
        let slack = 1e-6;
        let first = (self.min / step - slack).ceil();
        let count = (self.max / step + slack).floor() - first;
        let major = (0..=count.clamp(0.0, 100.0) as usize)
            .map(|index| {
                let value = (first + index as f64) * step;
                Tick { value, label: format_fixed(value / unit, decimals) }
            })
            .collect();
        Ticks { major, minor: Vec::new(), exponent }
    }

    /// Marks at powers of ten, or at 1, 2 and 5 times them where there are few; `None` if even
    /// those are too few.
    fn log_ticks(&self, most: usize) -> Option<Ticks> {
        let inside =
            |value: &f64| self.min * (1.0 - 1e-9) <= *value && *value <= self.max * (1.0 + 1e-9);
        let decades = || decade(self.min) - 1..=decade(self.max) + 1;
        let on = |multiples: &'static [f64]| -> Vec<f64> {
            decades()
                .flat_map(|power| multiples.iter().map(move |m| m * 10f64.powi(power)))
                .filter(inside)
                .collect()
        };
        let minor = on(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]);
        let powers = on(&[1.0]);
        let fine = on(&[1.0, 2.0, 5.0]);
        let crowded = fine.len() > most.max(3);
        let values = if powers.len() >= 3 || (powers.len() == 2 && crowded) {
            let stride = powers.len().div_ceil(most.max(1)) as i32;
            let kept = |value: &f64| decade(value * 1.001).rem_euclid(stride) == 0;
            powers.into_iter().filter(kept).collect()
        } else if fine.len() >= 3 && !crowded {
            fine
        } else {
            Vec::new()
        };
        (values.len() >= 2).then(|| Ticks { major: log_labels(&values), minor, exponent: 0 })
    }
}

/// Plain numbers if all are short, else powers of ten: all in one form.
fn log_labels(values: &[f64]) -> Vec<Tick> {
    let plain = values.iter().all(|value| (-3..=4).contains(&decade(value * 1.001)));
    let label = |value: f64| {
        let power = decade(value * 1.001);
        let leading = (value / 10f64.powi(power)).round();
        if plain {
            format_value(value)
        } else if leading == 1.0 {
            format!("10{}", superscript(power))
        } else {
            format!("{leading}×10{}", superscript(power))
        }
    };
    values.iter().map(|&value| Tick { value, label: label(value) }).collect()
}

/// The power of ten at or below a positive value; 0 for zero.
fn decade(value: f64) -> i32 {
    if value > 0.0 { value.log10().floor() as i32 } else { 0 }
}

/// The smallest of 1, 2 and 5 times a power of ten that makes at most `most` marks between two values.
fn round_step(least: f64, min: f64, max: f64, most: usize) -> f64 {
    let start = decade(least);
    let steps = (start..start + 3).flat_map(|power| [1.0, 2.0, 5.0].map(|m| m * 10f64.powi(power)));
    let count = |step: f64| (max / step + 1e-6).floor() - (min / step - 1e-6).ceil() + 1.0;
    let mut last = least;
    for step in steps {
        last = step;
        if count(step) <= most as f64 {
            break;
        }
    }
    last
}

/// A range of nonzero width: around a single value it extends to zero.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let largest = low.abs().max(high.abs());
    if largest < 1.0 / LARGEST {
        (0.0, 1.0)
    } else if high - low > NARROWEST * largest {
        (low, high)
    } else if high > 0.0 {
        (0.0, high)
    } else {
        (low, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(ticks: &Ticks) -> Vec<&str> {
        ticks.major.iter().map(|tick| tick.label.as_str()).collect()
    }

    #[test]
    fn marks_stand_on_round_numbers() {
        let ticks = PlotAxis::new(-5.0, 5.0, AxisScale::Linear).ticks(6);
        assert_eq!(labels(&ticks), ["−4", "−2", "0", "2", "4"]);
        let ticks = PlotAxis::new(0.0, 0.84, AxisScale::Linear).ticks(5);
        assert_eq!(labels(&ticks), ["0.0", "0.2", "0.4", "0.6", "0.8"]);
        let ticks = PlotAxis::new(0.0, 250_000.0, AxisScale::Linear).ticks(6);
        assert_eq!(
            (labels(&ticks), ticks.exponent),
            (vec!["0.0", "0.5", "1.0", "1.5", "2.0", "2.5"], 5)
        );
    }

    #[test]
    fn logarithmic_marks_are_powers_of_ten_or_1_2_5() {
        let ticks = PlotAxis::new(1e-7, 1.0, AxisScale::Log).ticks(4);
        assert_eq!(labels(&ticks), ["10⁻⁶", "10⁻⁴", "10⁻²", "10⁰"]);
        let ticks = PlotAxis::new(0.9, 25.0, AxisScale::Log).ticks(6);
        assert_eq!(labels(&ticks), ["1", "2", "5", "10", "20"]);
        let ticks = PlotAxis::new(3.1, 3.9, AxisScale::Log).ticks(5);
        assert_eq!(labels(&ticks), ["3.2", "3.4", "3.6", "3.8"]);
    }

    #[test]
    fn a_single_value_has_an_axis_from_zero() {
        assert_eq!(
            PlotAxis::new(5.0, 5.0, AxisScale::Linear),
            PlotAxis { min: 0.0, max: 5.0, scale: AxisScale::Linear }
        );
        assert_eq!(
            PlotAxis::new(0.0, 0.0, AxisScale::Log),
            PlotAxis { min: 0.0, max: 1.0, scale: AxisScale::Linear }
        );
        assert_eq!(
            PlotAxis::new(5.0, 5.0, AxisScale::Log),
            PlotAxis { min: 0.5, max: 5.0, scale: AxisScale::Log }
        );
    }

    #[test]
    fn fractions_run_from_one_end_to_the_other() {
        let linear = PlotAxis::new(-2.0, 6.0, AxisScale::Linear);
        assert_eq!(
            [-2.0, 0.0, 6.0, 8.0].map(|value| linear.fraction(value)),
            [0.0, 0.25, 1.0, 1.25]
        );
        let log = PlotAxis::new(1e-2, 1e2, AxisScale::Log);
        assert!((log.fraction(0.1) - 0.25).abs() < 1e-12);
        assert_eq!(log.fraction(0.0), -FARTHEST);
        assert!(log.fraction(f64::NAN).is_nan());
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(21), ..ProptestConfig::default() })]
        #[test]
        fn any_range_has_few_distinct_marks_inside(
            a in any::<f64>(), b in any::<f64>(), narrow in -9.0..0.0f64, most in 2usize..12,
        ) {
            for (min, max) in [(a, b), (a, a * (1.0 + 10f64.powf(narrow))), (a, f64::NAN)] {
                for scale in [AxisScale::Linear, AxisScale::Log] {
                    let axis = PlotAxis::new(min, max, scale);
                    prop_assert!(axis.min() < axis.max());
                    let ticks = axis.ticks(most);
                    prop_assert!((1..=most.max(3)).contains(&ticks.major.len()), "{axis:?} {most} {ticks:?}");
                    for tick in &ticks.major {
                        let fraction = axis.fraction(tick.value);
                        prop_assert!((-1e-3..=1.001).contains(&fraction), "{axis:?} {tick:?}");
                        prop_assert!(tick.label.chars().count() < 16, "{axis:?} {tick:?}");
                    }
                    for pair in ticks.major.windows(2) {
                        prop_assert_ne!(&pair[0].label, &pair[1].label);
                    }
                }
            }
        }
    }
}
