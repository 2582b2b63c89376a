//! Decisions before a run: the estimator of each sensor, and the size of its batches.

use crate::plan::{Estimator, RunPlan};
use crate::rng::Points;
use crate::scene::{Scene, SensorId};
use crate::transport::backward::paths::{Backward, Weights};
use crate::transport::choose::pilot::choose;
use crate::transport::estimators::{Portion, Prepared};
use crate::transport::forward::Forward;
use crate::transport::gather::estimator::{Combination, Gather};
use crate::transport::gather::settings::{WAVE_PASSES, groups, passes_in_turn};
use crate::transport::gather::trial::{PassWork, pass_work};
use crate::transport::run::rounds::{Phase, Run};
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::Series;
use crate::transport::tally::readings::GROUPS;
use crate::transport::tally::work;
use crate::transport::trial::PhotonPilot;
use crate::transport::{EstimatorChoice, GatherSettings, Readings, Stepping};
use std::time::{Duration, Instant};

/// Target number of segments of a batch: long enough that summing costs little, short enough
/// that little is lost when a run is stopped.
const BATCH_SEGMENTS: u64 = 1 << 15;
/// Most paths in a batch.
const BATCH_PATHS: u64 = 4096;
/// Most segments and paths of a batch where the number of paths is known: points fill a larger batch more evenly.
const LARGE_BATCH_SEGMENTS: u64 = 1 << 20;
const LARGE_BATCH_PATHS: u64 = 1 << 16;
/// Photon paths that measure the length of paths before a run.
const PILOT_PATHS: u64 = 64;
/// Most bounces of these paths.
const PILOT_BOUNCES: u32 = 10_000;
/// Time for which photon paths are traced to measure the time of a segment.
const TIMED: Duration = Duration::from_millis(10);
/// Most batches of [`PILOT_PATHS`] that are traced for this measurement.
const TIMED_BATCHES: u64 = 64;
/// Share of the work for photons where all sensors are estimated backward: for the balance and for
/// light outside the aim, 1. Otherwise photons and gather paths have half each.
const PHOTON_SHARE: f64 = 0.1;

/// The work of photons in a batch.
#[derive(Debug, Clone, Copy)]
enum PhotonWork {
    /// All of it, or all but gathering: no gather path is followed to the sources.
    Alone,
    /// This share of it; gather paths that are followed to the sources have the rest.
    Shared(f64),
}

impl<'s> Run<'s> {
    /// Prepares a run that nothing stops from outside; nothing is counted yet.
    pub fn new(scene: &'s Scene, plan: &RunPlan) -> Self {
        Self::start(scene, plan, &StopSignal::default(), &mut |_| ()).expect("nothing stops it")
    }

    /// Prepares a run that a signal may stop; `None` if it did so before anything could be counted.
    /// `watch` receives the trials of a pilot. A pilot may take half of the remaining time; one
    /// that takes longer is abandoned, and sensors without an explicit estimator are estimated
    /// forward.
    pub fn start(
        scene: &'s Scene,
        plan: &RunPlan,
        signal: &StopSignal,
        watch: &mut dyn FnMut(Phase),
    ) -> Option<Self> {
        let early = signal.with_grace();
        let pilot = photon_pilot(scene, plan, &early)?;
        let segments = pilot.segments_per_path as u64;
        let (estimators, choices) = estimators(scene, plan, pilot, signal, watch)?;
        let of = |wanted| sensors_of(&estimators, wanted);
        let gathered =
            gathered(scene, plan, (&of(Estimator::Gather), &of(Estimator::Mis)), pilot, signal)?;
        let followed = [of(Estimator::Backward), of(Estimator::Mix)];
        let work = match (gathered.is_empty(), followed.iter().all(Vec::is_empty)) {
            (_, true) => PhotonWork::Alone,
            // Photons also count for the sensors that are estimated forward, or mixed.
            (true, false) if of(Estimator::Forward).is_empty() && followed[1].is_empty() => {
                PhotonWork::Shared(PHOTON_SHARE)
            }
            (_, false) => PhotonWork::Shared(0.5),
        };
        let usual = plan.batch_paths.unwrap_or(usual_batch(segments));
        let by_pass = gathered.iter().map(|(settings, _)| settings.photons).max();
        let photons = match (by_pass, work, plan.stop.paths) {
            (Some(photons), ..) => photons,
            (None, PhotonWork::Alone, Some(paths)) => photons_for(plan, paths, usual, segments),
            (None, PhotonWork::Alone, None) => usual,
            (None, PhotonWork::Shared(share), _) => {
                Points::even_count((share * usual as f64) as u64)
            }
        };
        // At least one path of each source.
        let photons = photons.max(scene.sources.len() as u64).max(1);
        let by_photons = photons as f64 * work::of_photon_path(pilot.segments_per_path);
        let others = match work {
            PhotonWork::Alone => 0.0,
            PhotonWork::Shared(share) => (1.0 - share) / share * by_photons,
        };
        let mut prepared = backward(scene, plan, &followed, others, &early)?;
        prepared.extend(gathered.into_iter().map(|(_, prepared)| prepared));
        let block_batches = prepared.iter().map(Prepared::block_batches).max().unwrap_or(1);
        let has_passes = prepared.iter().any(|one| one.portion() == Portion::Pass);
        Some(Self {
            estimators,
            choices,
            forward: Forward::new(scene, plan.seed, plan.bounce_limit, photons),
            photons: Series::default(),
            others: prepared.into_iter().map(|one| (one, Series::default())).collect(),
            block_batches,
            wave_batches: if has_passes { WAVE_PASSES } else { GROUPS },
            signal: signal.clone(),
            batches: 0,
            paths: 0,
            paths_asked: plan.stop.paths,
            batches_asked: plan.stop.batches,
        })
    }
}

