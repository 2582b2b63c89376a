//! The backward estimator: gather paths from the sensors, followed until they meet emission.
//!
//! A gather path carries basic radiance L/n² and represents an etendue of its sensor: the mean of
//! their product is the flux on the sensor. Points, lines and collimated beams cannot be met; a run
//! with such sources is refused beforehand. When mixed with forward, photons also count on the
//! sensors, and both count by their weights (`mix`).

use crate::rng::Sampler;
use crate::scene::{Arrivals, Scene, SensorId};
use crate::transport::gather::merge::{Etendues, NO_WINDOW};
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::readings::Counted;
use crate::transport::tally::work;
use crate::transport::walk::emitters::Emitters;
use crate::transport::walk::follow::{Gathering, follow};
use crate::transport::{Event, Layout, Loss, MetEmission, Observer, Path, Readings};
use std::ops::ControlFlow;

/// Stream of random numbers of the gather paths; each sensor has a separate one from here on.
const STREAM: u64 = 1 << 32;

/// Gather paths of each sensor that measure their work.
const PILOT_PATHS: u64 = 64;
/// Batch of the pilot paths: not one that counts.
const PILOT_BATCH: u64 = 1 << 40;

/// Shared data of all batches of a run.
#[derive(Debug)]
pub(crate) struct Backward<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) layout: Layout,
    pub(crate) emitters: Emitters<'s>,
    pub(crate) sensors: Vec<(SensorId, Arrivals<'s>)>,
    seed: u64,
    bounce_limit: u32,
    /// Gather paths per batch of each sensor.
    pub(crate) paths: u64,
    /// The sensors to which forward contributes.
    pub(crate) mixed: Vec<SensorId>,
}

impl<'s> Backward<'s> {
    /// Prepares gather paths from some sensors, a few a batch from each.
    pub(crate) fn new(
        scene: &'s Scene,
        sensors: &[SensorId],
        seed: u64,
        bounce_limit: u32,
    ) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            emitters: Emitters::new(scene),
            sensors: sensors.iter().map(|&id| (id, Arrivals::new(scene, id))).collect(),
            seed,
            bounce_limit,
            paths: PILOT_PATHS,
            mixed: Vec::new(),
        }
    }

    /// The same with this many paths per batch from each sensor.
    pub(crate) fn with_paths(self, paths: u64) -> Self {
        Self { paths: paths.max(1), ..self }
    }

    /// The same, with forward contributing to some of the sensors.
    pub(crate) fn mixed(self, sensors: &[SensorId]) -> Self {
        Self { mixed: sensors.to_vec(), ..self }
    }

    /// Work of a gather path, mean of a few that are not counted; `None` if they were stopped.
    pub(crate) fn work_of_path(&self, signal: &StopSignal) -> Option<f64> {
        let segments = self.batch(PILOT_BATCH, &[], signal)?.segments;
        Some(work::of_gather_paths(self.batch_paths(), segments) / self.batch_paths() as f64)
    }

    /// Gather paths of all sensors in a batch.
    pub(crate) fn batch_paths(&self) -> u64 {
        self.paths * self.sensors.len() as u64
    }

    /// Traces one batch along with one of photons with these fluxes, lm or W, by source. It is not
    /// closed, since photons may contribute to it. `None` if it was stopped.
    pub(crate) fn batch(
        &self,
        batch: u64,
        photon_fluxes: &[f64],
        signal: &StopSignal,
    ) -> Option<Readings> {
        let pace = Pace::new(signal);
        let mut readings =
            Readings::of_batch(self.scene, &self.layout, self.seed, self.paths, batch);
        for (id, arrivals) in &self.sensors {
            let mixed_with = self.mixed.contains(id).then_some(photon_fluxes);
            for index in batch * self.paths..(batch + 1) * self.paths {
                if pace.spend(1).is_break() {
                    return None;
                }
                let beside = Beside { mixed_with, pace: &pace };
                self.trace((*id, arrivals), index, beside, &mut readings);
            }
        }
        (!pace.is_stopped()).then_some(readings)
    }

    fn trace(
        &self,
        (id, arrivals): (SensorId, &Arrivals<'s>),
        index: u64,
        Beside { mixed_with, pace }: Beside<'_>,
        readings: &mut Readings,
    ) {
        let mut sampler = Sampler::for_path(self.seed, STREAM + id.index() as u64, index);
        let Some(arrival) = arrivals.draw(&mut sampler) else { return };
        let gathering = Gathering {
            scene: self.scene,
            emitters: &self.emitters,
            sensor: id,
            bounce_limit: self.bounce_limit,
            pace: Some(pace),
        };
        let path = Path::arriving(self.scene, &arrival);
        let mut counter = Counter {
            etendue: path.etendue(self.scene, arrival.extent) / self.paths as f64,
            cells: &arrival.cells,
            id,
            layout: self.layout,
            mixed_with,
            readings,
        };
        let segments = follow(gathering, &arrival, &mut sampler, &mut counter);
        readings.segments += segments;
    }
}

/// Context of the gather paths of a batch.
#[derive(Clone, Copy)]
struct Beside<'a> {
    /// Mixed: flux of one photon of each source, lm or W.
    mixed_with: Option<&'a [f64]>,
    /// Stops the paths.
    pace: &'a Pace<'a>,
}

/// Counts the light of one gather path.
struct Counter<'a> {
    /// Etendue of this path per basic radiance, its share of the batch, mm² sr.
    etendue: f64,
    cells: &'a [usize],
    id: SensorId,
    layout: Layout,
    /// Mixed: flux of one photon of each source, lm or W.
    mixed_with: Option<&'a [f64]>,
    readings: &'a mut Readings,
}

impl Observer for Counter<'_> {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Meet(met) => self.meet(path, met),
            Event::Cut(throughput) => self.lose(throughput, Loss::Cut),
            Event::Leaked(_, throughput) => self.lose(throughput, Loss::Leaked),
            Event::Start(_)
            | Event::Travel(_)
            | Event::Collide(_)
            | Event::Arrive(_)
            | Event::Depart(..)
            | Event::Absorbed(_)
            | Event::Detect(_)
            | Event::Roulette(_)
            | Event::Escaped(_) => {}
        }
        ControlFlow::Continue(())
    }
}

impl Counter<'_> {
    fn meet(&mut self, path: &Path, met: &MetEmission) {
        let weight = self.mixed_with.map_or(1.0, |photon_fluxes| {
            let photon = photon_fluxes[met.source.index()] / met.emitted;
            let [weight, ..] =
                Etendues { photon, gather: self.etendue, window: NO_WINDOW }.backward();
            weight
        });
        let flux = weight * met.radiance * self.etendue;
        let counted = Counted { flux, depth: path.depth, source: met.source };
        self.readings.count(&self.layout, self.id, self.cells, &counted);
    }

    fn lose(&mut self, throughput: f64, loss: Loss) {
        self.readings.count_lost(&self.layout, self.id, throughput, loss);
    }
}
