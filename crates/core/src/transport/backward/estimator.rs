//! The backward estimator: gather paths from the sensors, followed until they meet emission, and
//! joined to sources where they are scattered.
//!
//! A gather path carries basic radiance L/n² and represents an etendue of its sensor: the mean of
//! their product is the flux on the sensor. Points, lines and collimated beams cannot be met; a run
//! with such sources is refused beforehand. When mixed with forward, photons also count on the
//! sensors, and all count by their weights (`mix`).

use crate::optics::Lobe;
use crate::plan::{Estimator, RunPlan};
use crate::rng::{Sampler, stream};
use crate::scene::{Arrival, Arrivals, Scene, SensorId, SourceId, Visibility};
use crate::transport::connect::passage::{Passage, PassedRecords, RecordPlaces};
use crate::transport::connect::sensors::SensorTargets;
use crate::transport::connect::sources::{SourcePoint, SourceTargets};
use crate::transport::connect::vertex::{ScatteringVertex, TurnAt, Turns};
use crate::transport::connect::way::WayStart;
use crate::transport::connect::weights::{Etendues, Sharing, Technique};
use crate::transport::estimate::Estimate;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::readings::{DetectedLight, MIN_LIT_GROUPS};
use crate::transport::tally::work;
use crate::transport::task::Task;
use crate::transport::trial::{BATCHES, SEED, Trials, Tried};
use crate::transport::walk::emitters::Emitters;
use crate::transport::walk::follow::{Gathering, follow};
use crate::transport::{
    Departure, Event, Layout, Loss, MetEmission, Observer, Path, ROULETTE_BELOW, Readings, Vertex,
};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Gather paths of each sensor that measure their work.
const PILOT_PATHS: u64 = 64;
/// Batch of the pilot paths: not one that counts.
const PILOT_BATCH: u64 = 1 << 40;

/// Standard errors of both by which photons must find more than gather paths to contradict them.
const CONTRADICTED: f64 = 4.0;
/// Possible relative rounding of a flux.
const ROUNDING: f64 = 1e-9;

/// Shared data of all batches of a run.
#[derive(Debug)]
pub(crate) struct Backward<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) layout: Layout,
    pub(crate) emitters: Emitters<'s>,
    /// What vertices of gather paths, and of photons, are joined to.
    pub(crate) joined_sources: SourceTargets<'s>,
    pub(crate) joined_sensors: SensorTargets<'s>,
    pub(crate) sensors: Vec<(SensorId, Arrivals<'s>)>,
    pub(crate) seed: u64,
    pub(crate) bounce_limit: u32,
    /// Gather paths per batch of each sensor.
    pub(crate) paths: u64,
    weights: Weights,
    /// How all techniques that find a path divide its light.
    pub(crate) sharing: Sharing,
}

/// How the light of gather paths counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weights {
    /// In full.
    Full,
    /// In shares, as photons count the rest.
    Shared,
}

/// Batches whose photons and gather paths find light together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint {
    /// Their number.
    pub(crate) batches: f64,
    /// Where their gather paths leave records, if they do.
    pub(crate) places: Option<RecordPlaces>,
}

