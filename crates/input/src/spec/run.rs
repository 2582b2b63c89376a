//! How long to compute, and what is expected of the results.

use lumiduct_core::plan::MOST_RECORDS;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How long to compute. The first of `paths`, `time_s` and `target` to be met stops the run; with none of them it is
/// 2 000 000 paths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunSpec {
    /// Number of paths: photon paths from the sources, and gather paths from the sensors where the estimator has them.
    /// Rounded up to whole waves, of 128 batches or of 16 passes of gathering (some million paths each wave).
    #[schemars(range(min = 1))]
    pub paths: Option<u64>,
    /// Number of batches, or passes of gathering, into which `paths` are divided: the run ends after exactly so many. For
    /// repeating a run that was stopped; its report says which number. Omitted: whole waves of 128 batches or 16 passes.
    #[schemars(range(min = 1))]
    pub batches: Option<u64>,
    /// Time, with the pilot of `auto`. Another run of the same time differs; the report gives the command that repeats it.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub time_s: Option<f64>,
    /// Uncertainty to reach.
    pub target: Option<TargetSpec>,
    /// Seed of the random numbers: the same seed gives the same results.
    #[serde(default = "seed")]
    pub seed: u64,
    /// How flux is estimated.
    #[serde(default)]
    pub estimator: EstimatorSpec,
    /// Settings of the estimators `gather` and `mis`, and for `auto` where it gathers.
    #[serde(default)]
    pub gather: GatherSpec,
    /// Number of surfaces after which a path is given up; the flux that this cuts off is reported.
    #[serde(default = "bounce_limit")]
    #[schemars(range(min = 1, max = 10_000_000))]
    pub bounce_limit: u32,
}

impl Default for RunSpec {
    fn default() -> Self {
        Self {
            paths: None,
            batches: None,
            time_s: None,
            target: None,
            seed: seed(),
            estimator: EstimatorSpec::default(),
            gather: GatherSpec::default(),
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

/// How flux is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EstimatorSpec {
    /// For every sensor, what a short trial finds best; the report names the choice and its figures.
    #[default]
    Auto,
    /// Photon paths from the sources, counted by the sensors.
    Forward,
    /// Gather paths from the sensors, followed until they meet a source.
    Backward,
    /// Forward and backward at once, weighed path by path; sources that paths cannot meet are left to photons.
    Mix,
    /// Gather paths from the sensors that end in records, and photon paths from the sources that are gathered there.
    Gather,
    /// Forward, backward and gather at once, weighed path by path (multiple importance sampling); for scenes whose
    /// finishes do not scatter.
    Mis,
}

/// How flux is estimated on one sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SensorEstimatorSpec {
    /// Photon paths from the sources, counted by the sensor.
    Forward,
    /// Gather paths from the sensor, followed until they meet a source.
    Backward,
    /// Forward and backward at once, weighed path by path.
    Mix,
    /// Gather paths from the sensor that end in records, and photon paths that are gathered there.
    Gather,
    /// Forward, backward and gather at once; only where no other sensor may be gathered without it.
    Mis,
}

/// Settings of the estimators `gather` and `mis`. What is left out is chosen by a short trial, and reported. The window
/// of a record is a disk on the surface and a cone of directions; photons inside both are gathered.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct GatherSpec {
    /// Depth at which gather paths end at the latest; the first surface they meet has depth 0.
    #[schemars(range(max = 1000))]
    pub depth: Option<u32>,
    /// Radius of the window in the first pass.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: Option<f64>,
    /// Half-angle of the window in the first pass.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 90.0))]
    pub angle_deg: Option<f64>,
    /// Number of gather paths in a pass, over all sensors. Each takes about 600 bytes in every thread.
    #[schemars(range(min = 1, max = MOST_RECORDS))]
    pub records: Option<u64>,
    /// Number of photon paths in a pass.
    #[schemars(range(min = 1))]
    pub photons: Option<u64>,
    /// How the window shrinks.
    #[serde(default)]
    pub schedule: ScheduleSpec,
}

/// How the window shrinks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ScheduleSpec {
    /// In stages of many passes with the same window; the value comes from the last stage alone.
    #[default]
    Stages,
    /// A little from pass to pass; the value comes from all passes. For comparison: its error bar is less sure.
    PerPass,
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
