//! What a scene file asks of a run besides the scene: when to stop, and what to check.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// How to trace and when to stop.
#[derive(Debug, Clone, PartialEq)]
pub struct RunPlan {
    /// How flux is estimated.
    pub estimator: Estimator,
    /// Seed of all random streams.
    pub seed: u64,
    /// Paths are cut after this many interfaces; the flux they carry is a line of the balance.
    pub bounce_limit: u32,
    /// The first rule that is met ends the run.
    pub stop: StopRules,
}

/// How flux is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Estimator {
    /// Photon paths from the sources, counted in the sensors' cells.
    Forward,
}

impl Estimator {
    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Forward => "forward",
        }
    }
}

/// When a run ends. At least one rule is set.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StopRules {
    /// After this many paths (rounded up to whole batches, 128 at least).
    pub paths: Option<u64>,
    /// After this time.
    pub time: Option<Duration>,
    /// When a measure is known well enough.
    pub target: Option<Target>,
}

/// A measure and how well it is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    /// Dotted name, such as `exit.flux`.
    pub measure: String,
    /// Standard error over value.
    pub relative_error: f64,
}

/// A demand on a measure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Dotted name of the measure.
    pub measure: String,
    /// The least value that passes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// The greatest value that passes.
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
    /// The run must reach at least this standard error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_std_error: Option<f64>,
    /// Where the expected value comes from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
}
