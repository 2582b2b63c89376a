//! How far noisy colours lie from their mean: the largest distance, and its root mean square.
//!
//! Noise moves every colour away from the mean, so both are too large as read. The mean square loses the noise that is expected in it. The
//! largest distance is that of colours without noise: all are shrunk toward the mean such that they keep the spread of the signal
//! (constrained empirical Bayes: Louis, J. Am. Stat. Assoc. 79 (1984) 393), except those beyond what signal and noise of a normal
//! distribution reach. A parametric bootstrap about these colours gives its bias, which is subtracted, and its error (Efron & Tibshirani, An
//! Introduction to the Bootstrap (1993), chapters 6 and 10). The truth lies between the corrected and the uncorrected distance, so half of what
//! is between them is reported as bias; where that is most of the distance, noise hides it, and it is given as read, with the whole of the
//! correction as bias.
//!
//! This module does not know sensors. Colours are coordinates of a chromaticity diagram, and independent of each other.

use crate::measure::Status;
use crate::measure::noise::Noise;
use crate::tally::Tally;
use glam::{DMat2, DMat3, DVec2, DVec3};

/// Drawings, fewer for many colours.
const REPLICAS: usize = 64;
const MIN_REPLICAS: usize = 16;
const DRAWS: usize = 1_000_000;
/// Real scatter of the largest distance over that of its drawings, whose colours are slightly too even; chosen by the trials below.
const SCATTER: f64 = 1.3;
/// The largest of n squared distances over twice their variance exceeds ln n by more than this in 5 of 100 cases.
const MARGIN: f64 = 3.0;
/// A correction beyond this share of the distance as read hides it, 1; where it is half, signal and noise are equal in the mean.
const HIDDEN: f64 = 0.5;
/// Squared distances this many times above the threshold are kept whole; between, a part of them (firm shrinkage: Gao & Bruce, Stat. Sinica
/// 7 (1997) 855).
const FIRM: f64 = 2.5;

/// Pivots of a covariance below this share of a variance are rounding, 1.
const PIVOT_ROUNDING: f64 = 1e-12;

/// A colour with its weight in a mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WeightedColour {
    pub(crate) uv: DVec2,
    pub(crate) weight: f64,
}

/// A colour that is known with noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoisyColour {
    pub(crate) read: WeightedColour,
    /// Covariance of u', v' and the logarithm of the weight.
    pub(crate) covariance: DMat3,
}

/// A distance corrected for noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CorrectedDistance {
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    /// Possible bias in addition to the noise; `None` where there is none.
    pub(crate) bias: Option<f64>,
    /// Whether noise hides it.
    pub(crate) status: Status,
}

/// Distances of colours from their mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ColourSpread {
    pub(crate) largest: CorrectedDistance,
    /// Root mean square by weight.
    pub(crate) rms: CorrectedDistance,
}

impl NoisyColour {
    /// Covariance of u' and v'.
    fn of_uv(&self) -> DMat2 {
        DMat2::from_mat3(self.covariance)
    }
}

/// The spread of at least one colour.
pub(crate) fn colour_spread(colours: &[NoisyColour]) -> ColourSpread {
    ColourSpread { largest: largest(colours), rms: rms(colours) }
}

/// The largest distance and the root mean square of some colours without their noise.
pub(crate) fn denoised_spread(colours: &[NoisyColour]) -> [f64; 2] {
    let distances = Distances::of(read(colours));
    [longest(&distances.without_noise(colours)), distances.mean_square(colours).max(0.0).sqrt()]
}

fn rms(colours: &[NoisyColour]) -> CorrectedDistance {
    let distances = Distances::of(read(colours));
    let square = distances.mean_square(colours);
    // A cell changes Σ w|d|² / Σ w by its share of 2 d·de + (|d|² - M) d ln w, and |de|² adds 2 tr Σ² to the variance; d'Σd as read
    // contains tr Σ² more.
    let (mut variance, mut of_noise) = (0.0, 0.0);
    for ((own, share), distance) in distances.beside(colours) {
        let of = (2.0 * distance).extend(distance.length_squared() - square);
        let noise = 2.0 * trace(own.of_uv() * own.of_uv());
        variance += share * share * (of.dot(own.covariance * of) - noise);
        of_noise += share * share * noise;
    }
    let two_errors = 2.0 * variance.max(of_noise).sqrt();
    let value = square.max(0.0).sqrt();
    let [low, high] = [-two_errors, two_errors].map(|own| (value * value + own).max(0.0).sqrt());
    CorrectedDistance {
        value,
        // Two errors reach both ends: where the square is no larger than its error, the root is not linear.
        std_error: 0.5 * (high - value).max(value - low),
        bias: None,
        status: if two_errors > 0.0 && square < two_errors {
            Status::NoiseLimited
        } else {
            Status::Ok
        },
    }
}

fn largest(colours: &[NoisyColour]) -> CorrectedDistance {
    let distances = Distances::of(read(colours));
    let denoised = distances.without_noise(colours);
    let found = longest(&denoised);
    let mut noise = Noise::new();
    let drawings = (DRAWS / colours.len()).clamp(MIN_REPLICAS, REPLICAS);
    let drawn = Tally::of((0..drawings).map(|_| {
        let again = denoised.iter().zip(colours).map(|(uv, own)| {
            let error = drawn(own.covariance, &mut noise);
            let weight = own.read.weight * (1.0 + error.z).max(0.0);
            WeightedColour { uv: *uv + error.truncate(), weight }
        });
        longest(&Distances::of(again.collect()).without_noise(colours))
    }));
    let [raw, noise_of_raw] = distances.longest_as_read(colours);
    let corrected = (2.0 * found - drawn.mean()).max(0.0).min(raw);
    let correction = raw - corrected;
    if correction > HIDDEN * raw {
        let bias = Some(correction);
        let status = Status::NoiseLimited;
        return CorrectedDistance { value: raw, std_error: noise_of_raw, bias, status };
    }
    CorrectedDistance {
        value: corrected,
        std_error: SCATTER * drawn.std_deviation(),
        bias: Some(0.5 * correction),
        status: Status::Ok,
    }
}

