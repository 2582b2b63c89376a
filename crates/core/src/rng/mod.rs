//! Random numbers that belong to a path, not to a thread.
//!
//! Every path has a stream of its own, made from (seed, stream, index), so a result does not depend
//! on which thread traced it or in what order. Numbers are requested by purpose ([`Dimension`]). The first few numbers of a path
//! come from a low-discrepancy set of its batch (`points`).
//!
//! Generator: xoshiro256++ (Blackman & Vigna, ACM Trans. Math. Softw. 47 (2021) 36), seeded by `SplitMix64`.
//! Instead of fresh numbers a path can be given recorded ones ([`Numbers`]), so that it can be repeated and varied.

mod points;
mod shares;

pub(crate) use points::Points;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
pub(crate) use shares::StratumShares;

/// The streams of a run: no two purposes share one under a seed. The lower 32 bits number sensors, where each has a
/// stream of its own. Samples of a study and the baselines of `compare` never meet in a run.
pub mod stream {
    /// Photons.
    pub(crate) const PHOTONS: u64 = 1;
    /// Photons whose paths are drawn.
    pub(crate) const DRAWN: u64 = 2;
    /// Choice of the rays that go into a file.
    pub(crate) const EXPORTED: u64 = 3;
    /// Rays of a file that a fit holds out.
    pub(crate) const HELD_OUT: u64 = 4;
    /// Candidates for the splits of a fit.
    pub(crate) const SPLITS: u64 = 5;
    /// Gather paths that are followed to sources.
    pub(crate) const BACKWARD: u64 = 1 << 32;
    /// Gather paths that end in records.
    pub(crate) const GATHER: u64 = 2 << 32;
    /// Choices at the records of gather paths.
    pub(crate) const RECORDS: u64 = 3 << 32;
    /// Gather paths of the pilot that sets windows.
    pub(crate) const GATHER_PILOT: u64 = 4 << 32;
    /// Points of sources that gather paths are joined to.
    pub(crate) const JOINED_SOURCES: u64 = 11 << 32;
    /// Points of sensors that photons are joined to.
    pub(crate) const JOINED_SENSORS: u64 = 12 << 32;
    /// Gather paths that tell whether a sensor sees any light.
    pub(crate) const BLIND: u64 = 10 << 32;
    /// Sobol points of photons; the lower bits number sources.
    pub(crate) const PHOTON_POINTS: u64 = 13 << 32;
    /// Sobol points of gather paths that are followed to sources.
    pub(crate) const BACKWARD_POINTS: u64 = 14 << 32;
    /// Sobol points of gather paths that end in records.
    pub(crate) const GATHER_POINTS: u64 = 15 << 32;
    /// Cells of a sensor that trials of gather paths take.
    pub(crate) const TRIED_CELLS: u64 = 16 << 32;
    /// Wavelengths that the photons and records of a pass share.
    pub(crate) const WAVELENGTHS: u64 = 17 << 32;
    /// Gather paths of baselines.
    pub const BASELINE_PATHS: u64 = 5 << 32;
    /// Their choices at interfaces.
    pub const BASELINE_BRANCHES: u64 = 6 << 32;
    /// Markov chains of baselines.
    pub const BASELINE_CHAINS: u64 = 7 << 32;
    /// Pilot of baselines.
    pub const BASELINE_PILOT: u64 = 8 << 32;
    /// Gather paths of baselines that map photons.
    pub const BASELINE_MAP: u64 = 9 << 32;
    /// Random samples of a study.
    pub const STUDY_SAMPLES: u64 = 5 << 32;
    /// Places of samples within the strata of a study.
    pub const STUDY_PLACES: u64 = 6 << 32;
    /// Order of the strata of a study.
    pub const STUDY_ORDERS: u64 = 7 << 32;
}

/// The purpose of a random number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Wavelength of a path, at its start or after fluorescence.
    Wavelength,
    /// Start point of a path on a source.
    EmitPosition,
    /// Start direction of a path.
    EmitDirection,
    /// Cell of a sensor in which a gather path starts.
    GatherCell,
    /// Start point of a gather path on a sensor, and the point of its aim.
    GatherPosition,
    /// Start direction of a gather path.
    GatherDirection,
    /// Distance in a medium up to a scattering or to absorption by fluorescence.
    FreePath,
    /// Lobe of a finish: reflected or transmitted, or a part of a mixture.
    Lobe,
    /// The direction within a lobe, of a phase function, or of fluorescence.
    Scatter,
    /// Whether a path of small throughput survives.
    Roulette,
    /// Value of a parameter of a study.
    Design,
    /// Choice or weight of a sample that is used again, or noise added to a result to find its error.
    Resampling,
}

