//! Gathering merged with forward, backward and their joins: the share of a path that each counts.
//!
//! Photons and gather paths find light as in a mix (`backward/mix`); pairs of photons and records are
//! one more technique. All belong to the same passes, and the readings of each order contain all
//! light of a sensor. This module does not know how paths are traced.

use crate::optics::Lobe;
use crate::scene::{Arrival, SensorId};
use crate::transport::backward::estimator::{Backward, Joint, against};
use crate::transport::backward::mix::{MergedPhoton, Mixing};
use crate::transport::connect::passage::{Passage, PassedRecords, RecordPlaces};
use crate::transport::connect::vertex::{ScatteringVertex, Turns};
use crate::transport::connect::weights::Etendues;
use crate::transport::gather::block::BlockCounts;
use crate::transport::gather::estimator::Gather;
use crate::transport::gather::stream::PhotonStream;
use crate::transport::tally::Counts;
use crate::transport::tally::work::RecordWork;
use crate::transport::task::Task;
use crate::transport::{Collision, Departure, Event, Observer, Path, Readings};
use glam::DVec3;
use std::ops::ControlFlow;

/// A gather path that goes on beyond its records: what weights their light.
#[derive(Debug, Clone)]
pub(super) struct MergedPath<'s> {
    /// Etendue of the path, its share of the block, mm² sr.
    etendue: f64,
    /// Point and unit normal of the sensor.
    sensor_place: (DVec3, DVec3),
    turns: Turns<'s>,
    records: PassedRecords,
    /// The vertex that the path has just met.
    vertex: Option<ScatteringVertex<'s>>,
}

/// A record whose light is shared with other techniques.
#[derive(Debug)]
pub(super) struct MergedRecord<'s> {
    /// Etendue of the gather path, its share of the block, mm² sr.
    gather: f64,
    /// Etendue of a photon that is joined to the sensor relative to one that is counted; `None` if the
    /// record is the vertex that would be joined.
    to_sensor: Option<f64>,
    sensor_place: (DVec3, DVec3),
    /// Vertices before the record.
    depth: usize,
    /// G/q of records at these, mm² sr.
    passed: f64,
    vertex: ScatteringVertex<'s>,
    lobe: Lobe,
    /// Unit direction of light from the record.
    out: DVec3,
    /// Unit direction of light to it; `None` if that is the photon's.
    along: Option<DVec3>,
}

impl<'s> MergedPath<'s> {
    /// A path that starts, with its etendue, a share of the block.
    pub(super) fn new(arrival: &Arrival, etendue: f64, places: RecordPlaces) -> Self {
        Self {
            etendue,
            sensor_place: (arrival.ray.origin(), arrival.normal),
            turns: Turns::default(),
            records: PassedRecords::new(places),
            vertex: None,
        }
    }

    /// The path meets a vertex as it travels along `dir`.
    pub(super) fn meet(&mut self, vertex: ScatteringVertex<'s>, dir: DVec3) {
        self.turns.meet(Some(vertex), dir);
        self.vertex = Some(vertex);
    }

    /// The path leaves the interface that it met.
    pub(super) fn depart(&mut self, dir: DVec3, departure: &Departure) {
        let Some(vertex) = self.vertex.take() else { return };
        self.turns.depart(departure.lobe);
        let light = [-departure.dir, -dir];
        self.records.push(|| Passage::of_lobe(vertex, light, departure.lobe));
    }

    /// The path is scattered within the medium where it collided.
    pub(super) fn collide(&mut self, collision: &Collision<'_>) {
        let Some(vertex) = self.vertex.take() else { return };
        self.turns.depart(Lobe::Diffuse);
        let light = [-collision.out, -collision.dir];
        self.records.push(|| Passage::Scattered(vertex, light));
    }

    /// A record at the vertex that the path has met as it travelled along `dir`, for light by a lobe from
    /// the direction `along`, or from all.
    pub(super) fn record(
        &self,
        scene: (&Backward<'s>, SensorId),
        (dir, lobe): (DVec3, Lobe),
        along: Option<DVec3>,
    ) -> Option<MergedRecord<'s>> {
        let (backward, sensor) = scene;
        let to_sensor = self.turns.is_begun().then(|| {
            let first = self.turns.first(dir).map(against);
            backward.joined_sensors.joined_ratio(first, sensor, self.sensor_place)
        });
        Some(MergedRecord {
            gather: self.etendue,
            to_sensor,
            sensor_place: self.sensor_place,
            depth: self.records.vertices(),
            passed: self.records.sum(None),
            vertex: self.vertex?,
            lobe,
            out: -dir,
            along,
        })
    }
}

