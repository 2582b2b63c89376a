//! Studies as a study file states them: one scene, many designs of it.

use indexmap::IndexMap;
use lumiduct_core::plan::{Check, Request, Target};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The version of the format of studies that this program reads.
pub(crate) const STUDY_FORMAT_VERSION: u32 = 1;

/// Most designs of a study: as many as the Sobol sequence has.
pub(crate) const MOST_DESIGNS: usize = 1 << 16;

/// Most parameters of a study: within the dimensions of the Sobol sequence.
pub(crate) const MOST_PARAMETERS: usize = 200;

/// Most objectives of a search: a front of more can hardly be read.
pub(crate) const MOST_OBJECTIVES: usize = 3;

/// A study: a scene, the parameters that vary, the measures to record and the criterion for a good design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Lumiduct study")]
pub(crate) struct StudySpec {
    /// Version of the study format.
    #[schemars(extend("const" = 1))]
    pub lumiduct_study: u32,
    /// One line that names the study in reports.
    pub title: String,
    /// What the study is for, in any number of lines.
    pub description: Option<String>,
    /// The scene file, relative to this file.
    pub scene: String,
    /// Keys of the scene that are set for all designs: dotted keys in quotes and values, as after `-D`.
    #[serde(default)]
    pub set: IndexMap<String, Value>,
    /// What is varied, by name.
    pub parameters: IndexMap<String, ParameterSpec>,
    /// Which designs are made of the parameters.
    pub plan: PlanSpec,
    /// Names of the measures to record for every design, such as `exit.efficiency`.
    #[schemars(length(min = 1))]
    pub measures: Vec<String>,
    /// When a design is computed well enough, and with which random numbers.
    #[serde(default)]
    pub run: StudyRunSpec,
    /// What the best design is.
    pub ranking: Option<Ranking>,
    /// What every design has to meet, in any number of `[[check]]` tables. The checks of the scene are ignored.
    #[serde(default)]
    pub check: Vec<Check>,
    /// What is kept of each design beside its row.
    #[serde(default)]
    pub keep: Keep,
}

/// A quantity that is varied. `grid` and `one_at_a_time` need `values`, `range` or `choices`; `latin_hypercube` and `sobol`
/// take any of the four; `tolerance` needs `spread` or `choices`; `search` needs `range` or `choices`, or `tolerance` for what it leaves as in the scene; `list`
/// takes values from its file, and here only `choices`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ParameterSpec {
    /// Keys of the scene that the parameter sets, all at once, such as `solids.pipe.sweep.path.0.straight_mm`.
    #[schemars(length(min = 1))]
    pub keys: Vec<TiedKeySpec>,
    /// Unit for tables and plots, such as `mm`; it does not change the units of the keys.
    pub unit: Option<String>,
    /// Values, each a level.
    #[schemars(length(min = 1))]
    pub values: Option<Vec<f64>>,
    /// Values at even steps.
    pub range: Option<RangeSpec>,
    /// Named values: numbers, text, lists or tables, as the keys require.
    pub choices: Option<IndexMap<String, Value>>,
    /// How the values scatter.
    pub spread: Option<SpreadSpec>,
    /// For a search: how production scatters the value around that of the best design; without a `range`, around that of the scene.
    /// (The plan `tolerance` takes `spread`.)
    pub tolerance: Option<Tolerance>,
    /// Whether values are whole numbers, before factors and offsets: `values` and `range` are rounded, a uniform spread
    /// gives every whole number within its ends the same probability, and a normal one is rounded within its limits.
    #[serde(default)]
    pub whole: bool,
}

/// A key of the scene that a parameter sets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum TiedKeySpec {
    /// The key takes the value itself.
    Same(String),
    /// The key takes factor times value plus offset.
    Scaled(ScaledKeySpec),
}

impl TiedKeySpec {
    /// The dotted key.
    pub(crate) fn key(&self) -> &str {
        match self {
            Self::Same(key) => key,
            Self::Scaled(own) => &own.key,
        }
    }
}

/// A key of the scene that follows a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ScaledKeySpec {
    /// The dotted key.
    pub key: String,
    /// What the value is multiplied by.
    #[serde(default = "one")]
    pub factor: f64,
    /// What is added to the product, in the unit of the key.
    #[serde(default)]
    pub offset: f64,
}

/// Values at even steps from one end to the other, both included.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct RangeSpec {
    /// The first value.
    pub from: f64,
    /// The last value.
    pub to: f64,
    /// Number of values in a grid; samples and a search take any value between the ends.
    #[serde(default = "two")]
    #[schemars(range(min = 2, max = 1000))]
    pub count: u32,
}

/// How values scatter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum SpreadSpec {
    /// Every value between two ends is equally likely.
    Uniform(UniformSpec),
    /// A normal distribution, truncated at `from` and `to` if given.
    Normal(NormalSpec),
}

/// Values between two ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct UniformSpec {
    /// Least value.
    pub from: f64,
    /// Greatest value.
    pub to: f64,
}

