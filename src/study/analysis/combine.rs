//! Sums and differences of a measure over several designs, with their errors.

use lumiduct_core::measure::Replicates;
use lumiduct_core::tally::Tally;
use lumiduct_report::study::{DesignRecord, Pairing, ValueWithError};

/// A design with the weight that it has in a sum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term<'a> {
    pub(super) weight: f64,
    pub(super) design: &'a DesignRecord,
}

/// The weighted sum of a measure over designs. Where all designs have the same groups of batches,
/// the error is computed group by group, so that common noise cancels; else as if they were
/// independent. `None` where a design lacks the measure.
pub(super) fn combine(terms: &[Term<'_>], measure: &str) -> Option<ValueWithError> {
    let value = |term: &Term<'_>| Some(term.weight * term.design.measure(measure)?.value);
    let value = terms.iter().map(value).sum::<Option<f64>>()?;
    Some(match paired_error(terms, measure) {
        Some(std_error) => ValueWithError { value, std_error, evidence: Pairing::Paired },
        None => {
            let std_error = independent_error(terms, measure)?;
            ValueWithError { value, std_error, evidence: Pairing::Independent }
        }
    })
}

/// The error of a weighted sum from its values group by group; `None` where the designs do not have the same groups.
fn paired_error(terms: &[Term<'_>], measure: &str) -> Option<f64> {
    let replicates: Option<Vec<&Replicates>> =
        terms.iter().map(|term| term.design.outcome.result()?.replicates.get(measure)).collect();
    let replicates = replicates?;
    let first = replicates.first()?;
    if !replicates.iter().all(|other| first.is_paired_with(other)) {
        return None;
    }
    let sums = (0..first.0.len()).map(|group| {
        let values = replicates.iter().map(|own| own.0[group].1);
        terms.iter().zip(values).map(|(term, value)| term.weight * value).sum::<f64>()
    });
    Some(Tally::of(sums).std_error())
}

/// The error of a weighted sum of independent values.
pub(super) fn independent_error(terms: &[Term<'_>], measure: &str) -> Option<f64> {
    let square =
        |term: &Term<'_>| Some((term.weight * term.design.measure(measure)?.std_error).powi(2));
    Some(terms.iter().map(square).sum::<Option<f64>>()?.sqrt())
}
