//! The run and the checks.

use crate::keys::Key;
use crate::lower::context::Context;
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

pub(super) fn run(spec: &SceneSpec, scene: &Scene) -> RunPlan {
    let run = &spec.run;
    let target = run.target.as_ref().map(|target| Target {
        measure: target.measure.clone(),
        relative_error: target.relative_error,
    });
    let none = run.paths.is_none() && run.time_s.is_none() && target.is_none();
    RunPlan {
        estimator: request(run.estimator),
        sensor_estimators: sensor_estimators(spec, scene),
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
fn sensor_estimators(spec: &SceneSpec, scene: &Scene) -> Vec<Option<Estimator>> {
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

/// Demands on measures; those that nothing can meet are noted.
pub(crate) fn checks(specs: &[CheckSpec], problems: &mut Problems) -> Vec<Check> {
    let lower = |(index, spec)| check(spec, &Key::of(&["check"]).index(index), problems);
    specs.iter().enumerate().map(lower).collect()
}

fn check(spec: &CheckSpec, key: &Key, problems: &mut Problems) -> Check {
    if let (Some(min), Some(max)) = (spec.min, spec.max)
        && min > max
    {
        problems.error(&key.field("min"), format!("{min} is above `max`, which is {max}"));
    }
    for (name, is_given) in [("within", spec.within.is_some()), ("sigmas", spec.sigmas.is_some())] {
        if is_given && spec.equals.is_none() {
            problems
                .error(&key.field(name), "is only for `equals`")
                .hint(format!("remove `{name}`"));
        }
    }
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

impl Context<'_> {
    /// Notes checks and targets whose measure cannot exist: the first word must be a sensor or
    /// `balance`.
    pub(super) fn check_measures(&mut self) {
        let spec = self.spec;
        let known: Vec<&str> = self.names("sensors").into_iter().chain(["balance"]).collect();
        let target =
            spec.run.target.iter().map(|target| (&target.measure, Key::of(&["run", "target"])));
        let checks = spec.check.iter().enumerate();
        let checks =
            checks.map(|(index, check)| (&check.measure, Key::of(&["check"]).index(index)));
        for (measure, key) in target.chain(checks) {
            let first = measure.split('.').next().unwrap_or_default();
            if !known.contains(&first) {
                let hint = name_hint(first, known.iter().copied());
                let message = format!("`{measure}` names no sensor");
                self.problems.error(&key.field("measure"), message).hint(hint);
            }
        }
    }
}
