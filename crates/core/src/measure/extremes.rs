//! The smallest and the largest of many values that are known with noise, their ratios, and the spread of all.
//!
//! The smallest of noisy values is too small: of 1024 cells of equal illuminance known to 1 %, the
//! darkest reads 3.2 % below. So the extremes are those of the values without noise
//! ([`crate::measure::multiscale`]). The effect on a statistic is estimated by a parametric
//! bootstrap about these values (Efron & Tibshirani, An Introduction to the Bootstrap (1993),
//! chapters 6 and 10): counts are redrawn, and the statistic is computed from each drawing in the
//! same way. The scatter of drawings is the standard error; half of their mean deviation is
//! subtracted, the other half is reported as bias. docs/trials.md contains the figures behind this
//! choice.
//!
//! This module does not know sensors. Units are those of its input.

use crate::measure::noise::Noise;
use crate::measure::noisy::{NoisySample, WeightedValue};
use crate::tally::Tally;

/// Drawings: the error of an error is then 9 %.
const REPLICAS: u64 = 64;
/// On large maps drawing stops after this many counts, but not before [`MIN_REPLICAS`] drawings.
const DRAWS: usize = 4_000_000;
const MIN_REPLICAS: u64 = 16;
/// Fraction of the mean deviation of drawings that is subtracted as bias, 1.
const BIAS_TAKEN: f64 = 0.5;
/// Scatter of an extreme of n values over that of its drawings, less 1, over ln n: the values that
/// drawings are made about are slightly too even, the more so the more there are.
const SCATTER: f64 = 0.05;
/// Real standard deviation of a CV over that of its drawings.
const SCATTER_OF_CV: f64 = 1.06;
/// Two-sided 95 % point of the normal distribution.
pub(crate) const TWO_SIDED_95: f64 = 1.959_964;
/// Length of the interval away from the other values and toward them, in [`TWO_SIDED_95`] standard
/// errors: an extreme is more often found too far out than too far in.
const OUTWARD: f64 = 1.1;
const INWARD: f64 = 1.7;
/// The same for the ratio of two extremes, since both estimates lie too far out.
const INWARD_OF_BOTH: f64 = 1.8;
/// Expected counts that are negligible, 1.
const NEXT_TO_NOTHING: f64 = 0.1;
/// Posterior standard deviation of the mean of a Poisson distribution after a count of 0, with Jeffreys'
/// prior: ½^½ (Jeffreys, Theory of Probability (1961), section 3.1).
const DEVIATION_OF_NONE: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Upper 97.5 % limit of the mean of a Poisson distribution after a count of 0, -ln 0.025.
const NONE_COUNTED: f64 = 3.69;

/// A statistic of some values as read, and corrected for noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CorrectedStatistic {
    /// As read.
    pub(crate) raw: f64,
    /// Corrected.
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    /// Possible bias of the corrected value, in addition to the noise.
    pub(crate) bias: f64,
    /// Contains the true value in 95 of 100 cases.
    pub(crate) interval: [f64; 2],
}

/// How even some values are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Evenness<T> {
    pub(crate) min: T,
    pub(crate) max: T,
    /// Smallest over average, 1.
    pub(crate) min_avg: T,
    /// Smallest over largest, 1.
    pub(crate) min_max: T,
    /// Standard deviation over average by weight, 1.
    pub(crate) cv: T,
    /// Its square, which may be negative where noise is subtracted from it, 1.
    pub(crate) variance: T,
}

/// The largest value alone.
pub(crate) fn maximum(parts: &[WeightedValue]) -> CorrectedStatistic {
    evenness(parts).max
}

