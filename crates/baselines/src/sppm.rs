//! Stochastic progressive photon mapping without an estimate on specular surfaces.
//!
//! Hachisuka & Jensen, Stochastic Progressive Photon Mapping, ACM Trans. Graph. 28 (2009) 141, with
//! the radii of Knaus & Zwicker, Progressive Photon Mapping: A Probabilistic Approach, ACM Trans.
//! Graph. 30 (2011) 25: every pass is a separate photon map, and the value is the mean over passes.
//! Gather paths continue through specular surfaces and leave records where a surface scatters; in
//! purely specular scenes they count only the sources they hit.

use crate::one_sensor::{BATCH_SEGMENTS, OneSensor};
use glam::DVec3;
use lumiduct_core::optics::{FinishModel, Incidence, Lobe};
use lumiduct_core::plan::RunPlan;
use lumiduct_core::rng::{Sampler, stream};
use lumiduct_core::scene::Visibility;
use lumiduct_core::transport::forward::Forward;
use lumiduct_core::transport::gather::contribution::{PairWeights, PhotonHit, SurfaceHit};
use lumiduct_core::transport::gather::index::PhotonKey;
use lumiduct_core::transport::gather::kernel::Kernels;
use lumiduct_core::transport::gather::records::{
    GatherRecord, RecordKind, RecordPath, Records, SurfaceRecord,
};
use lumiduct_core::transport::gather::settings::groups;
use lumiduct_core::transport::gather::surfaces::SurfaceNumbers;
use lumiduct_core::transport::stop::{Pace, StopSignal};
use lumiduct_core::transport::tally::sensor_reading::DetectedLight;
use lumiduct_core::transport::walk::follow::follow;
use lumiduct_core::transport::walk::scatter::facing;
use lumiduct_core::transport::{
    Emergence, Event, MetEmission, Observer, Path, PhotonPilot, Readings, Stepping, Vertex, Window,
};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// α of the radii, 1: squares fall as i^(α-1); 2/3 is best for the mean square error (Knaus & Zwicker 2011).
const ALPHA: f64 = 2.0 / 3.0;
/// Gather paths end after this many interfaces.
const DEEPEST: u32 = 1000;
/// Work of a pass in batches of the other baselines: small passes shrink the radius sooner.
const PASS_BATCHES: u64 = 4;
/// Photon paths of a pass for each of its gather paths.
const PHOTONS_PER_PATH: u64 = 4;

/// What all passes of a run have in common.
#[derive(Debug)]
pub(super) struct Sppm<'s> {
    sensor: OneSensor<'s>,
    surfaces: SurfaceNumbers,
    forward: Forward<'s>,
    /// Radius of the first pass, mm.
    radius: f64,
    /// Gather paths of a pass.
    paths: u64,
}

impl<'s> Sppm<'s> {
    pub(super) fn new(sensor: OneSensor<'s>, plan: &RunPlan) -> Self {
        let (scene, seed) = (sensor.scene, plan.seed);
        let pilot = Forward::new(scene, seed, plan.bounce_limit.min(10_000), 64);
        let signal = StopSignal::default();
        let pilot = pilot.batch_observed(0, &mut Stepping, &Pace::new(&signal));
        let pilot = pilot.expect("nothing stops it");
        let segments = pilot.segments.div_ceil(pilot.paths().max(1)).max(1);
        let photons = (PASS_BATCHES * BATCH_SEGMENTS / segments).max(256);
        let pilot = PhotonPilot::new(segments as f64, segments as f64);
        let groups = groups(scene, plan, (&[sensor.id], 1), pilot, &signal);
        let window = groups.expect("nothing stops it")[0].settings.window;
        Self {
            surfaces: SurfaceNumbers::new(scene),
            forward: Forward::new(scene, seed, plan.bounce_limit, photons),
            radius: window.radius,
            paths: photons / PHOTONS_PER_PATH,
            sensor,
        }
    }

    /// Runs one pass: gather paths, then photons past their records.
    pub(super) fn pass(&self, batch: u64) -> Readings {
        let mut readings = self.sensor.empty(self.paths, batch);
        // The angle is irrelevant: no record has a direction.
        let radius = self.radius * sppm_area_ratio(batch, ALPHA).sqrt();
        let window = Window { radius, theta_max: 0.1 };
        let mut waiting = SppmRecords::default();
        for index in batch * self.paths..(batch + 1) * self.paths {
            self.gather(index, window, &mut waiting, &mut readings);
        }
        let SppmRecords { cells, records } = waiting;
        let signal = StopSignal::default();
        let pace = Pace::new(&signal);
        let records =
            Records::new(records, window, &self.surfaces, &pace).expect("nothing stops it");
        let weights = PairWeights::new(window);
        let mut stream = SppmStream {
            sppm: self,
            weights,
            records: &records,
            cells,
            photon: None,
            readings: &mut readings,
        };
        let photons =
            self.forward.batch_observed(batch, &mut stream, &pace).expect("nothing stops it");
        readings.segments += photons.segments;
        readings.close_batch();
        readings
    }

    fn gather(
        &self,
        index: u64,
        window: Window,
        waiting: &mut SppmRecords<'s>,
        readings: &mut Readings,
    ) {
        let sensor = &self.sensor;
        let mut sampler = Sampler::for_path(sensor.seed, stream::BASELINE_MAP, index);
        let Some(arrival) = sensor.arrivals.draw(&mut sampler) else { return };
        waiting.cells.push(arrival.cells.clone());
        let (etendue, cells) = (sensor.etendue(&arrival) / self.paths as f64, &arrival.cells);
        let mut gatherer = Gatherer { sppm: self, window, etendue, cells, waiting, readings };
        let gathering = sensor.gathering(sensor.bounce_limit.min(DEEPEST));
        let segments = follow(gathering, &arrival, &mut sampler, &mut gatherer);
        readings.segments += segments;
    }
}

