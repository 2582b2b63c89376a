//! The part of a run that changes as it traces, so that it can be saved and restored.

use crate::plan::{Estimator, RunPlan};
use crate::transport::gather::stages::{Stages, StagesState};
use crate::transport::run::rounds::Run;
use crate::transport::tally::sums::Sums;
use crate::transport::{Choice, Readings, Windows};
use serde::{Deserialize, Serialize};

/// Progress of a run: everything counted, including a wave in progress. All else follows from scene
/// and plan.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct State {
    batches: u64,
    paths: u64,
    photons: Sums<Readings>,
    backward: Option<Sums<Readings>>,
    stages: Option<StagesState>,
    /// Its estimators, which depend on the clock if the time of the run is limited.
    estimators: Vec<Estimator>,
    choices: Vec<Choice>,
    pass: Option<PassSize>,
}

/// Paths of a pass of gathering.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct PassSize {
    photons: u64,
    /// Gather paths from all sensors in a pass of the first stage.
    records: u64,
}

impl State {
    /// The plan that prepares a run of this state again. Without a clock the same plan gives the
    /// same run.
    pub fn plan(&self, plan: &RunPlan) -> RunPlan {
        let mut own = plan.clone();
        if own.stop.time.is_some() {
            own.sensor_estimators = self.estimators.iter().copied().map(Some).collect();
            own.gather.photons = self.pass.map(|pass| pass.photons).or(own.gather.photons);
            own.gather.records = self.pass.map(|pass| pass.records).or(own.gather.records);
        }
        own
    }
}

impl Run<'_> {
    /// The current state.
    pub fn state(&self) -> State {
        State {
            batches: self.batches,
            paths: self.paths,
            photons: self.photons.clone(),
            backward: self.backward.as_ref().map(|(_, sums)| sums.clone()),
            stages: self.stages.as_ref().map(Stages::state),
            estimators: self.estimators.clone(),
            choices: self.choices.clone(),
            pass: self.pass_size(),
        }
    }

    /// Restores the state of a run of the same scene and plan; it continues to the same bits.
    pub fn restore(&mut self, state: State) {
        let State { batches, paths, photons, backward, stages, choices, .. } = state;
        (self.batches, self.paths, self.photons) = (batches, paths, photons);
        self.choices = choices;
        if let (Some((_, own)), Some(sums)) = (&mut self.backward, backward) {
            *own = sums;
        }
        if let (Some(own), Some(state)) = (&mut self.stages, stages) {
            own.restore(state);
        }
    }

    /// The state after all batches, from the counts of slices.
    pub(super) fn state_after(
        &self,
        batches: u64,
        photons: Vec<Readings>,
        backward: Vec<Readings>,
        windows: Vec<Windows>,
    ) -> State {
        State {
            batches,
            paths: batches * self.batch_paths(),
            photons: Sums::of_nodes(photons),
            backward: self.backward.as_ref().map(|_| Sums::of_nodes(backward)),
            stages: self.stages.as_ref().map(|_| StagesState::only(Sums::of_nodes(windows))),
            estimators: self.estimators.clone(),
            choices: self.choices.clone(),
            pass: self.pass_size(),
        }
    }

    fn pass_size(&self) -> Option<PassSize> {
        let stages = self.stages.as_ref()?;
        let records = stages.settings.gather_paths * stages.gather.sensors();
        Some(PassSize { photons: stages.settings.photons, records })
    }
}
