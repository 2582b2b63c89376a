//! How well the light of zones is as wanted: one number with its error, and the ratio that the target is about.

use lumiduct_input::PatternFeedback;
use lumiduct_report::optimise::{LightMisfit, MeasuredStep, Uncertain};

/// Weights of the parts of the objective, 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ObjectiveWeights {
    /// Of the deviations of the zones.
    pub(crate) uniformity: f64,
    /// Of the light that is lost.
    pub(crate) efficiency: f64,
}

impl ObjectiveWeights {
    pub(crate) fn of(feedback: &PatternFeedback) -> Self {
        Self { uniformity: feedback.uniformity_weight, efficiency: feedback.efficiency_weight }
    }
}

/// The judgement of a measured design. Zones with a wanted light of 0 do not count.
pub(crate) fn judge(step: &MeasuredStep, wanted: &[f64], weights: ObjectiveWeights) -> LightMisfit {
    let ratios = ratios(&step.zones, wanted);
    let (deviation, min_over_max) = match ratios.as_slice() {
        [] => {
            let nothing = Uncertain { value: 0.0, std_error: 0.0 };
            (Uncertain { value: 1.0, ..nothing }, nothing)
        }
        ratios => (deviation(ratios), min_over_max(ratios)),
    };
    let (uniformity, efficiency) = (weights.uniformity, weights.efficiency);
    let objective = Uncertain {
        value: uniformity * deviation.value + efficiency * (1.0 - step.efficiency.value),
        std_error: (uniformity * deviation.std_error).hypot(efficiency * step.efficiency.std_error),
    };
    LightMisfit { deviation, min_over_max, objective }
}

/// Measured over wanted light, relative to its mean over the zones that count; empty where there is no light.
pub(crate) fn ratios(zones: &[Uncertain], wanted: &[f64]) -> Vec<Uncertain> {
    let pairs = zones.iter().zip(wanted).filter(|(_, wanted)| **wanted > 0.0);
    let raw: Vec<Uncertain> = pairs
        .map(|(own, wanted)| Uncertain {
            value: own.value / wanted,
            std_error: own.std_error / wanted,
        })
        .collect();
    let mean = raw.iter().map(|own| own.value).sum::<f64>() / raw.len().max(1) as f64;
    if mean <= 0.0 {
        return Vec::new();
    }
    let relative =
        |own: Uncertain| Uncertain { value: own.value / mean, std_error: own.std_error / mean };
    raw.into_iter().map(relative).collect()
}

/// Root mean square of the errors of the ratios, 1.
pub(crate) fn noise(ratios: &[Uncertain]) -> f64 {
    let sum: f64 = ratios.iter().map(|own| own.std_error.powi(2)).sum();
    (sum / ratios.len().max(1) as f64).sqrt()
}

/// Root mean square deviation from 1, without the part that noise makes.
fn deviation(ratios: &[Uncertain]) -> Uncertain {
    let count = ratios.len() as f64;
    let (mut square, mut variance) = (0.0, 0.0);
    for Uncertain { value, std_error } in ratios {
        let (off, noise) = ((value - 1.0).powi(2), std_error.powi(2));
        square += (off - noise) / count;
        variance += (4.0 * off * noise + 2.0 * noise * noise) / (count * count);
    }
    let (value, error) = (square.max(0.0).sqrt(), variance.sqrt());
    // Near zero the root is not linear: the error is that of the square, taken whole.
    Uncertain {
        value,
        std_error: 0.5 * error / value.max(0.5 * error.sqrt()).max(f64::MIN_POSITIVE),
    }
}

fn min_over_max(ratios: &[Uncertain]) -> Uncertain {
    let order = |one: &&Uncertain, other: &&Uncertain| one.value.total_cmp(&other.value);
    let (least, most) = (ratios.iter().min_by(order), ratios.iter().max_by(order));
    let (Some(least), Some(most)) = (least, most) else {
        return Uncertain { value: 0.0, std_error: 0.0 };
    };
    let value = least.value.max(0.0) / most.value;
    let std_error = (least.std_error / most.value).hypot(value * most.std_error / most.value);
    Uncertain { value, std_error }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_core::plan::Request;
    use lumiduct_report::optimise::Purpose;

    pub(crate) fn step(values: &[f64], error: f64, efficiency: f64) -> MeasuredStep {
        let zone = |value: &f64| Uncertain { value: *value, std_error: error };
        MeasuredStep {
            lumiduct_step: 1,
            hash: String::new(),
            step: 1,
            purpose: Purpose::Search,
            seed: 1,
            estimator: Request::Forward,
            paths_asked: 1,
            is_start: false,
            values: Vec::new(),
            zones: values.iter().map(zone).collect(),
            efficiency: Uncertain { value: efficiency, std_error: 0.01 },
            paths: 1,
        }
    }

    const WEIGHTS: ObjectiveWeights = ObjectiveWeights { uniformity: 1.0, efficiency: 0.0 };

    #[test]
    fn the_deviation_is_without_noise_and_the_ratio_is_of_the_extremes() {
        let found = judge(&step(&[0.8, 1.0, 1.2], 0.0, 0.5), &[1.0; 3], WEIGHTS);
        assert!((found.deviation.value - (0.08_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((found.min_over_max.value - 0.8 / 1.2).abs() < 1e-12);
        let noisy = judge(&step(&[0.99, 1.0, 1.01], 0.05, 0.5), &[1.0; 3], WEIGHTS);
        assert_eq!(noisy.deviation.value, 0.0);
        assert!(noisy.deviation.std_error > 0.02);
    }

    #[test]
    fn wanted_light_divides_and_weights_sum() {
        let weights = ObjectiveWeights { uniformity: 2.0, efficiency: 0.5 };
        let found = judge(&step(&[1.0, 2.0, 7.0], 0.0, 0.6), &[1.0, 2.0, 0.0], weights);
        assert!(found.deviation.value.abs() < 1e-9);
        assert!((found.objective.value - 0.2).abs() < 1e-9, "{found:?}");
        let dark = judge(&step(&[0.0, 0.0], 0.0, 0.0), &[1.0; 2], WEIGHTS);
        assert_eq!((dark.deviation.value, dark.min_over_max.value), (1.0, 0.0));
    }
}
