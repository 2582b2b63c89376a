//! Rounds of work: bounded waves of batches over all threads, summed in a fixed order.
//!
//! A batch holds photon paths and, where sensors are estimated backward or by gathering, gather
//! paths. A wave is one batch of each group, or, with gathering, some passes; waves are traced in
//! pieces. A signal stops a run at any time: the batches before the first unfinished one then
//! count, so that a run of that many batches reproduces it.

use crate::plan::{Estimator, Schedule};
use crate::transport::backward::estimator::Backward;
use crate::transport::backward::mix::Mixing;
use crate::transport::forward::Forward;
use crate::transport::gather::stages::{FIRST_PASSES, Stages};
use crate::transport::gather::window::ESTIMATES;
use crate::transport::run::findings::{Findings, Gathered};
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::sums::Sums;
use crate::transport::{Choice, Observer, Readings, Unobserved};
use rayon::prelude::*;
use std::fmt;

/// Batches of a piece per thread: threads wait for the last batch of a piece.
pub(super) const PIECE_BATCHES: u64 = 4;
/// Activity of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// An estimator is tried before the run.
    Pilot(Estimator),
    /// Batches of photon paths, of gather paths, or of both.
    Batches(Estimator),
    /// A pass of gathering, counted from 1.
    Pass {
        /// Gather, or mis.
        estimator: Estimator,
        /// Number of the pass.
        number: u64,
    },
}

impl fmt::Display for Phase {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pilot(estimator) => write!(out, "pilot of {}", estimator.name()),
            Self::Batches(estimator) => out.write_str(estimator.name()),
            Self::Pass { estimator, number } => write!(out, "{} pass {number}", estimator.name()),
        }
    }
}

/// A run in progress.
#[derive(Debug)]
pub struct Run<'s> {
    pub(super) estimators: Vec<Estimator>,
    pub(super) choices: Vec<Choice>,
    pub(super) forward: Forward<'s>,
    pub(super) photons: Sums<Readings>,
    pub(super) backward: Option<(Backward<'s>, Sums<Readings>)>,
    pub(super) stages: Option<Stages<'s>>,
    pub(super) signal: StopSignal,
    /// Batches or passes so far.
    pub(super) batches: u64,
    /// Batches of a wave.
    pub(super) wave_batches: u64,
    /// Paths so far.
    pub(super) paths: u64,
    pub(super) paths_asked: Option<u64>,
    /// Batches into which the paths are divided; `None` for whole waves.
    pub(super) batches_asked: Option<u64>,
}

/// Counts of a batch.
pub(super) struct Batch {
    pub(super) photons: Readings,
    pub(super) backward: Option<Readings>,
    pub(super) windows: Option<[Readings; ESTIMATES]>,
}

impl<'s> Run<'s> {
    /// Traces the next piece of a wave: a few batches for each thread. If the signal stops it, the
    /// batches before the first unfinished one count, and the others are dropped.
    pub fn next_piece(&mut self) {
        let per_thread = if self.stages.is_some() { 1 } else { PIECE_BATCHES };
        let piece = per_thread * rayon::current_num_threads() as u64;
        let wave_end = (self.waves() + 1) * self.wave_batches;
        let end = (self.batches + piece).min(wave_end).min(self.batches_asked.unwrap_or(u64::MAX));
        let signal = match self.batches {
            0 => self.signal.with_grace(),
            _ => self.signal.clone(),
        };
        let batches: Vec<Option<Batch>> =
            (self.batches..end).into_par_iter().map(|batch| self.batch(batch, &signal)).collect();
        batches.into_iter().map_while(|batch| batch).for_each(|batch| self.add(batch));
    }

    /// Traces one batch; `None` if it was stopped.
    pub(super) fn batch(&self, batch: u64, signal: &StopSignal) -> Option<Batch> {
        let Some((backward, _)) = &self.backward else {
            let (photons, windows) = self.photons(batch, &mut Unobserved, signal)?;
            return Some(Batch { photons, backward: None, windows });
        };
        let photon_fluxes = self.forward.photon_fluxes();
        let mut readings = backward.batch(batch, &photon_fluxes, signal)?;
        let (photons, windows) = if backward.mixed.is_empty() {
            self.photons(batch, &mut Unobserved, signal)?
        } else {
            let mut mixing = Mixing::new(backward, &photon_fluxes, &mut readings);
            self.photons(batch, &mut mixing, signal)?
        };
        readings.close_batch();
        Some(Batch { photons, backward: Some(readings), windows })
    }

    /// Traces the photons of a batch, with an observer, and gathers them if requested; `None` if it
    /// was stopped.
    pub(super) fn photons(
        &self,
        batch: u64,
        observer: &mut impl Observer,
        signal: &StopSignal,
    ) -> Option<(Readings, Option<[Readings; ESTIMATES]>)> {
        let Some(stages) = &self.stages else {
            let readings = self.forward.batch_observed(batch, observer, &Pace::new(signal))?;
            return Some((readings, None));
        };
        let pass = stages.gather.pass(&self.forward, stages.pass(batch), observer, signal)?;
        Some((pass.photons, Some(pass.windows)))
    }