/// The origin of the numbers of a path.
pub trait Numbers {
    /// The next number, in [0, 1).
    fn next(&mut self) -> f64;
}

/// Fresh numbers.
#[derive(Debug, Clone)]
pub struct Fresh(Xoshiro256PlusPlus);

impl Numbers for Fresh {
    #[inline(always)]
    fn next(&mut self) -> f64 {
        unit(self.0.next_u64())
    }
}

/// A stream of numbers in [0, 1) that belongs to one path. Their origin is known at compile time: a
/// check at every number cost a path 4 % of its time.
#[derive(Debug, Clone)]
pub struct Sampler<N = Fresh> {
    numbers: N,
}

impl Sampler {
    /// The stream of path `index` of `stream` (a pass, or a purpose) under `seed`.
    #[inline]
    pub fn for_path(seed: u64, stream: u64, index: u64) -> Self {
        // Each word is mixed before the next is added, so neighbouring indices share no structure.
        let key = split_mix(split_mix(split_mix(seed) ^ stream) ^ index);
        // The four words are the next numbers of SplitMix64; written out, they need not go through memory one by one.
        let mut seed = [0; 32];
        for (step, word) in (0u64..).zip(seed.chunks_exact_mut(8)) {
            let state = key.wrapping_add(step.wrapping_mul(GOLDEN_GAMMA));
            word.copy_from_slice(&split_mix(state).to_le_bytes());
        }
        Self { numbers: Fresh(Xoshiro256PlusPlus::from_seed(seed)) }
    }
}

impl<N: Numbers> Sampler<N> {
    /// A stream of other numbers, such as those of a Markov chain's proposal.
    pub fn of(numbers: N) -> Self {
        Self { numbers }
    }

    /// One number in [0, 1), 53 bits.
    #[inline]
    pub fn one(&mut self, _dimension: Dimension) -> f64 {
        self.numbers.next()
    }

    /// Two numbers in [0, 1).
    #[inline]
    pub fn pair(&mut self, dimension: Dimension) -> [f64; 2] {
        [self.one(dimension), self.one(dimension)]
    }
}

/// A number in [0, 1) by its binary digits.
#[inline(always)]
fn unit(digits: u64) -> f64 {
    // 2^-53: the spacing of f64 just below 1.
    (digits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// Increment of the state of `SplitMix64` per number: 2^64 over the golden ratio.
const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// One step of `SplitMix64` (Steele, Lea & Flood, OOPSLA 2014, fig. 17).
#[inline]
fn split_mix(state: u64) -> u64 {
    let mut z = state.wrapping_add(GOLDEN_GAMMA);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_keys_give_other_streams() {
        let first =
            |seed, stream, index| Sampler::for_path(seed, stream, index).one(Dimension::Lobe);
        assert_ne!(first(1, 2, 3), first(2, 2, 3));
        assert_ne!(first(1, 2, 3), first(1, 3, 3));
        assert_ne!(first(1, 2, 3), first(1, 2, 4));
        assert_ne!(first(1, 2, 3), first(1, 3, 2));
    }

    #[test]
    fn the_stream_is_that_of_the_generator_seeded_by_its_key() {
        let key = split_mix(split_mix(split_mix(9) ^ 1) ^ 1234);
        let mut reference = Xoshiro256PlusPlus::seed_from_u64(key);
        let mut sampler = Sampler::for_path(9, 1, 1234);
        for _ in 0..8 {
            let expected = (reference.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
            assert_eq!(sampler.one(Dimension::Lobe), expected);
        }
    }

    #[test]
    fn first_numbers_of_neighbouring_paths_are_uniform() {
        let n = 100_000u64;
        let mut bins = [0u32; 10];
        for index in 0..n {
            bins[(Sampler::for_path(7, 0, index).one(Dimension::EmitPosition) * 10.0) as usize] +=
                1;
        }
        let expected = n as f64 / 10.0;
        let chi2: f64 = bins.iter().map(|&b| (f64::from(b) - expected).powi(2) / expected).sum();
        // 99.9 % point of chi-square with 9 degrees of freedom: 27.9.
        assert!(chi2 < 27.9, "chi-square {chi2}");
    }
}
