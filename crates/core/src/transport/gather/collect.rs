//! One gather path: it counts the light that it meets, and leaves records where it ends.

use crate::optics::{Finish, FinishModel, Lobe, Side, Spread};
use crate::rng::{Dimension, Sampler};
use crate::scene::SensorId;
use crate::transport::gather::ball::clipped_ball;
use crate::transport::gather::coverage::{Coverage, Middle, coverage};
use crate::transport::gather::estimator::{Gather, RecordedPath};
use crate::transport::gather::kernel::ORDERS;
use crate::transport::gather::merge::{self, FacePassage};
use crate::transport::gather::merged::Merging;
use crate::transport::gather::records::{
    GatherRecord, RecordKind, RecordPath, SurfaceRecord, VolumeRecord,
};
use crate::transport::gather::window::Window;
use crate::transport::tally::readings::DetectedLight;
use crate::transport::walk::scatter::{MetInterface, facing};
use crate::transport::{
    Collision, Departure, Event, Loss, MetEmission, Observer, Path, ROULETTE_BELOW, Readings,
    Vertex,
};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Gather paths that have ended, and their records.
#[derive(Debug, Default)]
pub(crate) struct EndedPaths<'s> {
    /// Passes of the block, and the one that is being traced.
    pub(crate) passes: usize,
    pub(crate) pass: usize,
    pub(crate) paths: Vec<RecordedPath>,
    pub(crate) records: Vec<GatherRecord<'s>>,
}

/// Collects the light and the records of one gather path.
pub(crate) struct Collecting<'c, 's> {
    pub(crate) gather: &'c Gather<'s>,
    pub(crate) window: Window,
    /// Etendue of this path, its share of the pass, mm² sr.
    pub(crate) etendue: f64,
    pub(crate) merging: Option<Merging<'c>>,
    pub(crate) id: SensorId,
    /// The number of the path among those of its sensor.
    pub(crate) index: u64,
    pub(crate) cells: &'c SmallVec<[usize; 1]>,
    /// For the draws of records; the path has a separate stream.
    pub(crate) sampler: Sampler,
    /// The interface that the path has just met.
    pub(crate) facing: Option<MetInterface<'s>>,
    pub(crate) found: &'c mut EndedPaths<'s>,
    pub(crate) orders: &'c mut [Readings; ORDERS],
}

impl Observer for Collecting<'_, '_> {
    fn roulette_below(&self) -> f64 {
        self.merging.as_ref().map_or(ROULETTE_BELOW, |_| merge::ROULETTE_BELOW)
    }

    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Meet(met) => self.meet(path, met),
            Event::Cut(throughput) => self.lose(throughput, Loss::Cut),
            Event::Leaked(_, throughput) => self.lose(throughput, Loss::Leaked),
            Event::Arrive(vertex) => return self.arrive(path, vertex),
            Event::Depart(_, departure) => return self.depart(path, departure),
            Event::Collide(collision) => {
                self.add_collided(path, collision);
                // The record counts all light that is scattered there.
                return ControlFlow::Break(());
            }
            Event::Start(_)
            | Event::Travel(_)
            | Event::Absorbed(_)
            | Event::Detect(_)
            | Event::Roulette(_)
            | Event::Escaped(_) => {}
        }
        ControlFlow::Continue(())
    }
}

impl Collecting<'_, '_> {
    fn meet(&mut self, path: &Path, met: &MetEmission) {
        let weight = self.merging.as_ref().map_or(1.0, |merging| merging.weight(met));
        let flux = met.radiance * self.etendue * weight;
        let light = DetectedLight { flux, depth: path.depth, source: met.source };
        for readings in &mut *self.orders {
            readings.count(
                (&self.gather.layout, &self.gather.scene.light),
                self.id,
                self.cells,
                &light,
            );
        }
    }

    fn lose(&mut self, throughput: f64, loss: Loss) {
        for readings in &mut *self.orders {
            readings.count_lost(&self.gather.layout, self.id, throughput, loss);
        }
    }

    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) -> ControlFlow<()> {
        let facing = facing(self.gather.scene, path, vertex);
        for side in [Side::Reflected, Side::Transmitted] {
            if is_broad(&facing, side) {
                self.add_scattered(path, vertex, &facing, side);
            }
        }
        if path.depth == self.gather.settings.depth {
            for side in [Side::Reflected, Side::Transmitted] {
                self.add_along(path, vertex, &facing, side);
            }
            if self.merging.is_none() {
                return ControlFlow::Break(());
            }
        }
        self.facing = Some(facing);
        ControlFlow::Continue(())
    }

    fn depart(&mut self, path: &Path, departure: &Departure) -> ControlFlow<()> {
        // Nothing faces the path where it meets no visible interface.
        let Some(facing) = self.facing.take() else { return ControlFlow::Continue(()) };
        if let Some(merging) = &mut self.merging
            && path.depth == self.gather.settings.depth + 1
        {
            let passage = FacePassage::of_gather_path(&facing, departure.dir, departure.side);
            merging.pass_vertex_d(passage.etendue(self.window));
        }
        // The records at the vertex count the light of a broad lobe.
        match departure.lobe {
            Lobe::Diffuse if is_broad(&facing, departure.side) => ControlFlow::Break(()),
            Lobe::Diffuse | Lobe::Specular => ControlFlow::Continue(()),
        }
    }
}