impl Joint {
    /// A batch alone, without records.
    pub(crate) const ALONE: Self = Self { batches: 1.0, places: None };
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
            joined_sources: SourceTargets::new(scene),
            joined_sensors: SensorTargets::new(scene, sensors.iter().copied()),
            sensors: sensors.iter().map(|&id| (id, Arrivals::new(scene, id))).collect(),
            seed,
            bounce_limit,
            paths: PILOT_PATHS,
            weights: Weights::Full,
            sharing: Sharing::default(),
        }
    }

    /// The same with this many paths per batch from each sensor.
    pub(crate) fn with_paths(self, paths: u64) -> Self {
        Self { paths: paths.max(1), ..self }
    }

    /// The same with other weights.
    pub(crate) fn with_weights(self, weights: Weights) -> Self {
        Self { weights, ..self }
    }

    /// Work of a gather path, mean of a few that are not counted; `None` if they were stopped.
    pub(crate) fn work_of_path(&self, signal: &StopSignal) -> Option<f64> {
        let pace = Pace::new(signal);
        let task = Task { batch: PILOT_BATCH, stage: 0, photon_fluxes: &[], pace: &pace };
        let segments = self.trace(task)?.segments;
        Some(work::of_gather_paths(self.batch_paths(), segments) / self.batch_paths() as f64)
    }

    /// The sensors.
    pub(crate) fn sensors(&self) -> impl Iterator<Item = SensorId> {
        self.sensors.iter().map(|(id, _)| *id)
    }

    /// Gather paths of all sensors in a batch.
    pub(crate) fn batch_paths(&self) -> u64 {
        self.paths * self.sensors.len() as u64
    }

    /// The etendue of a gather path joined to a source at a turn over that of one that meets its
    /// place; infinite if it is not joined.
    pub(crate) fn joined_to_source(
        &self,
        sensor: SensorId,
        turn: Option<TurnAt<'s>>,
        place: &SourcePoint,
    ) -> f64 {
        // The light of a join could have passed the sensor before.
        if self.scene.sensors[sensor.index()].counts_first_passage() {
            return f64::INFINITY;
        }
        self.joined_sources.joined_ratio(turn, place)
    }

    /// Traces the gather paths of a batch. It is not closed, since photons may contribute to it.
    /// `None` if it was stopped.
    pub(crate) fn trace(&self, task: Task<'_>) -> Option<Readings> {
        let Task { batch, pace, .. } = task;
        let mut readings =
            Readings::of_batch(self.scene, &self.layout, self.seed, self.paths, batch);
        let mut joints = Sampler::for_path(self.seed, stream::JOINED_SOURCES, batch);
        for (id, arrivals) in &self.sensors {
            for index in batch * self.paths..(batch + 1) * self.paths {
                if pace.spend(1).is_break() {
                    return None;
                }
                self.trace_path((*id, arrivals), index, (task, &mut joints), &mut readings);
            }
        }
        (!pace.is_stopped()).then_some(readings)
    }

    fn trace_path(
        &self,
        (id, arrivals): (SensorId, &Arrivals<'s>),
        index: u64,
        (task, joints): (Task<'_>, &mut Sampler),
        readings: &mut Readings,
    ) {
        let mut sampler = Sampler::for_path(self.seed, stream::BACKWARD + id.index() as u64, index);
        let Some(arrival) = arrivals.draw(&mut sampler) else { return };
        let gathering = Gathering {
            scene: self.scene,
            emitters: &self.emitters,
            sensor: id,
            bounce_limit: self.bounce_limit,
            pace: Some(task.pace),
        };
        let photon_fluxes = match self.weights {
            Weights::Full => None,
            Weights::Shared => Some(task.photon_fluxes),
        };
        let etendue = self.etendue_of(&arrival, self.paths);
        let mut counter = GatherPathCounter {
            backward: self,
            arrival: &arrival,
            etendue,
            id,
            photon_fluxes,
            batches: 1.0,
            records: None,
            turns: Turns::default(),
            joints,
            readings,
        };
        let segments = follow(gathering, &arrival, &mut sampler, &mut counter);
        readings.segments += segments;
    }

    /// Etendue per basic radiance of one of so many gather paths, mm² sr.
    fn etendue_of(&self, arrival: &Arrival, paths: u64) -> f64 {
        Path::arriving(self.scene, arrival).etendue(self.scene, arrival.extent) / paths as f64
    }
}

/// Gather paths of some sensors with this much work in total, divided into batches.
pub(crate) fn paths_for<'a>(trials: &Trials<'a>, effort: f64) -> Option<Backward<'a>> {
    let Trials { scene, plan, sensors, signal, .. } = *trials;
    let RunPlan { seed, bounce_limit, .. } = plan;
    let backward = Backward::new(scene, sensors, seed ^ SEED, *bounce_limit);
    let work = backward.work_of_path(signal)?;
    let paths = effort / BATCHES as f64 / sensors.len() as f64 / work;
    Some(backward.with_paths(paths as u64))
}

/// Work of the gather paths of each sensor: its share if it were alone.
pub(crate) fn work_of_one(backward: &Backward<'_>, batches: &[Readings]) -> f64 {
    let segments = batches.iter().map(|batch| batch.segments).sum();
    let work = work::of_gather_paths(BATCHES * backward.batch_paths(), segments);
    work / backward.sensors.len() as f64
}

