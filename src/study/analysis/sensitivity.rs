//! How much of what a measure varies comes from each parameter.
//!
//! Of a full grid the first-order indices of Sobol follow from the means over levels, as in an analysis of variance
//! (Sobol, Math. Comput. Simul. 55 (2001) 271, eq. 8); of samples a linear regression gives standardised coefficients
//! (Saltelli et al., Global Sensitivity Analysis, 2008, section 1.2.5).

use crate::input::Setting;
use crate::math::least_squares;
use crate::measure::Replicates;
use crate::report::study::{
    DesignRecord, PlanFacts, Sensitivity, SensitivityIndex, SensitivityMethod, StudyFacts,
};
use crate::tally::Tally;

/// The sensitivities of all measures, where the plan allows them.
pub(super) fn sensitivities(facts: &StudyFacts, designs: &[DesignRecord]) -> Vec<Sensitivity> {
    let of = |measure: &String| match facts.plan {
        PlanFacts::Grid => first_order(facts, designs, measure),
        PlanFacts::LatinHypercube(_) | PlanFacts::Sobol(_) | PlanFacts::Tolerance(_) => {
            regression(facts, designs, measure)
        }
        PlanFacts::OneAtATime | PlanFacts::List => None,
    };
    facts.measures.iter().filter_map(of).collect()
}

/// First-order indices of a grid of which every design was traced.
fn first_order(facts: &StudyFacts, designs: &[DesignRecord], measure: &str) -> Option<Sensitivity> {
    let values: Option<Vec<f64>> =
        designs.iter().map(|design| Some(design.measure(measure)?.value)).collect();
    let indices = indices(facts, designs, &values?)?;
    let errors = jackknife_errors(facts, designs, measure);
    let explained = indices.iter().sum();
    let named = facts.parameters.iter().zip(indices).enumerate();
    Some(Sensitivity {
        measure: measure.to_owned(),
        method: SensitivityMethod::FirstOrder,
        explained,
        indices: named
            .map(|(place, (parameter, value))| SensitivityIndex {
                parameter: parameter.name.clone(),
                value,
                std_error: errors.as_ref().map_or(f64::INFINITY, |errors| errors[place]),
            })
            .collect(),
    })
}

/// Variance of the means over the levels of each parameter, over the variance of all; `None` where nothing varies.
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

/// Errors of the indices from leaving out each group of batches of all designs in turn; `None` where the designs do not
/// have the same groups.
fn jackknife_errors(
    facts: &StudyFacts,
    designs: &[DesignRecord],
    measure: &str,
) -> Option<Vec<f64>> {
    let all: Option<Vec<(f64, &Replicates)>> = designs
        .iter()
        .map(|design| {
            Some((design.measure(measure)?.value, design.result()?.replicates.get(measure)?))
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
    Some(tallies.iter().map(|tally| tally.std_error() * (groups - 1.0)).collect())
}

/// Standardised coefficients of a linear regression on all parameters that are numbers.
fn regression(facts: &StudyFacts, designs: &[DesignRecord], measure: &str) -> Option<Sensitivity> {
    let done: Vec<(&DesignRecord, f64)> = designs
        .iter()
        .filter_map(|design| Some((design, design.measure(measure)?.value)))
        .filter(|(_, value)| value.is_finite())
        .collect();
    let column = |parameter: &str| -> Option<Vec<f64>> {
        let numbers: Option<Vec<f64>> = done
            .iter()
            .map(|(design, _)| design.settings.get(parameter).and_then(Setting::number))
            .collect();
        numbers.and_then(|numbers| standardised(&numbers))
    };
    let columns: Vec<(&str, Vec<f64>)> = facts
        .parameters
        .iter()
        .filter_map(|own| Some((own.name.as_str(), column(&own.name)?)))
        .collect();
    let values = standardised(&done.iter().map(|(_, value)| *value).collect::<Vec<_>>())?;
    let inputs: Vec<Vec<f64>> = columns.iter().map(|(_, column)| column.clone()).collect();
    let fit = least_squares(&inputs, &values)?;
    let indices = columns.iter().zip(&fit.coefficients).zip(&fit.std_errors);
    Some(Sensitivity {
        measure: measure.to_owned(),
        method: SensitivityMethod::Regression,
        explained: fit.r_squared,
        indices: indices
            .map(|(((parameter, _), value), std_error)| SensitivityIndex {
                parameter: (*parameter).to_owned(),
                value: *value,
                std_error: *std_error,
            })
            .collect(),
    })
}

/// Values less their mean, over their standard deviation; `None` where they are all the same.
fn standardised(values: &[f64]) -> Option<Vec<f64>> {
    let (mean, deviation) = (Tally::of(values.iter().copied()).mean(), variance(values).sqrt());
    (deviation > 0.0).then(|| values.iter().map(|value| (value - mean) / deviation).collect())
}

fn variance(values: &[f64]) -> f64 {
    let mean = Tally::of(values.iter().copied()).mean();
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64
}