/// Extremes and spread of at least one value. Neighbours in the list are neighbours on the sensor.
pub(crate) fn evenness(parts: &[WeightedValue]) -> Evenness<CorrectedStatistic> {
    let sample = NoisySample::of(parts);
    let raw = statistics(&sample, &sample.values, &sample.values, 0.0);
    if parts.iter().any(|part| !part.read.std_error.is_finite()) {
        return raw.map(unknown);
    }
    if sample.counts.iter().all(|&count| count == 0.0) {
        return raw.map(exact);
    }
    let denoised = sample.without_noise(&sample.values);
    let found =
        statistics(&sample, &sample.values, &denoised, noise_variance(&sample, &sample.values));
    let centre = statistics(&sample, &denoised, &denoised, 0.0);
    let drawn = scatter(&sample, &denoised);
    let (_, count) = sample.darkest();
    let judge = |side, pick: fn(&Evenness<f64>) -> f64, tally: &Tally| {
        corrected(side, parts.len(), [pick(&raw), pick(&found), pick(&centre)], tally)
    };
    let mean = sample.weights.iter().zip(&sample.values).map(|(w, value)| w * value).sum::<f64>();
    let [min, max] = [
        judge(ExtremeSide::Smallest, |one| one.min, &drawn.min).below(mean).not_counted(count),
        judge(ExtremeSide::Largest, |one| one.max, &drawn.max).above(mean),
    ];
    let relative =
        |extreme: CorrectedStatistic, whole: f64| extreme.not_counted(count / whole).below(1.0);
    Evenness {
        min,
        max,
        min_avg: relative(judge(ExtremeSide::Smallest, |one| one.min_avg, &drawn.min_avg), mean),
        min_max: relative(judge(ExtremeSide::Ratio, |one| one.min_max, &drawn.min_max), max.value),
        cv: variation([&raw, &found], &drawn),
        variance: exact(found.variance),
    }
}

impl<T: Copy> Evenness<T> {
    fn map<U>(self, f: impl Fn(T) -> U) -> Evenness<U> {
        let Self { min, max, min_avg, min_max, cv, variance } = self;
        let [min, max, min_avg, min_max, cv, variance] =
            [min, max, min_avg, min_max, cv, variance].map(f);
        Evenness { min, max, min_avg, min_max, cv, variance }
    }
}

/// The statistics of values, with the extremes of `denoised` and a CV without the variance of this noise.
fn statistics(sample: &NoisySample, values: &[f64], denoised: &[f64], noise: f64) -> Evenness<f64> {
    let mean: f64 = sample.weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
    let squares = sample.weights.iter().zip(values);
    let read: f64 = squares.map(|(weight, value)| weight * (value - mean).powi(2)).sum();
    let min = denoised.iter().copied().fold(f64::INFINITY, f64::min);
    let max = denoised.iter().copied().fold(0.0, f64::max);
    let over = |value: f64, whole: f64| if whole > 0.0 { value / whole } else { 0.0 };
    Evenness {
        min,
        max,
        min_avg: over(min, mean).min(1.0),
        min_max: over(min, max),
        cv: over((read - noise).max(0.0).sqrt(), mean),
        variance: if mean > 0.0 { (read - noise) / (mean * mean) } else { 0.0 },
    }
}

/// The variance that the noise of values alone would cause, Σ w (1 - w) σ².
fn noise_variance(sample: &NoisySample, values: &[f64]) -> f64 {
    let parts = sample.weights.iter().zip(values).zip(&sample.counts);
    parts.map(|((weight, value), count)| weight * (1.0 - weight) * value * count).sum()
}

fn found(sample: &NoisySample, values: &[f64]) -> Evenness<f64> {
    let denoised = sample.without_noise(values);
    statistics(sample, values, &denoised, noise_variance(sample, values))
}

/// The distribution of the statistics when counts are redrawn about some means.
fn scatter(sample: &NoisySample, means: &[f64]) -> Evenness<Tally> {
    let mut noise = Noise::new();
    let few = (DRAWS / means.len()) as u64;
    let mut all = statistics(sample, means, means, 0.0).map(|_| Tally::default());
    for _ in 0..few.clamp(MIN_REPLICAS, REPLICAS) {
        let found = found(sample, &sample.drawn(means, &mut noise));
        all.min.add(found.min);
        all.max.add(found.max);
        all.min_avg.add(found.min_avg);
        all.min_max.add(found.min_max);
        all.cv.add(found.cv);
        all.variance.add(found.variance);
    }
    all
}

/// A statistic of values without noise.
fn exact(raw: f64) -> CorrectedStatistic {
    CorrectedStatistic { raw, value: raw, std_error: 0.0, bias: 0.0, interval: [raw; 2] }
}

/// A statistic of unknown error.
fn unknown(raw: f64) -> CorrectedStatistic {
    let interval = [0.0, f64::INFINITY];
    CorrectedStatistic { raw, value: raw, std_error: f64::INFINITY, bias: 0.0, interval }
}

