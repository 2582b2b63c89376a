//! Forward and backward mixed, with connections: each way of finding the light of a path counts it
//! in proportion to how well it samples it.
//!
//! Photons and gather paths know the ends of every path that they find, and therefore the weights
//! of docs/method.md, eq. (27). The path between the ends does not matter, so finishes may scatter.
//! With records (`mis`), photons also remember their last vertices, eq. (31). `counter` counts the
//! share of gather paths.

use crate::optics::Lobe;
use crate::plan::Estimator;
use crate::rng::{Sampler, stream};
use crate::scene::{Ray, SensorId, SourceId, Visibility};
use crate::transport::backward::counter::roulette_below;
use crate::transport::backward::estimator::{paths_for, tried_batches};
use crate::transport::backward::paths::{Backward, SharedBatches, Weights};
use crate::transport::connect::passage::{PassedVertex, RecentPassages, VertexWindow};
use crate::transport::connect::sensors::SensorPoint;
use crate::transport::connect::sources::SourcePoint;
use crate::transport::connect::vertex::{ScatteringVertex, TurnAt, Turns};
use crate::transport::connect::way::WayStart;
use crate::transport::connect::weights::{Etendues, Technique};
use crate::transport::forward;
use crate::transport::stop::Pace;
use crate::transport::tally::sensor_reading::DetectedLight;
use crate::transport::tally::{Counts, work};
use crate::transport::task::Task;
use crate::transport::trial::{BATCHES, Trials, Tried};
use crate::transport::walk::follow::{arrivals_of, comes_through_aim, etendue_of};
use crate::transport::{Departure, Detection, Emergence, Event, Observer, Path, Readings, Vertex};
use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// A photon at a record, as far as it is known before the pair.
#[derive(Debug, Clone)]
pub(crate) struct MergedPhoton {
    /// Etendue that it represents, its share of all batches, mm² sr; 0 if no gather path could find it.
    pub(crate) etendue: f64,
    /// Where it started.
    pub(crate) start: SourcePoint,
    /// Etendue of a gather path that is joined to its source at its first vertex, relative to one that meets the
    /// source; `None` if the record is its first vertex.
    pub(crate) to_source: Option<f64>,
    /// G/q of records at its last vertices, the last first.
    pub(crate) windows: SmallVec<[VertexWindow; 9]>,
}

/// Counts the share of photons on the mixed sensors, beside that of gather paths.
pub(crate) struct Mixing<'m, 's> {
    backward: &'m Backward<'s>,
    photon_fluxes: &'m [f64],
    /// Batches that find light together.
    batches: f64,
    /// Gather paths of each sensor in all of them.
    paths: f64,
    /// Etendue represented by the current photon, its share of these batches, mm² sr; 0 if no gather
    /// path could find it.
    photon: f64,
    /// Where it started.
    start: SourcePoint,
    /// Its flux at throughput 1, lm or W.
    flux: f64,
    turns: Turns<'s>,
    /// Its last vertices, where gather paths leave records.
    recent: Option<RecentPassages<'s>>,
    /// For points of sensors that vertices are joined to.
    joints: Sampler,
    /// Counts of the batch, not closed.
    readings: Readings,
}

impl<'m, 's> Mixing<'m, 's> {
    /// The gather paths of a batch, traced, and ready for its photons; `None` if stopped.
    pub(crate) fn begin(backward: &'m Backward<'s>, task: Task<'m>) -> Option<Self> {
        let readings = backward.trace(task)?;
        Some(Self::new(backward, (task, backward.paths), SharedBatches::ALONE, readings))
    }

