//! The backward estimator: gather paths from the sensors, followed until they meet emission.
//!
//! A gather path carries basic radiance L/n² and stands for an etendue of its sensor: the mean of their product is the
//! flux on the sensor. Points, lines and collimated beams cannot be met; a run with such sources is refused before.

use crate::rng::Sampler;
use crate::scene::{Arrivals, Scene, SensorId};
use crate::transport::emitters::{Emitters, Met};
use crate::transport::follow::{Collector, Gathering, follow};
use crate::transport::readings::Counted;
use crate::transport::{Departure, Layout, Path, Readings, Vertex};
use std::ops::ControlFlow;

/// Stream of random numbers of the gather paths; each sensor has one of its own from here on.
const STREAM: u64 = 1 << 32;

/// What all batches of a run have in common.
#[derive(Debug)]
pub(crate) struct Backward<'s> {
    scene: &'s Scene,
    layout: Layout,
    emitters: Emitters<'s>,
    sensors: Vec<(SensorId, Arrivals<'s>)>,
    seed: u64,
    bounce_limit: u32,
    /// Gather paths per batch of each sensor.
    pub(crate) paths: u64,
}

impl<'s> Backward<'s> {
    /// Prepares gather paths from some sensors, `paths` a batch from each.
    pub(crate) fn new(
        scene: &'s Scene,
        sensors: &[SensorId],
        seed: u64,
        bounce_limit: u32,
        paths: u64,
    ) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            emitters: Emitters::new(scene),
            sensors: sensors.iter().map(|&id| (id, Arrivals::new(scene, id))).collect(),
            seed,
            bounce_limit,
            paths,
        }
    }

    /// Gather paths of all sensors in a batch.
    pub(crate) fn batch_paths(&self) -> u64 {
        self.paths * self.sensors.len() as u64
    }

    /// Traces one batch.
    pub(crate) fn batch(&self, batch: u64) -> Readings {
        let mut readings =
            Readings::of_batch(self.scene, &self.layout, self.seed, self.paths, batch);
        for (id, arrivals) in &self.sensors {
            for index in batch * self.paths..(batch + 1) * self.paths {
                self.trace(*id, arrivals, index, &mut readings);
            }
        }
        readings.close_batch();
        readings
    }

    fn trace(&self, id: SensorId, arrivals: &Arrivals<'s>, index: u64, readings: &mut Readings) {
        let mut sampler = Sampler::for_path(self.seed, STREAM + id.index() as u64, index);
        let Some(arrival) = arrivals.draw(&mut sampler) else { return };
        let gathering = Gathering {
            scene: self.scene,
            emitters: &self.emitters,
            sensor: id,
            bounce_limit: self.bounce_limit,
        };
        let path = Path::arriving(self.scene, &arrival);
        let mut counter = Counter {
            etendue: path.etendue(self.scene, arrival.extent) / self.paths as f64,
            cells: &arrival.cells,
            id,
            layout: self.layout,
            readings,
        };
        let segments = follow(gathering, &arrival, &mut sampler, &mut counter);
        readings.segments += segments;
    }
}

/// Counts the light of one gather path.
struct Counter<'a> {
    /// Etendue per basic radiance of this path, its share of the batch, mm² sr.
    etendue: f64,
    cells: &'a [usize],
    id: SensorId,
    layout: Layout,
    readings: &'a mut Readings,
}

impl Collector for Counter<'_> {
    fn meet(&mut self, path: &Path, met: Met) {
        let counted =
            Counted { flux: met.radiance * self.etendue, depth: path.depth, source: met.source };
        self.readings.count(&self.layout, self.id, self.cells, &counted);
    }

    fn arrive(&mut self, _: &Path, _: &Vertex<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn depart(&mut self, _: &Path, _: &Vertex<'_>, _: &Departure) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
