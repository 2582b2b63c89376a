//! Stages of the gather method: passes within one window, then more passes within a smaller one.
//!
//! Within a stage radius and angle are fixed, so its passes are independent samples of one quantity
//! and their spread is a valid error bar. Between stages the window shrinks by √2, the number of
//! gather paths doubles as far as memory allows and the number of passes grows by 8, since pairs
//! become rare: bias and standard error both halve. A value comes from one stage alone. With the
//! schedule `per-pass` there is one stage whose window shrinks from pass to pass.

use crate::plan::Schedule;
use crate::transport::gather::settings::GatherSettings;
use crate::transport::gather::window::Window;
use crate::transport::tally::Counts;
use crate::transport::{Readings, Stage};

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
#[derive(Debug, Clone, Copy)]
pub struct Windows<'a> {
    /// Within the whole window, E1.
    pub wide: &'a Readings,
    /// Within 1/√2 of radius and angle, E2.
    pub middle: &'a Readings,
    /// Within half of them, E3.
    pub narrow: &'a Readings,
    /// E0 = 2 E(r/√2, θ) + 2 E(r, θ/√2) - 3 E1: the remainder if the bias scales with the squares
    /// of radius and angle.
    pub extrapolated: &'a Readings,
}

impl<'a> Windows<'a> {
    /// The windows of passes of gathering.
    ///
    /// # Panics
    ///
    /// If the counts are of another estimator.
    pub fn of(counts: &'a Counts) -> Self {
        let [wide, middle, narrow, extrapolated] = counts.all() else {
            unreachable!("passes of gathering count in four windows")
        };
        Self { wide, middle, narrow, extrapolated }
    }
}

/// One pass: its number, its window, and its gather paths of each sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pass {
    pub(crate) batch: u64,
    pub(crate) window: Window,
    pub(crate) gather_paths: u64,
}

impl GatherSettings {
    /// Whether there are stages, each with a smaller window.
    pub(crate) fn has_stages(&self) -> bool {
        self.schedule == Schedule::Stages
    }

    /// The pass of a batch, in a stage.
    pub(crate) fn pass(&self, stage: u32, batch: u64) -> Pass {
        let window = match self.schedule {
            Schedule::Stages => self.window.of_stage(stage),
            Schedule::PerPass => self.window.of_pass(batch),
        };
        Pass { batch, window, gather_paths: self.gather_paths(stage) }
    }

    /// The last pass of a stage.
    pub(crate) fn last_pass(&self, stage: &Stage) -> Pass {
        self.pass(stage.number, stage.counts.batches().end - 1)
    }

    /// Gather paths of a pass from each sensor.
    fn gather_paths(&self, stage: u32) -> u64 {
        let grown = self.gather_paths.saturating_mul(1 << stage.min(32));
        let most = MOST_GATHER_PATHS / self.sensors.max(1);
        grown.min(most.max(self.gather_paths))
    }

    /// Gather paths of a pass from all sensors.
    pub(crate) fn batch_paths(&self, stage: u32) -> u64 {
        self.gather_paths(stage) * self.sensors
    }

    /// Passes after which a stage may end.
    pub(crate) fn planned_passes(&self, stage: u32) -> u64 {
        match self.schedule {
            // The gather paths of a pass double while memory allows: 8 times the passes, later 16 times.
            Schedule::Stages => {
                let growth = self.gather_paths(stage) / self.gather_paths;
                (FIRST_PASSES * GROWTH.pow(stage.min(14))) / growth
            }
            Schedule::PerPass => u64::MAX,
        }
    }

    /// Passes of a stage after which it is next decided whether it ends: they double.
    pub(crate) fn next_decision(&self, stage: u32, passes: u64) -> u64 {
        let (planned, doubled) = (self.planned_passes(stage), (2 * passes).max(FIRST_PASSES));
        if passes < planned { doubled.min(planned) } else { doubled }
    }
}