/// Tries gather paths that meet the sources; `None` if stopped.
pub(crate) fn trial(trials: &Trials<'_>) -> Option<Vec<Tried>> {
    let backward = paths_for(trials, trials.effort)?;
    let traced = |batch| {
        let pace = Pace::new(trials.signal);
        let mut readings =
            backward.trace(Task { batch, stage: 0, photon_fluxes: &[], pace: &pace })?;
        readings.close_batch();
        Some(readings)
    };
    let batches: Option<Vec<Readings>> = (0..BATCHES).into_par_iter().map(traced).collect();
    let batches = batches?;
    Some(trials.judged(&batches, work_of_one(&backward, &batches), Estimator::Backward))
}

/// The estimate of a sensor: unbiased, unless its gather paths almost never meet a source.
pub(crate) fn estimate<'a>(
    own: &'a Readings,
    photons: &Readings,
    layout: &Layout,
    id: SensorId,
) -> Estimate<'a> {
    let is_contradicted = layout.flux_slots(id).iter().any(|&slot| {
        let [by_photons, by_paths] = [photons, own].map(|one| one.scalar(slot));
        let error = by_photons.std_error().hypot(by_paths.std_error());
        let room = CONTRADICTED * error + ROUNDING * by_paths.mean().abs();
        photons.lit_groups(&[slot]) >= MIN_LIT_GROUPS && by_photons.mean() - by_paths.mean() > room
    });
    Estimate { estimator: Estimator::Backward, readings: own, bias: None, is_contradicted }
}

/// Counts the light of one gather path.
pub(crate) struct GatherPathCounter<'a, 's> {
    pub(crate) backward: &'a Backward<'s>,
    pub(crate) arrival: &'a Arrival,
    /// Etendue of this path per basic radiance, its share of the batch, mm² sr.
    pub(crate) etendue: f64,
    pub(crate) id: SensorId,
    /// Mixed: flux of one photon of each source, lm or W.
    pub(crate) photon_fluxes: Option<&'a [f64]>,
    /// Batches whose photons it shares light with.
    pub(crate) batches: f64,
    /// The records that it has left.
    pub(crate) records: Option<PassedRecords>,
    pub(crate) turns: Turns<'s>,
    /// For points of sources that vertices are joined to.
    pub(crate) joints: &'a mut Sampler,
    pub(crate) readings: &'a mut Readings,
}

