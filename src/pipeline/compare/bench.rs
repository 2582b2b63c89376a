//! What all runs of a comparison have in common: the scene, the sensor and the time.

use lumiduct_core::plan::{Request, RunPlan, StopRules};
use lumiduct_core::scene::SensorId;
use lumiduct_core::transport::Interrupt;
use lumiduct_input::Job;
use std::time::Duration;

/// A scene and the sensor on which methods are compared.
pub(super) struct Bench<'j> {
    pub(super) job: &'j Job,
    pub(super) id: SensorId,
    pub(super) interrupt: &'j Interrupt,
    /// Time of an independent run.
    pub(super) run_time: Duration,
}

impl Bench<'_> {
    /// Dotted name of the measure that is compared.
    pub(super) fn measure(&self) -> String {
        format!("{}.flux", self.sensor())
    }

    /// Cells of the sensor, in all views.
    pub(super) fn cells(&self) -> usize {
        self.job.scene.sensors[self.id.index()].cells()
    }

    /// Name of the sensor.
    pub(super) fn sensor(&self) -> &str {
        &self.job.scene.sensors[self.id.index()].name
    }

    /// The plan of an independent run: the job's except for seed and time.
    pub(super) fn plan(&self, estimator: Request, run: u64) -> RunPlan {
        let seed = self.job.run.seed.wrapping_add(run);
        let stop = StopRules { time: Some(self.run_time), ..StopRules::default() };
        // Estimators that sensors ask for play no part in a comparison.
        let sensor_estimators = Vec::new();
        RunPlan { estimator, sensor_estimators, seed, stop, ..self.job.run.clone() }
    }
}
