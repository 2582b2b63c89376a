//! The gather method: gather paths of limited depth from the sensors end in records, photons are streamed past them.
//!
//! A gather path goes on through specular and narrow scatter up to vertex D, where it leaves records for photons that
//! travel near the mirrored and the refracted direction: the position-and-angle estimate. On a surface that scatters
//! broadly it leaves records for all photons: the position estimate. Emission that it meets on its way counts as it is;
//! all other light, and what could be seen through vertex D, is brought by photons. So nothing counts twice.
//! All sensors share one stream of photons, and no photon is kept: memory goes with the records.

use crate::optics::{Bsdf, Incidence, Lobe, Side, Spread, scatter_toward, shares};
use crate::rng::{Dimension, Sampler};
use crate::scene::shape::Toward;
use crate::scene::{Arrival, Arrivals, MediumId, Scene, SensorId, SourceId, Visibility};
use crate::transport::coverage::{Middle, coverage};
use crate::transport::emitters::{Emitters, Met};
use crate::transport::estimate::{Arriving, Kernel};
use crate::transport::follow::{Collector, Gathering, follow};
use crate::transport::forward::{Forward, PhotonWatcher};
use crate::transport::readings::Counted;
use crate::transport::records::{GatherRecord, Records, Slot, Surfaces, Wanted};
use crate::transport::scatter::{Facing, facing};
use crate::transport::window::{NESTED, Window};
use crate::transport::work::RecordWork;
use crate::transport::{Departure, Layout, Path, Readings, Vertex};
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
    /// By the records, within each of the nested windows; not yet closed.
    pub(crate) windows: [Readings; NESTED],
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
        }
    }

    /// The sensors it estimates.
    pub(crate) fn sensors(&self) -> u64 {
        self.sensors.len() as u64
    }

    /// Runs one pass with the photons of a batch.
    pub(crate) fn pass(&self, forward: &Forward<'_>, pass: Pass) -> PassReadings {
        let paths = pass.gather_paths;
        let empty = || Readings::of_batch(self.scene, &self.layout, self.seed, paths, pass.batch);
        let mut windows = [empty(), empty(), empty()];
        let waiting = self.gather_paths(pass, &mut windows);
        let mut stream = Stream {
            gather: self,
            kernel: Kernel::new(pass.window),
            work: RecordWork { records: waiting.records.all.len() as u64, ..RecordWork::default() },
            waiting: &waiting,
            windows: &mut windows,
        };
        let photons = forward.batch_watched(pass.batch, &mut stream);
        let work = stream.work;
        PassReadings { photons, windows, work }
    }

    /// Traces the gather paths of a pass.
    fn gather_paths(&self, pass: Pass, windows: &mut [Readings; NESTED]) -> Waiting<'s> {
        let mut found = Found::default();
        for (id, arrivals) in &self.sensors {
            for index in pass.batch * pass.gather_paths..(pass.batch + 1) * pass.gather_paths {
                let stream = id.index() as u64;
                let mut sampler = Sampler::for_path(self.seed, PATH_STREAM + stream, index);
                let Some(arrival) = arrivals.draw(&mut sampler) else { continue };
                let Arrival { extent, cells, .. } = &arrival;
                let etendue = Path::arriving(self.scene, &arrival).etendue(self.scene, *extent);
                let mut collecting = Collecting {
                    gather: self,
                    window: pass.window,
                    etendue: etendue / pass.gather_paths as f64,
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
                    bounce_limit: u32::MAX,
                };
                let segments = follow(gathering, &arrival, &mut sampler, &mut collecting);
                windows[0].segments += segments;
            }
        }
        let records = Records::new(found.records, pass.window, &self.surfaces);
        Waiting { paths: found.paths, records }
    }
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
}

/// Collects the light and the records of one gather path.
struct Collecting<'c, 's> {
    gather: &'c Gather<'s>,
    window: Window,
    /// Etendue of this path, its share of the pass, mm² sr.
    etendue: f64,
    id: SensorId,
    /// The number of the path among those of its sensor.
    index: u64,
    cells: &'c SmallVec<[usize; 1]>,
    /// For what records draw; the path has a stream of its own.
    sampler: Sampler,
    /// The interface that the path has just met.
    facing: Option<Facing<'s>>,
    found: &'c mut Found<'s>,
    windows: &'c mut [Readings; NESTED],
}

