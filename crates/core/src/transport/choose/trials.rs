//! Trials of the estimators on all sensors, each with the same effort. This module does not draw
//! conclusions.

use crate::plan::{Estimator, RunPlan};
use crate::scene::{Scene, SensorId, SourceId};
use crate::tally::Tally;
use crate::transport::backward::estimator::Backward;
use crate::transport::backward::mix::Mixing;
use crate::transport::choose::choice::Trial;
use crate::transport::forward::Forward;
use crate::transport::gather::estimator::{Gather, Pass, PassReadings};
use crate::transport::gather::settings::{PhotonPilot, settle};
use crate::transport::gather::stages::FIRST_PASSES;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::readings::Readings;
use crate::transport::tally::work::{self, RecordWork};
use crate::transport::{Layout, Unobserved};
use rayon::prelude::*;

/// Batches from which an estimator is judged.
const BATCHES: u64 = 16;
/// Passes from which gathering is judged: fewer would contain more pairs, but give the variance
/// less accurately.
const PASSES: u64 = 8;
/// Variance of E0 over that of E1 where pairs limit both, 1: weights of 5, 1, 1 and -3 in the
/// quarters of the window. With the few pairs of a pilot, the latter is known much better.
const EXTRAPOLATED: f64 = 9.0;
/// Smallest relative variance of a pass times its photons, or its gather paths: the limit for
/// unlimited pairs.
const PER_PATH: f64 = 4.0;
/// The pilot uses random numbers of another seed, so that its paths do not count again in the run.
const SEED: u64 = 0x7069_6c6f_7431;

/// The estimators to try, and the effort.
#[derive(Debug)]
pub(super) struct Trials<'a> {
    pub(super) scene: &'a Scene,
    pub(super) plan: &'a RunPlan,
    pub(super) photons: PhotonPilot,
    pub(super) sensors: &'a [SensorId],
    /// Work for each estimator.
    pub(super) effort: f64,
    /// Stops the trial.
    pub(super) signal: &'a StopSignal,
}

/// A trial, and the flux it found, batch by batch: in total, and from each source.
#[derive(Debug)]
pub(super) struct Tried {
    pub(super) trial: Trial,
    pub(super) flux: Tally,
    pub(super) by_source: Vec<Tally>,
}

/// A trial of gathering, and the difference of its nested windows: E1 - E2, pass by pass.
#[derive(Debug)]
pub(super) struct Gathered {
    pub(super) tried: Tried,
    pub(super) apart: Tally,
}

