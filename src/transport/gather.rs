//! The gather method: gather paths of limited depth from the sensors end in records, photons are streamed past them.
//!
//! A gather path goes on through specular and narrow scatter up to vertex D, where it leaves records for photons that
//! travel near the mirrored and the refracted direction: the position-and-angle estimate. On a surface that scatters
//! broadly, and where a medium scatters, it leaves records for all photons: the position estimate. Emission that it meets on its way counts as it is;
//! all other light, and what could be seen through vertex D, is brought by photons. So nothing counts twice.
//! All sensors share one stream of photons, and no photon is kept: memory goes with the records.
//! Merged with forward and backward, gather paths go on to the sources, and everything counts by its weight (`merge`).

mod merged;
mod stream;

use crate::optics::{Bsdf, Lobe, Side, Spread, scatter_toward, shares};
use crate::rng::{Dimension, Sampler};
use crate::scene::{Arrival, Arrivals, Scene, SensorId};
use crate::transport::ball::clipped_volumes;
use crate::transport::coverage::{Middle, coverage};
use crate::transport::emitters::{Emitters, Met};
use crate::transport::follow::{Collector, Gathering, follow};
use crate::transport::forward::{Forward, PhotonWatcher};
use crate::transport::gather::merged::{MergedStream, Merging};
use crate::transport::gather::stream::Stream;
use crate::transport::merge::{self, Etendues, Passage};
use crate::transport::readings::Counted;
use crate::transport::records::{GatherRecord, Records, Surfaces, Wanted};
use crate::transport::scatter::{Facing, facing};
use crate::transport::stop::{Pace, RECORD_WORK, StopSignal};
use crate::transport::window::{COUNTED, ESTIMATES, Window, estimates};
use crate::transport::work::RecordWork;
use crate::transport::{
    Collision, Departure, Layout, Loss, Path, ROULETTE_BELOW, Readings, Vertex,
};
use glam::DVec3;
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Streams of random numbers of the gather paths and of their records; each sensor has one of its own.
const PATH_STREAM: u64 = 2 << 32;
const RECORD_STREAM: u64 = 3 << 32;

/// What all passes of a run have in common.
#[derive(Debug)]
pub(crate) struct Gather<'s> {
    scene: &'s Scene,
    layout: Layout,
    emitters: Emitters<'s>,
    surfaces: Surfaces,
    sensors: Vec<(SensorId, Arrivals<'s>)>,
    seed: u64,
    /// Vertex at which gather paths end, D.
    pub(crate) depth: u32,
    /// Merged with forward and backward: gather paths go on from vertex D, to so many interfaces.
    pub(crate) merging: Option<u32>,
}

/// One pass: which, within what window, and from how many gather paths of each sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pass {
    pub(crate) batch: u64,
    pub(crate) window: Window,
    pub(crate) gather_paths: u64,
}

/// What a pass has counted.
#[derive(Debug)]
pub(crate) struct PassReadings {
    /// By the photons in the sensors' cells, and the balance.
    pub(crate) photons: Readings,
    /// By the records: E1, E2, E3 and E0; not yet closed.
    pub(crate) windows: [Readings; ESTIMATES],
    /// What was done beside tracing.
    pub(crate) work: RecordWork,
}

