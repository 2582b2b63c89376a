//! The best design of a search traced again, with random numbers that the search has not used and by a second estimator.

use crate::study::designs::Design;
use crate::study::execute::{DesignBatch, DesignTracing};
use lumiduct_base::error::Result;
use lumiduct_core::plan::Request;
use lumiduct_input::{Keep, Setting, Settings, Study};
use lumiduct_report::study::{Confirmation, DesignRecord};

/// Traces the best of some designs again by the estimator of the study and by another, which no scene that fluoresces has; `None`
/// if it was interrupted.
pub(crate) fn confirmations(
    batch: &DesignBatch<'_>,
    best: &DesignRecord,
    designs: usize,
) -> Result<Option<Vec<Confirmation>>> {
    let run = &batch.study.base.run;
    let mut estimators = vec![run.estimator];
    if !batch.study.base.scene.fluoresces() {
        estimators.push(second(run.estimator));
    }
    let tracing = DesignTracing::new(batch, [designs + estimators.len(), estimators.len()])?;
    let setting = |name: &String| best.settings.get(name).cloned().unwrap_or(Setting::AsInScene);
    let settings = batch.study.parameters.iter().map(|own| setting(&own.name)).collect();
    let design = Design { number: best.design, settings };
    let seed = fresh_seed(batch.study);
    let mut found = Vec::new();
    for estimator in estimators {
        let fresh =
            Settings { seed: Some(seed), estimator: Some(estimator), ..tracing.common.clone() };
        let Some(outcome) = tracing.outcome(&design, &fresh, Keep::Records)? else {
            return Ok(None);
        };
        tracing.board.end(design.number);
        found.push(Confirmation { seed, estimator: estimator.name().to_owned(), outcome });
    }
    Ok(Some(found))
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
