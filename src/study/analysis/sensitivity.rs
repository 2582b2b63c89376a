//! How much of the variance of a measure comes from each parameter.
//!
//! For a full grid the first-order Sobol indices follow from the means over levels, as in an
//! analysis of variance (Sobol, Math. Comput. Simul. 55 (2001) 271, eq. 8); for samples a linear
//! regression gives standardised coefficients (Saltelli et al., Global Sensitivity Analysis, 2008,
//! section 1.2.5).

use lumiduct_base::math::least_squares;
use lumiduct_core::measure::Replicates;
use lumiduct_core::tally::Tally;
use lumiduct_input::Setting;
use lumiduct_report::study::{
    DesignRecord, PlanFacts, Sensitivity, SensitivityIndex, SensitivityMethod, StudyFacts,
};

/// The sensitivities of all measures, where the plan allows them.
pub(super) fn sensitivities(facts: &StudyFacts, designs: &[DesignRecord]) -> Vec<Sensitivity> {
    let of = |measure: &String| match facts.plan {
        PlanFacts::Grid => first_order(facts, designs, measure),
        PlanFacts::LatinHypercube(_) | PlanFacts::Sobol(_) | PlanFacts::Tolerance(_) => {
            regression(facts, designs, measure)
        }
        // A search crowds about the best: no sample of the ranges.
        PlanFacts::OneAtATime | PlanFacts::List | PlanFacts::Search(_) => None,
    };
    facts.measures.iter().filter_map(of).collect()
}

/// First-order indices of a grid whose designs were all traced.
fn first_order(facts: &StudyFacts, designs: &[DesignRecord], measure: &str) -> Option<Sensitivity> {
    let values: Option<Vec<f64>> =
        designs.iter().map(|design| Some(design.measure(measure)?.value)).collect();
    let raw = indices(facts, designs, &values?)?;
    let known = jackknife(facts, designs, measure, &raw)
        .unwrap_or_else(|| raw.iter().map(|value| [*value, f64::INFINITY]).collect());
    let named = facts.parameters.iter().zip(&known);
    Some(Sensitivity {
        measure: measure.to_owned(),
        method: SensitivityMethod::FirstOrder,
        explained: known.iter().map(|[value, _]| value).sum(),
        indices: named
            .map(|(parameter, [value, std_error])| SensitivityIndex {
                parameter: parameter.name.clone(),
                value: *value,
                std_error: *std_error,
                slope: None,
            })
            .collect(),
    })
}

/// Variance of the means over the levels of each parameter, over the total variance; `None` where
/// nothing varies.
fn indices(facts: &StudyFacts, designs: &[DesignRecord], values: &[f64]) -> Option<Vec<f64>> {
    let whole = variance(values);
    let of = |parameter: &str| {
        let mut levels: Vec<(&Setting, Tally)> = Vec::new();
        for (design, value) in designs.iter().zip(values) {
            let setting = design.settings.get(parameter)?;
            match levels.iter_mut().find(|(level, _)| *level == setting) {
                Some((_, tally)) => tally.add(*value),
                None => levels.push((setting, Tally::of([*value]))),
            }
        }
        let means: Vec<f64> = levels.iter().map(|(_, tally)| tally.mean()).collect();
        Some(variance(&means) / whole)
    };
    let all: Option<Vec<f64>> = facts.parameters.iter().map(|own| of(&own.name)).collect();
    all.filter(|_| whole > 0.0 && whole.is_finite())
}

/// Indices with their errors by the jackknife over groups of batches of all designs; `None` where
/// the designs do not have the same groups. It also removes what noise adds to the variances, the
/// squared error of a value (Quenouille, Biometrika 43 (1956) 353).
fn jackknife(
    facts: &StudyFacts,
    designs: &[DesignRecord],
    measure: &str,
    raw: &[f64],
) -> Option<Vec<[f64; 2]>> {
    let all: Option<Vec<(f64, &Replicates)>> = designs
        .iter()
        .map(|design| {
            Some((
                design.measure(measure)?.value,
                design.outcome.result()?.replicates.get(measure)?,
            ))
        })
        .collect();
    let all = all?;
    let first = all.first()?.1;
    if !all.iter().all(|(_, own)| first.is_paired_with(own)) {
        return None;
    }
    let groups = first.0.len() as f64;
    let mut tallies = vec![Tally::default(); facts.parameters.len()];
    for group in 0..first.0.len() {
        // A pseudo-value is g θ - (g - 1) θ₋ₖ.
        let without =
            |(value, own): &(f64, &Replicates)| (groups * value - own.0[group].1) / (groups - 1.0);
        let values: Vec<f64> = all.iter().map(without).collect();
        for (tally, index) in tallies.iter_mut().zip(indices(facts, designs, &values)?) {
            tally.add(index);
        }
    }
    // As in `Readings::jackknife`.
    let known = raw.iter().zip(&tallies).map(|(raw, tally)| {
        let unbiased = groups * raw - (groups - 1.0) * tally.mean();
        [unbiased, tally.std_error() * (groups - 1.0)]
    });
    Some(known.collect())
}