fn read(colours: &[NoisyColour]) -> Vec<WeightedColour> {
    colours.iter().map(|own| own.read).collect()
}

/// Colours as vectors from their mean.
struct Distances {
    distances: Vec<DVec2>,
    /// Their shares of the weight.
    shares: Vec<f64>,
}

impl Distances {
    fn of(colours: Vec<WeightedColour>) -> Self {
        let total: f64 = colours.iter().map(|own| own.weight).sum();
        let shares: Vec<f64> = colours.iter().map(|own| own.weight / total).collect();
        let mean: DVec2 = colours.iter().zip(&shares).map(|(own, share)| *share * own.uv).sum();
        Self { distances: colours.iter().map(|own| own.uv - mean).collect(), shares }
    }

    /// Colours with their shares and distances.
    fn beside<'a>(
        &'a self,
        colours: &'a [NoisyColour],
    ) -> impl Iterator<Item = ((&'a NoisyColour, f64), DVec2)> {
        colours.iter().zip(self.shares.iter().copied()).zip(self.distances.iter().copied())
    }

    /// Mean square of distances without that of the noise, Σ w (1 - w) tr Σ.
    fn mean_square(&self, colours: &[NoisyColour]) -> f64 {
        let part = |((own, share), distance): ((&NoisyColour, f64), DVec2)| {
            share * (distance.length_squared() - (1.0 - share) * trace(own.of_uv()))
        };
        self.beside(colours).map(part).sum()
    }

    /// The largest distance with all its noise, and the standard error of its colour.
    fn longest_as_read(&self, colours: &[NoisyColour]) -> [f64; 2] {
        let lengths = self.beside(colours).map(|((own, _), distance)| (distance.length(), own));
        let longest = lengths.max_by(|(one, _), (other, _)| one.total_cmp(other));
        longest.map_or([0.0; 2], |(length, own)| [length, largest_variance(own.of_uv()).sqrt()])
    }

    /// Without their noise.
    fn without_noise(&self, colours: &[NoisyColour]) -> Vec<DVec2> {
        // Of one coordinate.
        let signal = 0.5 * self.mean_square(colours).max(0.0);
        let margin = 2.0 * ((colours.len() as f64).ln() + MARGIN);
        let kept = |((own, _), distance): ((&NoisyColour, f64), DVec2)| {
            let noise = 0.5 * trace(own.of_uv());
            if noise == 0.0 {
                return distance;
            }
            let threshold = margin * (largest_variance(own.of_uv()) + signal);
            let beyond = (distance.length_squared() / threshold - 1.0) / (FIRM - 1.0);
            let whole = beyond.clamp(0.0, 1.0).sqrt();
            distance * (signal / (signal + noise)).sqrt().max(whole)
        };
        self.beside(colours).map(kept).collect()
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

/// Normal numbers with this covariance, by its Cholesky factor (Golub & Van Loan, Matrix Computations, 4th ed. (2013), section 4.2).
fn drawn(covariance: DMat3, noise: &mut Noise) -> DVec3 {
    let numbers: [f64; 3] = std::array::from_fn(|_| noise.normal());
    let mut left = covariance;
    let mut sum = DVec3::ZERO;
    for (axis, number) in numbers.into_iter().enumerate() {
        let pivot = left.col(axis)[axis];
        // What rounding leaves of a number that follows from those before it.
        if pivot > PIVOT_ROUNDING * covariance.col(axis)[axis] {
            let factor = left.col(axis) / pivot.sqrt();
            sum += number * factor;
            left -= DMat3::from_cols(factor * factor.x, factor * factor.y, factor * factor.z);
        }
    }
    sum
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
            // The weight has an error seven times as large, with which colours go.
            let of = [1.0, 0.5, -3.0, 0.5, 0.8, -3.0, -3.0, -3.0, 49.0];
            let covariance = DMat3::from_cols_array(&of) * (NOISE * NOISE / weight);
            let error = drawn(covariance, noise);
            let weight = weight * (1.0 + error.z);
            NoisyColour { read: WeightedColour { uv: uv + error.truncate(), weight }, covariance }
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
        for (name, hides, field) in fields() {
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
            // A normal distribution has 190; a share of 0.95 of 200 is known to 3.
            assert!(held.iter().all(|own| *own >= 180), "{name}: {held:?} of {trials}");
            let is_hidden = hidden > trials / 2;
            assert_eq!(is_hidden, hides, "{name}: {hidden} of {trials}");
        }
    }

    #[test]
    fn colours_without_noise_have_their_distances() {
        let at = |u: f64, weight: f64| NoisyColour {
            read: WeightedColour { uv: DVec2::new(0.2 + u, 0.5), weight },
            covariance: DMat3::ZERO,
        };
        let found = colour_spread(&[at(0.0, 3.0), at(0.04, 1.0)]);
        assert!((found.largest.value - 0.03).abs() < 1e-15, "{found:?}");
        assert!((found.rms.value - (0.0003f64).sqrt()).abs() < 1e-15, "{found:?}");
        assert_eq!([found.largest.std_error, found.rms.std_error], [0.0; 2]);
        assert_eq!(colour_spread(&[at(0.0, 1.0)]).largest.value, 0.0);
    }
}
