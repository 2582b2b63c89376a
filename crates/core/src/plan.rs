//! Run settings: how to estimate, when to stop, and what to check.
//!
//! Scene files, the command line, checkpoints and reports share these types, their names in files
//! and their schema; the documentation of keys and values becomes the manual.

mod polarisation;

pub use polarisation::Polarisation;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Version of the numerics. Every change that alters a committed report raises it, so that a
/// report, a checkpoint or a record from older numerics is never mistaken for a current one.
pub const NUMERICS: u32 = 23;

/// How to trace and when to stop. Its names in files are part of the identity of a run, and stay
/// fixed when the code changes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunPlan {
    /// The requested estimator.
    #[serde(rename = "estimator")]
    pub estimator: Request,
    /// Estimators of single sensors, in sensor order; the others follow `estimator`.
    #[serde(rename = "sensor_estimators")]
    pub sensor_estimators: Vec<Option<Estimator>>,
    /// Settings for the gather estimator.
    #[serde(rename = "gather")]
    pub gather: GatherPlan,
    /// Seed of all random streams.
    #[serde(rename = "seed")]
    pub seed: u64,
    /// Paths are cut at this depth: after this many interfaces and scatterings within media. The flux they
    /// carry is a line of the balance.
    #[serde(rename = "bounce_limit")]
    pub bounce_limit: u32,
    /// Photon paths of a batch; `None` chooses it by the length of paths. Runs with the same number
    /// have the same paths in the same batches.
    #[serde(rename = "batch_paths")]
    pub batch_paths: Option<u64>,
    /// The first rule that is met ends the run.
    #[serde(rename = "stop")]
    pub stop: StopRules,
}

/// How flux is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Request {
    /// For each sensor the best estimator found by a short pilot run; the report names the choice and its figures.
    #[default]
    #[serde(rename = "auto")]
    Auto,
    /// Photon paths from the sources, counted by the sensors.
    #[serde(rename = "forward")]
    Forward,
    /// Gather paths from the sensors, followed until they meet a source.
    #[serde(rename = "backward")]
    Backward,
    /// Forward and backward at once, weighted path by path; sources that gather paths cannot meet are found by photons, and
    /// by connections where light is scattered.
    #[serde(rename = "mix")]
    Mix,
    /// Gather paths from the sensors that end in records, and photon paths from the sources that are gathered there.
    #[serde(rename = "gather")]
    Gather,
    /// Forward, backward and gather at once, weighted path by path (multiple importance sampling), with connections where
    /// light is scattered.
    #[serde(rename = "mis")]
    Mis,
}

impl RunPlan {
    /// The estimator requested for a sensor.
    pub fn request(&self, sensor: usize) -> Request {
        self.own_estimator(sensor).map_or(self.estimator, Estimator::request)
    }

    /// The estimator requested for this sensor alone.
    pub fn own_estimator(&self, sensor: usize) -> Option<Estimator> {
        self.sensor_estimators.get(sensor).copied().flatten()
    }
}

impl Request {
    /// All requests.
    pub const ALL: [Self; 6] =
        [Self::Auto, Self::Forward, Self::Backward, Self::Mix, Self::Gather, Self::Mis];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        self.estimator().map_or("auto", Estimator::name)
    }

    /// The request with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|request| request.name() == name)
    }

    /// The estimator it names; `None` if a pilot chooses.
    pub fn estimator(self) -> Option<Estimator> {
        match self {
            Self::Auto => None,
            Self::Forward => Some(Estimator::Forward),
            Self::Backward => Some(Estimator::Backward),
            Self::Mix => Some(Estimator::Mix),
            Self::Gather => Some(Estimator::Gather),
            Self::Mis => Some(Estimator::Mis),
        }
    }

    /// Whether gather records may be made, so that a [`GatherPlan`] matters.
    pub fn may_gather(self) -> bool {
        match self {
            Self::Auto | Self::Gather | Self::Mis => true,
            Self::Forward | Self::Backward | Self::Mix => false,
        }
    }
}