/// Trials that were stopped give `None`.
impl Trials<'_> {
    /// Photons counted by the sensors.
    pub(super) fn forward(&self) -> Option<Vec<Tried>> {
        let forward = self.photons_for(self.effort);
        let traced = |batch| forward.batch(batch, self.signal);
        let batches: Option<Vec<Readings>> = (0..BATCHES).into_par_iter().map(traced).collect();
        let batches = batches?;
        let work = batches.iter().map(work::of_photons).sum();
        Some(self.judged(&batches, work, Estimator::Forward))
    }

    /// Gather paths that meet the sources.
    pub(super) fn backward(&self) -> Option<Vec<Tried>> {
        let backward = self.gather_paths_for(self.effort)?;
        let traced = |batch| {
            let mut readings = backward.batch(batch, &[], self.signal)?;
            readings.close_batch();
            Some(readings)
        };
        let batches: Option<Vec<Readings>> = (0..BATCHES).into_par_iter().map(traced).collect();
        let batches = batches?;
        Some(self.judged(&batches, self.work_of_one(&backward, &batches), Estimator::Backward))
    }

    /// Photons and gather paths with half of the work each.
    pub(super) fn mix(&self) -> Option<Vec<Tried>> {
        let half = 0.5 * self.effort;
        let forward = self.photons_for(half);
        let backward = self.gather_paths_for(half)?.mixed(self.sensors);
        let photon_fluxes = forward.photon_fluxes();
        let traced = |batch| {
            let mut readings = backward.batch(batch, &photon_fluxes, self.signal)?;
            let mut mixing = Mixing::new(&backward, &photon_fluxes, &mut readings);
            let pace = Pace::new(self.signal);
            let photons = forward.batch_observed(batch, &mut mixing, &pace)?;
            readings.close_batch();
            Some((work::of_photons(&photons), readings))
        };
        let both: Option<Vec<(f64, Readings)>> = (0..BATCHES).into_par_iter().map(traced).collect();
        let (by_photons, batches): (Vec<f64>, Vec<Readings>) = both?.into_iter().unzip();
        let work = by_photons.iter().sum::<f64>() + self.work_of_one(&backward, &batches);
        Some(self.judged(&batches, work, Estimator::Mix))
    }

    /// Passes with fewer photons and gather paths than those of a run, by one factor, and the cost
    /// of the run's passes: pairs, and the work they cause, grow with the square of that factor.
    pub(super) fn gather(&self) -> Option<Vec<Gathered>> {
        let Self { scene, plan, photons: pilot, sensors, effort, signal } = *self;
        let settings = settle(scene, plan, sensors, pilot, signal)?;
        let gather = Gather::new(scene, sensors, plan.seed ^ SEED, settings.depth);
        let by_photons = settings.photons as f64 * work::of_photon_path(pilot.segments_per_path);
        let all = (settings.gather_paths * gather.sensors()) as f64;
        let by_records = all * work::of_recorded_path(f64::from(settings.depth) + 1.0);
        let part = (effort / PASSES as f64 / (by_photons + by_records)).min(1.0);
        let scaled = |count: u64| ((part * count as f64).ceil() as u64).max(1);
        let forward = self.photons_of(scaled(settings.photons));
        let (window, gather_paths) = (settings.window, scaled(settings.gather_paths));
        let pass = |batch| Pass { batch, window, gather_paths };
        let passes: Option<Vec<PassReadings>> = (0..PASSES)
            .into_par_iter()
            .map(|batch| gather.pass(&forward, pass(batch), &mut Unobserved, signal))
            .collect();
        let passes = passes?;
        let [wide, values, apart] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, -1.0, 0.0]]
            .map(|factors| combined(&passes, factors));
        let gathered = gather_paths * gather.sensors();
        let work: f64 = passes.iter().map(|pass| work_of_whole(pass, gathered, part)).sum();
        let seconds = 1e-9 * work / PASSES as f64;
        let least = PER_PATH / settings.photons as f64 + PER_PATH / settings.gather_paths as f64;
        let tried = self.judged(&wide, 1e9 * seconds, Estimator::Gather);
        let judged = tried.into_iter().zip(sensors).map(|(mut tried, &sensor)| {
            let [wide, flux, apart] =
                [&wide, &values, &apart].map(|sums| flux(scene, sums, sensor));
            let trial = &mut tried.trial;
            trial.bias = (wide.mean() != 0.0).then(|| (apart.mean() / wide.mean()).abs());
            trial.least = FIRST_PASSES as f64 * seconds;
            // The cost of one pass, and of one of the run's.
            let of_pass = |cost: f64| {
                (EXTRAPOLATED * cost * PASSES as f64 * part * part).max(seconds * least)
            };
            trial.cost = trial.cost.map(of_pass);
            Gathered { tried: Tried { flux, ..tried }, apart }
        });
        Some(judged.collect())
    }

    /// Batches of photons with this much work in total.
    fn photons_for(&self, effort: f64) -> Forward<'_> {
        let path = work::of_photon_path(self.photons.segments_per_path);
        self.photons_of((effort / BATCHES as f64 / path) as u64)
    }

    /// Batches of gather paths of all sensors with this much work in total.
    fn gather_paths_for(&self, effort: f64) -> Option<Backward<'_>> {
        let Self { scene, plan, sensors, signal, .. } = *self;
        let backward = Backward::new(scene, sensors, plan.seed ^ SEED, plan.bounce_limit);
        let work = backward.work_of_path(signal)?;
        let paths = effort / BATCHES as f64 / sensors.len() as f64 / work;
        Some(backward.with_paths(paths as u64))
    }

    /// Work of the gather paths of each sensor: its share if it were alone.
    fn work_of_one(&self, backward: &Backward<'_>, batches: &[Readings]) -> f64 {
        let segments = batches.iter().map(|batch| batch.segments).sum();
        let work = work::of_gather_paths(BATCHES * backward.batch_paths(), segments);
        work / self.sensors.len() as f64
    }

    fn photons_of(&self, paths: u64) -> Forward<'_> {
        let least = self.scene.sources.len().max(1) as u64;
        let Self { scene, plan, .. } = self;
        Forward::new(scene, plan.seed ^ SEED, plan.bounce_limit, paths.max(least))
    }

    /// Performance of an estimator on each sensor with this much work.
    fn judged(&self, batches: &[Readings], work: f64, estimator: Estimator) -> Vec<Tried> {
        let merged = batches.iter().skip(1).fold(batches[0].clone(), |sum, batch| sum.merge(batch));
        let of_sensor = |&sensor: &SensorId| {
            let variance = relative_variance(self.scene, batches, &merged, sensor);
            let cost = variance.map(|variance| 1e-9 * work * variance);
            let trial = Trial { estimator, cost, bias: None, least: 0.0, objection: None };
            let by_source = sources(self.scene)
                .map(|source| flux_of(self.scene, batches, sensor, std::iter::once(source)));
            let by_source = by_source.collect();
            Tried { trial, flux: flux(self.scene, batches, sensor), by_source }
        };
        self.sensors.iter().map(of_sensor).collect()
    }
}

