//! One number with its error bar, and how far that error bar can be trusted.

use crate::plan::Estimator;
use lumiduct_base::number::{format_exact, format_with_error};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// A measured quantity. Infinite values and errors are written as null.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// The value, in `unit`.
    #[serde(deserialize_with = "null_is_infinite")]
    pub value: f64,
    /// Standard error of the value, in `unit`; infinite where it is unknown.
    #[serde(deserialize_with = "null_is_infinite")]
    pub std_error: f64,
    /// Possible bias of the value, in addition to the noise, in `unit`; `None` for unbiased
    /// estimates.
    pub bias: Option<f64>,
    /// Unit, such as `lm`; `1` for ratios.
    pub unit: String,
    /// Number of batches behind it.
    pub batches: u64,
    /// Number of paths behind it.
    pub paths: u64,
    /// How it was estimated.
    pub estimator: Estimator,
    /// Whether value and error are reliable.
    pub status: Status,
}

/// JSON has no infinity: it is written as null.
fn null_is_infinite<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

/// Whether a value and its error are reliable.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Both are reliable.
    Ok,
    /// Nothing was counted. The error of a flux is then the flux of one path: three of them are the 95 % upper limit
    /// ("rule of three", Hanley & Lippman-Hand, JAMA 249 (1983) 1743).
    NoSignal,
    /// Too little was counted, so the error bar itself is uncertain. For fluxes: light was found in fewer
    /// than ten groups of batches, or the relative error is above 32 %, that of ten counts. For maps: fewer
    /// than ten batches, or fewer than ten counts in an average cell.
    TooFew,
    /// An extreme of a map that is mostly noise: the correction for it exceeds a tenth of the value.
    NoiseLimited,
    /// The light has no such value: colours far from white have no colour temperature.
    Undefined,
    /// Estimates of second and fourth order of a gathered value agree within two standard errors. Its bias is not known
    /// better than half of their difference.
    BiasInNoise,
    /// Estimates of higher order of a gathered value do not converge, and the stated bias is not a bound.
    BiasNotResolved,
    /// Photons of the same run found more light from a source on the sensor than its estimator did,
    /// by more than four errors: its paths hardly ever meet that source.
    Contradicted,
}

impl Status {
    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::NoSignal => "no_signal",
            Self::TooFew => "too_few",
            Self::NoiseLimited => "noise_limited",
            Self::Undefined => "undefined",
            Self::BiasInNoise => "bias_in_noise",
            Self::BiasNotResolved => "bias_not_resolved",
            Self::Contradicted => "contradicted",
        }
    }

    /// The worse of two: the earlier in the order contradicted, no signal, undefined, too few, noise limited, bias not
    /// resolved, bias in the noise, good.
    pub(crate) fn worst(self, other: Self) -> Self {
        let rank = |status| match status {
            Self::Contradicted => 0,
            Self::NoSignal => 1,
            Self::Undefined => 2,
            Self::TooFew => 3,
            Self::NoiseLimited => 4,
            Self::BiasNotResolved => 5,
            Self::BiasInNoise => 6,
            Self::Ok => 7,
        };
        if rank(self) <= rank(other) { self } else { other }
    }
}

impl Measure {
    /// Combined standard error and bias, in `unit`.
    pub fn total_error(&self) -> f64 {
        self.std_error.hypot(self.bias.unwrap_or(0.0))
    }

    /// Total error over value, 1; infinite where there is no value or no reliable error bar.
    pub fn relative_error(&self) -> f64 {
        match self.status {
            Status::Ok | Status::BiasInNoise if self.value != 0.0 && self.value.is_finite() => {
                (self.total_error() / self.value).abs()
            }
            Status::Ok
            | Status::BiasInNoise
            | Status::NoSignal
            | Status::TooFew
            | Status::NoiseLimited
            | Status::Undefined
            | Status::BiasNotResolved
            | Status::Contradicted => f64::INFINITY,
        }
    }
}

impl fmt::Display for Measure {
    /// `0.51084 ± 0.00023 lm`: the value with its standard error, or, where it has a bias,
    /// `10.0 ± 0.5 lm (total error)`.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let error = self.total_error();
        let has_error = self.value.is_finite() && error.is_finite() && error != 0.0;
        if !self.value.is_finite() {
            write!(out, "unknown")?;
        } else if !error.is_finite() {
            write!(out, "{} with unknown error", format_exact(self.value))?;
        } else if error == 0.0 {
            write!(out, "{}", format_exact(self.value))?;
        } else {
            write!(out, "{}", format_with_error(self.value, error))?;
        }
        if self.unit != "1" {
            write!(out, " {}", self.unit)?;
        }
        // In tables, ± is the standard error alone.
        if has_error && self.bias.is_some_and(|bias| bias != 0.0) {
            write!(out, " (total error)")?;
        }
        Ok(())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn measure(value: f64, std_error: f64, unit: &str) -> Measure {
        Measure {
            value,
            std_error,
            bias: None,
            unit: unit.to_owned(),
            batches: 128,
            paths: 1_000_000,
            estimator: Estimator::Forward,
            status: Status::Ok,
        }
    }

    #[test]
    fn a_measure_is_written_with_the_digits_that_its_error_leaves() {
        assert_eq!(measure(0.510_84, 0.000_226, "lm").to_string(), "0.51084 ± 0.00023 lm");
        assert_eq!(measure(12_345.6, 123.0, "lx").to_string(), "12350 ± 120 lx");
        assert_eq!(measure(0.75, 0.0, "1").to_string(), "0.75");
        assert_eq!(measure(3e-9, 2.2e-10, "lm").to_string(), "(3.00 ± 0.22)×10⁻⁹ lm");
        assert_eq!(measure(2.0, f64::INFINITY, "1").to_string(), "2 with unknown error");
        assert_eq!(measure(1200.0, 0.0, "lx").to_string(), "1200 lx");
    }

    #[test]
    fn status_is_a_word_and_an_unknown_error_is_null_in_json() {
        let mut unlit = measure(0.0, f64::INFINITY, "1");
        unlit.status = Status::NoSignal;
        let json = serde_json::to_value(&unlit).unwrap();
        assert_eq!(json["status"], "no_signal");
        assert_eq!(json["estimator"], "forward");
        assert!(json["std_error"].is_null() && json["bias"].is_null());
        assert_eq!(unlit.relative_error(), f64::INFINITY);
    }

    #[test]
    fn bias_and_noise_add_in_quadrature() {
        let mut biased = measure(10.0, 0.3, "lm");
        biased.bias = Some(0.4);
        assert!((biased.total_error() - 0.5).abs() < 1e-15);
        assert!((biased.relative_error() - 0.05).abs() < 1e-15);
        assert_eq!(biased.to_string(), "10.0 ± 0.5 lm (total error)");
        biased.bias = Some(0.0);
        assert_eq!(biased.to_string(), "10.00 ± 0.30 lm");
    }
}
