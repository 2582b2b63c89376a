//! Findings of a run: readings by photons, and what each other estimator found.
//!
//! One serialisable value. The sensor's estimator decides which of it give its values.

use crate::plan::Estimator;
use crate::scene::{Scene, SensorId};
use crate::transport::estimate::{Account, Estimate};
use crate::transport::estimators::{self, EstimatorFindings};
use crate::transport::{EstimatorChoice, GatherSettings, Readings};
use serde::{Deserialize, Serialize};

/// Everything a run has counted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Findings {
    /// By photons: the balance, and all sensors.
    pub photons: Readings,
    /// By the other estimators.
    pub others: Vec<EstimatorFindings>,
    /// How each sensor is estimated.
    pub estimators: Vec<Estimator>,
    /// Findings of the pilot about each sensor, if the run is to choose.
    pub choices: Vec<EstimatorChoice>,
    /// Number of photon and gather paths.
    pub paths: u64,
}

impl Findings {
    /// The findings of photons alone.
    pub fn forward(photons: Readings) -> Self {
        let estimators = vec![Estimator::Forward; photons.sensors.len()];
        let paths = photons.paths();
        Self { photons, others: Vec::new(), estimators, choices: Vec::new(), paths }
    }

    /// What the estimator of a sensor found, other than forward.
    pub fn of_sensor(&self, sensor: SensorId) -> Option<&EstimatorFindings> {
        self.others.iter().find(|found| found.sensors.contains(&sensor))
    }

    /// The estimate of a sensor.
    pub(crate) fn estimate(&self, scene: &Scene, sensor: SensorId) -> Estimate<'_> {
        let estimator = self.estimators[sensor.index()];
        estimators::estimate(scene, (estimator, self.of_sensor(sensor)), &self.photons, sensor)
    }

    /// The readings from which the values of a sensor are taken.
    pub fn readings(&self, scene: &Scene, sensor: SensorId) -> &Readings {
        self.estimate(scene, sensor).readings
    }

    /// How the values of a sensor were computed, where there is something to say.
    pub(crate) fn account(&self, scene: &Scene, sensor: SensorId) -> Option<Account> {
        let found = self.of_sensor(sensor)?;
        estimators::account(scene, found, &self.photons, sensor)
    }

    /// Settings of gathering, by group of sensors.
    pub fn gathering(&self) -> impl Iterator<Item = (&[SensorId], &GatherSettings)> {
        self.others.iter().filter_map(|found| Some((&found.sensors[..], found.settings.as_ref()?)))
    }

    /// Segments of photon and gather paths.
    pub fn segments(&self) -> u64 {
        let latest = self.others.iter().filter_map(|found| found.stages.last());
        self.photons.segments + latest.map(|stage| stage.segments).sum::<u64>()
    }
}
