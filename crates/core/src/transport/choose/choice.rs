//! What a pilot has found out: how each estimator did, and which was chosen.

use crate::plan::Estimator;
use serde::{Deserialize, Serialize};

/// What a pilot has found out about a sensor, and what was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// The estimator that was taken.
    pub chosen: Estimator,
    /// How each that could be tried did.
    pub tried: Vec<Trial>,
}

/// How an estimator did in a pilot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Which.
    pub estimator: Estimator,
    /// Work × relative variance, in seconds of one thread of the reference machine: over the square of a relative
    /// error it is the time until that error is reached. `None` where nothing was found.
    pub cost: Option<f64>,
    /// |E1 - E2| over the value, of a gathered one, 1.
    pub bias: Option<f64>,
    /// What it needs to tell anything, in seconds likewise: the passes of a first stage.
    pub least: f64,
    /// What keeps it from being chosen, whatever it costs.
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

/// What speaks against gathering.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Objection {
    /// Its nested windows differ by more than the target, beyond their noise.
    WindowsDiffer,
    /// Its flux is not that of an unbiased estimator; of an unbiased one, it is less than that of another.
    Contradicted,
}
