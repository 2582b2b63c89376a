//! Findings of a pilot: the performance of each estimator, and the choice.

use crate::plan::Estimator;
use serde::{Deserialize, Serialize};

/// Findings of a pilot about a sensor, and the chosen estimator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// The chosen estimator.
    pub chosen: Estimator,
    /// The trial of each estimator that could be tried.
    pub tried: Vec<Trial>,
}

/// Performance of an estimator in a pilot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The estimator.
    pub estimator: Estimator,
    /// Work × relative variance, in seconds of one thread of the reference machine: divided by the
    /// square of a relative error, it is the time to reach that error. `None` where nothing was
    /// found.
    pub cost: Option<f64>,
    /// |E1 - E2| over the value, for a gathered one, 1.
    pub bias: Option<f64>,
    /// Smallest work for any result, in the same seconds: the passes of a first stage.
    pub least: f64,
    /// What excludes it, whatever it costs.
    pub objection: Option<Objection>,
}

impl Choice {
    /// Seconds of one thread of the reference machine until the chosen estimator has a relative error, 1; `None` where
    /// nothing was found.
    pub fn time(&self, error: f64) -> Option<f64> {
        self.tried.iter().find(|trial| trial.estimator == self.chosen)?.time(error)
    }
}

impl Trial {
    /// Seconds of one thread of the reference machine until a relative error is reached, 1; `None` where nothing was found.
    pub fn time(&self, error: f64) -> Option<f64> {
        self.cost.map(|cost| (cost / (error * error)).max(self.least))
    }
}

/// Objections to gathering.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Objection {
    /// Its nested windows differ by more than the target, beyond their noise.
    WindowsDiffer,
    /// Its flux disagrees with an unbiased estimator's; for an unbiased one, it is less than
    /// another's.
    Contradicted,
}