/// The coefficient of variation, from which the variance of the noise is already subtracted. Its
/// interval is that of the variance, which has no bound at zero.
fn variation([raw, found]: [&Evenness<f64>; 2], drawn: &Evenness<Tally>) -> CorrectedStatistic {
    let reach = TWO_SIDED_95 * SCATTER_OF_CV * drawn.variance.std_deviation();
    let root = |variance: f64| variance.max(0.0).sqrt();
    CorrectedStatistic {
        raw: raw.cv,
        value: found.cv,
        std_error: SCATTER_OF_CV * drawn.cv.std_deviation(),
        bias: 0.0,
        interval: [root(found.variance - reach), root(found.variance + reach).max(found.cv)],
    }
}

#[derive(Clone, Copy)]
enum ExtremeSide {
    Smallest,
    Largest,
    /// Of the smallest over the largest.
    Ratio,
}

/// A statistic of some cells as read, of the values without noise, and of the centre of the
/// drawings, corrected by what the drawings give.
fn corrected(
    side: ExtremeSide,
    cells: usize,
    [raw, found, centre]: [f64; 3],
    drawn: &Tally,
) -> CorrectedStatistic {
    let deviation = drawn.mean() - centre;
    let std_error = (1.0 + SCATTER * (cells as f64).ln()) * drawn.std_deviation();
    let [below, above] = match side {
        ExtremeSide::Smallest => [OUTWARD, INWARD],
        ExtremeSide::Largest => [INWARD, OUTWARD],
        ExtremeSide::Ratio => [OUTWARD, INWARD_OF_BOTH],
    };
    let value = (found - BIAS_TAKEN * deviation).max(0.0);
    let reach = TWO_SIDED_95 * std_error;
    CorrectedStatistic {
        raw,
        value,
        std_error,
        bias: (1.0 - BIAS_TAKEN) * deviation.abs(),
        interval: [(value - below * reach).max(0.0), value + above * reach],
    }
}

impl CorrectedStatistic {
    /// The same, limited to at most this.
    fn below(self, limit: f64) -> Self {
        let value = self.value.min(limit);
        // Sums round differently.
        Self { value, interval: self.interval.map(|end| end.min(limit.max(value))), ..self }
    }

    /// The same, limited to at least this.
    fn above(self, limit: f64) -> Self {
        let value = self.value.max(limit);
        Self { value, interval: self.interval.map(|end| end.max(limit.min(value))), ..self }
    }

    /// Where nothing was counted and next to nothing is expected, a value is known to about one
    /// count.
    fn not_counted(self, count: f64) -> Self {
        if self.raw > 0.0 || self.value > NEXT_TO_NOTHING * count {
            return self;
        }
        let high = self.interval[1].max(NONE_COUNTED * count);
        Self {
            std_error: self.std_error.max(DEVIATION_OF_NONE * count),
            interval: [self.interval[0], high],
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::noisy::Noisy;
    use crate::measure::trials::counted;

    #[test]
    fn the_smallest_is_not_the_unluckiest_and_a_dark_cell_that_stands_out_stays() {
        let mut noise = Noise::of_stream(4);
        let mut field = vec![(1.0, 1.0); 1024];
        let least = evenness(&counted(&field, 1000.0, &mut noise)).min;
        assert!(least.raw < 0.92 && least.value > 0.96, "{least:?}");
        assert!(least.interval[1] >= 1.0 - 1e-3, "{least:?}");
        field[300].0 = 0.5;
        let least = evenness(&counted(&field, 1000.0, &mut noise)).min;
        assert!((least.value - 0.5).abs() < 4.0 * least.std_error, "{least:?}");
    }

    #[test]
    fn what_is_not_counted_is_known_to_a_count_and_without_errors_nothing_is_known() {
        let dark = Noisy { value: 0.0, std_error: 0.0, count: 0.1 };
        let lit = Noisy { value: 1000.0, std_error: 10.0, count: 0.1 };
        let parts = [lit, lit, dark, dark].map(|read| WeightedValue { read, weight: 1.0 });
        let least = evenness(&parts).min;
        assert_eq!((least.value, least.std_error), (0.0, 0.5f64.sqrt() * 0.1));
        assert!((least.interval[1] - 0.369).abs() < 1e-3, "{least:?}");
        let lost = Noisy { std_error: f64::INFINITY, ..lit };
        let parts = [lit, lost].map(|read| WeightedValue { read, weight: 1.0 });
        assert_eq!(evenness(&parts).max.interval, [0.0, f64::INFINITY]);
    }
}
