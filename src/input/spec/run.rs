//! How long to compute, and what is expected of the results.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How long to compute. The first of `paths`, `time_s` and `target` to be met stops the run; with none of them it is
/// 2 000 000 paths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunSpec {
    /// Number of paths.
    #[schemars(range(min = 1))]
    pub paths: Option<u64>,
    /// Time. Another run of the same time differs; the report says how many paths it did, and `paths` with that number
    /// repeats it.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub time_s: Option<f64>,
    /// Uncertainty to reach.
    pub target: Option<TargetSpec>,
    /// Seed of the random numbers: the same seed gives the same results.
    #[serde(default = "seed")]
    pub seed: u64,
    /// How light is followed.
    #[serde(default)]
    pub estimator: EstimatorSpec,
    /// Number of surfaces after which a path is given up; the flux that this cuts off is reported.
    #[serde(default = "bounce_limit")]
    #[schemars(range(min = 1, max = 10_000_000))]
    pub bounce_limit: u32,
}

impl Default for RunSpec {
    fn default() -> Self {
        Self {
            paths: None,
            time_s: None,
            target: None,
            seed: seed(),
            estimator: EstimatorSpec::default(),
            bounce_limit: bounce_limit(),
        }
    }
}

/// An uncertainty to reach.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TargetSpec {
    /// Name of the measure, such as `exit.flux`.
    pub measure: String,
    /// Standard error relative to the value.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub relative_error: f64,
}

/// How light is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EstimatorSpec {
    /// From the sources to the sensors.
    #[default]
    Forward,
}

/// What is expected of one measure: a limit (`min`, `max`) or a value (`equals`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("anyOf" = [{ "required": ["min"] }, { "required": ["max"] }, { "required": ["equals"] }]))]
pub struct CheckSpec {
    /// Name of the measure, such as `exit.efficiency`.
    pub measure: String,
    /// Lowest value that passes, in the unit of the measure.
    pub min: Option<f64>,
    /// Highest value that passes, in the unit of the measure.
    pub max: Option<f64>,
    /// Expected value, in the unit of the measure.
    pub equals: Option<f64>,
    /// Largest deviation from `equals` that passes, in the unit of the measure.
    #[schemars(range(min = 0.0))]
    pub within: Option<f64>,
    /// Largest deviation from `equals` that passes, in standard errors. Omitted, and `within` too: 4.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub sigmas: Option<f64>,
    /// Largest standard error with which the check counts as passed, in the unit of the measure.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub max_std_error: Option<f64>,
    /// Where the expectation comes from.
    pub source: Option<String>,
}

fn seed() -> u64 {
    1
}

fn bounce_limit() -> u32 {
    100_000
}
