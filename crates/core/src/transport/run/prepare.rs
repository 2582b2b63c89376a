//! Decisions before a run: the estimator of each sensor, and the size of its batches.

use crate::plan::{Estimator, RunPlan};
use crate::scene::{Scene, SensorId};
use crate::transport::backward::learning::LEARNING;
use crate::transport::backward::paths::{Backward, Weights};
use crate::transport::batches::{BatchSizes, EQUAL_SHARE, LEAST_SHARE, usual_batch};
use crate::transport::choose::pilot::choose;
use crate::transport::estimators::{Portion, Prepared};
use crate::transport::forward::Forward;
use crate::transport::gather::estimator::{Combination, Gather};
use crate::transport::gather::settings::{WAVE_PASSES, groups, passes_in_turn};
use crate::transport::gather::trial::{PassWork, pass_work};
use crate::transport::photon_pilot::PhotonPilot;
use crate::transport::run::rounds::{Phase, Run};
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::Series;
use crate::transport::tally::readings::GROUPS;
use crate::transport::tally::work;
use crate::transport::{EstimatorChoice, GatherSettings, Readings, Stepping};
use std::time::{Duration, Instant};

/// Photon paths that measure the length of paths before a run.
const PILOT_PATHS: u64 = 64;
/// Most bounces of these paths.
const PILOT_BOUNCES: u32 = 10_000;
/// Time for which photon paths are traced to measure the speed of the machine.
const TIMED: Duration = Duration::from_millis(10);
/// Most batches of [`PILOT_PATHS`] that are traced for this measurement.
const TIMED_BATCHES: u64 = 64;
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
        let (estimators, choices) = estimators(scene, plan, pilot, signal, watch)?;
        let of = |wanted| sensors_of(&estimators, wanted);
        let gathered =
            gathered(scene, plan, (&of(Estimator::Gather), &of(Estimator::Mis)), pilot, signal)?;
        let followed = [of(Estimator::Backward), of(Estimator::Mix)];
        let work = match (gathered.is_empty(), followed.iter().all(Vec::is_empty)) {
            (_, true) => PhotonWork::Alone,
            // Photons also count for the sensors that are estimated forward, or mixed.
            (true, false) if of(Estimator::Forward).is_empty() && followed[1].is_empty() => {
                PhotonWork::Shared(LEAST_SHARE)
            }
            (_, false) => PhotonWork::Shared(EQUAL_SHARE),
        };
        let sizes = BatchSizes::new(plan, pilot, signal.work_left(pilot.speed));
        let by_pass = gathered.iter().map(|(settings, _)| settings.photons).max();
        let mut photons = match (by_pass, work) {
            (Some(photons), _) => photons,
            (None, PhotonWork::Alone) => sizes.photons(),
            (None, PhotonWork::Shared(share)) => sizes.shared(share).0,
        };
        // At least one path of each source.
        photons = photons.max(scene.sources.len() as u64).max(1);
        let by_photons = photons as f64 * work::of_photon_path(pilot.segments_per_path);
        let (mut prepared, mut batches_asked) = (Vec::new(), plan.stop.batches);
        if let PhotonWork::Shared(share) = work {
            let others = (1.0 - share) / share * by_photons;
            let (usual, of_path) = backward(scene, plan, &followed, others, &early)?;
            let paths =
                |all: &[Prepared<'_>]| all.iter().map(|own| own.batch_paths(0)).sum::<u64>();
            let growth = match by_pass {
                Some(_) => 1,
                None => {
                    let gathered = paths(&usual);
                    sizes.growth(photons + gathered, gathered as f64 * of_path + by_photons)
                }
            };
            photons *= growth;
            prepared = usual.into_iter().map(|own| own.resized([growth, 1])).collect();
            if let (Some(asked), true) = (plan.stop.paths, growth > 1) {
                batches_asked.get_or_insert(asked.div_ceil(photons + paths(&prepared)));
            }
        }
        prepared.extend(gathered.into_iter().map(|(_, prepared)| prepared));
        let block_batches = prepared.iter().map(Prepared::block_batches).max().unwrap_or(1);
        let has_passes = prepared.iter().any(|one| one.portion() == Portion::Pass);
        let forward = Forward::new(scene, plan.seed, plan.bounce_limit, photons);
        Some(Self {
            estimators,
            choices,
            forward: if has_passes { forward.of_passes() } else { forward },
            photons: Series::default(),
            others: prepared.into_iter().map(|one| (one, Series::default())).collect(),
            block_batches,
            wave_batches: if has_passes { WAVE_PASSES } else { GROUPS },
            signal: signal.clone(),
            batches: 0,
            paths: 0,
            paths_asked: plan.stop.paths,
            batches_asked,
            paths_planned: plan.stop.paths_for_stages(),
        })
    }
}

