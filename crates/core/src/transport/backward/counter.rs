//! The light of one gather path, as far as it is followed to the sources or joined to them.

use crate::optics::Lobe;
use crate::rng::Sampler;
use crate::scene::{Arrival, SensorId, SourceId, Visibility};
use crate::transport::backward::paths::Backward;
use crate::transport::connect::passage::{PassedRecords, PassedVertex};
use crate::transport::connect::sources::SourcePoint;
use crate::transport::connect::vertex::{ScatteringVertex, TurnAt, Turns};
use crate::transport::connect::way::WayStart;
use crate::transport::connect::weights::{Etendues, Technique};
use crate::transport::tally::sensor_reading::DetectedLight;
use crate::transport::{
    Departure, Event, Loss, MetEmission, Observer, Path, ROULETTE_BELOW, Readings, Vertex,
};
use glam::DVec3;
use std::ops::ControlFlow;

/// Counts the light of one gather path.
pub(crate) struct GatherPathCounter<'a, 's> {
    pub(crate) backward: &'a Backward<'s>,
    pub(crate) arrival: &'a Arrival,
    /// Etendue of this path per basic radiance, its share of the batch, mm² sr.
    pub(crate) etendue: f64,
    /// Basic radiance that it has found, with its shares.
    pub(crate) radiance: f64,
    /// Its share of what the gather paths of the sensor in the batch represent, 1.
    pub(crate) share: f64,
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

    fn allows_jumps(&self) -> bool {
        self.records.is_none()
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
                    records
                        .push(|| PassedVertex::Scattered(joint, [-collision.out, -collision.dir]));
                }
            }
            Event::Depart(vertex, departure) => self.depart(path, vertex, departure),
            Event::Start(_)
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
        self.count(path.depth, met.source, weight * met.radiance);
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
        self.readings.joins += 1;
        let Some(light) = vertex.scattered(place.dir, -dir) else { return };
        let Some(kept) = light.kept(self.joints) else { return };
        let start = way(place.dir);
        self.readings.segments += 1;
        let Some(end) = start.go(scene, vertex.point, -place.dir, distance) else { return };
        let emitted = joined_sources.emitted(&place, end.index, path.wavelength).unwrap_or(0.0);
        let measure = joined_sources.measure(&place, vertex.point, light.index_from);
        let (true, Some(measure)) = (emitted > 0.0, measure) else { return };
        let joined = light.adjoint / light.albedo * measure;
        let first = self.turns.first_if_joined(-place.dir);
        let next = || PassedVertex::of_lobe(*vertex, [place.dir, -dir], Lobe::Diffuse);
        let windows = self.records.map_or(0.0, |records| records.sum(Some(next())));
        let etendues = self.etendues(&place, emitted, joined, (first, windows));
        let weight = etendues.share(Technique::JoinedGatherPath, self.backward.sharing);
        let radiance = path.throughput * light.adjoint * emitted * measure * end.transmittance;
        self.count(path.depth + 1, place.source, weight * radiance / kept);
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
            let source = place.source.index();
            let spectral =
                self.backward.scene.sources[source].spectral_weight(self.arrival.wavelength.nm);
            spectral * fluxes[source] / (emitted * self.batches)
        });
        let gather = self.etendue / self.batches;
        let Arrival { ray, normal, .. } = self.arrival;
        let first = first.map(against);
        let at = (ray.origin(), *normal);
        let meets = self.backward.emitters.meets(place.source);
        let to_sensor = self.backward.joined_sensors.joined_ratio(first, self.id, at);
        let windows = windows / self.backward.scene.pair_weight_of(place.source);
        Etendues::new([photon, gather], meets, [to_sensor, joined], windows)
    }

    fn depart(&mut self, path: &Path, vertex: &Vertex<'_>, departure: &Departure) {
        self.turns.depart(departure.lobe);
        if let Some(records) = &mut self.records
            && vertex.interface.visibility == Visibility::Visible
        {
            records.push(|| {
                let met = ScatteringVertex::facing(self.backward.scene, path, vertex);
                PassedVertex::of_lobe(met, [-departure.dir, -vertex.dir], departure.lobe)
            });
        }
    }

    fn count(&mut self, depth: u32, source: SourceId, radiance: f64) {
        self.radiance += radiance;
        let flux = radiance * self.etendue;
        let Backward { layout, scene, .. } = self.backward;
        let light = DetectedLight { flux, depth, source, wavelength: self.arrival.wavelength.nm };
        self.readings.count((layout, &scene.light), self.id, &self.arrival.cells, &light);
    }

    fn lose(&mut self, throughput: f64, loss: Loss) {
        self.readings.count_lost(&self.backward.layout, self.id, throughput * self.share, loss);
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
