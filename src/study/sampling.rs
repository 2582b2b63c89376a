//! Samples of the unit cube, one dimension for each parameter, and what they mean for a parameter.

use lumiduct_core::rng::{Dimension, Sampler, stream};
use lumiduct_input::{Domain, Parameter, Samples, Setting};
use statrs::distribution::{ContinuousCDF, Normal};

/// Independent random samples.
pub(crate) fn random(samples: &Samples, dimensions: usize) -> Vec<Vec<f64>> {
    let one = |index| {
        let mut sampler = Sampler::for_path(samples.seed, stream::STUDY_SAMPLES, index);
        (0..dimensions).map(|_| sampler.one(Dimension::Design)).collect()
    };
    (0..u64::from(samples.count)).map(one).collect()
}

/// Samples with exactly one per equal interval in every dimension (`McKay`, Beckman & Conover,
/// Technometrics 21 (1979) 239).
pub(crate) fn latin_hypercube(samples: &Samples, dimensions: usize) -> Vec<Vec<f64>> {
    let count = samples.count as usize;
    let mut rows = vec![Vec::with_capacity(dimensions); count];
    for dimension in 0..dimensions as u64 {
        let mut order: Vec<usize> = (0..count).collect();
        let mut sampler = Sampler::for_path(samples.seed, stream::STUDY_ORDERS, dimension);
        // Fisher & Yates, as in Knuth, TAOCP 2, algorithm 3.4.2P.
        for last in (1..count).rev() {
            let other = (sampler.one(Dimension::Design) * (last + 1) as f64) as usize;
            order.swap(last, other);
        }
        let mut place = Sampler::for_path(samples.seed, stream::STUDY_PLACES, dimension);
        for (row, part) in rows.iter_mut().zip(order) {
            row.push((part as f64 + place.one(Dimension::Design)) / count as f64);
        }
    }
    rows
}

/// A Sobol sequence with the scrambling of Owen by hashes (Burley, JCGT 9 (2020) 1), 24 bits.
pub(crate) fn sobol(samples: &Samples, dimensions: usize) -> Vec<Vec<f64>> {
    let seed = (samples.seed ^ (samples.seed >> 32)) as u32;
    let one = |index| {
        let dimensions = 0..dimensions as u32;
        dimensions
            .map(|dimension| f64::from(sobol_burley::sample(index, dimension, seed)))
            .collect()
    };
    (0..samples.count).map(one).collect()
}

/// The setting of a parameter at a quantile of its distribution, 0..1.
pub(crate) fn quantile(parameter: &Parameter, share: f64) -> Setting {
    match &parameter.domain {
        Domain::Levels(levels) => {
            let place = (share * levels.len() as f64) as usize;
            levels
                .get(place.min(levels.len().saturating_sub(1)))
                .cloned()
                .unwrap_or(Setting::AsInScene)
        }
        Domain::Uniform { from, to } if parameter.whole => {
            // Every whole number between the ends is equally likely.
            let (first, last) = (from.ceil(), to.floor());
            Setting::whole((first + (share * (last - first + 1.0)).floor()).min(last))
        }
        Domain::Uniform { from, to } => Setting::Number(from + (to - from) * share),
        Domain::Normal { mean, std_dev, from, to } if parameter.whole => {
            // The range that rounds to whole numbers within the limits.
            let limits = [from.map(|from| from.ceil() - 0.5), to.map(|to| to.floor() + 0.5)];
            let value = normal([*mean, *std_dev], limits, share).round();
            // A half rounds away from zero, beyond a limit of the curve.
            let (low, high) = (from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY));
            Setting::whole(value.clamp(low.ceil(), high.floor()))
        }
        Domain::Normal { mean, std_dev, from, to } => {
            Setting::Number(normal([*mean, *std_dev], [*from, *to], share))
        }
        Domain::Listed | Domain::AsInScene => Setting::AsInScene,
    }
}

/// Quantile of a normal distribution truncated at limits.
fn normal([mean, std_dev]: [f64; 2], [from, to]: [Option<f64>; 2], share: f64) -> f64 {
    let curve = Normal::standard();
    let below = |limit: Option<f64>, open: f64| {
        limit.map_or(open, |limit| curve.cdf((limit - mean) / std_dev))
    };
    let (low, high) = (below(from, 0.0), below(to, 1.0));
    // The ends of an open curve lie at infinity; no sample of 2^-53 or more comes near.
    let share = (low + (high - low) * share).clamp(f64::EPSILON / 2.0, 1.0 - f64::EPSILON / 2.0);
    let value = mean + std_dev * curve.inverse_cdf(share);
    value.clamp(from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_core::tally::Tally;

    const SAMPLES: Samples = Samples { count: 512, seed: 3 };

    #[test]
    fn a_latin_hypercube_has_one_sample_in_every_part_of_every_dimension() {
        let rows = latin_hypercube(&SAMPLES, 3);
        for dimension in 0..3 {
            let mut parts: Vec<usize> =
                rows.iter().map(|row| (row[dimension] * 512.0) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..512).collect::<Vec<_>>());
        }
        // The orders of two dimensions are uncorrelated.
        let pairs = rows.iter().map(|row| (row[0] - 0.5) * (row[1] - 0.5) * 12.0);
        assert!(Tally::of(pairs).mean().abs() < 0.15);
    }

    #[test]
    fn a_sobol_sequence_fills_every_part_of_every_dimension_and_random_samples_do_not() {
        let filled = |rows: &[Vec<f64>]| {
            let mut parts: Vec<usize> = rows.iter().map(|row| (row[1] * 512.0) as usize).collect();
            parts.sort_unstable();
            parts.dedup();
            parts.len()
        };
        assert_eq!(filled(&sobol(&SAMPLES, 4)), 512);
        // A share of 1/e stays empty.
        assert!((290..=360).contains(&filled(&random(&SAMPLES, 4))));
    }

    #[test]
    fn other_seeds_give_other_samples() {
        let other = Samples { seed: 4, ..SAMPLES };
        for plan in [random, latin_hypercube, sobol] {
            assert_ne!(plan(&SAMPLES, 2), plan(&other, 2));
        }
    }

    #[test]
    fn quantiles_of_the_normal_distribution_are_those_of_the_tables() {
        let none = [None, None];
        assert!((normal([10.0, 2.0], none, 0.5) - 10.0).abs() < 1e-9);
        // Abramowitz & Stegun, table 26.5: 1.959964 at 0.975.
        assert!((normal([0.0, 1.0], none, 0.975) - 1.959_963_985).abs() < 1e-8);
        assert!(normal([0.0, 1.0], none, 0.0).is_finite());
        // Truncated at one standard deviation on both sides: the quartile is at
        // Φ(x) = 0.5 - 0.3413/2.
        let cut = normal([0.0, 1.0], [Some(-1.0), Some(1.0)], 0.25);
        assert!((cut + 0.441_770_547).abs() < 1e-8, "{cut}");
        let end = normal([0.0, 1.0], [Some(-1.0), Some(1.0)], 0.0);
        assert!((end + 1.0).abs() < 1e-9 && end >= -1.0, "{end}");
    }
}
