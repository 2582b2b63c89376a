//! The joint analysis of the designs of a study.

use lumiduct_input::Setting;
use serde::{Deserialize, Serialize};

/// A value with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ValueWithError {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
    /// How the error was computed.
    pub evidence: Pairing,
}

/// How the error of a function of several designs was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Pairing {
    /// Group by group, as the designs share their random numbers.
    Paired,
    /// From the errors of the single designs, as if independent; too large where they are
    /// correlated.
    Independent,
}

/// The joint analysis of all designs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Analysis {
    /// All designs that were traced, the best first; empty without a ranking.
    pub ranked: Vec<Ranked>,
    /// The designs on the front of a search with several objectives, the best by the first of them first.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub front: Vec<FrontDesign>,
    /// What the latest designs of a search have gained, if that ends it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latest_gain: Option<LatestGain>,
    /// Main effects of the parameters on the measures.
    pub effects: Vec<Effect>,
    /// How much of the variance of a measure comes from each parameter.
    pub sensitivities: Vec<Sensitivity>,
    /// Share of the designs that fail; for tolerance runs only.
    pub failures: Vec<FailureShare>,
    /// How much sharper differences between designs are than with independent random numbers.
    pub sharpness: Vec<Sharpness>,
}

/// A design on the front: no other that passes is as good in every objective and better in one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct FrontDesign {
    /// Its number.
    pub design: usize,
    /// The first other design that would beat it if differences within three standard errors counted for nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rival: Option<usize>,
}

/// How much better the latest designs of a search have made the best.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LatestGain {
    /// How many designs the latest are.
    pub designs: usize,
    /// The gain, in the unit of the measure.
    pub gain: ValueWithError,
}

/// The rank of a design.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ranked {
    /// Its number.
    pub design: usize,
    /// How much it is behind the best, in the unit of the measure; `None` for the best itself.
    pub behind: Option<ValueWithError>,
}

/// The mean of a measure over all designs with the same setting of one parameter, setting by setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Effect {
    /// The parameter.
    pub parameter: String,
    /// The measure.
    pub measure: String,
    /// In the order of the levels.
    pub points: Vec<EffectPoint>,
}

/// The mean of a measure over all designs with one setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EffectPoint {
    /// The setting.
    pub setting: Setting,
    /// Number of designs it is taken over.
    pub designs: usize,
    /// The mean, in the unit of the measure.
    pub mean: ValueWithError,
    /// How much it is above that of the first setting; `None` for the first itself.
    pub from_first: Option<ValueWithError>,
}

/// How much of the variance of a measure comes from each parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensitivity {
    /// The measure.
    pub measure: String,
    /// How it was found.
    pub method: SensitivityMethod,
    /// Share of the variance that these explain, 1: the sum of first-order indices, or R² of the
    /// regression.
    pub explained: f64,
    /// One for each parameter that can be judged.
    pub indices: Vec<SensitivityIndex>,
}

/// How sensitivities were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SensitivityMethod {
    /// First-order Sobol indices of a full grid: variance of the level means over that of all designs.
    FirstOrder,
    /// Coefficients of a linear regression, all quantities over their standard deviations.
    Regression,
}

/// The sensitivity to one parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SensitivityIndex {
    /// The parameter.
    pub parameter: String,
    /// The index, 1.
    pub value: f64,
    /// Its standard error, 1.
    pub std_error: f64,
    /// Of a regression: the change of the measure per unit of the parameter, and its standard error, in their units.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slope: Option<[f64; 2]>,
}

/// How many designs of a tolerance run meet a demand.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FailureShare {
    /// The demand: a measure with its limit, or all of them.
    pub demand: String,
    /// Designs that meet it.
    pub passed: usize,
    /// Designs that do not.
    pub failed: usize,
    /// Designs whose error bar leaves it open.
    pub undecided: usize,
    /// Share that fails if the undecided ones pass, 1.
    pub least: f64,
    /// Share that fails if the undecided ones fail, 1.
    pub most: f64,
    /// 95 % confidence interval of the share in all of production: its low end from `least`, its
    /// high end from `most`, 1.
    pub interval: [f64; 2],
}

/// How much sharper differences are than with independent random numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sharpness {
    /// The measure.
    pub measure: String,
    /// Median over neighbouring designs of the error as if independent over the reported error, 1.
    pub factor: f64,
    /// Pairs of designs it is taken over.
    pub pairs: usize,
}
