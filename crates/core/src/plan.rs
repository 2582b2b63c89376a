//! Run settings of a scene file: how to estimate, when to stop, and what to check.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Version of the numerics. Every change that alters a committed report raises it, so that a
/// report, a checkpoint or a record from older numerics is never mistaken for a current one.
pub const NUMERICS: u32 = 3;

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
    /// Paths are cut after this many interfaces; the flux they carry is a line of the balance.
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

/// The requested estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request {
    /// The best for each sensor, as found by a pilot.
    #[serde(rename = "auto")]
    Auto,
    /// [`Estimator::Forward`] for all sensors.
    #[serde(rename = "forward")]
    Forward,
    /// [`Estimator::Backward`] for all sensors.
    #[serde(rename = "backward")]
    Backward,
    /// [`Estimator::Mix`] for all sensors.
    #[serde(rename = "mix")]
    Mix,
    /// [`Estimator::Gather`] for all sensors.
    #[serde(rename = "gather")]
    Gather,
    /// [`Estimator::Mis`] for all sensors.
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

/// How the flux of a sensor was estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Estimator {
    /// Photon paths from the sources, counted in the sensors' cells.
    #[serde(rename = "forward")]
    Forward,
    /// Gather paths from the sensors' cells, followed until they meet emission.
    #[serde(rename = "backward")]
    Backward,
    /// Both, weighted path by path by the balance heuristic.
    #[serde(rename = "mix")]
    Mix,
    /// Gather paths of limited depth that end in records, where photons are gathered.
    #[serde(rename = "gather")]
    Gather,
    /// Forward, backward and gather merged by multiple importance sampling.
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

/// Settings for the gather estimator; a pilot chooses those left out.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct GatherPlan {
    /// Largest depth at which gather paths end; the first surface has depth 0.
    #[serde(rename = "depth")]
    pub depth: Option<u32>,
    /// Radius of the window of the first pass, mm.
    #[serde(rename = "radius_mm")]
    pub radius: Option<f64>,
    /// Half-angle of the window of the first pass, rad.
    #[serde(rename = "angle_rad")]
    pub theta_max: Option<f64>,
    /// Gather paths of a pass, over all sensors.
    #[serde(rename = "records")]
    pub records: Option<u64>,
    /// Photons of a pass.
    #[serde(rename = "photons")]
    pub photons: Option<u64>,
    /// How the window shrinks.
    #[serde(rename = "schedule")]
    pub schedule: Schedule,
}

/// How the window of the gather estimator shrinks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Schedule {
    /// In stages of many passes with one window; the last stage gives the value.
    #[default]
    #[serde(rename = "stages")]
    Stages,
    /// From pass to pass; all passes give the value.
    #[serde(rename = "per-pass")]
    PerPass,
}

impl Schedule {
    /// All schedules.
    pub const ALL: [Self; 2] = [Self::Stages, Self::PerPass];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stages => "stages",
            Self::PerPass => "per-pass",
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
    /// After this many paths, rounded up to whole waves (of 128 batches, or 16 passes of gathering).
    #[serde(rename = "paths")]
    pub paths: Option<u64>,
    /// Batches, or passes, into which the paths are divided: such a run ends after exactly this
    /// many. `None` for whole waves.
    #[serde(rename = "batches")]
    pub batches: Option<u64>,
    /// After this time.
    #[serde(rename = "time")]
    pub time: Option<Duration>,
    /// When a measure is known accurately enough.
    #[serde(rename = "target")]
    pub target: Option<Target>,
}

/// A measure and its target error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Dotted name, such as `exit.flux`.
    #[serde(rename = "measure")]
    pub measure: String,
    /// Standard error over value.
    #[serde(rename = "relative_error")]
    pub relative_error: f64,
}

/// A demand on a measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Dotted name of the measure.
    pub measure: String,
    /// The smallest value that passes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// The largest value that passes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// The value it must agree with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub equals: Option<f64>,
    /// Absolute deviation from `equals` that passes in any case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub within: Option<f64>,
    /// Deviation from `equals` that passes, in standard errors.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigmas: Option<f64>,
    /// The standard error must not be larger than this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_std_error: Option<f64>,
    /// Where the expected value comes from.
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
            radius: Some(0.5),
            theta_max: Some(0.1),
            records: Some(1000),
            photons: Some(5000),
            schedule: Schedule::PerPass,
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
            stop: StopRules { paths, batches: Some(3), time, target: Some(target) },
        };
        let text = serde_json::to_string(&plan).unwrap();
        let expected = concat!(
            r#"{"estimator":"gather","sensor_estimators":[null,"mis"],"gather":{"depth":8,"radius_mm":0.5,"angle_rad":0.1,"records":1000,"#,
            r#""photons":5000,"schedule":"per-pass"},"seed":7,"bounce_limit":100,"batch_paths":null,"#,
            r#""stop":{"paths":20,"batches":3,"time":{"secs":1,"nanos":500000000},"#,
            r#""target":{"measure":"exit.flux","relative_error":0.005}}}"#
        );
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<RunPlan>(&text).unwrap(), plan);
    }
}
