//! What an estimator knows about a sensor, in a form that hides how it was computed.

use crate::plan::Estimator;
use crate::transport::Readings;
use serde::Serialize;

/// The estimate of a sensor's light: cells and totals, by source and by light group.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Estimate<'a> {
    /// The estimator; photons stand in for one that has not counted anything yet.
    pub estimator: Estimator,
    /// Values with their noise, and their groups of batches for ratios and differences.
    pub readings: &'a Readings,
    /// What is known about the bias; `None` for an unbiased estimate.
    pub bias: Option<Bias<'a>>,
    /// Whether photons of the same run found more light on the sensor, beyond their errors.
    pub is_contradicted: bool,
}

/// The bias of an estimate: that of any measure is a share of the difference from its value by another estimate, and at
/// least a share of itself.
#[derive(Debug, Clone, Copy)]
pub struct Bias<'a> {
    /// The other estimate.
    pub other: &'a Readings,
    /// The share of the difference that may remain, 1.
    pub share: f64,
    /// The least bias as a share of the value, 1: that of the sensor's flux.
    pub least: f64,
    /// How far this can be trusted.
    pub resolution: Resolution,
}

impl Bias<'_> {
    /// The bias of a value whose other estimate is known.
    pub(crate) fn of(&self, value: f64, other: f64) -> f64 {
        if other.is_nan() {
            return f64::NAN;
        }
        (self.share * (value - other).abs()).max(self.least * value.abs())
    }
}

/// What is known about the bias of a sensor's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Resolution {
    /// The orders of the estimate differ and converge.
    Resolved,
    /// They agree within their noise.
    InNoise,
    /// They differ and do not converge.
    NotResolved,
}

/// How the values of a sensor were computed: text and numbers that a report prints as they are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Account {
    /// Name of the sensor.
    pub sensor: String,
    /// Its estimator.
    pub estimator: Estimator,
    /// What is known about the bias.
    pub resolution: Resolution,
    /// Difference of its flux from that of photons of the same run, in total errors of both, 1;
    /// `None` where either has found too little to decide.
    pub off_photons: Option<f64>,
    /// Sentences for the reader.
    pub sentences: Vec<String>,
    /// Columns of the table, with their units.
    pub columns: Vec<String>,
    /// Its rows.
    pub rows: Vec<Vec<AccountEntry>>,
    /// A warning, where there is reason for one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
}

/// An entry of a table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum AccountEntry {
    /// A count.
    Count(u64),
    /// A number.
    Number(f64),
    /// A value with its standard error.
    Measured {
        /// The value.
        value: f64,
        /// Its standard error.
        std_error: f64,
    },
}
