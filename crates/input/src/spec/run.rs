//! How long to compute, and what is expected of the results.

use lumiduct_core::plan::{GatherPlan, Polarisation, Request, Target};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How long to compute. The first of `paths`, `time_s` and `target` to be met stops the run; with none of them the run
/// has 2 000 000 paths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunSpec {
    /// Number of paths: photon paths from the sources, and gather paths from the sensors where the estimator
    /// has them. Rounded up to whole waves, of 128 batches or of 4 passes of gathering, or, for long runs of `backward` and `mix`,
    /// to whole batches. The sizes of batches and of passes follow from this number.
    #[schemars(range(min = 1))]
    pub paths: Option<u64>,
    /// Number of batches, or passes of gathering, into which `paths` are divided: the run ends after exactly this many.
    /// Used to repeat a run that was stopped; its report gives the number. Omitted: they follow from
    /// `paths`.
    #[schemars(range(min = 1))]
    pub batches: Option<u64>,
    /// Used with `batches` to repeat a gathered run that was stopped before its number of paths: that number, which decided
    /// whether a stage could begin; its report gives it. With `batches` alone, every stage may begin.
    #[schemars(range(min = 1))]
    pub planned_paths: Option<u64>,
    /// Time limit, including the pilot of `auto`. Another run with the same limit gives different results; the report
    /// gives the command that repeats the run.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub time_s: Option<f64>,
    /// Uncertainty to reach.
    pub target: Option<Target>,
    /// Seed of the random numbers: the same seed gives the same results.
    #[serde(default = "seed")]
    pub seed: u64,
    /// How flux is estimated.
    #[serde(default)]
    pub estimator: Request,
    /// Settings of the estimators `gather` and `mis`, and for `auto` where it gathers.
    #[serde(default)]
    pub gather: GatherPlan,
    /// Number of interfaces and scatterings within media after which a path is cut; the flux that is lost is reported.
    #[serde(default = "bounce_limit")]
    #[schemars(range(min = 1, max = 10_000_000))]
    pub bounce_limit: u32,
    /// Whether the polarisation of light is followed.
    #[serde(default)]
    pub polarisation: Polarisation,
}

impl Default for RunSpec {
    fn default() -> Self {
        Self {
            paths: None,
            batches: None,
            planned_paths: None,
            time_s: None,
            target: None,
            seed: seed(),
            estimator: Request::default(),
            gather: GatherPlan::default(),
            bounce_limit: bounce_limit(),
            polarisation: Polarisation::default(),
        }
    }
}

fn seed() -> u64 {
    1
}

fn bounce_limit() -> u32 {
    100_000
}