impl<'s> Gather<'s> {
    /// Prepares gather paths from some sensors that end at vertex `depth`.
    pub(crate) fn new(scene: &'s Scene, sensors: &[SensorId], seed: u64, depth: u32) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            emitters: Emitters::new(scene),
            surfaces: Surfaces::new(scene),
            sensors: sensors.iter().map(|&id| (id, Arrivals::new(scene, id))).collect(),
            seed,
            depth,
            merging: None,
        }
    }

    /// The sensors it estimates.
    pub(crate) fn sensors(&self) -> u64 {
        self.sensors.len() as u64
    }

    /// Runs one pass with the photons of a batch, which someone else may watch, too, unless all is merged. `None` if it was
    /// stopped.
    pub(crate) fn pass(
        &self,
        forward: &Forward<'_>,
        pass: Pass,
        beside: &mut impl PhotonWatcher,
        signal: &StopSignal,
    ) -> Option<PassReadings> {
        let pace = Pace::new(signal);
        let paths = pass.gather_paths;
        let empty = || Readings::of_batch(self.scene, &self.layout, self.seed, paths, pass.batch);
        let mut windows = [empty(), empty(), empty(), empty()];
        let photon_fluxes = forward.photon_fluxes();
        let beside_paths = Beside { photon_fluxes: &photon_fluxes, pace: &pace };
        let waiting = self.gather_paths(pass, beside_paths, &mut windows)?;
        let mut stream = Stream::new(self, pass, (&waiting, &pace), &mut windows);
        let photons = match self.merging {
            None => forward.batch_watched(pass.batch, &mut (&mut stream, beside), &pace)?,
            Some(_) => {
                let mut merged = MergedStream::new(&mut stream, pass, &photon_fluxes);
                forward.batch_watched(pass.batch, &mut merged, &pace)?
            }
        };
        let work = stream.finish();
        (!pace.is_stopped()).then_some(PassReadings { photons, windows, work })
    }

    /// Traces the gather paths of a pass; `None` if they were stopped.
    fn gather_paths(
        &self,
        pass: Pass,
        Beside { photon_fluxes, pace }: Beside<'_>,
        windows: &mut [Readings; ESTIMATES],
    ) -> Option<Waiting<'s>> {
        let mut found = Found::default();
        for (id, arrivals) in &self.sensors {
            for index in pass.batch * pass.gather_paths..(pass.batch + 1) * pass.gather_paths {
                if pace.spend(RECORD_WORK).is_break() {
                    return None;
                }
                let stream = id.index() as u64;
                let mut sampler = Sampler::for_path(self.seed, PATH_STREAM + stream, index);
                let Some(arrival) = arrivals.draw(&mut sampler) else { continue };
                let Arrival { extent, cells, .. } = &arrival;
                let etendue = Path::arriving(self.scene, &arrival).etendue(self.scene, *extent);
                let etendue = etendue / pass.gather_paths as f64;
                let mut collecting = Collecting {
                    gather: self,
                    window: pass.window,
                    etendue,
                    merging: self.merging.map(|_| Merging::new(etendue, photon_fluxes)),
                    id: *id,
                    index,
                    cells,
                    sampler: Sampler::for_path(self.seed, RECORD_STREAM + stream, index),
                    facing: None,
                    found: &mut found,
                    windows,
                };
                let gathering = Gathering {
                    scene: self.scene,
                    emitters: &self.emitters,
                    sensor: *id,
                    bounce_limit: self.merging.unwrap_or(u32::MAX),
                    pace: Some(pace),
                };
                let segments = follow(gathering, &arrival, &mut sampler, &mut collecting);
                windows[0].segments += segments;
            }
        }
        let records = Records::new(found.records, pass.window, &self.surfaces, pace)?;
        Some(Waiting { paths: found.paths, records })
    }
}

/// What is beside the gather paths of a pass.
#[derive(Clone, Copy)]
struct Beside<'a> {
    /// Flux of one photon of each source, lm or W.
    photon_fluxes: &'a [f64],
    /// What may stop them.
    pace: &'a Pace<'a>,
}

/// Gather paths that have ended, and their records.
#[derive(Debug, Default)]
struct Found<'s> {
    paths: Vec<Ended>,
    records: Vec<GatherRecord<'s>>,
}

/// The same, ready for photons.
#[derive(Debug)]
struct Waiting<'s> {
    paths: Vec<Ended>,
    records: Records<'s>,
}

