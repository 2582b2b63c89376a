//! Random numbers that belong to a path, not to a thread.
//!
//! Every path has a stream of its own, made from (seed, stream, index), so a result does not depend on which thread
//! traced it or in what order. Numbers are asked for by purpose ([`Dimension`]): a low-discrepancy set can later
//! answer the first of them without a change to the callers.
//!
//! Generator: xoshiro256++ (Blackman & Vigna, ACM Trans. Math. Softw. 47 (2021) 36), seeded by `SplitMix64`.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// What a random number is used for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Where on a source a path starts.
    EmitPosition,
    /// In which direction it starts.
    EmitDirection,
    /// Which lobe of a finish is taken: reflected or transmitted, or a part of a mixture.
    Lobe,
    /// The direction within a lobe.
    Scatter,
    /// Whether a path of small throughput survives.
    Roulette,
    /// Noise that is added to a result to learn its error.
    Resampling,
}

/// A stream of numbers in [0, 1) that belongs to one path.
#[derive(Debug, Clone)]
pub struct Sampler {
    generator: Xoshiro256PlusPlus,
}

impl Sampler {
    /// The stream of path `index` of `stream` (a pass, or a purpose) under `seed`.
    pub fn for_path(seed: u64, stream: u64, index: u64) -> Self {
        // Each word is mixed before the next comes in: neighbouring indices share no structure.
        let key = split_mix(split_mix(split_mix(seed) ^ stream) ^ index);
        Self { generator: Xoshiro256PlusPlus::seed_from_u64(key) }
    }

    /// One number in [0, 1), 53 bits.
    #[inline]
    pub fn one(&mut self, _dimension: Dimension) -> f64 {
        // 2^-53: the spacing of f64 just below 1.
        (self.generator.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Two numbers in [0, 1).
    #[inline]
    pub fn pair(&mut self, dimension: Dimension) -> [f64; 2] {
        [self.one(dimension), self.one(dimension)]
    }
}

/// One step of `SplitMix64` (Steele, Lea & Flood, OOPSLA 2014, fig. 17).
fn split_mix(state: u64) -> u64 {
    let mut z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_key_gives_the_same_stream_and_other_keys_do_not() {
        let first =
            |seed, stream, index| Sampler::for_path(seed, stream, index).one(Dimension::Lobe);
        assert_eq!(first(1, 2, 3), first(1, 2, 3));
        assert_ne!(first(1, 2, 3), first(2, 2, 3));
        assert_ne!(first(1, 2, 3), first(1, 3, 3));
        assert_ne!(first(1, 2, 3), first(1, 2, 4));
        assert_ne!(first(1, 2, 3), first(1, 3, 2));
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
