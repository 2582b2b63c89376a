//! Rounds of work: bounded waves of batches over all threads, summed in a fixed order.
//!
//! A batch holds photon paths and, where sensors are estimated backward or by gathering, gather paths. Stop rules act
//! after whole waves, so that asking for the number of paths that a run did repeats it. Waves are traced in pieces,
//! between which a run can be interrupted. A wave is one batch of each group, or, with gathering, some passes.

mod slices;
mod state;

pub use slices::{Slice, Unsliceable};
pub use state::State;

use crate::scene::plan::{Estimator, Request, RunPlan, Schedule};
use crate::scene::{Scene, SensorId};
use crate::transport::backward::Backward;
use crate::transport::findings::{Findings, Gathered};
use crate::transport::forward::{Forward, PhotonWatcher};
use crate::transport::gather::Gather;
use crate::transport::mix::Mixing;
use crate::transport::pilot::choose;
use crate::transport::readings::GROUPS;
use crate::transport::settings::{PhotonPilot, settle};
use crate::transport::stages::{FIRST_PASSES, Stages};
use crate::transport::sums::Sums;
use crate::transport::window::ESTIMATES;
use crate::transport::{Choice, Readings, work};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Straight pieces that a batch should hold: long enough that summing up costs little, short enough to stop soon.
const BATCH_SEGMENTS: u64 = 1 << 15;
/// Most paths in a batch.
const BATCH_PATHS: u64 = 4096;
/// Paths from which the length of paths is learnt before a run, and bounces of them that are looked at.
const PILOT_PATHS: u64 = 64;
const PILOT_BOUNCES: u32 = 10_000;
/// Batches of a piece per thread: threads wait for the last batch of a piece.
const PIECE_BATCHES: u64 = 4;
/// Share of the work that goes to photons where all sensors are estimated backward: for the balance and what is beside
/// the aim, 1. Else photons and gather paths have half each.
const PHOTON_SHARE: f64 = 0.1;