/// A gather path that has ended in records.
#[derive(Debug)]
struct Ended {
    /// Its number among those of its sensor.
    index: u64,
    sensor: SensorId,
    cells: SmallVec<[usize; 1]>,
    /// Merged: what weighs its record, of which it then has one; the photon's part is still missing.
    etendues: Option<Etendues>,
}

/// Collects the light and the records of one gather path.
struct Collecting<'c, 's> {
    gather: &'c Gather<'s>,
    window: Window,
    /// Etendue of this path, its share of the pass, mm² sr.
    etendue: f64,
    merging: Option<Merging<'c>>,
    id: SensorId,
    /// The number of the path among those of its sensor.
    index: u64,
    cells: &'c SmallVec<[usize; 1]>,
    /// For what records draw; the path has a stream of its own.
    sampler: Sampler,
    /// The interface that the path has just met.
    facing: Option<Facing<'s>>,
    found: &'c mut Found<'s>,
    windows: &'c mut [Readings; ESTIMATES],
}

impl Collector for Collecting<'_, '_> {
    fn roulette_below(&self) -> f64 {
        self.merging.as_ref().map_or(ROULETTE_BELOW, |_| merge::ROULETTE_BELOW)
    }

    fn meet(&mut self, path: &Path, met: Met) {
        let flux = met.radiance * self.etendue;
        let weights = self.merging.as_ref().map_or([1.0; COUNTED], |merging| merging.weights(&met));
        for (readings, weight) in self.windows.iter_mut().zip(estimates(weights)) {
            let light = Counted { flux: flux * weight, depth: path.depth, source: met.source };
            readings.count(&self.gather.layout, self.id, self.cells, &light);
        }
    }

    fn lose(&mut self, throughput: f64, loss: Loss) {
        for readings in &mut *self.windows {
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
        if path.depth == self.gather.depth {
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

    fn collide(&mut self, path: &Path, collision: &Collision<'_>) -> ControlFlow<()> {
        self.add_collided(path, collision);
        // All light that is scattered there, the record brings.
        ControlFlow::Break(())
    }

    fn depart(&mut self, path: &Path, _: &Vertex<'_>, departure: &Departure) -> ControlFlow<()> {
        // Nothing faces the path where it meets no visible interface.
        let Some(facing) = self.facing.take() else { return ControlFlow::Continue(()) };
        if let Some(merging) = &mut self.merging
            && path.depth == self.gather.depth + 1
        {
            let passage = Passage::of_gather_path(&facing, departure.dir, departure.side);
            merging.pass_vertex_d(passage.etendues(self.window));
        }
        // What a broad lobe brings, the records at the vertex bring.
        match departure.lobe {
            Lobe::Diffuse if is_broad(&facing, departure.side) => ControlFlow::Break(()),
            Lobe::Diffuse | Lobe::Specular => ControlFlow::Continue(()),
        }
    }
}

/// Whether light that comes from a side is scattered broadly: reflected light by the finish met, transmitted light by
/// that of the other side.
fn is_broad(facing: &Facing<'_>, side: Side) -> bool {
    match finish(facing, side).kind() {
        Spread::Broad => true,
        Spread::Discrete | Spread::Narrow(_) => false,
    }
}

fn finish<'s>(facing: &Facing<'s>, side: Side) -> &'s Bsdf {
    match side {
        Side::Reflected => facing.faces.own,
        Side::Transmitted => facing.faces.behind,
    }
}

impl<'s> Collecting<'_, 's> {
    /// A record for photons that a broad finish scatters into the gather path: docs/method.md, eq. (22).
    fn add_scattered(&mut self, path: &Path, vertex: &Vertex<'_>, facing: &Facing<'s>, side: Side) {
        let bsdf = finish(facing, side);
        if bsdf.width().is_none() && shares(bsdf, &facing.incidence).of(side) == 0.0 {
            return;
        }
        // L* of the light that leaves, in the medium of the gather path.
        let index = facing.incidence.index_from;
        let value = self.etendue * vertex.throughput / (index * index);
        self.add(path, vertex, facing, side, value, Wanted::Scattered { bsdf, out: -vertex.dir });
    }

