//! One gather path: it leaves records, where it ends unless it is merged, and then counts the light that it meets.

use crate::optics::{Finish, FinishModel, Lobe, Side, Spread};
use crate::rng::{Dimension, Sampler};
use crate::scene::{RowReach, SensorId};
use crate::transport::connect::vertex::ScatteringVertex;
use crate::transport::gather::ball::clipped_ball;
use crate::transport::gather::coverage::{Coverage, Middle, coverage};
use crate::transport::gather::estimator::{Gather, RecordedPath};
use crate::transport::gather::kernel::ORDERS;
use crate::transport::gather::records::{
    GatherRecord, RecordKind, RecordPath, SurfaceRecord, VolumeRecord,
};
use crate::transport::gather::shares::{MergedPath, MergedRecord};
use crate::transport::tally::sensor_reading::DetectedLight;
use crate::transport::walk::scatter::{MetInterface, facing};
use crate::transport::window::Window;
use crate::transport::{
    Collision, Departure, Event, Loss, MetEmission, Observer, Path, Readings, Vertex,
};
use glam::DVec3;
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Gather paths that have ended, and their records.
#[derive(Debug, Default)]
pub(crate) struct EndedPaths<'s> {
    /// Passes of the block, and the one that is being traced.
    pub(crate) passes: usize,
    pub(crate) pass: usize,
    pub(crate) paths: Vec<RecordedPath<'s>>,
    pub(crate) records: Vec<GatherRecord<'s>>,
}

/// Collects the light and the records of one gather path.
pub(crate) struct Collecting<'c, 's> {
    pub(crate) gather: &'c Gather<'s>,
    pub(crate) window: Window,
    /// Etendue of this path, its share of the pass, mm² sr.
    pub(crate) etendue: f64,
    /// If merged: what weights its records; another observer then counts the emission it meets.
    pub(crate) merged: Option<MergedPath<'s>>,
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

/// A gather path at an interface.
#[derive(Clone, Copy)]
struct PathAtFace<'a, 's> {
    path: &'a Path,
    vertex: &'a Vertex<'a>,
    facing: MetInterface<'s>,
}

impl Observer for Collecting<'_, '_> {
    fn allows_jumps(&self) -> bool {
        self.merged.is_none()
    }

