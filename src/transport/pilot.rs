//! The choice between the estimators, by measurement: a pilot of each on every sensor.
//!
//! The work until a target error is reached is t = work × relative variance / target². The pilot measures it for
//! forward, backward and gather with a small part of the budget, in counted work, never in time; the least t is taken.
//! Gathering is considered only where its nested windows agree within the target: where they do not, its bias would
//! have to be shrunk away at a cost that a pilot cannot foresee.

use crate::scene::plan::{Estimator, GatherPlan, RunPlan};
use crate::scene::{Scene, SensorId};
use crate::tally::Tally;
use crate::transport::backward::Backward;
use crate::transport::emitters::invisible;
use crate::transport::forward::Forward;
use crate::transport::gather::{Gather, Pass};
use crate::transport::readings::Readings;
use crate::transport::settings::{PhotonPilot, settle};
use crate::transport::{Layout, work};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Share of the budget of a run that the pilot may use, 1.
const SHARE: f64 = 0.05;
/// Work that a run is taken to be given whose only rule is a target: a minute, in the units of `work`.
const TARGET_BUDGET: f64 = 6e10;
/// Least and most work of a pilot.
const BOUNDS: [f64; 2] = [1e8, 4e9];
/// Batches, or passes, from which each estimator is judged.
const BATCHES: u64 = 16;
/// Relative error that is aimed at where no target is set, 1.
const USUAL_TARGET: f64 = 0.01;
/// Random numbers of the pilot are those of another seed: what it chooses by is not counted again.
const SEED: u64 = 0x7069_6c6f_7431;
/// Straight pieces that gather paths are taken to have, for sizing.
const GATHER_SEGMENTS: f64 = 20.0;

/// What a pilot has found out about a sensor, and what was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// The estimator that was taken.
    pub chosen: Estimator,
    /// How each that could be tried did.
    pub tried: Vec<Trial>,
}

/// How an estimator did in a pilot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Which.
    pub estimator: Estimator,
    /// Work × relative variance, in seconds of one thread of the reference machine: over the square of a relative
    /// error it is the time until that error is reached. `None` where nothing was found.
    pub cost: Option<f64>,
    /// |E1 - E2| over the value, of a gathered one, 1.
    pub bias: Option<f64>,
}

/// Tries the estimators on all sensors and chooses.
pub(crate) fn choose(scene: &Scene, plan: &RunPlan, pilot: PhotonPilot) -> Vec<Choice> {
    let sensors: Vec<SensorId> = (0..scene.sensors.len()).map(SensorId::new).collect();
    let effort = effort(plan, pilot);
    let forward = try_forward(scene, plan, pilot, effort, &sensors);
    let can_meet = scene.sources.iter().all(|source| invisible(source, scene).is_none());
    let (backward, gather) = if can_meet && !sensors.is_empty() {
        (
            try_backward(scene, plan, effort, &sensors),
            try_gather(scene, plan, pilot, effort, &sensors),
        )
    } else {
        (Vec::new(), Vec::new())
    };
    let target = plan.stop.target.as_ref().map_or(USUAL_TARGET, |target| target.relative_error);
    sensors
        .iter()
        .map(|sensor| {
            let of = |trials: &[Trial]| trials.get(sensor.index()).cloned();
            let tried: Vec<Trial> =
                [of(&forward), of(&backward), of(&gather)].into_iter().flatten().collect();
            Choice { chosen: best(&tried, target), tried }
        })
        .collect()
}

/// The estimator of least cost among those whose bias is below the target; forward where none found anything.
fn best(tried: &[Trial], target: f64) -> Estimator {
    let fit = tried.iter().filter(|trial| trial.bias.is_none_or(|bias| bias <= target));
    let known = fit.filter_map(|trial| Some((trial.cost?, trial.estimator)));
    known.min_by(|(a, _), (b, _)| a.total_cmp(b)).map_or(Estimator::Forward, |(_, best)| best)
}

/// Work that each estimator may use.
fn effort(plan: &RunPlan, pilot: PhotonPilot) -> f64 {
    let path = work::of_photon_path(pilot.segments_per_path);
    let by_paths = plan.stop.paths.map(|paths| paths as f64 * path);
    let by_time = plan.stop.time.map(|time| time.as_secs_f64() * 1e9);
    let budget = by_paths.into_iter().chain(by_time).reduce(f64::min).unwrap_or(TARGET_BUDGET);
    (SHARE * budget).clamp(BOUNDS[0], BOUNDS[1]) / 3.0
}