/// The sensors of an estimator.
fn sensors_of(estimators: &[Estimator], wanted: Estimator) -> Vec<SensorId> {
    let all = estimators.iter().enumerate();
    all.filter(|(_, own)| **own == wanted).map(|(index, _)| SensorId::new(index)).collect()
}

/// Gather paths from sensors that are estimated backward, and mixed, with this much work in a
/// batch; `None` if the signal stopped it.
fn backward<'s>(
    scene: &'s Scene,
    plan: &RunPlan,
    followed: &[Vec<SensorId>; 2],
    work: f64,
    signal: &StopSignal,
) -> Option<Vec<Prepared<'s>>> {
    let all = followed.concat();
    if all.is_empty() {
        return Some(Vec::new());
    }
    let new = |sensors: &[SensorId]| Backward::new(scene, sensors, plan.seed, plan.bounce_limit);
    let paths = (work / new(&all).work_of_path(signal)? / all.len() as f64) as u64;
    let [alone, mixed] = followed;
    let alone = (!alone.is_empty()).then(|| Prepared::Backward(new(alone).with_paths(paths)));
    let mixed = (!mixed.is_empty())
        .then(|| Prepared::Mix(new(mixed).with_paths(paths).with_weights(Weights::Shared)));
    Some(alone.into_iter().chain(mixed).collect())
}

/// Gather paths from sensors that are gathered alone, and merged, with their settings; `None` if
/// the signal stopped it.
fn gathered<'s>(
    scene: &'s Scene,
    plan: &RunPlan,
    (alone, merged): (&[SensorId], &[SensorId]),
    pilot: PhotonPilot,
    signal: &StopSignal,
) -> Option<Vec<(GatherSettings, Prepared<'s>)>> {
    if alone.is_empty() && merged.is_empty() {
        return Some(Vec::new());
    }
    let early = signal.with_grace();
    let left = signal.work_left(|| time_of_segment(scene, plan, &early));
    let pilot = if merged.is_empty() { pilot } else { pilot.step_by_step() };
    let pilot = pilot.with_passes_for(plan, left.map(|segments| segments / passes_in_turn()));
    let mut gathers = Vec::new();
    for (sensors, combination) in [(alone, Combination::Alone), (merged, Combination::Merged)] {
        if sensors.is_empty() {
            continue;
        }
        for group in groups(scene, plan, (sensors, alone.len() + merged.len()), pilot, &early)? {
            gathers.push((Gather::prepare(scene, plan, (&group, combination), pilot), combination));
        }
    }
    let all: Option<Vec<PassWork>> =
        gathers.iter().map(|(own, _)| pass_work(own, plan, pilot, &early)).collect();
    let factor = PassWork::of_all(&all?).size_for(pilot.pass_work);
    for (own, _) in &mut gathers {
        own.settings = own.settings.with_passes_of_size(factor, &plan.gather);
    }
    let prepared = gathers.into_iter().map(|(own, combination)| {
        let settings = own.settings;
        match combination {
            Combination::Alone => (settings, Prepared::Gather(own)),
            Combination::Merged => (settings, Prepared::Mis(own)),
        }
    });
    Some(prepared.collect())
}

/// Suitable number of photon paths of a batch for a scene, where a run may end after any batch.
pub fn batch_paths(scene: &Scene, plan: &RunPlan) -> u64 {
    let pilot = photon_pilot(scene, plan, &StopSignal::default());
    usual_batch(pilot.expect("nothing stops it").segments_per_path as u64)
}