/// Sums of E1, E2 and E0 with factors, pass by pass.
fn combined(passes: &[PassReadings], [e1, e2, e0]: [f64; 3]) -> Vec<Readings> {
    let of_pass = |pass: &PassReadings| {
        let [wide, middle, _, extrapolated] = &pass.windows;
        let mut sum = wide.combined([e1, e2], middle).combined([1.0, e0], extrapolated);
        sum.close_batch();
        sum
    };
    passes.iter().map(of_pass).collect()
}

/// Work of a pass of the run, from a pass of the pilot that is a part of it with this many gather
/// paths.
fn work_of_whole(pass: &PassReadings, gather_paths: u64, part: f64) -> f64 {
    let RecordWork { records, look_ups, near, pairs } = pass.work;
    let grown = |count: u64, factor: f64| (count as f64 / factor) as u64;
    let near_of_whole = grown(near, part * part).min(grown(pass.photons.segments, part));
    let records = RecordWork {
        records: grown(records, part),
        // The filter is built for the records, so its errors scale with the photons alone.
        look_ups: grown(look_ups - near, part) + near_of_whole,
        near: near_of_whole,
        pairs: grown(pairs, part * part),
    };
    let gathering = work::of_gather_paths(gather_paths, pass.windows[0].segments);
    (work::of_photons(&pass.photons) + gathering) / part + work::of_records(records)
}

/// Relative variance of the mean over all batches: of the flux, or over cells of Σ σ² / Σ mean². `None` in the dark.
fn relative_variance(
    scene: &Scene,
    batches: &[Readings],
    merged: &Readings,
    sensor: SensorId,
) -> Option<f64> {
    let cells = &merged.sensors[sensor.index()].cells;
    if cells.len() == 1 {
        let flux = flux(scene, batches, sensor);
        return (flux.mean() != 0.0).then(|| (flux.std_error() / flux.mean()).powi(2));
    }
    let (mut variance, mut square) = (0.0, 0.0);
    for cell in 0..cells.len() {
        let (mean, error) = cells.mean(cell, merged.batch_count());
        variance += error * error;
        // Noise adds its own square to that of the mean.
        square += mean * mean - error * error;
    }
    (variance > 0.0).then(|| if square > 0.0 { variance / square } else { 1.0 })
}

/// The flux of a sensor, batch by batch.
fn flux(scene: &Scene, batches: &[Readings], sensor: SensorId) -> Tally {
    flux_of(scene, batches, sensor, sources(scene))
}

/// The flux of some sources.
fn flux_of(
    scene: &Scene,
    batches: &[Readings],
    sensor: SensorId,
    sources: impl Iterator<Item = SourceId> + Clone,
) -> Tally {
    let layout = Layout::new(scene);
    Tally::of(batches.iter().map(|batch| {
        let sums = &batch.groups[0].sums;
        sources.clone().map(|source| sums[layout.sensor_flux(sensor, source)]).sum()
    }))
}

fn sources(scene: &Scene) -> impl Iterator<Item = SourceId> + Clone + use<> {
    (0..scene.sources.len()).map(SourceId::new)
}
