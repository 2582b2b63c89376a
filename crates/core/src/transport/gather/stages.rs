//! Stages of the gather method: passes within one window, then more passes within a smaller one.
//!
//! Within a stage radius and angle are fixed. Passes of a wave share photons and records, and their counts are corrected so that the
//! spread of passes is a valid error bar (docs/method.md, eq. 29). Between stages the window shrinks by √2, the number of
//! gather paths doubles as far as memory allows and the number of passes grows by 8, since pairs
//! become rare: the bias of E1 and its standard error both halve. A stage is left out where bias is far above noise. A value comes from one stage
//! alone. With the schedule `fixed` there is no second stage.

use crate::plan::Schedule;
use crate::transport::Readings;
use crate::transport::gather::settings::{GatherSettings, WAVE_PASSES};
use crate::transport::tally::Counts;
use crate::transport::window::Window;

/// Passes after which it is first decided whether the first stage ends: two waves, each traced by one thread, so that no more
/// than two threads work until then.
const FIRST_DECISION: u64 = 2 * WAVE_PASSES;
/// Planned passes of the first stage.
pub(crate) const FIRST_PASSES: u64 = 16;
/// Growth of passes times gather paths from stage to stage. A quarter of the pairs of a pass
/// remains, since the window shrinks in four dimensions, and half the standard error requires four
/// times as many in total.
const GROWTH: u64 = 16;
/// Largest number of gather paths of a pass, from all sensors of the run, that stages grow to: with its record
/// and the entries of an index, each takes about 350 bytes for each pass of a wave.
const MOST_GATHER_PATHS: u64 = 1 << 18;

/// Readings by kernels of several orders, from the same photons and records.
#[derive(Debug, Clone, Copy)]
pub struct Orders<'a> {
    /// Of second order, E1: the mean over windows.
    pub second: &'a Readings,
    /// Of fourth order, E0: without the bias that scales with the squares of radius and angle.
    pub fourth: &'a Readings,
    /// Of sixth order, E00: without that of their fourth powers, too.
    pub sixth: &'a Readings,
}

impl<'a> Orders<'a> {
    /// The orders of passes of gathering.
    ///
    /// # Panics
    ///
    /// If the counts are of another estimator.
    pub fn of(counts: &'a Counts) -> Self {
        let [second, fourth, sixth] = counts.all() else {
            unreachable!("passes of gathering count in three orders")
        };
        Self { second, fourth, sixth }
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
        let window = self.window.of_stage(stage);
        Pass { batch, window, gather_paths: self.gather_paths(stage) }
    }

    /// Gather paths of a pass from each sensor.
    pub(super) fn gather_paths(&self, stage: u32) -> u64 {
        let grown = self.gather_paths.saturating_mul(1 << stage.min(32));
        let most = MOST_GATHER_PATHS / self.all_sensors.max(1);
        grown.min(most.max(self.gather_paths))
    }

    /// Variance of a pass after one and two shrinks from a stage over that in it, 1: its pairs grow with the gather paths and
    /// with the fourth power of the window's size.
    pub(super) fn variance_growth(&self, stage: u32) -> [f64; 2] {
        let paths = |stage| self.gather_paths(stage) as f64;
        [(1, 4.0), (2, 16.0)].map(|(shrinks, fewer)| fewer * paths(stage) / paths(stage + shrinks))
    }

    /// Passes of a stage that is not ended early by a plain bias.
    pub(crate) fn planned_passes(&self, stage: u32) -> u64 {
        match self.schedule {
            // The gather paths of a pass double while memory allows: 8 times the passes, later 16 times.
            Schedule::Stages => {
                let growth = self.gather_paths(stage) / self.gather_paths;
                (FIRST_PASSES * GROWTH.pow(stage.min(14))) / growth
            }
            Schedule::Fixed => u64::MAX,
        }
    }

    /// Passes of a stage after which it is next decided whether it ends: they double. Only the first stage may end with too
    /// few passes for an error bar: a run of 24 passes then has enough left for the second.
    pub(crate) fn next_decision(&self, stage: u32, passes: u64) -> u64 {
        let first = if stage == 0 { FIRST_DECISION } else { FIRST_PASSES };
        let (planned, doubled) = (self.planned_passes(stage), (2 * passes).max(first));
        if passes < planned { doubled.min(planned) } else { doubled }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_stage_may_end_after_a_few_passes() {
        let window = Window { radius: 1.0, theta_max: 0.1 };
        let settings = GatherSettings {
            depth: 1,
            window,
            all_sensors: 1,
            gather_paths: 100,
            photons: 1000,
            schedule: Schedule::Stages,
        };
        let decisions = |stage| {
            let mut passes = 0;
            std::array::from_fn(|_| {
                passes = settings.next_decision(stage, passes);
                passes
            })
        };
        assert_eq!(decisions(0), [8, 16, 32, 64]);
        assert_eq!(decisions(1), [16, 32, 64, 128]);
        assert_eq!(settings.variance_growth(0), [2.0, 4.0]);
        let grown = GatherSettings { gather_paths: MOST_GATHER_PATHS / 2, ..settings };
        assert_eq!(grown.variance_growth(0), [2.0, 8.0], "as many gather paths as memory allows");
    }
}