    fn limit_row(&self, path: &Path, reach: &mut RowReach) {
        // The bounces of a row only mirror, so the only records on them are those of vertex D.
        reach.end_after(self.gather.settings.depth.saturating_sub(path.depth));
    }

    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Meet(met) if self.merged.is_none() => self.meet(path, met),
            Event::Cut(throughput) if self.merged.is_none() => self.lose(throughput, Loss::Cut),
            Event::Leaked(_, throughput) if self.merged.is_none() => {
                self.lose(throughput, Loss::Leaked);
            }
            Event::Arrive(vertex) => return self.arrive(path, vertex),
            Event::Depart(vertex, departure) => return self.depart(vertex, departure),
            Event::Collide(collision) => return self.collide(path, collision),
            Event::Meet(_)
            | Event::Cut(_)
            | Event::Leaked(..)
            | Event::Start(_)
            | Event::Travel(_)
            | Event::Jump(_)
            | Event::Convert(_)
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
        let flux = met.radiance * self.etendue;
        let light = DetectedLight {
            flux,
            depth: path.depth,
            source: met.source,
            wavelength: path.wavelength,
        };
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
            let share = throughput / readings.batch_paths as f64;
            readings.count_lost(&self.gather.layout, self.id, share, loss);
        }
    }

    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) -> ControlFlow<()> {
        let vertex_d = self.gather.settings.depth;
        if path.depth > vertex_d {
            return ControlFlow::Continue(());
        }
        let facing = facing(self.gather.scene, path, vertex);
        if let Some(merged) = &mut self.merged {
            merged.meet(ScatteringVertex::at(vertex.point, facing), vertex.dir);
        }
        let at = PathAtFace { path, vertex, facing };
        for side in [Side::Reflected, Side::Transmitted] {
            if is_broad(&facing, side) {
                self.add_scattered(at, side);
            }
        }
        if path.depth == vertex_d {
            for side in [Side::Reflected, Side::Transmitted] {
                self.add_along(at, side);
            }
            if self.merged.is_none() {
                return ControlFlow::Break(());
            }
        }
        self.facing = Some(facing);
        ControlFlow::Continue(())
    }

    fn depart(&mut self, vertex: &Vertex<'_>, departure: &Departure) -> ControlFlow<()> {
        // Nothing faces the path where it meets no visible interface.
        let Some(facing) = self.facing.take() else { return ControlFlow::Continue(()) };
        if let Some(merged) = &mut self.merged {
            merged.depart(vertex.dir, departure);
            return ControlFlow::Continue(());
        }
        // The records at the vertex count the light of a broad lobe.
        match departure.lobe {
            Lobe::Diffuse if is_broad(&facing, departure.side) => ControlFlow::Break(()),
            Lobe::Diffuse | Lobe::Specular => ControlFlow::Continue(()),
        }
    }

    fn collide(&mut self, path: &Path, collision: &Collision<'_>) -> ControlFlow<()> {
        if path.depth > self.gather.settings.depth {
            return ControlFlow::Continue(());
        }
        if let Some(merged) = &mut self.merged {
            let vertex = ScatteringVertex::in_medium(self.gather.scene, path, collision);
            merged.meet(vertex, collision.dir);
        }
        self.add_collided(path, collision);
        let Some(merged) = &mut self.merged else {
            // The record counts all light that is scattered there.
            return ControlFlow::Break(());
        };
        merged.collide(collision);
        ControlFlow::Continue(())
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
    /// Etendue of the path for light that its records take, mm² sr.
    fn pair_etendue(&self, path: &Path) -> f64 {
        self.etendue * self.gather.scene.pair_weight(path.band)
    }

    /// A record for photons that a broad finish scatters into the gather path: docs/method.md, eq. (22).
    fn add_scattered(&mut self, at: PathAtFace<'_, 's>, side: Side) {
        let PathAtFace { path, vertex, facing } = at;
        let finish = finish(&facing, side);
        if finish.width().is_none() && finish.radiance_chances(&facing.incidence).of(side) == 0.0 {
            return;
        }
        // L* of the leaving light, in the medium of the gather path.
        let index = facing.incidence.index_from;
        let value = self.pair_etendue(path) * vertex.throughput / (index * index);
        let kind = RecordKind::Scattered { finish, out: -vertex.dir };
        self.add(at, (side, Lobe::Diffuse), value, kind);
    }

    /// A record for photons near the direction in which the gather path would continue:
    /// docs/method.md, eq. (15).
    fn add_along(&mut self, at: PathAtFace<'_, 's>, side: Side) {
        let PathAtFace { path, vertex, facing } = at;
        let finish = finish(&facing, side);
        let Some(out) = finish.scatter_toward(side, &facing.incidence, &mut self.sampler) else {
            return;
        };
        if out.lobe == Lobe::Diffuse && is_broad(&facing, side) {
            return;
        }
        let out = facing.corrected(out);
        // L* of the arriving light, in the medium it arrives in.
        let index = match out.side {
            Side::Reflected => facing.incidence.index_from,
            Side::Transmitted => facing.incidence.index_to,
        };
        let value = self.pair_etendue(path) * vertex.throughput * out.factor / (index * index);
        self.add(at, (side, out.lobe), value, RecordKind::Along(-out.dir.normalize()));
    }

    /// A record for photons that a medium scatters into the gather path: docs/method.md, eq. (23).
    fn add_collided(&mut self, path: &Path, collision: &Collision<'_>) {
        let Gather { scene, surfaces, .. } = self.gather;
        let &Collision { point, dir, medium, scattering, throughput, .. } = collision;
        let index = scene.media[medium.index()].index(path.wavelength);
        let value =
            self.pair_etendue(path) * throughput / (index * index * scattering.coefficient());
        let turn = self.sampler.pair(Dimension::GatherPosition);
        let ball = clipped_ball(scene, path, point, self.window, turn);
        let merged = self.merged_record((dir, Lobe::Diffuse), None);
        let record = VolumeRecord {
            point,
            medium: surfaces.of_medium(medium),
            scattering: *scattering,
            out: -dir,
            value: value / ball.volume,
            kernels: ball.kernels,
            path: self.path_of_record(path, merged),
        };
        self.found.records.push(GatherRecord::Volume(record));
    }

    /// `value` is the etendue of the path times its throughput per flux per area (and solid angle).
    fn add(
        &mut self,
        at: PathAtFace<'_, 's>,
        (side, lobe): (Side, Lobe),
        value: f64,
        kind: RecordKind<'s>,
    ) {
        let PathAtFace { path, vertex, facing } = at;
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
        let merged = self.merged_record((vertex.dir, lobe), along);
        let path = self.path_of_record(path, merged);
        let (point, surface) = (vertex.point, middle.surface);
        let Coverage { kernels, slope, .. } = covered;
        let record =
            SurfaceRecord { point, normal, surface, medium, kind, value, kernels, slope, path };
        self.found.records.push(GatherRecord::Surface(record));
    }

    /// What weights a record for light by a lobe into the path, which travels along `dir`.
    fn merged_record(
        &self,
        (dir, lobe): (DVec3, Lobe),
        along: Option<DVec3>,
    ) -> Option<MergedRecord<'s>> {
        let backward = self.gather.merging.as_ref()?;
        Some(self.merged.as_ref()?.record((backward, self.id), (dir, lobe), along))
    }

    /// This path, as one that ends in records.
    fn path_of_record(&mut self, path: &Path, merged: Option<MergedRecord<'s>>) -> RecordPath {
        let of_this = |last: &RecordedPath<'_>| (last.sensor, last.index) == (self.id, self.index);
        if merged.is_some() || !self.found.paths.last().is_some_and(of_this) {
            let (sensor, cells) = (self.id, self.cells.clone());
            self.found.paths.push(RecordedPath {
                index: self.index,
                sensor,
                pass: self.found.pass,
                cells,
                merged,
            });
        }
        RecordPath {
            place: self.found.paths.len() as u32 - 1,
            depth: path.depth + 1,
            band: path.band,
        }
    }
}