    /// Ready for the photons of a batch, with this many gather paths of each sensor, which have been traced.
    pub(crate) fn new(
        backward: &'m Backward<'s>,
        (task, paths): (Task<'m>, u64),
        together: SharedBatches,
        readings: Readings,
    ) -> Self {
        let nowhere =
            SourcePoint { source: SourceId::new(0), shape: 0, point: DVec3::ZERO, dir: DVec3::Z };
        Self {
            backward,
            photon_fluxes: task.photon_fluxes,
            batches: together.batches,
            paths: together.batches * paths as f64,
            photon: 0.0,
            start: nowhere,
            flux: 0.0,
            turns: Turns::default(),
            recent: together.places.map(RecentPassages::new),
            joints: Sampler::for_path(backward.seed, stream::JOINED_SENSORS, task.batch),
            readings,
        }
    }

    /// The current photon as a record finds it.
    pub(crate) fn photon(&self, dir: DVec3) -> MergedPhoton {
        let first = self.turns.first(dir).map(Some).or(self.turns.is_begun().then_some(None));
        MergedPhoton {
            etendue: self.photon,
            start: self.start,
            to_source: first
                .map(|turn| self.backward.joined_sources.joined_ratio(turn, &self.start)),
            windows: self.recent.as_ref().map(RecentPassages::windows).unwrap_or_default(),
        }
    }

    /// The counts of the batch so far, not closed.
    pub(crate) fn into_readings(self) -> Readings {
        self.readings
    }

    /// The counts of the batch, after its photons.
    pub(crate) fn into_counts(self) -> Counts {
        Counts::closed([self.readings])
    }
}

/// Tries photons and gather paths with half of the work each; `None` if stopped.
pub(crate) fn trial(trials: &Trials<'_>) -> Option<Vec<Tried>> {
    trials.by_size(Estimator::Mix, |effort| {
        let half = 0.5 * effort;
        let forward = forward::photons_for(trials, half);
        let (backward, _) = paths_for(trials, half)?;
        let backward = backward.with_weights(Weights::Shared);
        let photon_fluxes = forward.photon_fluxes();
        let traced = |batch| {
            let pace = Pace::new(trials.signal);
            let task = Task { batch, stage: 0, photon_fluxes: &photon_fluxes, pace: &pace };
            let mut mixing = Mixing::begin(&backward, task)?;
            let photons = forward.batch_observed(batch, &mut mixing, &pace)?;
            mixing.readings.close_batch();
            Some((work::of_photons(&photons), mixing.readings))
        };
        let both: Option<Vec<(f64, Readings)>> = (0..BATCHES).into_par_iter().map(traced).collect();
        let (by_photons, batches): (Vec<f64>, Vec<Readings>) = both?.into_iter().unzip();
        Some(tried_batches(&backward, batches, by_photons.iter().sum()))
    })
}

impl Observer for Mixing<'_, '_> {
    fn roulette_below(&self) -> f64 {
        roulette_below(self.recent.is_some())
    }

    fn allows_jumps(&self) -> bool {
        self.recent.is_none()
    }

    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Start(start) => self.start(path, start),
            Event::Arrive(vertex) if vertex.interface.visibility == Visibility::Visible => {
                let joint = ScatteringVertex::at_face(self.backward.scene, path, vertex);
                self.turns.meet(joint, vertex.dir);
                if let Some(joint) = joint.filter(|_| self.is_joined()) {
                    let way = |light: DVec3| WayStart::from_face(path, vertex, joint.side(light));
                    self.join_drawn(path, &joint, vertex.dir, way);
                    let mut seen = SmallVec::<[SensorPoint; 1]>::new();
                    let Backward { scene, joined_sensors, .. } = self.backward;
                    joined_sensors
                        .draw_leaving(scene, vertex, &mut self.joints, |place| seen.push(place));
                    for place in &seen {
                        self.join(path, &joint, (vertex.dir, place), way);
                    }
                }
            }
            Event::Collide(collision) => {
                let joint = ScatteringVertex::in_medium(self.backward.scene, path, collision);
                self.turns.meet(Some(joint), collision.dir);
                if self.is_joined() {
                    self.join_drawn(path, &joint, collision.dir, |_| WayStart::within(path));
                }
                self.turns.depart(Lobe::Diffuse);
                if let Some(recent) = &mut self.recent {
                    recent.push(PassedVertex::Scattered(joint, [collision.dir, collision.out]));
                }
            }
            Event::Depart(vertex, departure) => self.depart(path, vertex, departure),
            Event::Detect(light) => self.detect(path, light),
            Event::Travel(_)
            | Event::Jump(_)
            | Event::Convert(_)
            | Event::Arrive(_)
            | Event::Absorbed(_)
            | Event::Meet(_)
            | Event::Roulette(_)
            | Event::Escaped(_)
            | Event::Cut(_)
            | Event::Leaked(..) => {}
        }
        ControlFlow::Continue(())
    }
}

impl Mixing<'_, '_> {
    /// Whether vertices of the current photon are joined to sensors.
    fn is_joined(&self) -> bool {
        self.photon > 0.0 && !self.backward.joined_sensors.is_empty()
    }

    fn start(&mut self, path: &Path, start: &Emergence) {
        let Backward { scene, emitters, joined_sources, .. } = self.backward;
        let (point, dir) = (path.ray.origin(), path.ray.dir());
        self.start = SourcePoint { source: start.source, shape: start.shape, point, dir };
        self.flux = start.flux;
        self.turns = Turns::default();
        self.recent.iter_mut().for_each(RecentPassages::clear);
        let met = emitters.emitted(start.source, path, start.shape);
        let index = scene.media[path.medium.index()].index(path.wavelength);
        let emitted = if met > 0.0 {
            Some(met)
        } else {
            joined_sources.emitted(&self.start, index, path.wavelength)
        };
        let spectral = scene.sources[start.source.index()].spectral_weight(path.wavelength);
        let flux = spectral * self.photon_fluxes[start.source.index()] / self.batches;
        self.photon = emitted.filter(|emitted| *emitted > 0.0).map_or(0.0, |one| flux / one);
    }

