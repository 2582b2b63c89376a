//! The check of a result: the scene as it was and the design that was found, with random numbers that the search has not used.

use crate::optimise::judge::{ObjectiveWeights, judge};
use crate::optimise::measure::{DesignToMeasure, MeasureEnd, Measurements};
use crate::optimise::search::SearchEnd;
use lumiduct_base::error::Result;
use lumiduct_base::number::{format_percent, format_with_error};
use lumiduct_report::optimise::{Ending, JudgedStep, Purpose};

/// Errors by which a check has to miss the target to refute it, 1.
const REFUTED: f64 = 3.0;

/// Measures both designs by both estimators; `table` turns lengths into the value of their key. The end changes where the check is refused,
/// stopped, or does not confirm the target.
pub(crate) fn check(
    measurements: &Measurements<'_>,
    end: &mut SearchEnd,
    table: impl Fn(&[f64]) -> String,
) -> Result<Vec<JudgedStep>> {
    let (Some(first), Some(best)) = (end.steps.first(), end.steps.get(end.best)) else {
        return Ok(Vec::new());
    };
    if end.ending == Ending::Interrupted {
        return Ok(Vec::new());
    }
    let feedback = measurements.feedback;
    let weights = ObjectiveWeights::of(feedback);
    let ratio = best.misfit.min_over_max;
    let words = format!("min/max {}", format_with_error(ratio.value, ratio.std_error));
    let mut found = Vec::new();
    for design in designs(measurements, first, best, table) {
        let number = end.steps.len() + found.len() + 1;
        match measurements.measure(number, &design, &words)? {
            MeasureEnd::Done(step) => {
                let misfit = judge(&step, &measurements.zones.wanted, weights);
                found.push(JudgedStep { measured: *step, misfit });
            }
            MeasureEnd::Refused(why) => {
                end.ending = Ending::Refused(format!(
                    "the check with the estimator `{}` was refused: {why}; choose another `check_estimator`",
                    design.estimator.name()
                ));
                return Ok(found);
            }
            MeasureEnd::Interrupted => {
                end.ending = Ending::Interrupted;
                return Ok(found);
            }
        }
    }
    if end.ending == Ending::Reached
        && let Some(refutation) = refutation(&found, best, feedback.min_over_max)
    {
        end.ending = refutation;
    }
    Ok(found)
}

/// What is measured: before and after by the estimator of the run, then by the second one.
fn designs(
    measurements: &Measurements<'_>,
    first: &JudgedStep,
    best: &JudgedStep,
    table: impl Fn(&[f64]) -> String,
) -> Vec<DesignToMeasure> {
    let (run, feedback) = (&measurements.study.base.run, measurements.feedback);
    let second = Some(feedback.check_estimator).filter(|own| *own != run.estimator);
    let after = (!best.measured.is_start).then_some((Purpose::CheckAfter, best));
    let pair = || [(Purpose::CheckBefore, first)].into_iter().chain(after);
    let estimators = [run.estimator].into_iter().chain(second);
    let all = estimators.flat_map(|estimator| pair().map(move |own| (estimator, own)));
    all.map(|(estimator, (purpose, own))| DesignToMeasure {
        purpose,
        seed: run.seed.wrapping_add(1),
        estimator,
        paths: feedback.paths,
        values: own.measured.values.clone(),
        setting: (!own.measured.is_start).then(|| table(&own.measured.values)),
    })
    .collect()
}

/// The ending of a search whose target a check refutes.
fn refutation(found: &[JudgedStep], best: &JudgedStep, goal: f64) -> Option<Ending> {
    let refutes = |own: &&JudgedStep| {
        let ratio = own.misfit.min_over_max;
        (own.measured.purpose == Purpose::CheckAfter || best.measured.is_start)
            && ratio.value + REFUTED * ratio.std_error < goal
    };
    let own = found.iter().find(refutes)?;
    let ratio = own.misfit.min_over_max;
    Some(Ending::NotConfirmed(format!(
        "the check does not confirm the result: with fresh random numbers and the estimator `{}` the smallest over the largest ratio is \
         {}, {} is wanted; raise `run.paths`",
        own.measured.estimator.name(),
        format_with_error(ratio.value, ratio.std_error),
        format_percent(goal)
    )))
}
