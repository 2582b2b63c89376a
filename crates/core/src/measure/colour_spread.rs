//! How far noisy colours lie from their mean: the largest distance, and its root mean square.
//!
//! Noise moves every colour away from the mean, so both are too large as read. The mean square loses the noise that is expected in it. The
//! largest distance is that of colours without noise: all are shrunk toward the mean such that they keep the spread of the signal
//! (constrained empirical Bayes: Louis, J. Am. Stat. Assoc. 79 (1984) 393), except those beyond what signal and noise of a normal
//! distribution reach. A parametric bootstrap about these colours gives its bias, which is subtracted, and its error (Efron & Tibshirani, An
//! Introduction to the Bootstrap (1993), chapters 6 and 10). The truth lies between the corrected and the uncorrected distance, so half of what
//! is between them is reported as bias; where that is most of the distance, noise hides it, and the uncorrected one is given as a bound.
//!
//! This module does not know sensors. Colours are coordinates of a chromaticity diagram, and independent of each other.

use crate::measure::Status;
use crate::measure::noise::Noise;
use crate::tally::Tally;
use glam::{DMat2, DVec2};

/// Drawings, fewer for many colours.
const REPLICAS: usize = 64;
const MIN_REPLICAS: usize = 16;
const DRAWS: usize = 1_000_000;
/// Real scatter of the largest distance over that of its drawings, whose colours are slightly too even; chosen by the trials below.
const SCATTER: f64 = 1.3;
/// The largest of n squared distances over twice their variance exceeds ln n by more than this in 5 of 100 cases.
const MARGIN: f64 = 3.0;
/// A correction beyond this share of the distance as read hides it, 1.
const HIDDEN: f64 = 0.5;
/// Squared distances this many times above the threshold are kept whole; between, a part of them (firm shrinkage: Gao & Bruce, Stat. Sinica
/// 7 (1997) 855).
const FIRM: f64 = 2.5;

/// A colour that is known with noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoisyColour {
    pub(crate) uv: DVec2,
    pub(crate) covariance: DMat2,
    /// Its weight in the mean.
    pub(crate) weight: f64,
    /// Standard error of the weight.
    pub(crate) weight_error: f64,
}

/// A distance corrected for noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CorrectedDistance {
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    /// Possible bias in addition to the noise; `None` where there is none.
    pub(crate) bias: Option<f64>,
    /// Whether noise hides it: then it is a bound.
    pub(crate) status: Status,
}

/// Distances of colours from their mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ColourSpread {
    pub(crate) largest: CorrectedDistance,
    /// Root mean square by weight.
    pub(crate) rms: CorrectedDistance,
}

/// The spread of at least one colour.
pub(crate) fn colour_spread(colours: &[NoisyColour]) -> ColourSpread {
    let total: f64 = colours.iter().map(|own| own.weight).sum();
    let shares: Vec<f64> = colours.iter().map(|own| own.weight / total).collect();
    let noise = NoiseOfColours { colours, shares: &shares };
    let read: Vec<DVec2> = colours.iter().map(|own| own.uv).collect();
    ColourSpread { largest: noise.largest(&read), rms: noise.rms(&read) }
}

struct NoiseOfColours<'a> {
    colours: &'a [NoisyColour],
    /// Shares of the weight.
    shares: &'a [f64],
}

