//! The gather paths of one sensor, and batches of them: what all baselines have in common.

use lumiduct_core::plan::RunPlan;
use lumiduct_core::rng::{Sampler, stream};
use lumiduct_core::scene::{Arrival, Arrivals, Scene, SensorId};
use lumiduct_core::transport::tally::sensor_reading::DetectedLight;
use lumiduct_core::transport::walk::emitters::Emitters;
use lumiduct_core::transport::walk::follow::{Gathering, follow};
use lumiduct_core::transport::{Layout, Path, Readings, Unobserved};

/// Segments that a batch should contain.
pub(crate) const BATCH_SEGMENTS: u64 = 1 << 16;
/// Gather paths from which the mean length is estimated.
const PILOT_PATHS: u64 = 64;

/// What a batch has counted.
pub(crate) struct BaselineBatch {
    pub(crate) readings: Readings,
    /// Throughput cut off per gather path, 1.
    pub(crate) cut: f64,
}

/// The gather paths of one sensor.
#[derive(Debug)]
pub(crate) struct OneSensor<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) layout: Layout,
    pub(crate) emitters: Emitters<'s>,
    pub(crate) id: SensorId,
    pub(crate) arrivals: Arrivals<'s>,
    pub(crate) seed: u64,
    pub(crate) bounce_limit: u32,
}

impl<'s> OneSensor<'s> {
    pub(crate) fn new(scene: &'s Scene, id: SensorId, plan: &RunPlan) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            emitters: Emitters::new(scene),
            id,
            arrivals: Arrivals::new(scene, id),
            seed: plan.seed,
            bounce_limit: plan.bounce_limit,
        }
    }

    /// The settings its gather paths share, up to a depth.
    pub(crate) fn gathering(&self, bounce_limit: u32) -> Gathering<'_, 's> {
        let Self { scene, emitters, id: sensor, .. } = self;
        Gathering { scene, emitters, sensor: *sensor, bounce_limit, pace: None }
    }

    /// The etendue that a gather path represents, mm² sr.
    pub(crate) fn etendue(&self, arrival: &Arrival) -> f64 {
        Path::arriving(self.scene, arrival).etendue(self.scene, arrival.extent)
    }

    /// An empty batch of `paths` paths.
    pub(crate) fn empty(&self, paths: u64, batch: u64) -> Readings {
        Readings::of_batch(self.scene, &self.layout, self.seed, paths, batch)
    }

    pub(crate) fn count(&self, readings: &mut Readings, cells: &[usize], light: &DetectedLight) {
        readings.count((&self.layout, &self.scene.light), self.id, cells, light);
    }

    /// Gather paths per batch, for about the same work in every scene; deterministic for a seed.
    pub(crate) fn batch_paths(&self) -> u64 {
        let mut segments = 0;
        for index in 0..PILOT_PATHS {
            let mut sampler = Sampler::for_path(self.seed, stream::BASELINE_PILOT, index);
            if let Some(arrival) = self.arrivals.draw(&mut sampler) {
                let gathering = self.gathering(self.bounce_limit.min(10_000));
                segments += follow(gathering, &arrival, &mut sampler, &mut Unobserved);
            }
        }
        (BATCH_SEGMENTS * PILOT_PATHS / segments.max(1)).clamp(16, 1 << 14)
    }
}