/// How flux is estimated on one sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Estimator {
    /// Photon paths from the sources, counted by the sensor.
    #[serde(rename = "forward")]
    Forward,
    /// Gather paths from the sensor, followed until they meet a source.
    #[serde(rename = "backward")]
    Backward,
    /// Forward and backward at once, weighted path by path.
    #[serde(rename = "mix")]
    Mix,
    /// Gather paths from the sensor that end in records, and photon paths that are gathered there.
    #[serde(rename = "gather")]
    Gather,
    /// Forward, backward and gather at once, weighted path by path, with connections where light is scattered; not where
    /// another sensor has `gather` or `auto`.
    #[serde(rename = "mis")]
    Mis,
}

impl Estimator {
    /// The request for it.
    pub fn request(self) -> Request {
        match self {
            Self::Forward => Request::Forward,
            Self::Backward => Request::Backward,
            Self::Mix => Request::Mix,
            Self::Gather => Request::Gather,
            Self::Mis => Request::Mis,
        }
    }

    /// Its name in files and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
            Self::Backward => "backward",
            Self::Mix => "mix",
            Self::Gather => "gather",
            Self::Mis => "mis",
        }
    }
}

/// Largest number of gather paths of a pass that may be set: they must fit into memory.
pub const MOST_RECORDS: u64 = 1 << 22;

/// Settings of the estimators `gather` and `mis`. Omitted settings are chosen by a short pilot run and reported. The
/// window of a record is a disk on the surface and a cone of directions; photons inside both are gathered.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct GatherPlan {
    /// Largest depth of gather paths; the first surface they meet has depth 0.
    #[schemars(range(max = 1000))]
    pub depth: Option<u32>,
    /// Radius of the window in the first stage.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: Option<f64>,
    /// Half-angle of the window in the first stage.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 90.0))]
    pub angle_deg: Option<f64>,
    /// Number of gather paths in a pass, over all sensors. Each takes about 350 bytes in every thread.
    #[schemars(range(min = 1, max = MOST_RECORDS))]
    pub records: Option<u64>,
    /// Number of photon paths in a pass.
    #[schemars(range(min = 1))]
    pub photons: Option<u64>,
    /// Size of the window during the run. Omitted: it shrinks in stages.
    pub schedule: Option<Schedule>,
}

impl GatherPlan {
    /// These settings, and for those left out the others.
    pub fn or(&self, others: &Self) -> Self {
        Self {
            depth: self.depth.or(others.depth),
            radius_mm: self.radius_mm.or(others.radius_mm),
            angle_deg: self.angle_deg.or(others.angle_deg),
            records: self.records.or(others.records),
            photons: self.photons.or(others.photons),
            schedule: self.schedule.or(others.schedule),
        }
    }

    /// Names of the settings that are given.
    pub fn given(&self) -> Vec<&'static str> {
        let all = [
            ("depth", self.depth.is_some()),
            ("radius_mm", self.radius_mm.is_some()),
            ("angle_deg", self.angle_deg.is_some()),
            ("records", self.records.is_some()),
            ("photons", self.photons.is_some()),
            ("schedule", self.schedule.is_some()),
        ];
        all.into_iter().filter(|(_, is_given)| *is_given).map(|(name, _)| name).collect()
    }
}

/// Size of the window during a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Schedule {
    /// It shrinks in stages of many passes each; the value comes from the stage with the smallest total error, among those with
    /// at least ten passes if there are any.
    #[default]
    #[serde(rename = "stages")]
    Stages,
    /// All passes have the window of the first stage, and the value comes from all of them. For runs in parts.
    #[serde(rename = "fixed")]
    Fixed,
}

impl Schedule {
    /// All schedules.
    pub const ALL: [Self; 2] = [Self::Stages, Self::Fixed];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stages => "stages",
            Self::Fixed => "fixed",
        }
    }

    /// The schedule with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|schedule| schedule.name() == name)
    }
}

/// When a run ends. At least one rule is set.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct StopRules {
    /// After this many paths, rounded up to whole batches, or to waves of them (128, or 4 passes of gathering).
    #[serde(rename = "paths")]
    pub paths: Option<u64>,
    /// Batches, or passes, into which the paths are divided: such a run ends after exactly this
    /// many. `None` for whole waves.
    #[serde(rename = "batches")]
    pub batches: Option<u64>,
    /// With `batches`, which repeat a stopped run: the paths that it had been asked for, which decide whether a stage begins.
    #[serde(rename = "planned_paths")]
    pub planned_paths: Option<u64>,
    /// After this time.
    #[serde(rename = "time")]
    pub time: Option<Duration>,
    /// When a measure is known accurately enough.
    #[serde(rename = "target")]
    pub target: Option<Target>,
}

