//! What follows from all designs of a study together. Pure functions of its facts and records.

mod combine;
mod effects;
mod failures;
mod ranking;
mod sensitivity;

use crate::report::study::{Analysis, DesignRecord, Pairing, Sharpness, StudyFacts};
use combine::{Term, combine};

/// Everything that follows.
pub(crate) fn analysis(facts: &StudyFacts, designs: &[DesignRecord]) -> Analysis {
    Analysis {
        ranked: ranking::ranked(facts, designs),
        effects: effects::effects(facts, designs),
        sensitivities: sensitivity::sensitivities(facts, designs),
        failures: failures::failures(facts, designs),
        sharpness: facts.measures.iter().filter_map(|name| sharpness(name, designs)).collect(),
    }
}

/// How much sharper the difference of neighbouring designs is than if they were independent.
fn sharpness(measure: &str, designs: &[DesignRecord]) -> Option<Sharpness> {
    let mut factors: Vec<f64> = designs
        .windows(2)
        .filter_map(|pair| {
            let terms =
                [Term { weight: 1.0, design: &pair[0] }, Term { weight: -1.0, design: &pair[1] }];
            let difference = combine(&terms, measure)?;
            let alone = combine::independent_error(&terms, measure)?;
            let is_told = difference.evidence == Pairing::Paired && difference.std_error > 0.0;
            (is_told && alone.is_finite()).then(|| alone / difference.std_error)
        })
        .collect();
    factors.sort_by(f64::total_cmp);
    let middle = *factors.get(factors.len() / 2)?;
    Some(Sharpness { measure: measure.to_owned(), factor: middle, pairs: factors.len() })
}