/// Area of the disk of pass `pass`, from 0, over that of the first, 1: `r²_{i+1} = r²_i (i + α)/(i + 1)` with i from 1
/// (Knaus & Zwicker 2011), for an α between 0 and 1.
pub fn sppm_area_ratio(pass: u64, alpha: f64) -> f64 {
    (1..=pass).fold(1.0, |ratio, i| ratio * (i as f64 + alpha) / (i as f64 + 1.0))
}

/// The records of the gather paths of a pass, and the cell of each path.
#[derive(Default)]
struct SppmRecords<'s> {
    cells: Vec<SmallVec<[usize; 1]>>,
    records: Vec<GatherRecord<'s>>,
}

/// Collects the light and the records of one gather path.
struct Gatherer<'a, 's> {
    sppm: &'a Sppm<'s>,
    window: Window,
    /// Etendue of the path, its share of the pass, mm² sr.
    etendue: f64,
    cells: &'a [usize],
    waiting: &'a mut SppmRecords<'s>,
    readings: &'a mut Readings,
}

impl Observer for Gatherer<'_, '_> {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Meet(met) => self.meet(path, met),
            Event::Arrive(vertex) => self.leave_records(path, vertex),
            // The photons at the record account for it.
            Event::Depart(_, departure) if departure.lobe == Lobe::Diffuse => {
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

impl Gatherer<'_, '_> {
    fn meet(&mut self, path: &Path, met: &MetEmission) {
        let (flux, depth) = (met.radiance * self.etendue, path.depth);
        let light = DetectedLight { flux, depth, source: met.source, wavelength: path.wavelength };
        self.sppm.sensor.count(self.readings, self.cells, &light);
    }

    fn leave_records(&mut self, path: &Path, vertex: &Vertex<'_>) {
        let Sppm { sensor, surfaces, .. } = self.sppm;
        let facing = facing(sensor.scene, path, vertex);
        let interface = vertex.interface;
        let sides = [
            (facing.faces.own, facing.facet, interface.from),
            (facing.faces.behind, -facing.facet, interface.to),
        ];
        for (finish, normal, medium) in sides.into_iter().filter(|side| !side.0.is_specular()) {
            // L* of the light that leaves, in the medium of the gather path: docs/method.md, eq. (22), over its n².
            let index = facing.incidence.index_from;
            let value = self.etendue * vertex.throughput / (index * index);
            // The whole disk counts also at rims; that bias vanishes with the radius.
            let value = value / self.window.area();
            let record = SurfaceRecord {
                point: vertex.point,
                normal,
                surface: surfaces.of(interface.acting.prim),
                medium,
                kind: RecordKind::Scattered { finish, out: -vertex.dir },
                value,
                kernels: Kernels::NONE,
                slope: DVec3::ZERO,
                path: RecordPath {
                    place: self.waiting.cells.len() as u32 - 1,
                    depth: path.depth + 1,
                    band: path.band,
                },
            };
            self.waiting.records.push(GatherRecord::Surface(record));
        }
    }
}

/// Photons traced past the records.
struct SppmStream<'p, 's> {
    sppm: &'p Sppm<'s>,
    weights: PairWeights,
    records: &'p Records<'s>,
    /// The current photon.
    photon: Option<Emergence>,
    cells: Vec<SmallVec<[usize; 1]>>,
    readings: &'p mut Readings,
}

impl Observer for SppmStream<'_, '_> {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Start(start) => self.photon = Some(*start),
            Event::Arrive(vertex) => self.arrive(path, vertex),
            Event::Travel(_)
            | Event::Jump(_)
            | Event::Collide(_)
            | Event::Convert(_)
            | Event::Depart(..)
            | Event::Absorbed(_)
            | Event::Detect(_)
            | Event::Meet(_)
            | Event::Roulette(_)
            | Event::Escaped(_)
            | Event::Cut(_)
            | Event::Leaked(..) => {}
        }
        ControlFlow::Continue(())
    }
}

impl SppmStream<'_, '_> {
    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) {
        let Some(Emergence { flux, source, .. }) = self.photon else { return };
        let Sppm { sensor, surfaces, .. } = self.sppm;
        let interface = vertex.interface;
        let surface = surfaces.of(interface.acting.prim);
        let key = PhotonKey { surface, band: path.band, point: vertex.point, dir: vertex.dir };
        if interface.visibility == Visibility::Invisible || !self.records.may_take(&key) {
            return;
        }
        let facing = facing(sensor.scene, path, vertex);
        let incidence = Incidence { normal: facing.facet, ..facing.incidence };
        let medium = interface.from;
        let photon = SurfaceHit { surface, medium, point: vertex.point, incidence };
        let photon = PhotonHit::Surface(photon);
        let Self { weights, cells, readings, .. } = self;
        self.records.visit(&[key], |_, record| {
            let Some([share, ..]) = weights.flux(record, &photon) else { return };
            let (flux, depth) =
                (flux * vertex.throughput * share, path.depth + record.path().depth);
            let light = DetectedLight { flux, depth, source, wavelength: path.wavelength };
            sensor.count(readings, &cells[record.path().place as usize], &light);
        });
    }
}