/// The sensors of an estimator.
fn sensors_of(estimators: &[Estimator], wanted: Estimator) -> Vec<SensorId> {
    let all = estimators.iter().enumerate();
    all.filter(|(_, own)| **own == wanted).map(|(index, _)| SensorId::new(index)).collect()
}

/// Gather paths from sensors that are estimated backward, and mixed, with about this much work in a
/// batch, and the work of each, ns; `None` if the signal stopped it.
fn backward<'s>(
    scene: &'s Scene,
    plan: &RunPlan,
    followed: &[Vec<SensorId>; 2],
    work: f64,
    signal: &StopSignal,
) -> Option<(Vec<Prepared<'s>>, f64)> {
    let all = followed.concat();
    if all.is_empty() {
        return Some((Vec::new(), 0.0));
    }
    let new = |sensors: &[SensorId]| Backward::new(scene, sensors, plan.seed, plan.bounce_limit);
    let of_path = new(&all).work_of_path(signal)?;
    let paths = (work / of_path / all.len() as f64) as u64;
    let [alone, mixed] = followed;
    let mut prepared = Vec::new();
    if !alone.is_empty() {
        let own = new(alone).in_cells().with_paths(paths);
        // The same however long the run is, so that one that is continued has the same paths.
        let laws = own.learned_laws(LEARNING / of_path, signal)?;
        let own = own.with_laws(&laws);
        prepared.push(Prepared::Backward(own));
    }
    if !mixed.is_empty() {
        let own = new(mixed).with_paths(paths).with_weights(Weights::Shared);
        prepared.push(Prepared::Mix(own));
    }
    Some((prepared, of_path))
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
    let left = signal.work_left(pilot.speed);
    let pilot = if merged.is_empty() { pilot } else { pilot.step_by_step() };
    let pilot = pilot.with_passes_for(plan, left.map(|work| work / passes_in_turn()));
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
    usual_batch(pilot.expect("nothing stops it"))
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
    let speed = if signal.is_timed() { speed(scene, plan, signal)? } else { 1.0 };
    let per_path = (segments + rest * (segments / steps).min(1.0)).floor();
    Some(PhotonPilot { speed, ..PhotonPilot::new(per_path, steps + rest) })
}

/// Work of photon paths in a second by the clock, over that of the reference machine (`work`): the upper quartile of short
/// measurements, since other programs lower some of them. `None` if stopped.
fn speed(scene: &Scene, plan: &RunPlan, signal: &StopSignal) -> Option<f64> {
    let limit = plan.bounce_limit.min(PILOT_BOUNCES);
    let forward = Forward::new(scene, plan.seed, limit, PILOT_PATHS);
    let (start, mut speeds) = (Instant::now(), Vec::new());
    for batch in 0..TIMED_BATCHES {
        let began = Instant::now();
        let work = work::of_photons(&forward.batch(batch, signal)?);
        speeds.push(1e-9 * work / began.elapsed().as_secs_f64().max(1e-9));
        if start.elapsed() >= TIMED {
            break;
        }
    }
    speeds.sort_by(|a, b| b.total_cmp(a));
    Some(speeds[speeds.len() / 4])
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
    let left = signal.work_left(pilot.speed);
    let choices = choose(scene, plan, (pilot, left), &signal.with_half(), &mut tried);
    let Some(choices) = choices else {
        // The best is unknown; photons find something everywhere.
        return if signal.is_due() { None } else { all(Estimator::Forward) };
    };
    Some((choices.iter().map(|choice| choice.chosen).collect(), choices))
}