    fn detect(&mut self, path: &Path, light: &Detection<'_>) {
        let Backward { scene, sensors, joined_sensors, .. } = self.backward;
        let known = arrivals_of(light.sensor, sensors);
        let (Some(arrivals), false) = (known, light.cells.is_empty()) else { return };
        let weight = if self.photon > 0.0 {
            let windows = self.recent.as_ref().map_or(0.0, |recent| recent.sum(None));
            let gather = etendue_of(light, scene, arrivals, path.wavelength);
            let last = self.turns.last(light.dir);
            let joined =
                joined_sensors.joined_ratio(last, light.sensor, (light.point, light.normal));
            let first = self.turns.first(light.dir);
            let etendues = self.etendues(light.sensor, gather, joined, (first, windows));
            etendues.share(Technique::Photon, self.backward.sharing)
        } else {
            Etendues::PHOTON_ALONE.share(Technique::Photon, self.backward.sharing)
        };
        self.count((path.depth, path.wavelength), light.sensor, light.cells, light.flux * weight);
    }

    /// Joins a vertex to points of sensors.
    fn join_drawn(
        &mut self,
        path: &Path,
        vertex: &ScatteringVertex<'_>,
        dir: DVec3,
        way: impl Fn(DVec3) -> WayStart,
    ) {
        let Backward { joined_sensors, .. } = self.backward;
        for join in 0..joined_sensors.joins() {
            let drawn = joined_sensors.draw(vertex.point, join, &mut self.joints);
            if let Some(place) = drawn {
                self.join(path, vertex, (dir, &place), &way);
            }
        }
    }

    /// Joins a vertex to a place of a sensor: docs/method.md, eq. (25).
    fn join(
        &mut self,
        path: &Path,
        vertex: &ScatteringVertex<'_>,
        (dir, place): (DVec3, &SensorPoint),
        way: impl FnOnce(DVec3) -> WayStart,
    ) {
        let Backward { scene, sensors, .. } = self.backward;
        self.readings.joins += 1;
        let Some(light) = vertex.scattered(dir, place.dir) else { return };
        let Some(kept) = light.kept(&mut self.joints) else { return };
        self.readings.segments += 1;
        let way = way(place.dir).go(scene, vertex.point, place.dir, place.distance);
        let Some(end) = way else { return };
        if !comes_through_aim(scene, place.sensor, (&end.on, &end.ray), end.length) {
            return;
        }
        let Some(arrivals) = arrivals_of(place.sensor, sensors) else { return };
        let back = Ray::new(place.point, -place.dir);
        let gather = end.index * end.index * arrivals.extent(&back, place.normal);
        let joined = light.density / light.albedo * place.solid_angle;
        let first = self.turns.first_if_joined(place.dir);
        let next = || Some(PassedVertex::of_lobe(*vertex, [dir, place.dir], Lobe::Diffuse));
        let windows = self.recent.as_ref().map_or(0.0, |recent| recent.sum(next()));
        let etendues = self.etendues(place.sensor, gather, joined, (first, windows));
        let weight = etendues.share(Technique::JoinedPhoton, self.backward.sharing);
        let flux = self.flux * path.throughput * light.density * place.solid_angle;
        let flux = flux * end.transmittance * weight / kept;
        self.count((path.depth + 1, path.wavelength), place.sensor, &place.cells, flux);
    }

    /// Etendues of light of this photon at a sensor; `gather` is that of the sensor's only gather
    /// path, `joined` that of a photon joined to the sensor relative to this one, `first` its first
    /// turn, `windows` those of records on its path.
    fn etendues(
        &self,
        sensor: SensorId,
        gather: f64,
        joined: f64,
        (first, windows): (Option<TurnAt<'_>>, f64),
    ) -> Etendues {
        let gather = gather / self.paths;
        let meets = self.backward.emitters.meets(self.start.source);
        let to_source = self.backward.joined_to_source(sensor, first, &self.start);
        let windows = windows / self.backward.scene.pair_weight_of(self.start.source);
        Etendues::new([self.photon, gather], meets, [joined, to_source], windows)
    }

    fn depart(&mut self, path: &Path, vertex: &Vertex<'_>, departure: &Departure) {
        self.turns.depart(departure.lobe);
        if let Some(recent) = &mut self.recent
            && vertex.interface.visibility == Visibility::Visible
        {
            let met = ScatteringVertex::facing(self.backward.scene, path, vertex);
            recent.push(PassedVertex::of_lobe(met, [vertex.dir, departure.dir], departure.lobe));
        }
    }

    fn count(
        &mut self,
        (depth, wavelength): (u32, f64),
        sensor: SensorId,
        cells: &[usize],
        flux: f64,
    ) {
        let Backward { layout, scene, .. } = self.backward;
        let light = DetectedLight { flux, depth, source: self.start.source, wavelength };
        self.readings.count((layout, &scene.light), sensor, cells, &light);
    }
}
