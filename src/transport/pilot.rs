//! The choice between the estimators, by measurement: a pilot of each on every sensor.
//!
//! The work until a target error is reached is t = work × relative variance / target². The pilot measures it for
//! forward, backward and gather with a small part of the budget, in counted work, never in time; the least t is taken.
//! Gathering is left out where something speaks against it: nested windows that differ by more than the target and
//! their noise, or a flux that the best of the unbiased two contradicts. Two windows alone are blind to a feature that
//! is smaller than both.

use crate::scene::plan::{Estimator, RunPlan};
use crate::scene::{Scene, SensorId};
use crate::tally::Tally;
use crate::transport::backward::Backward;
use crate::transport::emitters::invisible;
use crate::transport::forward::Forward;
use crate::transport::gather::{Gather, Pass, PassReadings};
use crate::transport::readings::Readings;
use crate::transport::settings::{PhotonPilot, settle};
use crate::transport::work::RecordWork;
use crate::transport::{Layout, work};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Share of the budget of a run that the pilot may use, 1.
const SHARE: f64 = 0.05;
/// Work that a run is taken to be given whose only rule is a target: a minute, in the units of `work`.
const TARGET_BUDGET: f64 = 6e10;
/// Least and most work of a pilot.
const BOUNDS: [f64; 2] = [1e8, 4e9];
/// Batches from which an estimator is judged.
const BATCHES: u64 = 16;
/// Passes from which gathering is judged: few, because the pairs that limit it grow with the square of a pass.
const PASSES: u64 = 4;
/// Least relative variance of a pass times its photons, or its gather paths: what pairs without limit would leave.
const PER_PATH: f64 = 4.0;
/// Standard errors beyond which a difference counts.
const SIGMAS: f64 = 3.0;
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
    /// What keeps it from being chosen, whatever it costs.
    pub objection: Option<Objection>,
}

/// What speaks against gathering.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Objection {
    /// Its nested windows differ by more than the target, beyond their noise.
    WindowsDiffer,
    /// Its flux is not that of an unbiased estimator.
    Contradicted,
}

/// A trial, and the flux it found, batch by batch.
#[derive(Debug)]
struct Tried {
    trial: Trial,
    flux: Tally,
}

/// A trial of gathering, and how far its nested windows are apart: E1 - E2, pass by pass.
#[derive(Debug)]
struct Gathered {
    tried: Tried,
    apart: Tally,
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
            let unbiased = [&forward, &backward].map(|tried| tried.get(sensor.index()));
            let gathered = gather.get(sensor.index()).map(|gathered| Trial {
                objection: objection(gathered, unbiased, target),
                ..gathered.tried.trial.clone()
            });
            let unbiased = unbiased.into_iter().flatten().map(|tried| tried.trial.clone());
            let tried: Vec<Trial> = unbiased.chain(gathered).collect();
            Choice { chosen: best(&tried), tried }
        })
        .collect()
}

/// The estimator of least cost to which nothing is objected; forward where none found anything.
fn best(tried: &[Trial]) -> Estimator {
    let fit = tried.iter().filter(|trial| trial.objection.is_none());
    let known = fit.filter_map(|trial| Some((trial.cost?, trial.estimator)));
    known.min_by(|(a, _), (b, _)| a.total_cmp(b)).map_or(Estimator::Forward, |(_, best)| best)
}

/// What speaks against a gathered flux, beside what the unbiased estimators found.
fn objection(gathered: &Gathered, unbiased: [Option<&Tried>; 2], target: f64) -> Option<Objection> {
    let (flux, apart) = (&gathered.tried.flux, &gathered.apart);
    let allowed = target * flux.mean().abs();
    if apart.mean().abs() > allowed + SIGMAS * apart.std_error() {
        return Some(Objection::WindowsDiffer);
    }
    let other = unbiased
        .into_iter()
        .flatten()
        .filter(|tried| tried.flux.mean() > 0.0)
        .min_by(|a, b| a.flux.std_error().total_cmp(&b.flux.std_error()))?;
    let error = flux.std_error().hypot(other.flux.std_error());
    let off = (flux.mean() - other.flux.mean()).abs();
    (off > allowed + SIGMAS * error).then_some(Objection::Contradicted)
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
) -> Vec<Tried> {
    let paths = effort / BATCHES as f64 / work::of_photon_path(pilot.segments_per_path);
    let paths = (paths as u64).max(scene.sources.len() as u64).max(1);
    let forward = Forward::new(scene, plan.seed ^ SEED, plan.bounce_limit, paths);
    let batches: Vec<Readings> =
        (0..BATCHES).into_par_iter().map(|batch| forward.batch(batch)).collect();
    let work: f64 = batches.iter().map(work::of_photons).sum();
    trials(scene, sensors, &batches, work, Estimator::Forward)
}

