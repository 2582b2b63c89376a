//! What a search has found traced again, with random numbers that the search has not used and by a second estimator.

use crate::study::designs::Design;
use crate::study::execute::{DesignBatch, DesignTracing};
use lumiduct_base::error::Result;
use lumiduct_core::plan::Request;
use lumiduct_input::{Keep, Setting, Settings, Study};
use lumiduct_report::study::{Confirmation, DesignRecord};

/// How often each is traced again, at most.
pub(crate) const CONFIRMATIONS: usize = 2;

/// Traces some of all designs again by the estimator of the study and by another, which no scene that fluoresces has; `None`
/// if it was interrupted.
pub(crate) fn confirmations(
    batch: &DesignBatch<'_>,
    found: &[&DesignRecord],
    designs: usize,
) -> Result<Option<Vec<Confirmation>>> {
    let run = &batch.study.base.run;
    let mut estimators = vec![run.estimator];
    if !batch.study.base.scene.fluoresces() {
        estimators.push(second(run.estimator));
    }
    let runs = found.len() * estimators.len();
    let tracing = DesignTracing::new(batch, [designs + runs, runs])?;
    let seed = fresh_seed(batch.study);
    let is_front = batch.study.is_front();
    let mut again = Vec::new();
    for own in found {
        let setting = |name: &String| own.settings.get(name).cloned().unwrap_or(Setting::AsInScene);
        let settings = batch.study.parameters.iter().map(|own| setting(&own.name)).collect();
        let design = Design { number: own.design, settings };
        for estimator in estimators.iter().copied() {
            let fresh =
                Settings { seed: Some(seed), estimator: Some(estimator), ..tracing.common.clone() };
            let Some(outcome) = tracing.outcome(&design, &fresh, Keep::Records)? else {
                return Ok(None);
            };
            tracing.board.end(design.number);
            again.push(Confirmation {
                design: is_front.then_some(design.number),
                seed,
                estimator: estimator.name().to_owned(),
                outcome,
            });
        }
    }
    Ok(Some(again))
}

/// A seed of the random numbers of light that a search has not used.
pub(crate) fn fresh_seed(study: &Study) -> u64 {
    study.base.run.seed.wrapping_add(1)
}

/// An estimator that follows light in another way.
fn second(first: Request) -> Request {
    match first {
        Request::Mix => Request::Forward,
        Request::Auto | Request::Forward | Request::Backward | Request::Gather | Request::Mis => {
            Request::Mix
        }
    }
}