impl Observer for GatherPathCounter<'_, '_> {
    fn roulette_below(&self) -> f64 {
        roulette_below(self.records.is_some())
    }

    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        match event {
            Event::Meet(met) => self.meet(path, met),
            Event::Cut(throughput) => self.lose(throughput, Loss::Cut),
            Event::Leaked(_, throughput) => self.lose(throughput, Loss::Leaked),
            Event::Arrive(vertex) => {
                let joint = ScatteringVertex::at_face(self.backward.scene, path, vertex);
                self.turns.meet(joint, vertex.dir);
                if let Some(joint) = joint {
                    let way = |light: DVec3| WayStart::from_face(path, vertex, joint.side(-light));
                    self.join(path, &joint, vertex.dir, way);
                }
            }
            Event::Collide(collision) => {
                let joint = ScatteringVertex::in_medium(self.backward.scene, path, collision);
                self.turns.meet(Some(joint), collision.dir);
                self.join(path, &joint, collision.dir, |_| WayStart::within(path));
                self.turns.depart(Lobe::Diffuse);
                if let Some(records) = &mut self.records {
                    records.push(|| Passage::Scattered(joint, [-collision.out, -collision.dir]));
                }
            }
            Event::Depart(vertex, departure) => self.depart(path, vertex, departure),
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

impl GatherPathCounter<'_, '_> {
    fn meet(&mut self, path: &Path, met: &MetEmission) {
        let dir = path.ray.dir();
        let place = SourcePoint {
            source: met.source,
            shape: met.shape,
            point: path.ray.at(met.t),
            dir: -dir,
        };
        let last = self.turns.last(dir).map(against);
        let joined = self.backward.joined_to_source(self.id, last, &place);
        let windows = self.records.map_or(0.0, |records| records.sum(None));
        let first = self.turns.first(dir);
        let etendues = self.etendues(&place, met.emitted, joined, (first, windows));
        let weight = etendues.share(Technique::GatherPath, self.backward.sharing);
        self.count(path.depth, met.source, weight * met.radiance * self.etendue);
    }

    /// Joins a vertex to a source: docs/method.md, eq. (26).
    fn join(
        &mut self,
        path: &Path,
        vertex: &ScatteringVertex<'_>,
        dir: DVec3,
        way: impl FnOnce(DVec3) -> WayStart,
    ) {
        let Backward { scene, joined_sources, .. } = self.backward;
        if scene.sensors[self.id.index()].counts_first_passage() {
            return;
        }
        let Some((place, distance)) = joined_sources.draw(vertex.point, self.joints) else {
            return;
        };
        let Some(light) = vertex.scattered(place.dir, -dir) else { return };
        let Some(kept) = light.kept(self.joints) else { return };
        let start = way(place.dir);
        self.readings.segments += 1;
        let Some(end) = start.go(scene, vertex.point, -place.dir, distance) else { return };
        let emitted = joined_sources.emitted(&place, end.index).unwrap_or(0.0);
        let measure = joined_sources.measure(&place, vertex.point, light.index_from);
        let (true, Some(measure)) = (emitted > 0.0, measure) else { return };
        let joined = light.adjoint / light.albedo * measure;
        let first = self.turns.first_if_joined(-place.dir);
        let next = || Passage::of_lobe(*vertex, [place.dir, -dir], Lobe::Diffuse);
        let windows = self.records.map_or(0.0, |records| records.sum(Some(next())));
        let etendues = self.etendues(&place, emitted, joined, (first, windows));
        let weight = etendues.share(Technique::JoinedGatherPath, self.backward.sharing);
        let radiance = path.throughput * light.adjoint * emitted * measure * end.transmittance;
        self.count(path.depth + 1, place.source, weight * radiance * self.etendue / kept);
    }

    /// Etendues of light from a place that this path has found; `joined` is that of a path joined
    /// to the source relative to this one's, `first` the first turn of the path, `windows` those of its
    /// records.
    fn etendues(
        &self,
        place: &SourcePoint,
        emitted: f64,
        joined: f64,
        (first, windows): (Option<TurnAt<'_>>, f64),
    ) -> Etendues {
        let photon = self.photon_fluxes.map_or(f64::INFINITY, |fluxes| {
            fluxes[place.source.index()] / (emitted * self.batches)
        });
        let gather = self.etendue / self.batches;
        let Arrival { ray, normal, .. } = self.arrival;
        let first = first.map(against);
        let at = (ray.origin(), *normal);
        let meets = self.backward.emitters.meets(place.source);
        Etendues {
            photon,
            photon_joined: photon * self.backward.joined_sensors.joined_ratio(first, self.id, at),
            gather,
            gather_met: if meets { gather } else { f64::INFINITY },
            gather_joined: gather * joined,
            windows,
        }
    }

    fn depart(&mut self, path: &Path, vertex: &Vertex<'_>, departure: &Departure) {
        self.turns.depart(departure.lobe);
        if let Some(records) = &mut self.records
            && vertex.interface.visibility == Visibility::Visible
        {
            records.push(|| {
                let met = ScatteringVertex::facing(self.backward.scene, path, vertex);
                Passage::of_lobe(met, [-departure.dir, -vertex.dir], departure.lobe)
            });
        }
    }

    fn count(&mut self, depth: u32, source: SourceId, flux: f64) {
        let Backward { layout, scene, .. } = self.backward;
        let light = DetectedLight { flux, depth, source };
        self.readings.count((layout, &scene.light), self.id, &self.arrival.cells, &light);
    }

    fn lose(&mut self, throughput: f64, loss: Loss) {
        self.readings.count_lost(&self.backward.layout, self.id, throughput, loss);
    }
}

/// Throughput below which roulette ends paths that share their light with others, 1. With records it is
/// low, since roulette would change the density of pairs.
pub(crate) fn roulette_below(has_records: bool) -> f64 {
    const WITH_RECORDS: f64 = 1e-4;
    if has_records { WITH_RECORDS } else { ROULETTE_BELOW }
}

/// A turn of a gather path as its light takes it.
pub(crate) fn against((vertex, [before, after]): TurnAt<'_>) -> TurnAt<'_> {
    (vertex, [-after, -before])
}