    /// A record for photons near the direction in which the gather path would go on: docs/method.md, eq. (15).
    fn add_along(&mut self, path: &Path, vertex: &Vertex<'_>, facing: &Facing<'s>, side: Side) {
        let bsdf = finish(facing, side);
        let Some(out) = scatter_toward(bsdf, side, &facing.incidence, &mut self.sampler) else {
            return;
        };
        if out.lobe == Lobe::Diffuse && is_broad(facing, side) {
            return;
        }
        let out = facing.corrected(out);
        // L* of the light that arrives, in the medium it arrives in.
        let index = match out.side {
            Side::Reflected => facing.incidence.index_from,
            Side::Transmitted => facing.incidence.index_to,
        };
        let value = self.etendue * vertex.throughput * out.factor / (index * index);
        let dir = out.dir.normalize();
        self.add(path, vertex, facing, side, value, Wanted::Along(-dir));
        if let (Some(merging), Some(ended)) = (&self.merging, self.found.paths.last_mut()) {
            let passage = Passage::of_gather_path(facing, dir, side);
            ended.etendues = Some(merging.waiting(passage.etendues(self.window)));
        }
    }

    /// A record for photons that a medium scatters into the gather path: docs/method.md, eq. (24).
    fn add_collided(&mut self, path: &Path, collision: &Collision<'_>) {
        let Gather { scene, surfaces, .. } = self.gather;
        let &Collision { point, dir, medium, scattering, throughput } = collision;
        let index = scene.media[medium.index()].index(path.wavelength);
        let value = self.etendue * throughput / (index * index * scattering.coefficient());
        let turn = self.sampler.pair(Dimension::GatherPosition);
        let volumes = clipped_volumes(scene, path, point, self.window, turn);
        let path_place = self.place();
        self.found.records.push(GatherRecord {
            point,
            normal: DVec3::ZERO,
            surface: surfaces.of_medium(medium),
            medium,
            wanted: Wanted::Collided { scattering: *scattering, out: -dir },
            values: volumes.map(|volume| value / volume),
            path: path_place,
            depth: path.depth + 1,
        });
    }

    /// `value` is the etendue of the path times what its throughput makes of flux per area (and solid angle).
    fn add(
        &mut self,
        path: &Path,
        vertex: &Vertex<'_>,
        facing: &Facing<'s>,
        side: Side,
        value: f64,
        wanted: Wanted<'s>,
    ) {
        let Gather { scene, surfaces, .. } = self.gather;
        let interface = vertex.interface;
        let prim = interface.acting.prim;
        let (normal, medium) = match side {
            Side::Reflected => (facing.facet, interface.from),
            Side::Transmitted => (-facing.facet, interface.to),
        };
        let middle = Middle { prim, surface: surfaces.of(prim), point: vertex.point, normal };
        let turn = self.sampler.one(Dimension::GatherPosition);
        let covered = coverage(scene, surfaces, &middle, self.window, turn);
        let nested = self.window.nested();
        let values = [0, 1, 2].map(|window| value / (covered[window] * nested[window].area()));
        let path_place = self.place();
        self.found.records.push(GatherRecord {
            point: vertex.point,
            normal,
            surface: middle.surface,
            medium,
            wanted,
            values,
            path: path_place,
            depth: path.depth + 1,
        });
    }

    /// The place of this path among those that have ended in records.
    fn place(&mut self) -> u32 {
        let of_this = |last: &Ended| (last.sensor, last.index) == (self.id, self.index);
        if self.merging.is_some() || !self.found.paths.last().is_some_and(of_this) {
            let (sensor, cells) = (self.id, self.cells.clone());
            self.found.paths.push(Ended { index: self.index, sensor, cells, etendues: None });
        }
        self.found.paths.len() as u32 - 1
    }
}