fn try_backward(scene: &Scene, plan: &RunPlan, effort: f64, sensors: &[SensorId]) -> Vec<Tried> {
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

/// Tries passes that are smaller than those of a run by one factor in photons and gather paths, and tells what those of
/// the run would cost: pairs, and with them the work they make, grow with the square of that factor.
fn try_gather(
    scene: &Scene,
    plan: &RunPlan,
    pilot: PhotonPilot,
    effort: f64,
    sensors: &[SensorId],
) -> Vec<Gathered> {
    let settings = settle(scene, &plan.gather, sensors, plan.seed, pilot);
    let gather = Gather::new(scene, sensors, plan.seed ^ SEED, settings.depth);
    let by_photons = settings.photons as f64 * work::of_photon_path(pilot.segments_per_path);
    let all = (settings.gather_paths * gather.sensors()) as f64;
    let by_records = all * work::of_recorded_path(f64::from(settings.depth) + 1.0);
    let part = (effort / PASSES as f64 / (by_photons + by_records)).min(1.0);
    let scaled = |count: u64| ((part * count as f64).ceil() as u64).max(1);
    let photons = scaled(settings.photons).max(scene.sources.len() as u64);
    let forward = Forward::new(scene, plan.seed ^ SEED, plan.bounce_limit, photons);
    let (window, gather_paths) = (settings.window, scaled(settings.gather_paths));
    let passes: Vec<PassReadings> = (0..PASSES)
        .into_par_iter()
        .map(|batch| gather.pass(&forward, Pass { batch, window, gather_paths }))
        .collect();
    let closed = |[a, b]: [f64; 2], one: usize, other: usize| -> Vec<Readings> {
        let all = passes.iter().map(|pass| {
            let mut sum = pass.windows[one].combined([a, b], &pass.windows[other]);
            sum.close_batch();
            sum
        });
        all.collect()
    };
    let (values, apart) = (closed([2.0, -1.0], 1, 0), closed([1.0, -1.0], 0, 1));
    let gathered = gather_paths * gather.sensors();
    let work = passes.iter().map(|pass| work_of_whole(pass, gathered, part)).sum::<f64>();
    let work = work / PASSES as f64;
    let least = PER_PATH / settings.photons as f64 + PER_PATH / settings.gather_paths as f64;
    let tried = trials(scene, sensors, &values, work, Estimator::Gather);
    let judged = tried.into_iter().zip(sensors).map(|(mut tried, &sensor)| {
        let apart = flux(scene, &apart, sensor);
        let value = tried.flux.mean().abs();
        tried.trial.bias = Some((apart.mean().abs() / value).min(f64::MAX));
        // Of one pass, and one of the run's.
        let of_pass = |cost: f64| (cost * PASSES as f64 * part * part).max(1e-9 * work * least);
        tried.trial.cost = tried.trial.cost.map(of_pass);
        Gathered { tried, apart }
    });
    judged.collect()
}

/// Work of a pass of the run, of which a pass of the pilot with so many gather paths was a part.
fn work_of_whole(pass: &PassReadings, gather_paths: u64, part: f64) -> f64 {
    let RecordWork { records, look_ups, pairs } = pass.work;
    let grown = |count: u64, factor: f64| (count as f64 / factor) as u64;
    let records = RecordWork {
        records: grown(records, part),
        look_ups: grown(look_ups, part * part).min(grown(pass.photons.segments, part)),
        pairs: grown(pairs, part * part),
    };
    let gathering = work::of_gather_paths(gather_paths, pass.windows[0].segments);
    (work::of_photons(&pass.photons) + gathering) / part + work::of_records(records)
}

/// How an estimator did on each sensor.
fn trials(
    scene: &Scene,
    sensors: &[SensorId],
    batches: &[Readings],
    work: f64,
    estimator: Estimator,
) -> Vec<Tried> {
    let merged = batches.iter().skip(1).fold(batches[0].clone(), |sum, batch| sum.merge(batch));
    sensors
        .iter()
        .map(|&sensor| {
            let variance = relative_variance(scene, batches, &merged, sensor);
            let cost = variance.map(|variance| 1e-9 * work * variance);
            let trial = Trial { estimator, cost, bias: None, objection: None };
            Tried { trial, flux: flux(scene, batches, sensor) }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn tried(estimator: Estimator, cost: Option<f64>, fluxes: [f64; 4]) -> Tried {
        let trial = Trial { estimator, cost, bias: None, objection: None };
        Tried { trial, flux: Tally::of(fluxes) }
    }

    fn gathered(fluxes: [f64; 4], apart: [f64; 4]) -> Gathered {
        let tried = tried(Estimator::Gather, Some(1.0), fluxes);
        Gathered { tried, apart: Tally::of(apart) }
    }

    #[test]
    fn the_cheapest_estimator_without_an_objection_is_chosen() {
        let of = |estimator, cost| tried(estimator, cost, [1.0; 4]).trial;
        let mut trials = vec![
            of(Estimator::Forward, Some(3.0)),
            of(Estimator::Backward, None),
            of(Estimator::Gather, Some(1.0)),
        ];
        assert_eq!(best(&trials), Estimator::Gather);
        trials[2].objection = Some(Objection::WindowsDiffer);
        assert_eq!(best(&trials), Estimator::Forward);
        trials[0].cost = None;
        assert_eq!(best(&trials), Estimator::Forward, "in the dark");
    }

    #[test]
    fn windows_object_when_they_differ_beyond_target_and_noise() {
        let target = 0.01;
        let with = |apart| objection(&gathered([1.0; 4], apart), [None, None], target);
        assert_eq!(with([0.2, 0.21, 0.2, 0.19]), Some(Objection::WindowsDiffer));
        assert_eq!(with([0.009; 4]), None, "within the target");
        assert_eq!(with([0.3, -0.2, 0.25, -0.15]), None, "noise");
    }

    #[test]
    fn the_better_of_the_unbiased_estimators_contradicts_a_flux() {
        let flux = gathered([0.50, 0.52, 0.49, 0.49], [0.0; 4]);
        let noisy = tried(Estimator::Forward, Some(1.0), [0.0, 2.0, 0.0, 0.0]);
        let sharp = tried(Estimator::Backward, Some(1.0), [1.0, 1.02, 0.99, 0.99]);
        let dark = tried(Estimator::Backward, None, [0.0; 4]);
        let with = |others| objection(&flux, others, 0.01);
        assert_eq!(with([Some(&noisy), Some(&sharp)]), Some(Objection::Contradicted));
        assert_eq!(with([Some(&noisy), Some(&dark)]), None, "what saw nothing says nothing");
        assert_eq!(with([None, None]), None);
    }
}