impl StopRules {
    /// Paths that must suffice for a stage of gathering before it begins; `None` where the end of the run is not known.
    pub fn paths_for_stages(&self) -> Option<u64> {
        if self.batches.is_some() { self.planned_paths } else { self.paths }
    }
}

/// An uncertainty to reach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Target {
    /// Name of the measure, such as `exit.flux`.
    pub measure: String,
    /// Standard error relative to the value.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub relative_error: f64,
}

/// Expectation for one measure: a limit (`min`, `max`) or a value (`equals`). A check is undecided, which counts as missed,
/// where the total error (noise and bias) leaves it open: within 3 errors of a limit, up to 3 errors beyond `within`, where
/// the value cannot be relied on, and above `max_std_error`. More paths decide it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("anyOf" = [{ "required": ["min"] }, { "required": ["max"] }, { "required": ["equals"] }]))]
pub struct Check {
    /// Name of the measure, such as `exit.efficiency`.
    pub measure: String,
    /// Lowest value that passes, in the unit of the measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// Highest value that passes, in the unit of the measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Expected value, in the unit of the measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equals: Option<f64>,
    /// Largest deviation from `equals` that passes, in the unit of the measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub within: Option<f64>,
    /// Largest deviation from `equals` that passes, in standard errors. Omitted, and `within` too: 4.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub sigmas: Option<f64>,
    /// Largest standard error with which the check can pass, in the unit of the measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub max_std_error: Option<f64>,
    /// Where the expectation comes from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_files_and_lead_back() {
        for request in Request::ALL {
            assert_eq!(serde_json::to_value(request).unwrap(), request.name());
            assert_eq!(Request::named(request.name()), Some(request));
        }
        for schedule in Schedule::ALL {
            assert_eq!(serde_json::to_value(schedule).unwrap(), schedule.name());
            assert_eq!(Schedule::named(schedule.name()), Some(schedule));
        }
        for estimator in [
            Estimator::Forward,
            Estimator::Backward,
            Estimator::Mix,
            Estimator::Gather,
            Estimator::Mis,
        ] {
            assert_eq!(serde_json::to_value(estimator).unwrap(), estimator.name());
        }
        assert_eq!(Request::named("sideways"), None);
    }

    /// Reports, checkpoints and records of older runs contain this text; a renamed field makes them
    /// unreadable.
    #[test]
    fn a_plan_has_fixed_names_in_files_and_comes_back_from_them() {
        let gather = GatherPlan {
            depth: Some(8),
            radius_mm: Some(0.5),
            angle_deg: Some(6.0),
            records: Some(1000),
            photons: Some(5000),
            schedule: Some(Schedule::Fixed),
        };
        let target = Target { measure: "exit.flux".into(), relative_error: 0.005 };
        let (paths, time) = (Some(20), Some(Duration::from_millis(1500)));
        let plan = RunPlan {
            estimator: Request::Gather,
            sensor_estimators: vec![None, Some(Estimator::Mis)],
            gather,
            seed: 7,
            bounce_limit: 100,
            batch_paths: None,
            stop: StopRules {
                paths,
                batches: Some(3),
                planned_paths: Some(90),
                time,
                target: Some(target),
            },
        };
        let text = serde_json::to_string(&plan).unwrap();
        let expected = concat!(
            r#"{"estimator":"gather","sensor_estimators":[null,"mis"],"gather":{"depth":8,"radius_mm":0.5,"angle_deg":6.0,"records":1000,"#,
            r#""photons":5000,"schedule":"fixed"},"seed":7,"bounce_limit":100,"batch_paths":null,"#,
            r#""stop":{"paths":20,"batches":3,"planned_paths":90,"time":{"secs":1,"nanos":500000000},"#,
            r#""target":{"measure":"exit.flux","relative_error":0.005}}}"#
        );
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<RunPlan>(&text).unwrap(), plan);
    }
}
