//! Findings of a run: readings by photons, by gather paths, and by stages of the gather method.
//!
//! One serialisable value. The sensor's estimator decides which of the readings give its values.

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
    /// Findings of the pilot about each sensor, if the run is to choose.
    pub choices: Vec<Choice>,
    /// Number of photon and gather paths.
    pub paths: u64,
}

/// Findings of the gather method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Gathered {
    /// Its settings.
    pub settings: GatherSettings,
    /// The last finished stage and the one after it, as far as it has got.
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