/// A flag that asks a run to stop.
#[derive(Debug, Clone, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Asks the run to stop.
    pub fn raise(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether the run was asked to stop.
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A run in progress.
#[derive(Debug)]
pub struct Run<'s> {
    estimators: Vec<Estimator>,
    choices: Vec<Choice>,
    forward: Forward<'s>,
    photons: Sums<Readings>,
    backward: Option<(Backward<'s>, Sums<Readings>)>,
    stages: Option<Stages<'s>>,
    waves: u64,
    /// Batches of a wave.
    wave_batches: u64,
    /// Paths of whole waves.
    paths: u64,
    paths_asked: Option<u64>,
}

/// What a batch has counted.
struct Batch {
    photons: Readings,
    backward: Option<Readings>,
    windows: Option<[Readings; ESTIMATES]>,
}

impl<'s> Run<'s> {
    /// Prepares a run; nothing is counted yet.
    pub fn new(scene: &'s Scene, plan: &RunPlan) -> Self {
        let segments = segments_per_path(scene, plan);
        let pilot = PhotonPilot { segments_per_path: segments as f64 };
        let (estimators, choices) = estimators(scene, plan, pilot);
        let of = |wanted: Estimator| -> Vec<SensorId> {
            let all = estimators.iter().enumerate();
            all.filter(|(_, own)| **own == wanted).map(|(index, _)| SensorId::new(index)).collect()
        };
        let (alone, merged) = (of(Estimator::Gather), of(Estimator::Mis));
        let gathered = if merged.is_empty() { &alone } else { &merged };
        let stages = (!gathered.is_empty()).then(|| {
            let settings = settle(scene, &plan.gather, gathered, plan.seed, pilot);
            let mut gather = Gather::new(scene, gathered, plan.seed, settings.depth);
            gather.merging = (!merged.is_empty()).then_some(plan.bounce_limit);
            Stages::new(gather, settings)
        });
        let mixed = of(Estimator::Mix);
        let followed = [of(Estimator::Backward), mixed.clone()].concat();
        let has_followed = !followed.is_empty();
        // Photons also count for the sensors that are estimated forward, or mixed.
        let is_for_balance = of(Estimator::Forward).is_empty() && mixed.is_empty();
        let share = match (&stages, has_followed) {
            (_, false) => 1.0,
            (None, true) if is_for_balance => PHOTON_SHARE,
            (_, true) => 0.5,
        };
        let usual = plan.batch_paths.unwrap_or(usual_batch(segments));
        let photons = match (&stages, plan.stop.paths) {
            (Some(stages), _) => stages.settings.photons,
            (None, Some(paths)) if !has_followed => {
                paths.div_ceil(GROUPS * paths.div_ceil(GROUPS * usual).max(1))
            }
            (None, _) => (share * usual as f64).ceil() as u64,
        };
        // A path of each source at least.
        let photons = photons.max(scene.sources.len() as u64).max(1);
        let backward = has_followed.then(|| {
            let backward = Backward::new(scene, &followed, plan.seed, plan.bounce_limit);
            let by_photons = photons as f64 * work::of_photon_path(pilot.segments_per_path);
            let others = (1.0 - share) / share * by_photons;
            let paths = others / backward.work_of_path() / followed.len() as f64;
            backward.with_paths(paths as u64).mixed(&mixed)
        });
        let wave_batches = if stages.is_some() { FIRST_PASSES } else { GROUPS };
        Self {
            estimators,
            choices,
            forward: Forward::new(scene, plan.seed, plan.bounce_limit, photons),
            photons: Sums::new(),
            backward: backward.map(|backward| (backward, Sums::new())),
            stages,
            waves: 0,
            wave_batches,
            paths: 0,
            paths_asked: plan.stop.paths,
        }
    }

    /// Traces the next piece of a wave: a few batches for each thread.
    pub fn next_piece(&mut self) {
        let first = self.photons.batches_of_wave();
        let per_thread = if self.stages.is_some() { 1 } else { PIECE_BATCHES };
        let piece = per_thread * rayon::current_num_threads() as u64;
        let end = (first + piece).min(self.wave_batches);
        let before = self.waves * self.wave_batches;
        let batches: Vec<Batch> =
            (before + first..before + end).into_par_iter().map(|batch| self.batch(batch)).collect();
        batches.into_iter().for_each(|batch| self.add(batch));
        if end == self.wave_batches {
            self.end_wave();
        }
    }

    fn batch(&self, batch: u64) -> Batch {
        let Some((backward, _)) = &self.backward else {
            let (photons, windows) = self.photons(batch, &mut ());
            return Batch { photons, backward: None, windows };
        };
        let photon_fluxes = self.forward.photon_fluxes();
        let mut readings = backward.batch(batch, &photon_fluxes);
        let (photons, windows) = if backward.mixed.is_empty() {
            self.photons(batch, &mut ())
        } else {
            self.photons(batch, &mut Mixing::new(backward, &photon_fluxes, &mut readings))
        };
        readings.close_batch();
        Batch { photons, backward: Some(readings), windows }
    }

    /// Traces the photons of a batch, which someone watches, and gathers them where that is asked for.
    fn photons(
        &self,
        batch: u64,
        watcher: &mut impl PhotonWatcher,
    ) -> (Readings, Option<[Readings; ESTIMATES]>) {
        match &self.stages {
            None => (self.forward.batch_watched(batch, watcher), None),
            Some(stages) => {
                let pass = stages.gather.pass(&self.forward, stages.pass(batch), watcher);
                (pass.photons, Some(pass.windows))
            }
        }
    }

    fn add(&mut self, batch: Batch) {
        if let (Some(stages), Some(windows)) = (&mut self.stages, batch.windows) {
            stages.push(windows);
        }
        if let (Some((_, sums)), Some(backward)) = (&mut self.backward, batch.backward) {
            sums.push(backward);
        }
        self.photons.push(batch.photons);
    }

    fn end_wave(&mut self) {
        self.paths += self.wave_batches * self.batch_paths();
        self.waves += 1;
        self.photons.end_wave();
        if let Some((_, sums)) = &mut self.backward {
            sums.end_wave();
        }
        if let Some(stages) = &mut self.stages {
            stages.end_wave();
        }
    }

    /// Traces the rest of a wave, or a whole one.
    pub fn next_wave(&mut self) {
        self.next_piece();
        while !self.is_between_waves() {
            self.next_piece();
        }
    }

    /// Waves after which the next test of the stop rules is due: rounds grow by a quarter; with gathering they double
    /// the passes of a stage, and end with it.
    pub fn round_end(&self) -> u64 {
        let waves = self.waves;
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
        self.waves
    }

    /// Photon paths of a batch, or of a pass.
    pub fn photons_per_batch(&self) -> u64 {
        self.forward.shares.iter().sum()
    }

    /// Whether no wave is in progress.
    pub fn is_between_waves(&self) -> bool {
        self.photons.batches_of_wave() == 0
    }

    /// Whether all paths that were asked for have been traced.
    pub fn is_complete(&self) -> bool {
        self.paths_asked.is_some_and(|asked| self.paths >= asked)
    }

    /// Paths traced so far, those of a wave in progress included.
    pub fn paths(&self) -> u64 {
        self.paths + self.photons.batches_of_wave() * self.batch_paths()
    }

    /// Paths asked for, rounded up to whole batches; `None` without such a rule.
    pub fn planned_paths(&self) -> Option<u64> {
        let wave = self.wave_batches * self.batch_paths();
        let left = |asked: u64| asked.saturating_sub(self.paths).div_ceil(wave) * wave;
        self.paths_asked.map(|asked| self.paths + left(asked))
    }

    /// Whether the stage of the gather method in progress has the passes it was planned for.
    pub fn may_end_stage(&self) -> bool {
        self.stages.as_ref().is_some_and(|stages| stages.passes() >= stages.planned_passes())
    }

    /// Whether there are stages, each with a smaller window.
    pub fn shrinks(&self) -> bool {
        self.stages.as_ref().is_some_and(|own| own.settings.schedule == Schedule::Stages)
    }

    /// Goes on to the next stage of the gather method: a smaller window.
    pub fn next_stage(&mut self) {
        if let Some(stages) = &mut self.stages {
            stages.next_stage();
        }
    }

    /// Everything counted in whole waves; in a first wave that was stopped, in all of its batches so far. At least one
    /// piece has been traced.
    pub fn findings(&self) -> Findings {
        Findings {
            photons: self.photons.total().expect("a piece has been traced"),
            backward: self.backward.as_ref().and_then(|(_, sums)| sums.total()),
            gathered: self
                .stages
                .as_ref()
                .map(|stages| Gathered { settings: stages.settings, stages: stages.found() }),
            estimators: self.estimators.clone(),
            choices: self.choices.clone(),
            paths: if self.waves == 0 { self.paths() } else { self.paths },
        }
    }

    fn batch_paths(&self) -> u64 {
        let backward = self.backward.as_ref().map_or(0, |(backward, _)| backward.batch_paths());
        let gather = self.stages.as_ref().map_or(0, Stages::batch_paths);
        self.photons_per_batch() + backward + gather
    }
}

/// Photon paths of a batch that suit a scene: what [`RunPlan::batch_paths`] is when nothing is said.
pub fn batch_paths(scene: &Scene, plan: &RunPlan) -> u64 {
    usual_batch(segments_per_path(scene, plan))
}

fn usual_batch(segments_per_path: u64) -> u64 {
    (BATCH_SEGMENTS / segments_per_path).clamp(1, BATCH_PATHS)
}

/// Straight pieces of a photon path on the average, from a few of them.
fn segments_per_path(scene: &Scene, plan: &RunPlan) -> u64 {
    let limit = plan.bounce_limit.min(PILOT_BOUNCES);
    let pilot = Forward::new(scene, plan.seed, limit, PILOT_PATHS).batch(0);
    pilot.segments.div_ceil(pilot.paths().max(1)).max(1)
}

/// The estimator of each sensor: the one that was asked for, never another, or what a pilot chooses.
fn estimators(scene: &Scene, plan: &RunPlan, pilot: PhotonPilot) -> (Vec<Estimator>, Vec<Choice>) {
    let all = |estimator| (vec![estimator; scene.sensors.len()], Vec::new());
    match plan.estimator {
        Request::Forward => all(Estimator::Forward),
        Request::Backward => all(Estimator::Backward),
        Request::Mix => all(Estimator::Mix),
        Request::Gather => all(Estimator::Gather),
        Request::Mis => all(Estimator::Mis),
        Request::Auto => {
            let choices = choose(scene, plan, pilot);
            (choices.iter().map(|choice| choice.chosen).collect(), choices)
        }
    }
}
