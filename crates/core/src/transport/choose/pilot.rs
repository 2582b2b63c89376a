//! The choice between the estimators, by measurement: a pilot of each on every sensor.
//!
//! The work to reach a relative error is t = work × relative variance / error², and at least that of the passes without which
//! gathering gives no result. The pilot measures it for forward, backward, their mix and gather with a small part of the
//! budget, in counted work, never in time, and takes the smallest t. The budget of a run to a target is what the best needs
//! according to a first, small pilot. Gathering is excluded if there is an objection: a bias above the target and its noise, or
//! a flux that the best of the unbiased ones contradicts. Windows alone cannot see a feature that is smaller than all of them.
//! An unbiased estimator is excluded if it found too little compared with another: its variance does not contain what it has
//! missed so far. Sensors that want different estimators agree on a few.

use crate::plan::{Estimator, RunPlan};
use crate::scene::{Scene, SensorId};
use crate::tally::Tally;
use crate::transport::batches::BatchSizes;
use crate::transport::choose::choice::EstimatorChoice;
use crate::transport::choose::sharing::{Wanted, in_common};
use crate::transport::estimators;
use crate::transport::gather::settings::passes_in_turn;
use crate::transport::photon_pilot::PhotonPilot;
use crate::transport::stop::StopSignal;
use crate::transport::tally::work;
use crate::transport::trial::{Objection, Trial, Trials, Tried};

/// Share of the budget of a run that is planned for trials, 1: with their preparation, the pilot takes 5 %.
const SHARE: f64 = 0.04;
/// Default budget of a run: a minute of one thread, s.
const USUAL_BUDGET: f64 = 60.0;
/// Shortest and longest time of a pilot, s.
const BOUNDS: [f64; 2] = [0.1, 4.0];
/// A second pilot is worthwhile if it may take this many times as long as the first, 1.
const WORTH_ANOTHER: f64 = 3.0;
/// Relative error of a flux that may contradict another: that of ten counts, 1.
const KNOWN: f64 = 0.32;
/// Standard errors beyond which a difference is significant.
const SIGMAS: f64 = 3.0;
/// The same where an estimator is compared with every other, source by source: among many differences some are large by chance.
const SIGMAS_OF_MANY: f64 = 4.0;
/// Possible relative rounding of a flux, 1.
const ROUNDING: f64 = 1e-9;
/// Relative bias allowed if there is no target, 1.
const USUAL_TARGET: f64 = 0.01;

/// Tries the estimators on all sensors and chooses; `None` if stopped before anything was known. If time is limited, `left`
/// ns of work of one thread fit in what remains. `watch` receives the current trial.
pub(crate) fn choose(
    scene: &Scene,
    plan: &RunPlan,
    (photons, left): (PhotonPilot, Option<f64>),
    signal: &StopSignal,
    watch: &mut dyn FnMut(Estimator),
) -> Option<Vec<EstimatorChoice>> {
    let sensors: Vec<SensorId> = (0..scene.sensors.len()).map(SensorId::new).collect();
    let photons = photons.with_passes_for(plan, left.map(|work| work / passes_in_turn()));
    let sizes = BatchSizes::new(plan, photons, left);
    let given = budget(plan, photons, left.map(|work| 1e-9 * work));
    let [least, most] = BOUNDS.map(|bound| photons.speed * bound);
    let mut choices = |budget: f64| {
        let effort = 1e9 * (SHARE * budget).clamp(least, most) / Estimator::TRIED.len() as f64;
        let sensors = &sensors;
        let trials = Trials { scene, plan, photons, sensors, effort, sizes, signal };
        choices(&trials, budget, watch)
    };
    let found = match &plan.stop.target {
        None => choices(given.unwrap_or(USUAL_BUDGET))?,
        Some(target) => {
            let first = choices(least / SHARE)?;
            let time = |choice: &EstimatorChoice| {
                choice.time(target.relative_error).unwrap_or(USUAL_BUDGET)
            };
            let needed = first.iter().map(time).fold(0.0, f64::max);
            let needed = needed.min(given.unwrap_or(f64::INFINITY));
            let second =
                if SHARE * needed > WORTH_ANOTHER * least { choices(needed) } else { None };
            second.unwrap_or(first)
        }
    };
    Some(found.into_iter().map(|choice| choice.at_speed(photons.speed)).collect())
}

/// Budget of a run in seconds of one thread of the reference machine; `left` of them remain if time is limited. `None` if
/// it has only a target. A number of paths is worth their work step by step: estimators that jump need less of it.
fn budget(plan: &RunPlan, photons: PhotonPilot, left: Option<f64>) -> Option<f64> {
    let path = 1e-9 * work::of_photon_path(photons.steps_per_path);
    let by_paths = plan.stop.paths.map(|paths| paths as f64 * path);
    by_paths.into_iter().chain(left).reduce(f64::min)
}

