//! Paths of a batch divided evenly among strata.
//!
//! Each stratum has its share of the paths, as a mean over batches exactly, so that a batch is an unbiased sample also where it
//! has fewer paths than strata. Paths of a stratum follow one another: their points then fill it evenly, and those of all
//! strata fill the whole, with the stratum as one more dimension (Hammersley, Ann. N. Y. Acad. Sci. 86 (1960) 844).

use crate::rng::{Dimension, Numbers, Sampler};

/// Least strata in a batch of a trial, if there are as many.
const LEAST_TRIED: u64 = 8;

/// Strata of the paths of a batch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StratumShares {
    strata: u64,
    /// Strata in which the batch has paths, at equal distances: all of them, except in a trial.
    tried: u64,
    /// Which ones those are, 0 to 1.
    turn: f64,
    /// Paths of the batch: a multiple of the strata that are tried, or fewer than there are.
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
        Self { strata, tried: strata, turn: 0.0, paths }
    }

    /// The same for a trial with about `about` paths. If these cannot give every stratum as many paths as the run does, only some strata
    /// are tried, at least [`LEAST_TRIED`] if there are as many, with as many paths in each as in the run or as `about` allows. Fewer
    /// paths are then fewer in each stratum, which shows what more would gain.
    pub(crate) fn for_trial(self, about: u64) -> Self {
        if self.strata < 2 || self.paths < self.strata || self.paths <= about {
            return Self::of(self.strata, about);
        }
        let most = (about / LEAST_TRIED.min(self.strata)).max(1);
        let each = self.each().min(1 << most.ilog2());
        let tried = (about / each).clamp(1, self.strata);
        Self { tried, paths: each * tried, ..self }
    }

    /// Share of the strata in which the batch has paths, 1.
    pub(crate) fn share(&self) -> f64 {
        self.tried as f64 / self.strata as f64
    }

    /// The same in other strata, if it has not paths in all, evenly over all of them for a uniform `turn`.
    pub(crate) fn turned(self, turn: f64) -> Self {
        Self { turn, ..self }
    }

    /// Paths in a stratum; 0 where there are fewer paths than strata.
    pub(crate) fn each(&self) -> u64 {
        self.paths / self.tried
    }

    /// The stratum of a path by its place in the batch. Where there are fewer paths than strata, each path draws one out of
    /// its own range: strata at equal distances would often be a single column of a map.
    #[inline]
    pub(crate) fn stratum(&self, place: u64, sampler: &mut Sampler<impl Numbers>) -> usize {
        let Self { strata, tried, turn, paths } = *self;
        if paths >= tried {
            let place = place / self.each();
            if tried == strata {
                return place as usize;
            }
            let distance = strata as f64 / tried as f64;
            return (((place as f64 + turn) * distance) as usize).min(strata as usize - 1);
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
    fn a_trial_has_paths_in_some_strata_as_a_run_has_in_all() {
        let run = StratumShares::of(856, 20_000);
        let trial = run.for_trial(500);
        assert_eq!((run.each(), trial.each(), trial.tried), (32, 32, 15));
        assert_eq!(StratumShares::of(856, 1000).for_trial(500).each(), 2, "as a run");
        assert_eq!(StratumShares::of(856, 20_000).for_trial(16).each(), 2, "in eight strata");
        for (strata, about) in [(45, 8192), (856, 8192), (20, 4096)] {
            let run = StratumShares::of(strata, 1 << 19);
            let [large, small] = [about, about / 16].map(|about| run.for_trial(about).each());
            assert!(large >= 8 * small, "the gain shows: {large}, {small} in {strata}");
        }
        assert_eq!(StratumShares::of(5, 1 << 14).for_trial(4000).each(), 512, "in all strata");
        for (strata, of_run, about) in [(2, 4096, 64), (856, 100, 64), (1, 4096, 64)] {
            let trial = StratumShares::of(strata, of_run).for_trial(about);
            assert_eq!(trial.tried, strata, "all strata");
        }
        let mut found = vec![0; 856];
        const TURNS: u64 = 856;
        for turn in 0..TURNS {
            let turned = trial.turned((turn as f64 + 0.5) / TURNS as f64);
            let place = |place| turned.stratum(place, &mut Sampler::for_path(1, 2, place));
            (0..trial.paths).for_each(|path| found[place(path)] += 1);
        }
        assert!(
            found.iter().all(|count| *count == trial.paths),
            "evenly over all turns: {found:?}"
        );
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
