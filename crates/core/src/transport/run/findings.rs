//! What a run has found: readings by photons, by gather paths, and by stages of the gather method.
//!
//! One serialisable value. Which of its readings speak for a sensor follows from the sensor's estimator.

use crate::plan::Estimator;
use crate::scene::SensorId;
use crate::transport::{Choice, GatherSettings, Readings, Stage};
use serde::{Deserialize, Serialize};

/// Everything a run has counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// By photons: the balance, and all sensors.
    pub photons: Readings,
    /// By gather paths that were followed to their sources: sensors estimated backward, and mixed ones with the share of
    /// photons.
    pub backward: Option<Readings>,
    /// By gather records.
    pub gathered: Option<Gathered>,
    /// How each sensor is estimated.
    pub estimators: Vec<Estimator>,
    /// What a pilot found out about each sensor, if it was asked to choose.
    pub choices: Vec<Choice>,
    /// Photon and gather paths behind it.
    pub paths: u64,
}

/// What the gather method has found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gathered {
    /// How it was set.
    pub settings: GatherSettings,
    /// The last finished stage and the one after it, as far as that has come.
    pub stages: Vec<Stage>,
}

impl Findings {
    /// The findings of photons alone.
    pub fn forward(photons: Readings) -> Self {
        let estimators = vec![Estimator::Forward; photons.sensors.len()];
        let paths = photons.paths();
        Self { photons, backward: None, gathered: None, estimators, choices: Vec::new(), paths }
    }

    /// How a sensor is estimated.
    pub fn estimator(&self, sensor: SensorId) -> Estimator {
        self.estimators[sensor.index()]
    }
}
