//! The run and the checks.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::problems::{Problems, name_hint};
use crate::spec::SceneSpec;
use lumiduct_core::plan::{Check, Estimator, RunPlan, StopRules};
use lumiduct_core::scene::{Scene, Sensor};
use std::time::Duration;

/// Paths of a run without a stop rule.
const DEFAULT_PATHS: u64 = 2_000_000;

pub(super) fn run(spec: &SceneSpec, scene: &Scene) -> RunPlan {
    let run = &spec.run;
    let none = run.paths.is_none() && run.time_s.is_none() && run.target.is_none();
    RunPlan {
        estimator: run.estimator,
        sensor_estimators: sensor_estimators(spec, scene),
        gather: run.gather,
        seed: run.seed,
        bounce_limit: run.bounce_limit,
        batch_paths: None,
        stop: StopRules {
            paths: if none { Some(DEFAULT_PATHS) } else { run.paths },
            batches: run.batches,
            planned_paths: run.planned_paths,
            // Validated as positive; a time beyond what a clock can hold is no limit.
            time: run.time_s.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
            target: run.target.clone(),
        },
    }
}

/// The estimators set for single sensors, in the order of the scene.
fn sensor_estimators(spec: &SceneSpec, scene: &Scene) -> Vec<Option<Estimator>> {
    let of_sensor = |sensor: &Sensor| spec.sensors.get(&sensor.name)?.estimator;
    scene.sensors.iter().map(of_sensor).collect()
}

/// Notes checks that nothing can meet.
pub(crate) fn checks(checks: &[Check], problems: &mut Problems) {
    for (index, one) in checks.iter().enumerate() {
        check(one, &Key::of(&["check"]).index(index), problems);
    }
}

fn check(spec: &Check, key: &Key, problems: &mut Problems) {
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