impl Collector for Collecting<'_, '_> {
    fn meet(&mut self, path: &Path, met: Met) {
        let light =
            Counted { flux: met.radiance * self.etendue, depth: path.depth, source: met.source };
        for readings in self.windows.iter_mut() {
            readings.count(&self.gather.layout, self.id, self.cells, &light);
        }
    }

    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) -> ControlFlow<()> {
        let facing = facing(self.gather.scene, path, vertex);
        for side in [Side::Reflected, Side::Transmitted] {
            if is_broad(&facing, side) {
                self.add_scattered(path, vertex, &facing, side);
            }
        }
        if path.depth < self.gather.depth {
            self.facing = Some(facing);
            return ControlFlow::Continue(());
        }
        for side in [Side::Reflected, Side::Transmitted] {
            self.add_along(path, vertex, &facing, side);
        }
        ControlFlow::Break(())
    }

    fn depart(&mut self, _: &Path, _: &Vertex<'_>, departure: &Departure) -> ControlFlow<()> {
        // What a broad lobe brings, the records at the vertex bring.
        let broad = self.facing.as_ref().is_some_and(|facing| is_broad(facing, departure.side));
        match departure.lobe {
            Lobe::Diffuse if broad => ControlFlow::Break(()),
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
    /// A record for photons that a broad finish scatters into the gather path: eq. (2).
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

    /// A record for photons near the direction in which the gather path would go on: eq. (3).
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
        self.add(path, vertex, facing, side, value, Wanted::Along(-out.dir.normalize()));
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
        if self.found.paths.last().is_none_or(|last| last.index != self.index) {
            let (sensor, cells) = (self.id, self.cells.clone());
            self.found.paths.push(Ended { index: self.index, sensor, cells });
        }
        self.found.records.push(GatherRecord {
            point: vertex.point,
            normal,
            surface: middle.surface,
            medium,
            wanted,
            values,
            path: self.found.paths.len() as u32 - 1,
            depth: path.depth + 1,
        });
    }
}

/// Photons that stream past the records.
struct Stream<'p, 's> {
    gather: &'p Gather<'s>,
    kernel: Kernel,
    waiting: &'p Waiting<'s>,
    windows: &'p mut [Readings; NESTED],
    work: RecordWork,
}

impl PhotonWatcher for Stream<'_, '_> {
    #[inline(always)]
    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>, flux: f64, source: SourceId) {
        let surface = self.gather.surfaces.of(vertex.interface.acting.prim);
        if vertex.interface.visibility == Visibility::Visible
            && self.waiting.records.may_take(surface, vertex.point, vertex.dir)
        {
            self.look_up(path, vertex, flux * vertex.throughput, source);
        }
    }
}

impl Stream<'_, '_> {
    #[inline(never)]
    fn look_up(&mut self, path: &Path, vertex: &Vertex<'_>, flux: f64, source: SourceId) {
        let Gather { scene, surfaces, layout, .. } = self.gather;
        let surface = surfaces.of(vertex.interface.acting.prim);
        // Most photons that pass the filter are near no record after all.
        let mut known = None;
        let (kernel, windows, work) = (&self.kernel, &mut *self.windows, &mut self.work);
        work.look_ups += 1;
        self.waiting.records.visit(surface, vertex.point, vertex.dir, |record| {
            let photon = known.get_or_insert_with(|| arriving(scene, surface, path, vertex));
            let Some(shares) = kernel.flux(record, photon) else { return };
            work.pairs += 1;
            let Ended { sensor, cells, .. } = &self.waiting.paths[record.path as usize];
            let depth = path.depth + record.depth;
            for (readings, share) in windows.iter_mut().zip(shares) {
                if share > 0.0 {
                    let light = Counted { flux: flux * share, depth, source };
                    readings.count(layout, *sensor, cells, &light);
                }
            }
        });
    }
}

/// A photon as records take it.
fn arriving(scene: &Scene, surface: Slot, path: &Path, vertex: &Vertex<'_>) -> Arriving {
    let interface = vertex.interface;
    let index = |medium: MediumId| scene.media[medium.index()].index(path.wavelength);
    let outward = scene.normal(interface.acting.prim, vertex.point);
    Arriving {
        surface,
        medium: interface.from,
        point: vertex.point,
        incidence: Incidence {
            dir: vertex.dir,
            normal: match interface.acting.toward {
                Toward::Front => -outward,
                Toward::Back => outward,
            },
            index_from: index(interface.from),
            index_to: index(interface.to),
        },
    }
}