/// Standardised coefficients of a linear regression on all parameters that are numbers.
fn regression(facts: &StudyFacts, designs: &[DesignRecord], measure: &str) -> Option<Sensitivity> {
    let done: Vec<(&DesignRecord, f64)> = designs
        .iter()
        .filter_map(|design| Some((design, design.measure(measure)?.value)))
        .filter(|(_, value)| value.is_finite())
        .collect();
    let column = |parameter: &str| -> Option<Standardised> {
        let numbers: Option<Vec<f64>> = done
            .iter()
            .map(|(design, _)| design.settings.get(parameter).and_then(Setting::number))
            .collect();
        numbers.and_then(|numbers| standardised(&numbers))
    };
    let columns: Vec<(&str, Standardised)> = facts
        .parameters
        .iter()
        .filter_map(|own| Some((own.name.as_str(), column(&own.name)?)))
        .collect();
    let values = standardised(&done.iter().map(|(_, value)| *value).collect::<Vec<_>>())?;
    let inputs: Vec<Vec<f64>> = columns.iter().map(|(_, column)| column.values.clone()).collect();
    let fit = least_squares(&inputs, &values.values)?;
    let indices = columns.iter().zip(&fit.coefficients).zip(&fit.std_errors);
    Some(Sensitivity {
        measure: measure.to_owned(),
        method: SensitivityMethod::Regression,
        explained: fit.r_squared,
        indices: indices
            .map(|(((parameter, column), value), std_error)| SensitivityIndex {
                parameter: (*parameter).to_owned(),
                value: *value,
                std_error: *std_error,
                slope: Some(
                    [value, std_error].map(|own| own * values.deviation / column.deviation),
                ),
            })
            .collect(),
    })
}

/// Values less their mean, over their standard deviation.
struct Standardised {
    values: Vec<f64>,
    deviation: f64,
}

/// Standardised values; `None` where they are all the same.
fn standardised(values: &[f64]) -> Option<Standardised> {
    let (mean, deviation) = (Tally::of(values.iter().copied()).mean(), variance(values).sqrt());
    let values = values.iter().map(|value| (value - mean) / deviation).collect();
    (deviation > 0.0).then_some(Standardised { values, deviation })
}

fn variance(values: &[f64]) -> f64 {
    let mean = Tally::of(values.iter().copied()).mean();
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::analysis::testing::{design, facts};
    use lumiduct_core::rng::{Dimension, Sampler};
    use lumiduct_report::study::DesignOutcome;

    /// A grid of a and b in 0, 1, 2 where only a has an effect, with independent noise in every
    /// group of every design.
    fn noisy_grid(study: u64) -> Vec<DesignRecord> {
        const GROUPS: usize = 16;
        let mut designs = Vec::new();
        for number in 0..9u32 {
            let (a, b) = (f64::from(number / 3), f64::from(number % 3));
            let mut sampler = Sampler::for_path(study, 0, u64::from(number));
            let values = [(); GROUPS].map(|()| a + 3.0 * (sampler.one(Dimension::Design) - 0.5));
            let mean = Tally::of(values).mean();
            let mut own = design(number as usize + 1, [a, b], mean, 1.0);
            let DesignOutcome::Done(result) = &mut own.outcome else { panic!("no result") };
            result.replicates["exit.flux"] = Replicates((0..).zip(values).collect());
            designs.push(own);
        }
        designs
    }

    #[test]
    fn noise_is_no_effect_of_a_parameter() {
        let facts = facts(PlanFacts::Grid);
        let (mut raw, mut told) = (Tally::default(), Tally::default());
        for study in 0..1000 {
            let designs = noisy_grid(study);
            let values: Vec<f64> =
                designs.iter().map(|own| own.measure("exit.flux").unwrap().value).collect();
            raw.add(indices(&facts, &designs, &values).unwrap()[1]);
            told.add(sensitivities(&facts, &designs)[0].indices[1].value);
        }
        assert!(raw.mean() > 10.0 * raw.std_error(), "{raw:?}");
        assert!(told.sigmas_from(0.0).abs() < 4.0, "{told:?}");
    }
}