impl NoiseOfColours<'_> {
    /// Distances from the mean as vectors.
    fn distances(&self, read: &[DVec2]) -> Vec<DVec2> {
        let mean: DVec2 = self.shares.iter().zip(read).map(|(share, uv)| *share * *uv).sum();
        read.iter().map(|uv| *uv - mean).collect()
    }

    /// Standard error that the errors of the weights give to a mean over colours, of which `of` is what a colour has beyond the mean.
    fn by_weights(&self, distances: &[DVec2], of: impl Fn(DVec2) -> f64) -> f64 {
        let parts = self.colours.iter().zip(self.shares).zip(distances);
        let errors = parts
            .map(|((own, share), distance)| share * own.weight_error / own.weight * of(*distance));
        errors.map(|error| error * error).sum::<f64>().sqrt()
    }

    /// Mean square of distances without that of the noise, Σ w (1 - w) tr Σ.
    fn mean_square(&self, distances: &[DVec2]) -> f64 {
        let parts = self.colours.iter().zip(self.shares).zip(distances);
        parts
            .map(|((own, share), distance)| {
                share * (distance.length_squared() - (1.0 - share) * trace(own.covariance))
            })
            .sum()
    }

    fn rms(&self, read: &[DVec2]) -> CorrectedDistance {
        let distances = self.distances(read);
        let square = self.mean_square(&distances);
        // The variance of |d + e|² is 4 d'Σd + 2 tr Σ², and d'Σd as read contains tr Σ² more.
        let parts = self.colours.iter().zip(self.shares).zip(&distances);
        let variance: f64 = parts
            .map(|((own, share), distance)| {
                let noise = 2.0 * trace(own.covariance * own.covariance);
                let both = 4.0 * distance.dot(own.covariance * *distance) - noise;
                share * share * both.max(noise)
            })
            .sum();
        let value = square.max(0.0).sqrt();
        // That of the weights, dM = Σ (|d|² - M) dw.
        let by_weights = self.by_weights(&distances, |own| own.length_squared() - square);
        let variance = variance + by_weights * by_weights;
        CorrectedDistance {
            value,
            // To the upper end: where the square is no larger than its error, the root is not linear.
            std_error: (value * value + variance.sqrt()).sqrt() - value,
            bias: None,
            status: Status::Ok,
        }
    }

    fn largest(&self, read: &[DVec2]) -> CorrectedDistance {
        let denoised = self.without_noise(read);
        let found = longest(&denoised);
        let mut noise = Noise::new();
        let drawings = (DRAWS / read.len()).clamp(MIN_REPLICAS, REPLICAS);
        let drawn = Tally::of((0..drawings).map(|_| {
            let again = denoised.iter().zip(self.colours);
            let again: Vec<DVec2> =
                again.map(|(uv, own)| *uv + drawn(own.covariance, &mut noise)).collect();
            longest(&self.without_noise(&again))
        }));
        let [raw, noise_of_raw] = self.longest_as_read(read);
        let corrected = (2.0 * found - drawn.mean()).clamp(0.0, raw);
        let correction = raw - corrected;
        if correction > HIDDEN * raw {
            let bias = Some(correction);
            let status = Status::NoiseLimited;
            return CorrectedDistance { value: raw, std_error: noise_of_raw, bias, status };
        }
        let farthest = denoised
            .iter()
            .copied()
            .max_by(|one, other| one.length_squared().total_cmp(&other.length_squared()));
        let toward = farthest.unwrap_or_default().normalize_or_zero();
        let by_weights = self.by_weights(&denoised, |own| own.dot(toward));
        CorrectedDistance {
            value: corrected,
            std_error: (SCATTER * drawn.std_deviation()).hypot(by_weights),
            bias: Some(0.5 * correction),
            status: Status::Ok,
        }
    }

    /// The largest distance with all its noise, and the standard error of its colour.
    fn longest_as_read(&self, read: &[DVec2]) -> [f64; 2] {
        let lengths = self.distances(read).into_iter().map(DVec2::length);
        let (longest, of) = lengths
            .zip(self.colours)
            .max_by(|(one, _), (other, _)| one.total_cmp(other))
            .expect("there is at least one colour");
        [longest, largest_variance(of.covariance).sqrt()]
    }

    /// Distances from the mean without their noise.
    fn without_noise(&self, read: &[DVec2]) -> Vec<DVec2> {
        let distances = self.distances(read);
        // Of one coordinate.
        let signal = 0.5 * self.mean_square(&distances).max(0.0);
        let margin = 2.0 * ((read.len() as f64).ln() + MARGIN);
        let kept = |(distance, own): (DVec2, &NoisyColour)| {
            let noise = 0.5 * trace(own.covariance);
            if noise == 0.0 {
                return distance;
            }
            let threshold = margin * (largest_variance(own.covariance) + signal);
            let beyond = (distance.length_squared() / threshold - 1.0) / (FIRM - 1.0);
            let whole = beyond.clamp(0.0, 1.0).sqrt();
            distance * (signal / (signal + noise)).sqrt().max(whole)
        };
        distances.into_iter().zip(self.colours).map(kept).collect()
    }
}

fn longest(distances: &[DVec2]) -> f64 {
    distances.iter().map(|own| own.length_squared()).fold(0.0, f64::max).sqrt()
}

fn trace(of: DMat2) -> f64 {
    of.x_axis.x + of.y_axis.y
}

/// The larger eigenvalue of a symmetric matrix.
fn largest_variance(of: DMat2) -> f64 {
    let apart = 0.5 * (of.x_axis.x - of.y_axis.y);
    0.5 * trace(of) + apart.hypot(of.x_axis.y)
}

