//! Means with their standard error, from independent batches.

use serde::{Deserialize, Serialize};

/// A running mean over independent samples (batches of paths, passes), never over bounces.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Tally {
    count: u64,
    mean: f64,
    /// Sum of squared deviations from the mean.
    m2: f64,
}

impl Tally {
    /// The tally of a set of samples.
    pub fn of(samples: impl IntoIterator<Item = f64>) -> Self {
        let mut tally = Self::default();
        for sample in samples {
            tally.add(sample);
        }
        tally
    }

    /// The tally of means of several samples each; the numbers of samples are their weights.
    ///
    /// The variance of a mean is proportional to 1/w, with w its weight, so that Σ w (x - mean)² /
    /// ((n - 1) Σ w) is that of the weighted mean (Bevington & Robinson, Data Reduction and Error
    /// Analysis, 3rd ed., eq. 4.22).
    pub(crate) fn weighted(means: impl Iterator<Item = (f64, u64)> + Clone) -> Self {
        let (mut sum, mut weights, mut count) = (0.0, 0.0, 0);
        for (mean, weight) in means.clone() {
            sum += mean * weight as f64;
            weights += weight as f64;
            count += 1;
        }
        if weights == 0.0 {
            return Self::default();
        }
        let mean = sum / weights;
        let squares: f64 = means.map(|(x, weight)| weight as f64 * (x - mean).powi(2)).sum();
        Self { count, mean, m2: squares * count as f64 / weights }
    }

    /// Adds one sample (Welford, Technometrics 4 (1962) 419).
    pub fn add(&mut self, x: f64) {
        self.count += 1;
        let delta = x - self.mean;
        self.mean += delta / self.count as f64;
        self.m2 += delta * (x - self.mean);
    }

    /// Adds all samples of another tally (Chan, Golub and Le Veque, Am. Stat. 37 (1983) 242).
    pub fn merge(&mut self, other: &Self) {
        if other.count == 0 {
            return;
        }
        let total = (self.count + other.count) as f64;
        let delta = other.mean - self.mean;
        self.m2 += other.m2 + delta * delta * self.count as f64 * other.count as f64 / total;
        self.mean += delta * other.count as f64 / total;
        self.count += other.count;
    }

    /// Mean of the samples; 0 without any.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Standard error of the mean; infinite with fewer than two samples.
    pub fn std_error(&self) -> f64 {
        if self.count < 2 {
            return f64::INFINITY;
        }
        (self.m2 / (self.count - 1) as f64 / self.count as f64).sqrt()
    }

    /// Standard deviation of the samples; infinite with fewer than two.
    pub(crate) fn std_deviation(&self) -> f64 {
        self.std_error() * (self.count as f64).sqrt()
    }

    /// Distance of the mean from `expected` in standard errors; 0 when they are equal.
    pub fn sigmas_from(&self, expected: f64) -> f64 {
        sigmas(self.mean, self.std_error(), expected)
    }
}

/// Deviation of `value` from `expected` in units of `std_error`; 0 when they are equal.
pub fn sigmas(value: f64, std_error: f64, expected: f64) -> f64 {
    let deviation = value - expected;
    if deviation == 0.0 { 0.0 } else { deviation / std_error }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_error_of_a_known_set() {
        let tally = Tally::of([1.0, 2.0, 3.0, 4.0]);
        assert_eq!(tally.mean(), 2.5);
        assert!((tally.std_error() - (5.0f64 / 3.0 / 4.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn merging_equals_adding() {
        let all = Tally::of((0..100).map(|i| f64::from(i * i % 17)));
        let mut halves = Tally::of((0..37).map(|i| f64::from(i * i % 17)));
        halves.merge(&Tally::of((37..100).map(|i| f64::from(i * i % 17))));
        assert_eq!(all.count, halves.count);
        assert!((all.mean() - halves.mean()).abs() < 1e-13);
        assert!((all.std_error() - halves.std_error()).abs() < 1e-13);
    }

    #[test]
    fn weighted_means_are_those_of_all_samples_and_equal_weights_change_nothing() {
        let equal = Tally::weighted([1.0, 2.0, 3.0, 4.0].map(|mean| (mean, 3)).into_iter());
        let plain = Tally::of([1.0, 2.0, 3.0, 4.0]);
        assert!((equal.mean() - plain.mean()).abs() < 1e-15);
        assert!((equal.std_error() - plain.std_error()).abs() < 1e-15);
        // Means of two samples and of one, 7 and 1: 15/3, and (2·4 + 16) / (1 · 3).
        let two = Tally::weighted([(7.0, 2), (1.0, 1)].into_iter());
        assert!((two.mean() - 5.0).abs() < 1e-15);
        assert!((two.std_error() - 8f64.sqrt()).abs() < 1e-15);
        assert_eq!(Tally::weighted([(7.0, 2)].into_iter()).std_error(), f64::INFINITY);
    }

    #[test]
    fn a_single_sample_has_no_error_bar() {
        assert_eq!(Tally::of([3.0]).std_error(), f64::INFINITY);
    }
}