impl MergedRecord<'_> {
    /// The share of the light of a photon that arrives along `dir` that the pair counts, 1.
    pub(super) fn share(
        &self,
        (backward, sensor): (&Backward<'_>, SensorId),
        places: RecordPlaces,
        (photon, dir): (&MergedPhoton, DVec3),
    ) -> f64 {
        if photon.etendue <= 0.0 {
            return 0.0;
        }
        let light = [self.along.unwrap_or(dir), self.out];
        let turn = (self.lobe == Lobe::Diffuse).then_some((self.vertex, light));
        let RecordPlaces { window, vertex_d } = places;
        let own = Passage::of_lobe(self.vertex, light, self.lobe).window(window);
        let own = own.at(self.depth, vertex_d);
        let beyond = photon.windows.iter().zip(self.depth + 1..);
        let beyond: f64 = beyond.map(|(window, depth)| window.at(depth, vertex_d)).sum();
        let to_sensor = self.to_sensor.unwrap_or_else(|| {
            backward.joined_sensors.joined_ratio(turn, sensor, self.sensor_place)
        });
        let to_source = photon
            .to_source
            .unwrap_or_else(|| backward.joined_to_source(sensor, turn, &photon.start));
        let meets = backward.emitters.meets(photon.start.source);
        let etendues = Etendues {
            photon: photon.etendue,
            photon_joined: photon.etendue * to_sensor,
            gather: self.gather,
            gather_met: if meets { self.gather } else { f64::INFINITY },
            gather_joined: self.gather * to_source,
            windows: self.passed + own + beyond,
        };
        etendues.share_of_pair(own, backward.sharing)
    }
}

/// Photons that stream past the records, are counted by sensors, and are joined to them.
pub(crate) struct MergedStream<'p, 's> {
    stream: PhotonStream<'p, 's>,
    gather: &'p Gather<'s>,
    task: Task<'p>,
    /// The pass whose photons are traced, and its counts.
    current: Option<(usize, Mixing<'p, 's>)>,
    /// Counts of the others without pairs, not closed.
    others: Vec<Option<Readings>>,
}

impl<'p, 's> MergedStream<'p, 's> {
    /// Traces the gather paths of a block of passes, from the task's batch on; `None` if stopped.
    pub(crate) fn begin(gather: &'p Gather<'s>, task: Task<'p>, passes: u64) -> Option<Self> {
        let (stream, met) = gather.trace_records(task, passes)?;
        let others = met.into_iter().map(Some).collect();
        Some(Self { stream, gather, task, current: None, others })
    }

    /// The photons that follow are those of another pass of the block.
    pub(crate) fn begin_pass(&mut self, place: usize) {
        self.end_pass();
        self.stream.begin_pass(place);
        let readings = self.others.get_mut(place).and_then(Option::take);
        if let (Some(backward), Some(readings)) = (&self.gather.merging, readings) {
            let task = Task { batch: self.task.batch + place as u64, ..self.task };
            let paths = self.stream.first.gather_paths;
            let joint = Joint {
                batches: self.others.len() as f64,
                places: Some(self.gather.record_places(self.stream.first)),
            };
            self.current = Some((place, Mixing::new(backward, (task, paths), joint, readings)));
        }
    }

    fn end_pass(&mut self) {
        if let Some((place, mixing)) = self.current.take() {
            self.others[place] = Some(mixing.into_readings());
        }
    }

    /// The counts after all photons, and the work in addition to tracing.
    pub(super) fn finish(mut self) -> (BlockCounts, RecordWork) {
        self.end_pass();
        let (mut counts, work) = self.stream.finish();
        for (place, own) in self.others.iter().enumerate() {
            own.iter().for_each(|own| counts.add(place, own));
        }
        (counts, work)
    }

    /// The counts of all passes, after their photons.
    pub(crate) fn into_counts(self) -> Counts {
        self.finish().0.into_counts()
    }
}

impl Observer for MergedStream<'_, '_> {
    fn roulette_below(&self) -> f64 {
        let current = self.current.as_ref();
        current.map_or_else(|| self.stream.roulette_below(), |(_, own)| own.roulette_below())
    }

    #[inline(always)]
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        let Some((_, mixing)) = &mut self.current else { return ControlFlow::Continue(()) };
        self.stream.offer(path, event, |dir| Some(mixing.photon(dir)));
        mixing.see(path, event)
    }
}
