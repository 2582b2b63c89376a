//! A trial of the forward estimator.

use crate::plan::Estimator;
use crate::transport::Readings;
use crate::transport::forward::Forward;
use crate::transport::tally::work;
use crate::transport::trial::{BATCHES, SEED, Trials, Tried, TriedBatches};
use rayon::prelude::*;

/// Tries photons counted by the sensors; `None` if stopped.
pub(crate) fn trial(trials: &Trials<'_>) -> Option<Vec<Tried>> {
    trials.by_size(Estimator::Forward, |effort| {
        let forward = photons_for(trials, effort);
        let traced = |batch| forward.batch(batch, trials.signal);
        let batches: Option<Vec<Readings>> = (0..BATCHES).into_par_iter().map(traced).collect();
        let batches = batches?;
        let work = batches.iter().map(work::of_photons).sum();
        Some(TriedBatches { batches, work, work_of_one: work, strata: Vec::new() })
    })
}

/// Batches of photons with this much work in total.
pub(crate) fn photons_for<'a>(trials: &Trials<'a>, effort: f64) -> Forward<'a> {
    let path = work::of_photon_path(trials.photons.segments_per_path);
    photons_of(trials, (effort / BATCHES as f64 / path) as u64)
}

/// Batches of this many photons.
pub(crate) fn photons_of<'a>(trials: &Trials<'a>, paths: u64) -> Forward<'a> {
    let Trials { scene, plan, .. } = *trials;
    let least = scene.sources.len().max(1) as u64;
    Forward::new(scene, plan.seed ^ SEED, plan.bounce_limit, paths.max(least))
}