/// A normal pair of numbers with this covariance, by its Cholesky factor.
fn drawn(covariance: DMat2, noise: &mut Noise) -> DVec2 {
    let [a, b] = std::array::from_fn(|_| noise.normal());
    let first = covariance.x_axis.x.sqrt();
    let along = if first > 0.0 { covariance.x_axis.y / first } else { 0.0 };
    let second = (covariance.y_axis.y - along * along).max(0.0).sqrt();
    DVec2::new(first * a, along * a + second * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: f64 = 0.001;

    /// True colours with their weights.
    type Field = Vec<(DVec2, f64)>;

    /// Colours as if read: with a noise that is larger along u' + v' and where there is less light.
    fn read(truth: &[(DVec2, f64)], noise: &mut Noise) -> Vec<NoisyColour> {
        let one = |&(uv, weight): &(DVec2, f64)| {
            let covariance =
                DMat2::from_cols_array(&[1.0, 0.5, 0.5, 0.8]) * (NOISE * NOISE / weight);
            let uv = uv + drawn(covariance, noise);
            NoisyColour { uv, covariance, weight, weight_error: 0.0 }
        };
        truth.iter().map(one).collect()
    }

    /// Largest and root mean square of the true distances.
    fn truth_of(field: &[(DVec2, f64)]) -> [f64; 2] {
        let weight: f64 = field.iter().map(|(_, weight)| weight).sum();
        let mean: DVec2 = field.iter().map(|(uv, own)| *uv * *own).sum::<DVec2>() / weight;
        let squares = field.iter().map(|(uv, own)| ((*uv - mean).length_squared(), own / weight));
        let largest = squares.clone().map(|(square, _)| square).fold(0.0, f64::max);
        [largest, squares.map(|(square, share)| square * share).sum()].map(f64::sqrt)
    }

    /// Name, whether noise hides its largest distance, and colours.
    fn fields() -> Vec<(&'static str, bool, Field)> {
        let row = |n: u32, of: &dyn Fn(f64) -> DVec2, light: &dyn Fn(f64) -> f64| {
            let at = move |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0;
            (0..n).map(|i| (of(at(i)), light(at(i)))).collect::<Field>()
        };
        let (even, fading) = (|_: f64| 1.0, |at: f64| 1.0 - 0.8 * at.abs());
        let line = |reach: f64| move |at: f64| DVec2::new(reach * at, -0.4 * reach * at);
        let spot =
            |reach: f64| move |at: f64| if at > 0.995 { DVec2::X * reach } else { DVec2::ZERO };
        vec![
            ("flat", true, row(400, &line(0.0), &even)),
            ("flat, fading", true, row(400, &line(0.0), &fading)),
            ("line of noise", true, row(400, &line(NOISE), &even)),
            ("line", false, row(400, &line(5.0 * NOISE), &even)),
            ("line, fading", false, row(400, &line(5.0 * NOISE), &fading)),
            ("spot", false, row(400, &spot(20.0 * NOISE), &even)),
            ("spot in doubt", false, row(400, &spot(6.0 * NOISE), &even)),
            ("spot of noise", true, row(400, &spot(3.0 * NOISE), &even)),
            ("few", false, row(9, &line(3.0 * NOISE), &even)),
            ("few, flat", true, row(9, &line(0.0), &even)),
            ("two", false, row(2, &line(3.0 * NOISE), &even)),
        ]
    }

    #[test]
    fn distances_hold_within_their_errors() {
        let trials = 200;
        for (name, may_hide, field) in fields() {
            let mut noise = Noise::of_stream(6);
            let expected = truth_of(&field);
            let (mut held, mut hidden) = ([0, 0], 0);
            for _ in 0..trials {
                let ColourSpread { largest, rms } = colour_spread(&read(&field, &mut noise));
                hidden += i32::from(largest.status == Status::NoiseLimited);
                for ((own, truth), held) in [largest, rms].iter().zip(expected).zip(&mut held) {
                    let error = own.std_error.hypot(own.bias.unwrap_or(0.0));
                    *held += i32::from((own.value - truth).abs() <= 2.0 * error);
                }
            }
            // Fewer than the 190 of a normal distribution; a share of 0.87 of 200 is known to 5.
            assert!(held.iter().all(|own| *own >= 165), "{name}: {held:?} of {trials}");
            let is_hidden = hidden > trials / 2;
            assert_eq!(is_hidden, may_hide, "{name}: {hidden} of {trials}");
        }
    }

    #[test]
    fn colours_without_noise_have_their_distances() {
        let at = |u: f64, weight: f64| NoisyColour {
            uv: DVec2::new(0.2 + u, 0.5),
            covariance: DMat2::ZERO,
            weight,
            weight_error: 0.0,
        };
        let found = colour_spread(&[at(0.0, 3.0), at(0.04, 1.0)]);
        assert!((found.largest.value - 0.03).abs() < 1e-15, "{found:?}");
        assert!((found.rms.value - (0.0003f64).sqrt()).abs() < 1e-15, "{found:?}");
        assert_eq!([found.largest.std_error, found.rms.std_error], [0.0; 2]);
        assert_eq!(colour_spread(&[at(0.0, 1.0)]).largest.value, 0.0);
    }
}