/// Whether light from a side is scattered broadly: reflected light by the finish met, transmitted
/// light by that of the other side.
fn is_broad(facing: &MetInterface<'_>, side: Side) -> bool {
    match finish(facing, side).spread() {
        Spread::Broad => true,
        Spread::Discrete | Spread::Narrow(_) => false,
    }
}

fn finish<'s>(facing: &MetInterface<'s>, side: Side) -> &'s Finish {
    match side {
        Side::Reflected => facing.faces.own,
        Side::Transmitted => facing.faces.behind,
    }
}

impl<'s> Collecting<'_, 's> {
    /// A record for photons that a broad finish scatters into the gather path: docs/method.md, eq. (22).
    fn add_scattered(
        &mut self,
        path: &Path,
        vertex: &Vertex<'_>,
        facing: &MetInterface<'s>,
        side: Side,
    ) {
        let finish = finish(facing, side);
        if finish.width().is_none() && finish.shares(&facing.incidence).of(side) == 0.0 {
            return;
        }
        // L* of the leaving light, in the medium of the gather path.
        let index = facing.incidence.index_from;
        let value = self.etendue * vertex.throughput / (index * index);
        self.add(
            path,
            vertex,
            facing,
            side,
            value,
            RecordKind::Scattered { finish, out: -vertex.dir },
        );
    }

    /// A record for photons near the direction in which the gather path would continue:
    /// docs/method.md, eq. (15).
    fn add_along(
        &mut self,
        path: &Path,
        vertex: &Vertex<'_>,
        facing: &MetInterface<'s>,
        side: Side,
    ) {
        let finish = finish(facing, side);
        let Some(out) = finish.scatter_toward(side, &facing.incidence, &mut self.sampler) else {
            return;
        };
        if out.lobe == Lobe::Diffuse && is_broad(facing, side) {
            return;
        }
        let out = facing.corrected(out);
        // L* of the arriving light, in the medium it arrives in.
        let index = match out.side {
            Side::Reflected => facing.incidence.index_from,
            Side::Transmitted => facing.incidence.index_to,
        };
        let value = self.etendue * vertex.throughput * out.factor / (index * index);
        let dir = out.dir.normalize();
        self.add(path, vertex, facing, side, value, RecordKind::Along(-dir));
        if let (Some(merging), Some(ended)) = (&self.merging, self.found.paths.last_mut()) {
            let passage = FacePassage::of_gather_path(facing, dir, side);
            ended.etendues = Some(merging.waiting(passage.etendue(self.window)));
        }
    }

    /// A record for photons that a medium scatters into the gather path: docs/method.md, eq. (23).
    fn add_collided(&mut self, path: &Path, collision: &Collision<'_>) {
        let Gather { scene, surfaces, .. } = self.gather;
        let &Collision { point, dir, medium, scattering, throughput } = collision;
        let index = scene.media[medium.index()].index(path.wavelength);
        let value = self.etendue * throughput / (index * index * scattering.coefficient());
        let turn = self.sampler.pair(Dimension::GatherPosition);
        let ball = clipped_ball(scene, path, point, self.window, turn);
        let record = VolumeRecord {
            point,
            medium: surfaces.of_medium(medium),
            scattering: *scattering,
            out: -dir,
            value: value / ball.volume,
            kernels: ball.kernels,
            path: self.path_of_record(path),
        };
        self.found.records.push(GatherRecord::Volume(record));
    }

    /// `value` is the etendue of the path times its throughput per flux per area (and solid angle).
    fn add(
        &mut self,
        path: &Path,
        vertex: &Vertex<'_>,
        facing: &MetInterface<'s>,
        side: Side,
        value: f64,
        kind: RecordKind<'s>,
    ) {
        let Gather { scene, surfaces, .. } = self.gather;
        let interface = vertex.interface;
        let prim = interface.acting.prim;
        let (normal, medium) = match side {
            Side::Reflected => (facing.facet, interface.from),
            Side::Transmitted => (-facing.facet, interface.to),
        };
        let along = match kind {
            RecordKind::Along(dir) => Some(dir),
            RecordKind::Scattered { .. } => None,
        };
        let middle =
            Middle { prim, surface: surfaces.of(prim), point: vertex.point, normal, along };
        let turn = self.sampler.one(Dimension::GatherPosition);
        let covered = coverage(scene, surfaces, &middle, self.window, turn);
        let value = value / (covered.share * self.window.area());
        let path = self.path_of_record(path);
        let (point, surface) = (vertex.point, middle.surface);
        let Coverage { kernels, slope, .. } = covered;
        let record =
            SurfaceRecord { point, normal, surface, medium, kind, value, kernels, slope, path };
        self.found.records.push(GatherRecord::Surface(record));
    }

    /// This path, as one that ends in records.
    fn path_of_record(&mut self, path: &Path) -> RecordPath {
        let of_this = |last: &RecordedPath| (last.sensor, last.index) == (self.id, self.index);
        if self.merging.is_some() || !self.found.paths.last().is_some_and(of_this) {
            let (sensor, cells) = (self.id, self.cells.clone());
            self.found.paths.push(RecordedPath {
                index: self.index,
                sensor,
                pass: self.found.pass,
                cells,
                etendues: None,
            });
        }
        RecordPath { place: self.found.paths.len() as u32 - 1, depth: path.depth + 1 }
    }
}
