//! Findings of a pilot: the performance of each estimator, and the choice.

use crate::plan::Estimator;
use crate::transport::Trial;
use serde::{Deserialize, Serialize};

/// Findings of a pilot about a sensor, and the chosen estimator.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EstimatorChoice {
    /// The chosen estimator.
    pub chosen: Estimator,
    /// The trial of each estimator that could be tried.
    pub tried: Vec<Trial>,
}

impl EstimatorChoice {
    /// The same with the costs and times of a machine of this speed, relative to that of the trials.
    pub(crate) fn at_speed(self, speed: f64) -> Self {
        let of_machine = |trial: Trial| Trial {
            cost: trial.cost.map(|cost| cost / speed),
            least: trial.least / speed,
            ..trial
        };
        Self { tried: self.tried.into_iter().map(of_machine).collect(), ..self }
    }

    /// Seconds of one thread until the chosen estimator has a relative error, 1; `None` where
    /// nothing was found.
    pub(crate) fn time(&self, error: f64) -> Option<f64> {
        self.tried.iter().find(|trial| trial.estimator == self.chosen)?.time(error)
    }
}