/// Tries all permitted estimators on each sensor, for a run of this many seconds; `None` if
/// stopped.
fn choices(
    trials: &Trials<'_>,
    budget: f64,
    watch: &mut dyn FnMut(Estimator),
) -> Option<Vec<EstimatorChoice>> {
    let Trials { scene, plan, sensors, .. } = trials;
    if sensors.is_empty() {
        return Some(Vec::new());
    }
    let mut tried: Vec<Vec<Tried>> = Vec::new();
    for estimator in Estimator::TRIED.into_iter().filter(|one| one.is_worth_a_trial(scene)) {
        watch(estimator);
        tried.push(estimators::trial(estimator, trials)?);
    }
    let target = plan.stop.target.as_ref().map(|target| target.relative_error);
    let of_sensor = |sensor: &SensorId| {
        let own = &scene.sensors[sensor.index()];
        let tried: Vec<&Tried> = tried.iter().map(|tried| &tried[sensor.index()]).collect();
        let able = tried.iter().filter(|tried| tried.trial.estimator.can_estimate(own));
        let judged = able.map(|one| Trial {
            objection: objection(one, &tried, target.unwrap_or(USUAL_TARGET)),
            ..one.trial.clone()
        });
        let tried: Vec<Trial> = judged.collect();
        let error = target.or_else(|| least_error(&tried, budget));
        let own = plan.own_estimator(sensor.index());
        let chosen = own.unwrap_or_else(|| best(&tried, error));
        Wanted { choice: EstimatorChoice { chosen, tried }, error, is_given: own.is_some() }
    };
    Some(in_common(sensors.iter().map(of_sensor).collect()))
}

/// The relative error that the best reaches within a budget, s; `None` where none found anything.
fn least_error(tried: &[Trial], budget: f64) -> Option<f64> {
    let costs = tried.iter().filter_map(|trial| trial.cost);
    costs.min_by(f64::total_cmp).map(|cost| (cost / budget).sqrt())
}

/// The fastest estimator without an objection; forward if none found anything.
fn best(tried: &[Trial], error: Option<f64>) -> Estimator {
    let fit = tried.iter().filter(|trial| trial.objection.is_none());
    let known = fit.filter_map(|trial| Some((trial.time(error?)?, trial.estimator)));
    known.min_by(|(a, _), (b, _)| a.total_cmp(b)).map_or(Estimator::Forward, |(_, best)| best)
}

/// Standard error over value; infinite or NaN in the dark.
fn relative_error(flux: &Tally) -> f64 {
    flux.std_error() / flux.mean()
}

/// The objection to an estimator, given the results of all.
fn objection(one: &Tried, all: &[&Tried], target: f64) -> Option<Objection> {
    let unbiased = all.iter().copied().filter(|tried| tried.bias.is_none());
    match &one.bias {
        None => misses_light(one, unbiased).then_some(Objection::Contradicted),
        Some(bias) => objection_to_biased(one, bias, unbiased, target),
    }
}

/// Whether an unbiased estimator found less of the light of a source than another, beyond their errors.
fn misses_light<'a>(tried: &Tried, mut others: impl Iterator<Item = &'a Tried>) -> bool {
    others.any(|other| {
        tried.by_source.iter().zip(&other.by_source).any(|(own, other)| {
            let error = own.std_error().hypot(other.std_error());
            let room = SIGMAS_OF_MANY * error + ROUNDING * own.mean().abs();
            relative_error(other) < KNOWN && other.mean() - own.mean() > room
        })
    })
}