    pub(super) fn add(&mut self, batch: Batch) {
        self.batches += 1;
        self.paths += self.batch_paths();
        if let (Some(stages), Some(windows)) = (&mut self.stages, batch.windows) {
            stages.push(windows);
        }
        if let (Some((_, sums)), Some(backward)) = (&mut self.backward, batch.backward) {
            sums.push(backward);
        }
        self.photons.push(batch.photons);
    }

    /// Traces the rest of a wave, or a whole one.
    pub fn next_wave(&mut self) {
        self.next_piece();
        while !self.is_between_waves() && !self.is_complete() {
            self.next_piece();
        }
    }

    /// Waves after which the next test of the stop rules is due: rounds grow by a quarter; with gathering they double
    /// the passes of a stage, and end with it.
    pub fn round_end(&self) -> u64 {
        let waves = self.waves();
        match &self.stages {
            None => {
                let next = (waves + 1).max(waves * 5 / 4);
                self.paths_asked.map_or(next, |paths| {
                    next.min(paths.div_ceil(self.wave_batches * self.batch_paths()))
                })
            }
            Some(stages) => {
                let (passes, planned) = (stages.passes(), stages.planned_passes());
                let doubled = (2 * passes).max(FIRST_PASSES);
                let end = if passes < planned { doubled.min(planned) } else { doubled };
                waves + (end - passes).div_ceil(FIRST_PASSES)
            }
        }
    }

    /// Whole waves traced so far.
    pub fn waves(&self) -> u64 {
        self.batches / self.wave_batches
    }

    /// Batches or passes traced so far.
    pub fn batches(&self) -> u64 {
        self.batches
    }

    /// The current activity.
    pub fn phase(&self) -> Phase {
        match (&self.stages, &self.backward) {
            (Some(stages), _) if stages.gather.merging.is_some() => {
                Phase::Pass { estimator: Estimator::Mis, number: self.batches + 1 }
            }
            (Some(_), _) => Phase::Pass { estimator: Estimator::Gather, number: self.batches + 1 },
            (None, Some((backward, _))) if backward.mixed.is_empty() => {
                Phase::Batches(Estimator::Backward)
            }
            (None, Some(_)) => Phase::Batches(Estimator::Mix),
            (None, None) => Phase::Batches(Estimator::Forward),
        }
    }

    /// Photon paths of a batch, or of a pass.
    pub fn photons_per_batch(&self) -> u64 {
        self.forward.shares.iter().sum()
    }

    /// Whether no wave is in progress.
    pub fn is_between_waves(&self) -> bool {
        self.batches.is_multiple_of(self.wave_batches)
    }

    /// Whether all requested paths have been traced: the batches they are divided into, or whole
    /// waves.
    pub fn is_complete(&self) -> bool {
        match self.batches_asked {
            Some(asked) => self.batches >= asked,
            None => {
                self.is_between_waves() && self.paths_asked.is_some_and(|asked| self.paths >= asked)
            }
        }
    }

    /// Paths traced so far, including those of a wave in progress.
    pub fn paths(&self) -> u64 {
        self.paths
    }

    /// Requested paths, rounded up to whole waves if their batches were not given; `None` without
    /// such a rule.
    pub fn planned_paths(&self) -> Option<u64> {
        let batch = self.batch_paths();
        if let Some(batches) = self.batches_asked {
            return Some(
                self.paths
                    .saturating_add(batches.saturating_sub(self.batches).saturating_mul(batch)),
            );
        }
        let in_wave = self.batches % self.wave_batches;
        let before = self.paths - in_wave * batch;
        let wave = self.wave_batches * batch;
        let left = |asked: u64| asked.saturating_sub(before).div_ceil(wave).saturating_mul(wave);
        self.paths_asked.map(|asked| before.saturating_add(left(asked)))
    }

    /// Whether the stage of the gather method in progress has its planned passes.
    pub fn may_end_stage(&self) -> bool {
        self.stages.as_ref().is_some_and(|stages| stages.passes() >= stages.planned_passes())
    }

    /// Whether there are stages, each with a smaller window.
    pub fn shrinks(&self) -> bool {
        self.stages.as_ref().is_some_and(|own| own.settings.schedule == Schedule::Stages)
    }

    /// Starts the next stage of the gather method: a smaller window.
    pub fn next_stage(&mut self) {
        if let Some(stages) = &mut self.stages {
            stages.next_stage();
        }
    }

    /// Everything counted so far. At least one batch has been traced.
    pub fn findings(&self) -> Findings {
        Findings {
            photons: self.photons.total().expect("a batch has been traced"),
            backward: self.backward.as_ref().and_then(|(_, sums)| sums.total()),
            gathered: self
                .stages
                .as_ref()
                .map(|stages| Gathered { settings: stages.settings, stages: stages.found() }),
            estimators: self.estimators.clone(),
            choices: self.choices.clone(),
            paths: self.paths,
        }
    }

    pub(super) fn batch_paths(&self) -> u64 {
        let backward = self.backward.as_ref().map_or(0, |(backward, _)| backward.batch_paths());
        let gather = self.stages.as_ref().map_or(0, Stages::batch_paths);
        self.photons_per_batch() + backward + gather
    }
}
