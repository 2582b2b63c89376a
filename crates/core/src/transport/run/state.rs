//! The part of a run that changes as it traces, so that it can be saved and restored.

use crate::plan::{Estimator, RunPlan};
use crate::transport::EstimatorChoice;
use crate::transport::estimators::Prepared;
use crate::transport::run::rounds::Run;
use crate::transport::tally::{Counts, Series};
use serde::{Deserialize, Serialize};

/// Progress of a run: everything counted, including a wave in progress. All else follows from scene
/// and plan.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RunState {
    batches: u64,
    paths: u64,
    photons: Series,
    others: Vec<Series>,
    /// Its estimators, which depend on the clock if the time of the run is limited.
    estimators: Vec<Estimator>,
    choices: Vec<EstimatorChoice>,
    /// Photon paths of a batch, and batches of the run if they are known, which depend on the clock, too.
    photons_per_batch: u64,
    batches_asked: Option<u64>,
    /// Photons of a pass of gathering, and its gather paths from all sensors in the first stage.
    pass: Option<[u64; 2]>,
}

impl RunState {
    /// The plan that prepares a run of this state again. Without a clock the same plan gives the
    /// same run.
    pub fn plan(&self, plan: &RunPlan) -> RunPlan {
        let mut own = plan.clone();
        if own.stop.time.is_some() {
            own.sensor_estimators = self.estimators.iter().copied().map(Some).collect();
            own.gather.photons = self.pass.map(|[photons, _]| photons).or(own.gather.photons);
            own.gather.records = self.pass.map(|[_, records]| records).or(own.gather.records);
        }
        own
    }
}

impl<'s> Run<'s> {
    /// The current state.
    pub fn state(&self) -> RunState {
        let others = self.others.iter().map(|(_, series)| series.clone()).collect();
        self.state_of(self.batches, self.paths, self.photons.clone(), others)
    }

    /// Restores the state of a run of the same scene and plan; it continues to the same bits.
    pub fn restore(&mut self, state: RunState) {
        self.resize_batches(state.photons_per_batch);
        let RunState { batches, paths, photons, others, choices, batches_asked, .. } = state;
        self.batches_asked = batches_asked;
        (self.batches, self.paths, self.photons) = (batches, paths, photons);
        self.choices = choices;
        for ((_, own), series) in self.others.iter_mut().zip(others) {
            *own = series;
        }
    }

    /// Gives a batch this many photon paths, and other paths in proportion.
    fn resize_batches(&mut self, photons: u64) {
        let now = self.photons_per_batch();
        if photons != now {
            self.forward = self.forward.with_paths(photons);
            let others = std::mem::take(&mut self.others);
            let resized =
                |(own, series): (Prepared<'s>, Series)| (own.resized([photons, now]), series);
            self.others = others.into_iter().map(resized).collect();
        }
    }

    /// The state after all batches, from the counts of slices.
    pub(super) fn state_after(
        &self,
        batches: u64,
        photons: Vec<Counts>,
        others: Vec<Vec<Counts>>,
    ) -> RunState {
        let others = others.into_iter().map(Series::of_nodes).collect();
        let paths = batches * self.batch_paths();
        self.state_of(batches, paths, Series::of_nodes(photons), others)
    }

    fn state_of(&self, batches: u64, paths: u64, photons: Series, others: Vec<Series>) -> RunState {
        let settings = self.others.iter().find_map(|(own, series)| own.found(series).settings);
        RunState {
            batches,
            paths,
            photons,
            others,
            estimators: self.estimators.clone(),
            choices: self.choices.clone(),
            photons_per_batch: self.photons_per_batch(),
            batches_asked: self.batches_asked,
            pass: settings.map(|own| own.pass_size()),
        }
    }
}
