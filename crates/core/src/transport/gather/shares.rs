//! The light of a record whose gather path goes on to the sources: the share that its pairs count.
//!
//! A gather path adds up the windows of the records that it has left, a photon those of its last
//! vertices; a pair knows both, and the vertex where they meet (docs/method.md, eq. 31).

use crate::optics::Lobe;
use crate::scene::{Arrival, SensorId};
use crate::transport::backward::counter::against;
use crate::transport::backward::mix::MergedPhoton;
use crate::transport::backward::paths::Backward;
use crate::transport::connect::passage::{PassedRecords, PassedVertex, RecordPlaces};
use crate::transport::connect::vertex::{ScatteringVertex, Turns};
use crate::transport::connect::weights::Etendues;
use crate::transport::{Collision, Departure};
use glam::DVec3;

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
        self.records.push(|| PassedVertex::of_lobe(vertex, light, departure.lobe));
    }

    /// The path is scattered within the medium where it collided.
    pub(super) fn collide(&mut self, collision: &Collision<'_>) {
        let Some(vertex) = self.vertex.take() else { return };
        self.turns.depart(Lobe::Diffuse);
        let light = [-collision.out, -collision.dir];
        self.records.push(|| PassedVertex::Scattered(vertex, light));
    }

    /// A record at the vertex that the path has met as it travelled along `dir`, for light by a lobe from
    /// the direction `along`, or from all.
    pub(super) fn record(
        &self,
        (backward, sensor): (&Backward<'s>, SensorId),
        (dir, lobe): (DVec3, Lobe),
        along: Option<DVec3>,
    ) -> MergedRecord<'s> {
        let to_sensor = self.turns.is_begun().then(|| {
            let first = self.turns.first(dir).map(against);
            backward.joined_sensors.joined_ratio(first, sensor, self.sensor_place)
        });
        MergedRecord {
            gather: self.etendue,
            to_sensor,
            sensor_place: self.sensor_place,
            depth: self.records.vertices(),
            passed: self.records.sum(None),
            vertex: self.vertex.expect("a record lies at the vertex that was met"),
            lobe,
            out: -dir,
            along,
        }
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
        let own = PassedVertex::of_lobe(self.vertex, light, self.lobe).window(window);
        let own = own.at(self.depth, vertex_d);
        let beyond = photon.windows.iter().zip(self.depth + 1..);
        let beyond: f64 = beyond.map(|(window, depth)| window.at(depth, vertex_d)).sum();
        let to_sensor = self.to_sensor.unwrap_or_else(|| {
            backward.joined_sensors.joined_ratio(turn, sensor, self.sensor_place)
        });
        let to_source = photon
            .to_source
            .unwrap_or_else(|| backward.joined_to_source(sensor, turn, &photon.start));
        let pairs = backward.scene.pair_weight_of(photon.start.source);
        let etendues = Etendues::new(
            [photon.etendue, self.gather],
            backward.emitters.meets(photon.start.source),
            [to_sensor, to_source],
            (self.passed + own + beyond) / pairs,
        );
        etendues.share_of_pair(own / pairs, backward.sharing)
    }
}
