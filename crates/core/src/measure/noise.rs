//! Redrawn counts, which show how far noise scatters a statistic of a map.

use crate::rng::{Dimension, Sampler};
use statrs::distribution::{ContinuousCDF, Normal};

/// Seed and stream: the same readings always give the same measures.
const SEED: u64 = 0x6d65_6173;
const STREAM: u64 = 0;
/// From this many counts on, their number is drawn from the normal distribution.
const MANY: f64 = 25.0;

/// A stream of counts.
#[derive(Debug)]
pub(crate) struct Noise {
    sampler: Sampler,
    normal: Normal,
}

impl Noise {
    pub(crate) fn new() -> Self {
        Self::of_stream(STREAM)
    }

    /// Another stream, for tests.
    pub(crate) fn of_stream(stream: u64) -> Self {
        Self { sampler: Sampler::for_path(SEED, stream, 0), normal: Normal::standard() }
    }

    /// A standard normal number.
    pub(crate) fn normal(&mut self) -> f64 {
        let [u, _] = self.sampler.pair(Dimension::Resampling);
        // In the middle of its interval of 2^-53: neither 0 nor 1.
        self.normal.inverse_cdf(u + 0.5 / (1u64 << 53) as f64)
    }

    /// A number of counts with this mean, by inversion of the Poisson distribution (Devroye, Non-Uniform Random Variate
    /// Generation (1986), section X.3).
    pub(crate) fn poisson(&mut self, mean: f64) -> f64 {
        if mean <= 0.0 {
            return 0.0;
        }
        if mean > MANY {
            return (mean + mean.sqrt() * self.normal()).max(0.0);
        }
        let mut left = self.sampler.one(Dimension::Resampling);
        let (mut count, mut chance) = (0.0, (-mean).exp());
        while left > chance && chance > 0.0 {
            left -= chance;
            count += 1.0;
            chance *= mean / count;
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tally::Tally;

    #[test]
    fn counts_have_their_mean_and_variance() {
        for mean in [0.0, 0.3, 4.0, 24.0, 26.0, 1e6] {
            let mut noise = Noise::of_stream(3);
            let drawn: Vec<f64> = (0..20_000).map(|_| noise.poisson(mean)).collect();
            let tally = Tally::of(drawn.iter().copied());
            assert!(tally.sigmas_from(mean).abs() < 4.0, "{mean}: {}", tally.mean());
            let variance = Tally::of(drawn.iter().map(|count| (count - mean).powi(2)));
            assert!(variance.sigmas_from(mean).abs() < 4.0, "{mean}: {}", variance.mean());
        }
    }
}