/// The objection to a biased flux, given the results of the unbiased estimators.
fn objection_to_biased<'a>(
    tried: &Tried,
    bias: &Tally,
    unbiased: impl Iterator<Item = &'a Tried>,
    target: f64,
) -> Option<Objection> {
    let flux = &tried.flux;
    tried.trial.cost?;
    let allowed = target * flux.mean().abs();
    if bias.mean().abs() > allowed + SIGMAS * bias.std_error() {
        return Some(Objection::Biased);
    }
    let other = unbiased
        .filter(|tried| relative_error(&tried.flux) < KNOWN)
        .min_by(|a, b| relative_error(&a.flux).total_cmp(&relative_error(&b.flux)))?;
    let error = flux.std_error().hypot(other.flux.std_error());
    let off = (flux.mean() - other.flux.mean()).abs();
    (off > allowed + SIGMAS * error).then_some(Objection::Contradicted)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(estimator: Estimator, cost: Option<f64>) -> Trial {
        Trial { estimator, cost, bias: None, least: 0.0, objection: None }
    }

    fn tried(estimator: Estimator, fluxes: [f64; 4]) -> Tried {
        let by_source = vec![Tally::of(fluxes)];
        let trial = trial(estimator, Some(1.0));
        Tried { trial, flux: Tally::of(fluxes), by_source, bias: None }
    }

    fn gathered(fluxes: [f64; 4], bias: [f64; 4]) -> Tried {
        Tried { bias: Some(Tally::of(bias)), ..tried(Estimator::Gather, fluxes) }
    }

    #[test]
    fn the_quickest_estimator_without_an_objection_is_chosen() {
        let mut trials = vec![
            trial(Estimator::Forward, Some(3e-4)),
            trial(Estimator::Backward, None),
            trial(Estimator::Gather, Some(1e-4)),
        ];
        assert_eq!(best(&trials, Some(0.01)), Estimator::Gather);
        trials[2].least = 2.0;
        assert_eq!(best(&trials, Some(0.01)), Estimator::Gather, "2 s instead of 3 s");
        assert_eq!(best(&trials, Some(0.02)), Estimator::Forward, "2 s instead of 0.75 s");
        trials[2].objection = Some(Objection::Biased);
        assert_eq!(best(&trials, Some(0.01)), Estimator::Forward);
        trials[0].cost = None;
        assert_eq!(best(&trials, Some(0.01)), Estimator::Forward, "in the dark");
        assert_eq!(best(&trials, None), Estimator::Forward, "in the dark");
    }

    #[test]
    fn a_choice_knows_the_time_of_what_was_chosen() {
        let forward = trial(Estimator::Forward, Some(3e-4));
        let gather = Trial { least: 1.5, ..trial(Estimator::Gather, Some(1e-4)) };
        let choice = EstimatorChoice { chosen: Estimator::Gather, tried: vec![forward, gather] };
        assert_eq!(choice.time(0.005), Some(4.0));
        assert_eq!(choice.time(0.02), Some(1.5));
        assert!((least_error(&choice.tried, 4.0).unwrap() - 0.005).abs() < 1e-12);
    }

    #[test]
    fn a_known_bias_lengthens_the_time_to_an_error_below_it() {
        let gather = Trial { bias: Some(0.02), ..trial(Estimator::Gather, Some(1e-4)) };
        let time = |error| gather.time(error).unwrap();
        assert!((time(0.1) - 0.01).abs() < 1e-12, "the error is above the bias");
        assert!((time(0.01) - 3.0).abs() < 1e-3, "three times as long as by noise alone");
    }

    #[test]
    fn a_bias_beyond_target_and_noise_is_an_objection() {
        let target = 0.01;
        let with = |apart| objection(&gathered([1.0; 4], apart), &[], target);
        assert_eq!(with([0.2, 0.21, 0.2, 0.19]), Some(Objection::Biased));
        assert_eq!(with([0.009; 4]), None, "within the target");
        assert_eq!(with([0.3, -0.2, 0.25, -0.15]), None, "noise");
    }

    #[test]
    fn an_estimator_that_has_missed_light_is_left_out() {
        let sharp = tried(Estimator::Backward, [1.0, 1.001, 0.999, 1.0]);
        let all = tried(Estimator::Forward, [1.8, 2.2, 2.1, 1.9]);
        let noisy = tried(Estimator::Forward, [0.0, 6.0, 0.0, 2.0]);
        assert!(misses_light(&sharp, [&all, &sharp].into_iter()));
        assert!(!misses_light(&all, [&all, &sharp].into_iter()), "less is no reason to doubt more");
        assert!(!misses_light(&sharp, [&noisy, &sharp].into_iter()), "noise");
    }

    #[test]
    fn the_better_of_the_unbiased_estimators_contradicts_a_flux() {
        let flux = gathered([0.50, 0.52, 0.49, 0.49], [0.0; 4]);
        let noisy = tried(Estimator::Forward, [0.0, 2.0, 0.0, 0.0]);
        let sharp = tried(Estimator::Backward, [1.0, 1.02, 0.99, 0.99]);
        let dark = tried(Estimator::Backward, [0.0; 4]);
        let one_event = tried(Estimator::Forward, [0.004, 0.0, 0.0, 0.0]);
        let with = |others: &[&Tried]| objection(&flux, others, 0.01);
        assert_eq!(with(&[&noisy, &sharp]), Some(Objection::Contradicted));
        assert_eq!(with(&[&noisy, &dark]), None, "what saw nothing says nothing");
        assert_eq!(with(&[&one_event]), None, "one weak event says nothing");
        assert_eq!(with(&[]), None);
    }
}
