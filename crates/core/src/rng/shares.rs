//! Paths of a batch divided evenly among strata.
//!
//! Each stratum has its share of the paths, as a mean over batches exactly, so that a batch is an unbiased sample also where it
//! has fewer paths than strata. Paths of a stratum follow one another: their points then fill it evenly, and those of all
//! strata fill the whole, with the stratum as one more dimension (Hammersley, Ann. N. Y. Acad. Sci. 86 (1960) 844).

use crate::rng::{Dimension, Numbers, Sampler};

/// Strata of the paths of a batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StratumShares {
    strata: u64,
    /// Paths of the batch: a multiple of the strata, or fewer.
    pub(crate) paths: u64,
}

impl StratumShares {
    /// About `about` paths, which is a power of two: where they suffice for more than half of the strata, the same power of two in each
    /// stratum, and together at least `about`. Twice `about` then gives twice the paths, or with fewer paths than strata
    /// two to four times as many.
    pub(crate) fn of(strata: u64, about: u64) -> Self {
        let is_few = strata < 2 || 2 * about <= strata;
        let paths =
            if is_few { about } else { strata * about.div_ceil(strata).next_power_of_two() };
        Self { strata, paths }
    }

    /// The stratum of a path by its place in the batch. Where there are fewer paths than strata, each path draws one out of
    /// its own range: strata at equal distances would often be a single column of a map.
    #[inline]
    pub(crate) fn stratum(&self, place: u64, sampler: &mut Sampler<impl Numbers>) -> usize {
        let Self { strata, paths } = *self;
        if paths >= strata {
            return (place / (paths / strata)) as usize;
        }
        let share = (place as f64 + sampler.one(Dimension::GatherCell)) / paths as f64;
        ((share * strata as f64) as usize).min(strata as usize - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Paths of each stratum in a batch.
    fn counts(batch: u64, shares: StratumShares) -> Vec<u64> {
        let mut counts = vec![0; shares.strata as usize];
        for place in 0..shares.paths {
            counts[shares.stratum(place, &mut Sampler::for_path(batch, 2, place))] += 1;
        }
        counts
    }

    #[test]
    fn every_stratum_has_its_share_of_the_paths_of_every_batch() {
        for [strata, about] in [[1, 64], [7, 7], [20, 320], [20, 64], [856, 3424], [856, 5000]] {
            let shares = StratumShares::of(strata, about);
            let own = shares.paths / strata;
            assert!(own.is_power_of_two());
            assert!(counts(0, shares).iter().all(|count| *count == own), "{shares:?}");
        }
    }

    #[test]
    fn a_stratum_has_its_exact_share_of_few_paths_as_a_mean_over_batches() {
        for [strata, about] in [[17, 8], [16, 4], [9, 4]] {
            const BATCHES: u64 = 4000;
            let shares = StratumShares::of(strata, about);
            assert_eq!(shares.paths, about);
            let mut sums = vec![0; strata as usize];
            for batch in 0..BATCHES {
                sums.iter_mut().zip(counts(batch, shares)).for_each(|(sum, count)| *sum += count);
            }
            let share = about as f64 / strata as f64;
            for sum in sums {
                let found = sum as f64 / BATCHES as f64;
                // Four standard errors of a number that is one of two neighbours.
                assert!((found - share).abs() < 4.0 * 0.5 / (BATCHES as f64).sqrt(), "{found}");
            }
        }
    }

    #[test]
    fn more_paths_are_a_multiple_of_a_few() {
        for strata in [1, 2, 20, 856, 5000] {
            for about in [64, 256, 1024, 4096] {
                let [few, more] =
                    [about, 8 * about].map(|about| StratumShares::of(strata, about).paths);
                assert!((about..=2 * about).contains(&few), "{strata} {about}: {few}");
                assert!((8 * few..16 * few).contains(&more), "{strata} {about}: {few}, {more}");
            }
        }
    }
}