/// Values about a mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct NormalSpec {
    /// Mean before truncation.
    pub mean: f64,
    /// Standard deviation before truncation.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub std_dev: f64,
    /// Least value.
    pub from: Option<f64>,
    /// Greatest value.
    pub to: Option<f64>,
}

/// How production scatters a value about the nominal one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Tolerance {
    /// Uniform: every value that differs by no more than this is equally likely. A drawing's ±t that is meant as three standard
    /// deviations is `std_dev = t/3`.
    PlusMinus(#[schemars(extend("exclusiveMinimum" = 0.0))] f64),
    /// A normal distribution with this standard deviation, not truncated.
    StdDev(#[schemars(extend("exclusiveMinimum" = 0.0))] f64),
}

/// Which designs are made of the parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum PlanSpec {
    /// Every combination of all values.
    Grid,
    /// The scene as it is, then every value of every parameter with the others as in the scene.
    OneAtATime,
    /// The designs of a table.
    List(ListPlanSpec),
    /// Samples that fill the range of each parameter evenly (Latin hypercube).
    LatinHypercube(Samples),
    /// Samples that fill all ranges together evenly: a scrambled Sobol sequence. Best with a power of two of them.
    Sobol(Samples),
    /// Independent random samples, as production scatters them; they give the share of designs that pass.
    Tolerance(Samples),
    /// Designs that a search proposes one after the other, to find the best by `ranking` or `cost`, or a front by `objectives`, among those that
    /// pass every `[[check]]`.
    Search(SearchPlan),
}

/// A search for the best design: Nelder and Mead's simplex within the ranges, restarted where it has converged. It begins at the
/// values of the scene; combinations of `choices` race each other. What is best is set by `ranking`, by `cost` or by `objectives`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SearchPlan {
    /// Most designs to trace.
    #[schemars(range(min = 4, max = 10_000))]
    pub designs: u32,
    /// Seed of the restarts. Light has a seed of its own, in `run`.
    #[serde(default = "seed")]
    pub seed: u64,
    /// What a design costs, by parameter: the sum of these factors times the values, to be the lowest among the designs that pass.
    /// It is recorded as the measure `cost`.
    #[serde(default)]
    pub cost: IndexMap<String, f64>,
    /// Two or three measures in place of `ranking`, of which `cost` must be one if it is given: the search finds the designs for which no other is
    /// as good in every objective and better in one.
    #[serde(default)]
    #[schemars(length(min = 2, max = MOST_OBJECTIVES))]
    pub objectives: Vec<Ranking>,
    /// The search ends early when its latest designs, 10 for each range, have improved the best by no more than this, in the unit of
    /// the measure that decides, or by no more than the standard error of the improvement. Not with `objectives`. Omitted: it traces all `designs`.
    #[schemars(range(min = 0.0))]
    pub least_gain: Option<f64>,
    /// Number of simulated parts around the best design, where a parameter has a `tolerance`. Omitted: 100.
    #[schemars(range(min = 2, max = MOST_DESIGNS))]
    pub samples: Option<u32>,
}

impl SearchPlan {
    /// Least number of shares into which a front divides its designs: two for each objective, and one between any two.
    pub fn least_shares(&self) -> usize {
        let count = self.objectives.len();
        count * (count + 3) / 2
    }
}

/// The designs of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ListPlanSpec {
    /// A CSV file, relative to this file: a column for each parameter, a row for each design.
    pub file: String,
}

/// A number of samples.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Samples {
    /// Number of designs.
    #[serde(rename = "samples")]
    #[schemars(range(min = 2, max = MOST_DESIGNS))]
    pub count: u32,
    /// Seed of the samples. Light has a seed of its own, in `run`.
    #[serde(default = "seed")]
    pub seed: u64,
}

/// When a design is computed well enough. Omitted keys are as in the scene; stop rules come from only one of the two
/// files. All designs use the same random numbers, so their differences are known more precisely than their values.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct StudyRunSpec {
    /// Number of paths of a design.
    #[schemars(range(min = 1))]
    pub paths: Option<u64>,
    /// Uncertainty to reach.
    pub target: Option<Target>,
    /// Seed of the random numbers of light.
    pub seed: Option<u64>,
    /// How flux is estimated.
    pub estimator: Option<Request>,
}

/// What the best design is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ranking {
    /// Name of the measure that decides, one of `measures`; among objectives also `cost`.
    pub measure: String,
    /// Whether the highest or the lowest value is the best.
    #[serde(default)]
    pub best: Best,
}

/// Which end of a measure is the best.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Best {
    /// The highest.
    #[default]
    Highest,
    /// The lowest.
    Lowest,
}

/// What is kept of each design beside its row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Keep {
    /// Its record: settings, measures with errors, checks.
    #[default]
    Records,
    /// The record, and a full report with maps and pictures, as `run` writes it.
    Reports,
}

fn one() -> f64 {
    1.0
}

fn two() -> u32 {
    2
}

fn seed() -> u64 {
    1
}
