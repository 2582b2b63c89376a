//! Gather paths that split at every smooth interface into the reflected and the refracted ray.
//!
//! Whitted, An Improved Illumination Model for Shaded Display, Communications of the ACM 23
//! (1980) 343. Nothing is drawn at random there: both rays are followed until their throughput
//! falls below a cut-off. What is cut off is reported, not compensated. Finishes that scatter
//! sample one direction.

use crate::one_sensor::{BaselineBatch, OneSensor};
use lumiduct_core::optics::{FinishModel, Scattered, Side};
use lumiduct_core::rng::{Sampler, stream};
use lumiduct_core::scene::{Ray, StartSurfaces};
use lumiduct_core::transport::tally::sensor_reading::DetectedLight;
use lumiduct_core::transport::walk::follow::{follow, follow_on};
use lumiduct_core::transport::walk::scatter::{facing, scatter_gather_path};
use lumiduct_core::transport::{Event, MetEmission, Observer, Path, Readings, Vertex};
use std::ops::ControlFlow;

/// Branches of less throughput are cut off, 1.
const CUT_OFF: f64 = 1e-3;
/// Branches are cut off after this many interfaces.
const DEEPEST: u32 = 1000;

/// What all batches of a run have in common.
#[derive(Debug)]
pub(super) struct Whitted<'s> {
    sensor: OneSensor<'s>,
    /// Gather paths in a batch.
    paths: u64,
    deepest: u32,
}

impl<'s> Whitted<'s> {
    pub(super) fn new(sensor: OneSensor<'s>) -> Self {
        let deepest = sensor.bounce_limit.min(DEEPEST);
        Self { paths: sensor.batch_paths(), deepest, sensor }
    }

    /// Traces one batch.
    pub(super) fn batch(&self, batch: u64) -> BaselineBatch {
        let mut readings = self.sensor.empty(self.paths, batch);
        let mut cut = 0.0;
        for index in batch * self.paths..(batch + 1) * self.paths {
            cut += self.trace(index, &mut readings);
        }
        readings.close_batch();
        BaselineBatch { readings, cut: cut / self.paths as f64 }
    }

    /// Traces all branches of a gather path; returns the throughput that was cut off.
    fn trace(&self, index: u64, readings: &mut Readings) -> f64 {
        let Self { sensor, deepest, .. } = self;
        let mut sampler = Sampler::for_path(sensor.seed, stream::BASELINE_PATHS, index);
        let Some(arrival) = sensor.arrivals.draw(&mut sampler) else { return 0.0 };
        let mut splitter = Splitter {
            whitted: self,
            etendue: sensor.etendue(&arrival) / self.paths as f64,
            cells: &arrival.cells,
            factor: 1.0,
            branches: Vec::new(),
            sampler: Sampler::for_path(sensor.seed, stream::BASELINE_BRANCHES, index),
            cut: 0.0,
            readings,
        };
        let gathering = sensor.gathering(u32::MAX);
        let mut segments = follow(gathering, &arrival, &mut sampler, &mut splitter);
        while let Some(Branch { path, factor }) = splitter.branches.pop() {
            if factor < CUT_OFF || path.depth >= *deepest {
                splitter.cut += factor;
                continue;
            }
            splitter.factor = factor;
            segments += follow_on(gathering, path, &mut sampler, &mut splitter);
        }
        let cut = splitter.cut;
        readings.segments += segments;
        cut
    }
}

/// A ray still to be followed.
struct Branch {
    /// Its start, at throughput 1, so that roulette does not treat it as weak.
    path: Path,
    /// The throughput up to there.
    factor: f64,
}

/// Counts the light of a branch up to its next interface, where it is split.
struct Splitter<'a, 's> {
    whitted: &'a Whitted<'s>,
    /// Etendue of the path, its share of the batch, mm² sr.
    etendue: f64,
    cells: &'a [usize],
    /// Throughput up to the start of the branch, 1.
    factor: f64,
    branches: Vec<Branch>,
    /// For random choices at interfaces.
    sampler: Sampler,
    cut: f64,
    readings: &'a mut Readings,
}

impl Splitter<'_, '_> {
    fn push(&mut self, path: &Path, vertex: &Vertex<'_>, out: Scattered) {
        let mut next = Path {
            ray: Ray::new(vertex.point, out.dir),
            throughput: 1.0,
            on: StartSurfaces::hits(vertex.hits),
            depth: path.depth + 1,
            ..path.clone()
        };
        if out.side == Side::Transmitted {
            next.medium = vertex.interface.to;
            vertex.hits.cross(&mut next.inside);
        }
        let factor = self.factor * vertex.throughput * out.factor;
        self.branches.push(Branch { path: next, factor });
    }
}

impl Observer for Splitter<'_, '_> {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Meet(met) => self.meet(path, met),
            Event::Arrive(vertex) => {
                self.split(path, vertex);
                return ControlFlow::Break(());
            }
            Event::Start(_)
            | Event::Travel(_)
            | Event::Jump(_)
            | Event::Collide(_)
            | Event::Convert(_)
            | Event::Depart(..)
            | Event::Absorbed(_)
            | Event::Detect(_)
            | Event::Roulette(_)
            | Event::Escaped(_)
            | Event::Cut(_)
            | Event::Leaked(..) => {}
        }
        ControlFlow::Continue(())
    }
}

impl Splitter<'_, '_> {
    fn meet(&mut self, path: &Path, met: &MetEmission) {
        let flux = met.radiance * self.factor * self.etendue;
        let light = DetectedLight {
            flux,
            depth: path.depth,
            source: met.source,
            wavelength: path.wavelength,
        };
        self.whitted.sensor.count(self.readings, self.cells, &light);
    }

    fn split(&mut self, path: &Path, vertex: &Vertex<'_>) {
        let scene = self.whitted.sensor.scene;
        let facing = facing(scene, path, vertex);
        let sides = [(Side::Reflected, facing.faces.own), (Side::Transmitted, facing.faces.behind)];
        if sides.iter().all(|(_, finish)| finish.is_specular()) {
            for (side, finish) in sides {
                let out = finish.scatter_toward(side, &facing.incidence, &mut self.sampler);
                if let Some(out) = out {
                    self.push(path, vertex, facing.corrected(out));
                }
            }
        } else if let Some(out) = scatter_gather_path(scene, path, vertex, &mut self.sampler) {
            self.push(path, vertex, out);
        }
    }
}