fn try_forward(
    scene: &Scene,
    plan: &RunPlan,
    pilot: PhotonPilot,
    effort: f64,
    sensors: &[SensorId],
) -> Vec<Trial> {
    let paths = effort / BATCHES as f64 / work::of_photon_path(pilot.segments_per_path);
    let paths = (paths as u64).max(scene.sources.len() as u64).max(1);
    let forward = Forward::new(scene, plan.seed ^ SEED, plan.bounce_limit, paths);
    let batches: Vec<Readings> =
        (0..BATCHES).into_par_iter().map(|batch| forward.batch(batch)).collect();
    let work: f64 = batches.iter().map(work::of_photons).sum();
    trials(scene, sensors, &batches, work, Estimator::Forward)
}

fn try_backward(scene: &Scene, plan: &RunPlan, effort: f64, sensors: &[SensorId]) -> Vec<Trial> {
    let all = (BATCHES * sensors.len() as u64) as f64;
    let paths = effort / all / work::of_gather_path(GATHER_SEGMENTS);
    let backward =
        Backward::new(scene, sensors, plan.seed ^ SEED, plan.bounce_limit, (paths as u64).max(1));
    let batches: Vec<Readings> =
        (0..BATCHES).into_par_iter().map(|batch| backward.batch(batch)).collect();
    let segments = batches.iter().map(|batch| batch.segments).sum();
    let work = work::of_gather_paths(BATCHES * backward.batch_paths(), segments);
    // Each sensor alone would have had its share of the work.
    trials(scene, sensors, &batches, work / sensors.len() as f64, Estimator::Backward)
}

fn try_gather(
    scene: &Scene,
    plan: &RunPlan,
    pilot: PhotonPilot,
    effort: f64,
    sensors: &[SensorId],
) -> Vec<Trial> {
    let photons = 0.3 * effort / BATCHES as f64 / work::of_photon_path(pilot.segments_per_path);
    let wishes = GatherPlan { photons: Some((photons as u64).max(1)), ..plan.gather };
    let settings = settle(scene, &wishes, sensors, plan.seed ^ SEED, pilot);
    let forward = Forward::new(scene, plan.seed ^ SEED, plan.bounce_limit, settings.photons.max(1));
    let gather = Gather::new(scene, sensors, plan.seed ^ SEED, settings.depth);
    let paths = 0.5 * effort
        / (BATCHES * sensors.len() as u64) as f64
        / work::of_gather_path(f64::from(settings.depth) + 1.0);
    let passes: Vec<_> = (0..BATCHES)
        .into_par_iter()
        .map(|batch| {
            let gather_paths = (paths as u64).max(1);
            gather.pass(&forward, Pass { batch, window: settings.window, gather_paths })
        })
        .collect();
    let work: f64 = passes
        .iter()
        .map(|pass| {
            let gathering = pass.windows[0].segments;
            work::of_photons(&pass.photons)
                + work::of_gather_paths(gather.sensors() * (paths as u64).max(1), gathering)
                + work::of_records(pass.work)
        })
        .sum();
    let closed = |[a, b]: [f64; 2], one: usize, other: usize| -> Vec<Readings> {
        let all = passes.iter().map(|pass| {
            let mut sum = pass.windows[one].combined([a, b], &pass.windows[other]);
            sum.close_batch();
            sum
        });
        all.collect()
    };
    let values = closed([2.0, -1.0], 1, 0);
    let biases = closed([1.0, -1.0], 0, 1);
    let mut found = trials(scene, sensors, &values, work, Estimator::Gather);
    for (trial, &sensor) in found.iter_mut().zip(sensors) {
        let [value, bias] = [&values, &biases].map(|batches| flux(scene, batches, sensor));
        trial.bias = Some((bias.mean().abs() / value.mean().abs()).min(f64::MAX));
    }
    found
}

/// How an estimator did on each sensor.
fn trials(
    scene: &Scene,
    sensors: &[SensorId],
    batches: &[Readings],
    work: f64,
    estimator: Estimator,
) -> Vec<Trial> {
    let merged = batches.iter().skip(1).fold(batches[0].clone(), |sum, batch| sum.merge(batch));
    sensors
        .iter()
        .map(|&sensor| {
            let variance = relative_variance(scene, batches, &merged, sensor);
            Trial { estimator, cost: variance.map(|variance| 1e-9 * work * variance), bias: None }
        })
        .collect()
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
    let layout = Layout::new(scene);
    let sources = || (0..scene.sources.len()).map(crate::scene::SourceId::new);
    Tally::of(batches.iter().map(|batch| {
        sources().map(|source| batch.groups[0].sums[layout.sensor_flux(sensor, source)]).sum()
    }))
}