fn usual_batch(segments_per_path: u64) -> u64 {
    Points::even_count((BATCH_SEGMENTS / segments_per_path).min(BATCH_PATHS))
}

/// Photon paths of a batch without other paths: the requested ones are divided evenly among the batches of whole waves. A power
/// of two would often need smaller batches, which lose more than it gains.
fn photons_for(plan: &RunPlan, paths: u64, usual: u64, segments_per_path: u64) -> u64 {
    let may_end_early = plan.stop.time.is_some() || plan.stop.target.is_some();
    let most = if may_end_early || plan.batch_paths.is_some() {
        usual
    } else {
        usual.max((LARGE_BATCH_SEGMENTS / segments_per_path).min(LARGE_BATCH_PATHS))
    };
    let waves = paths.div_ceil(GROUPS * most).max(1);
    paths.div_ceil(plan.stop.batches.unwrap_or(GROUPS * waves))
}

/// Measures the length of photon paths from a few of them; `None` if they were stopped.
fn photon_pilot(scene: &Scene, plan: &RunPlan, signal: &StopSignal) -> Option<PhotonPilot> {
    let limit = plan.bounce_limit.min(PILOT_BOUNCES);
    let forward = Forward::new(scene, plan.seed, limit, PILOT_PATHS);
    let jumped = forward.batch(0, signal)?;
    let stepped = forward.batch_observed(0, &mut Stepping, &Pace::new(signal))?;
    let per_path = |pilot: &Readings| pilot.segments.div_ceil(pilot.paths().max(1)).max(1) as f64;
    let (segments, steps) = (per_path(&jumped), per_path(&stepped));
    // Light that the pilot cuts off continues, at most to the bounce limit of the run.
    let flux = scene.source_flux();
    let cut = stepped.groups[0].sums[forward.layout.cut()];
    let rest = if flux > 0.0 { cut / flux * f64::from(plan.bounce_limit - limit) } else { 0.0 };
    let rest = rest.floor();
    Some(PhotonPilot::new((segments + rest * (segments / steps).min(1.0)).floor(), steps + rest))
}

/// Time of a segment of a photon path, s, by the clock: the lower quartile of short measurements, since other programs
/// lengthen some of them. `None` if stopped.
fn time_of_segment(scene: &Scene, plan: &RunPlan, signal: &StopSignal) -> Option<f64> {
    let limit = plan.bounce_limit.min(PILOT_BOUNCES);
    let forward = Forward::new(scene, plan.seed, limit, PILOT_PATHS);
    let (start, mut times) = (Instant::now(), Vec::new());
    for batch in 0..TIMED_BATCHES {
        let began = Instant::now();
        let segments = forward.batch(batch, signal)?.segments.max(1);
        times.push(began.elapsed().as_secs_f64() / segments as f64);
        if start.elapsed() >= TIMED {
            break;
        }
    }
    times.sort_by(f64::total_cmp);
    Some(times[times.len() / 4])
}

/// The estimator of each sensor: its own, the requested one, or a pilot's choice.
fn estimators(
    scene: &Scene,
    plan: &RunPlan,
    pilot: PhotonPilot,
    signal: &StopSignal,
    watch: &mut dyn FnMut(Phase),
) -> Option<(Vec<Estimator>, Vec<EstimatorChoice>)> {
    let own = |sensor: usize| plan.own_estimator(sensor);
    let sensors = 0..scene.sensors.len();
    let all = |estimator: Estimator| {
        let estimators = sensors.clone().map(|sensor| own(sensor).unwrap_or(estimator));
        Some((estimators.collect(), Vec::new()))
    };
    if let Some(estimator) = plan.estimator.estimator() {
        return all(estimator);
    }
    if sensors.clone().all(|sensor| own(sensor).is_some()) {
        return all(Estimator::Forward);
    }
    let mut tried = |estimator| watch(Phase::Pilot(estimator));
    let left = signal.work_left(|| time_of_segment(scene, plan, &signal.with_grace()));
    let choices = choose(scene, plan, (pilot, left), &signal.with_half(), &mut tried);
    let Some(mut choices) = choices else {
        // The best is unknown; photons find something everywhere.
        return if signal.is_due() { None } else { all(Estimator::Forward) };
    };
    for (sensor, choice) in choices.iter_mut().enumerate() {
        choice.chosen = own(sensor).unwrap_or(choice.chosen);
    }
    Some((choices.iter().map(|choice| choice.chosen).collect(), choices))
}
