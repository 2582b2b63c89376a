//! Stages of the gather method: passes within one window, then more passes within a smaller one.
//!
//! Within a stage radius and angle are fixed, so its passes are independent samples of one quantity
//! and their spread is a valid error bar. Between stages the window shrinks by √2, the number of
//! gather paths doubles as far as memory allows and the number of passes grows by 8, since pairs
//! become rare: bias and standard error both halve. A value comes from one stage alone. With the
//! schedule `per-pass` there is one stage whose window shrinks from pass to pass.

use crate::plan::Schedule;
use crate::transport::gather::estimator::{Gather, Pass};
use crate::transport::gather::settings::GatherSettings;
use crate::transport::gather::window::ESTIMATES;
use crate::transport::tally::sums::{Merge, Sums};
use crate::transport::{Readings, Window};
use serde::{Deserialize, Serialize};

/// Passes of the first stage, and of a wave of passes.
pub(crate) const FIRST_PASSES: u64 = 16;
/// Growth of passes times gather paths from stage to stage. A quarter of the pairs of a pass
/// remains, since the window shrinks in four dimensions, and half the standard error requires four
/// times as many in total.
const GROWTH: u64 = 16;
/// Largest number of gather paths of a pass, from all sensors, that stages grow to: with its record
/// and the entries of an index, each takes about 600 bytes.
const MOST_GATHER_PATHS: u64 = 1 << 20;

/// Readings of the estimates within windows of several sizes, from the same photons and records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Windows {
    /// Within the whole window, E1.
    pub wide: Readings,
    /// Within 1/√2 of radius and angle, E2.
    pub middle: Readings,
    /// Within half of them, E3.
    pub narrow: Readings,
    /// E0 = 2 E(r/√2, θ) + 2 E(r, θ/√2) - 3 E1: the remainder if the bias scales with the squares
    /// of radius and angle.
    pub extrapolated: Readings,
}

impl Merge for Windows {
    fn batch_count(&self) -> u64 {
        self.narrow.batch_count()
    }

    fn first_batch(&self) -> u64 {
        self.narrow.batches.start
    }

    fn merge(self, later: &Self) -> Self {
        Self {
            wide: self.wide.merge(&later.wide),
            middle: self.middle.merge(&later.middle),
            narrow: self.narrow.merge(&later.narrow),
            extrapolated: self.extrapolated.merge(&later.extrapolated),
        }
    }
}

impl Windows {
    /// The windows of a pass that has ended.
    pub(crate) fn closed(windows: [Readings; ESTIMATES]) -> Self {
        let [wide, middle, narrow, extrapolated] = windows.map(|mut readings| {
            readings.close_batch();
            readings
        });
        Self { wide, middle, narrow, extrapolated }
    }
}

/// The state of the stages that changes in a run.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct StagesState {
    number: u32,
    first_batch: u64,
    sums: Sums<Windows>,
    finished: Vec<Stage>,
}

impl StagesState {
    /// The only stage of a schedule without stages, with all counts.
    pub(crate) fn only(sums: Sums<Windows>) -> Self {
        Self { number: 0, first_batch: 0, sums, finished: Vec::new() }
    }
}

/// Findings of a stage.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// Number of the stage, from 0.
    pub number: u32,
    /// Its widest window; with the schedule `per-pass` that of the last pass.
    pub window: Window,
    /// Gather paths of a pass from each sensor.
    pub gather_paths: u64,
    /// Its counts.
    pub windows: Windows,
}

/// The stages of a run in progress.
#[derive(Debug)]
pub(crate) struct Stages<'s> {
    pub(crate) gather: Gather<'s>,
    pub(crate) settings: GatherSettings,
    number: u32,
    /// The first batch of the stage in progress.
    first_batch: u64,
    sums: Sums<Windows>,
    /// The last two finished stages.
    finished: Vec<Stage>,
}

impl<'s> Stages<'s> {
    pub(crate) fn new(gather: Gather<'s>, settings: GatherSettings) -> Self {
        let sums = Sums::default();
        Self { gather, settings, number: 0, first_batch: 0, sums, finished: Vec::new() }
    }

    /// The pass of a batch, in the stage in progress.
    pub(crate) fn pass(&self, batch: u64) -> Pass {
        let window = match self.settings.schedule {
            Schedule::Stages => self.settings.window.of_stage(self.number),
            Schedule::PerPass => self.settings.window.of_pass(batch),
        };
        Pass { batch, window, gather_paths: self.gather_paths() }
    }

    /// Gather paths of a pass from each sensor.
    pub(crate) fn gather_paths(&self) -> u64 {
        let grown = self.settings.gather_paths.saturating_mul(1 << self.number.min(32));
        let most = MOST_GATHER_PATHS / self.gather.sensors().max(1);
        grown.min(most.max(self.settings.gather_paths))
    }

    /// Gather paths of a pass from all sensors.
    pub(crate) fn batch_paths(&self) -> u64 {
        self.gather_paths() * self.gather.sensors()
    }

    /// Passes after which the stage in progress may end.
    pub(crate) fn planned_passes(&self) -> u64 {
        match self.settings.schedule {
            // The gather paths of a pass double while memory allows: 8 times the passes, later 16 times.
            Schedule::Stages => {
                let growth = self.gather_paths() / self.settings.gather_paths;
                (FIRST_PASSES * GROWTH.pow(self.number.min(14))) / growth
            }
            Schedule::PerPass => u64::MAX,
        }
    }

    /// Passes of the stage in progress.
    pub(crate) fn passes(&self) -> u64 {
        self.sums.batches()
    }

    /// Adds the counts of a pass.
    pub(crate) fn push(&mut self, windows: [Readings; ESTIMATES]) {
        self.sums.push(Windows::closed(windows));
    }

    /// The part that changes in a run.
    pub(crate) fn state(&self) -> StagesState {
        StagesState {
            number: self.number,
            first_batch: self.first_batch,
            sums: self.sums.clone(),
            finished: self.finished.clone(),
        }
    }

    /// Restores a state of the same stages.
    pub(crate) fn restore(&mut self, state: StagesState) {
        let StagesState { number, first_batch, sums, finished } = state;
        (self.number, self.first_batch) = (number, first_batch);
        (self.sums, self.finished) = (sums, finished);
    }

    /// Starts the next stage; the value comes from the one that ends here until the next is as
    /// good.
    pub(crate) fn next_stage(&mut self) {
        let ends = self.in_progress();
        self.finished.drain(..self.finished.len().saturating_sub(1));
        self.finished.extend(ends);
        self.first_batch += self.passes();
        self.number += 1;
        self.sums = Sums::default();
    }

    /// The stage in progress and the one before it. A stage without a pass does not count, so a run
    /// that is stopped as it starts one reports the same as a run that ends there.
    pub(crate) fn found(&self) -> Vec<Stage> {
        let new = self.in_progress();
        let skipped = if new.is_some() { self.finished.len().saturating_sub(1) } else { 0 };
        self.finished.iter().skip(skipped).cloned().chain(new).collect()
    }

    fn in_progress(&self) -> Option<Stage> {
        let last = self.first_batch + self.passes().max(1) - 1;
        Some(Stage {
            number: self.number,
            window: self.pass(last).window,
            gather_paths: self.gather_paths(),
            windows: self.sums.total()?,
        })
    }
}
