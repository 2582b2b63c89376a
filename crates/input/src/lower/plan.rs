//! The run and the checks.

use crate::keys::Key;
use crate::problems::{Problems, name_hint};
use crate::spec::SceneSpec;
use crate::spec::run::{CheckSpec, EstimatorSpec, GatherSpec, ScheduleSpec, SensorEstimatorSpec};
use lumiduct_core::plan::{
    Check, Estimator, GatherPlan, Request, RunPlan, Schedule, StopRules, Target,
};
use lumiduct_core::scene::{Scene, Sensor};
use std::time::Duration;

/// Paths of a run without a stop rule.
const DEFAULT_PATHS: u64 = 2_000_000;

pub(super) fn run(spec: &SceneSpec) -> RunPlan {
    let run = &spec.run;
    let target = run.target.as_ref().map(|target| Target {
        measure: target.measure.clone(),
        relative_error: target.relative_error,
    });
    let none = run.paths.is_none() && run.time_s.is_none() && target.is_none();
    RunPlan {
        estimator: request(run.estimator),
        sensor_estimators: Vec::new(),
        gather: gather(&run.gather),
        seed: run.seed,
        bounce_limit: run.bounce_limit,
        batch_paths: None,
        stop: StopRules {
            paths: if none { Some(DEFAULT_PATHS) } else { run.paths },
            batches: run.batches,
            // Validated as positive; a time beyond what a clock can hold is no limit.
            time: run.time_s.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
            target,
        },
    }
}

/// The estimators set for single sensors, in the order of the scene.
pub(super) fn sensor_estimators(spec: &SceneSpec, scene: &Scene) -> Vec<Option<Estimator>> {
    let of_sensor = |sensor: &Sensor| {
        spec.sensors.get(&sensor.name)?.estimator.map(|estimator| match estimator {
            SensorEstimatorSpec::Forward => Estimator::Forward,
            SensorEstimatorSpec::Backward => Estimator::Backward,
            SensorEstimatorSpec::Mix => Estimator::Mix,
            SensorEstimatorSpec::Gather => Estimator::Gather,
            SensorEstimatorSpec::Mis => Estimator::Mis,
        })
    };
    scene.sensors.iter().map(of_sensor).collect()
}

/// The requested estimator of flux.
pub(crate) fn request(spec: EstimatorSpec) -> Request {
    match spec {
        EstimatorSpec::Auto => Request::Auto,
        EstimatorSpec::Forward => Request::Forward,
        EstimatorSpec::Backward => Request::Backward,
        EstimatorSpec::Mix => Request::Mix,
        EstimatorSpec::Gather => Request::Gather,
        EstimatorSpec::Mis => Request::Mis,
    }
}

fn gather(spec: &GatherSpec) -> GatherPlan {
    GatherPlan {
        depth: spec.depth,
        radius: spec.radius_mm,
        theta_max: spec.angle_deg.map(f64::to_radians),
        records: spec.records,
        photons: spec.photons,
        schedule: match spec.schedule {
            ScheduleSpec::Stages => Schedule::Stages,
            ScheduleSpec::PerPass => Schedule::PerPass,
        },
    }
}

/// A demand on a measure.
pub(crate) fn check(spec: &CheckSpec) -> Check {
    Check {
        measure: spec.measure.clone(),
        min: spec.min,
        max: spec.max,
        equals: spec.equals,
        within: spec.within,
        sigmas: spec.sigmas,
        max_std_error: spec.max_std_error,
        source: spec.source.clone(),
    }
}

/// Notes checks and targets whose measure cannot exist: the first word must be a sensor or `balance`.
pub(super) fn check_measures(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    let mut known: Vec<&str> = scene.sensors.iter().map(|sensor| sensor.name.as_str()).collect();
    known.push("balance");
    let mut judge = |measure: &str, key: &Key| {
        let first = measure.split('.').next().unwrap_or_default();
        if !known.contains(&first) {
            let hint = name_hint(first, known.iter().copied());
            problems.error(key, format!("`{measure}` names no sensor")).hint(hint);
        }
    };
    if let Some(target) = &spec.run.target {
        judge(&target.measure, &Key::of(&["run", "target", "measure"]));
    }
    for (index, check) in spec.check.iter().enumerate() {
        judge(&check.measure, &Key::of(&["check"]).index(index).field("measure"));
    }
}
