//! What a sensor's gather paths find before a run: how wide the guide is, how far its sources are, by how much the light is
//! scattered that waits at the records, and how near to the edge of a guide's aperture it lies.

use crate::optics::{FinishModel, Incidence, Side, Spread};
use crate::rng::{Sampler, stream};
use crate::scene::{Arrivals, FaceId, Ray, Scene, SensorId, SmoothId, SourceId, StartSurfaces};
use crate::transport::forward::Forward;
use crate::transport::stop::Pace;
use crate::transport::walk::emitters::Emitters;
use crate::transport::walk::follow::{Gathering, follow};
use crate::transport::walk::scatter::facing;
use crate::transport::{Departure, Event, Observer, Path, Vertex};
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Pilot gather paths from a sensor.
const PATHS: u64 = 64;
/// Interfaces beyond the records that a pilot path meets, 1.
const BEYOND: u32 = 8;
/// Photons of each source, to find the surfaces that its light reaches, and the most interfaces that each meets.
const PHOTONS: u64 = 512;
const PHOTON_BOUNCES: u32 = 200;

/// Pilot measurements of a sensor's gather paths, medians.
#[derive(Debug)]
pub(super) struct Sounded {
    /// Half the distance across the guide at the records, or the radius of a disk with the area of the face, whichever is
    /// less, mm.
    pub(super) inradius: f64,
    /// Refractive index of the medium at the records.
    pub(super) index: f64,
    /// Widest narrow scatter beyond the records, rad.
    pub(super) scatter: f64,
    /// Smallest angle between a refracted path and the cone of directions that light entering from outside can have, rad:
    /// lower quartile over paths, infinite without refraction. Light from a similar face at the other end stops at this cone.
    pub(super) to_aperture: f64,
    /// Distance of the records from each source, mm; `None` for sources whose light reaches none of their surfaces.
    pub(super) from_sources: Vec<Option<f64>>,
}

/// The surfaces that the light of each source reaches.
#[derive(Debug)]
pub(super) struct Reached(Vec<BTreeSet<SmoothId>>);

impl Reached {
    /// Traces a few photons; `None` if stopped.
    pub(super) fn new(scene: &Scene, seed: u64, pace: &Pace<'_>) -> Option<Self> {
        let mut reached = vec![BTreeSet::new(); scene.sources.len()];
        let mut forward = Forward::new(scene, seed, PHOTON_BOUNCES, 1);
        let lit = scene.sources.iter().map(|source| u64::from(source.is_lit()));
        forward.shares = lit.map(|lit| PHOTONS * lit).collect();
        let mut source = SourceId::new(0);
        let mut watch = |_: &Path, event: Event<'_>| {
            if let Event::Start(start) = event {
                source = start.source;
            } else if let Event::Arrive(vertex) = event {
                reached[source.index()].insert(scene.smooth(vertex.interface.acting.prim));
            }
            ControlFlow::Continue(())
        };
        forward.batch_observed(0, &mut watch, pace)?;
        Some(Self(reached))
    }
}

/// Sounds the gather paths of a sensor that end at a depth; `None` if stopped.
pub(super) fn sound(
    scene: &Scene,
    sensor: SensorId,
    reached: &Reached,
    (seed, depth): (u64, u32),
    pace: &Pace<'_>,
) -> Option<Sounded> {
    let emitters = Emitters::new(scene);
    let arrivals = Arrivals::new(scene, sensor);
    let gathering =
        Gathering { scene, emitters: &emitters, sensor, bounce_limit: u32::MAX, pace: Some(pace) };
    let mut sounding = Sounding {
        scene,
        depth,
        surfaces: BTreeSet::new(),
        across: Vec::new(),
        indices: Vec::new(),
        distances: vec![Vec::new(); scene.sources.len()],
        scatter: 0.0,
        to_aperture: f64::INFINITY,
    };
    let (mut scatters, mut to_aperture) = (Vec::new(), Vec::new());
    for index in 0..PATHS {
        if pace.spend(1).is_break() {
            return None;
        }
        let mut sampler =
            Sampler::for_path(seed, stream::GATHER_PILOT + sensor.index() as u64, index);
        if let Some(arrival) = arrivals.draw(&mut sampler) {
            follow(gathering, &arrival, &mut sampler, &mut sounding);
            scatters.push(std::mem::take(&mut sounding.scatter));
            to_aperture.push(std::mem::replace(&mut sounding.to_aperture, f64::INFINITY));
        }
    }
    // Without any vertex there is nothing to gather from, and any window works.
    let size = scene.bounds.diagonal();
    let Sounding { surfaces, across, indices, distances, .. } = sounding;
    let meets: Vec<bool> = reached.0.iter().map(|own| !own.is_disjoint(&surfaces)).collect();
    let knows = meets.contains(&true);
    let from_sources = distances
        .into_iter()
        .zip(meets)
        .map(|(distances, meets)| (meets || !knows).then(|| median(distances).unwrap_or(size)));
    let sounded = Sounded {
        inradius: median(across).unwrap_or(0.1 * size),
        index: median(indices).unwrap_or(1.0),
        scatter: median(scatters).unwrap_or(0.0),
        to_aperture: quantile(to_aperture, 0.25).unwrap_or(f64::INFINITY),
        from_sources: from_sources.collect(),
    };
    (!pace.is_stopped()).then_some(sounded)
}

fn median(found: Vec<f64>) -> Option<f64> {
    quantile(found, 0.5)
}

fn quantile(mut found: Vec<f64>, share: f64) -> Option<f64> {
    found.sort_by(f64::total_cmp);
    found.get((share * found.len() as f64) as usize).copied()
}

/// Sounds the guide where gather paths meet it.
struct Sounding<'s> {
    scene: &'s Scene,
    depth: u32,
    /// The surfaces met up to the records.
    surfaces: BTreeSet<SmoothId>,
    /// Half the distance across, mm.
    across: Vec<f64>,
    /// Indices of the media that paths are in.
    indices: Vec<f64>,
    /// Distances to each source, mm.
    distances: Vec<Vec<f64>>,
    /// Widest narrow scatter that the current path has met beyond its records, rad.
    scatter: f64,
    /// Least angle to an aperture on the current path, rad.
    to_aperture: f64,
}

impl Observer for Sounding<'_> {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        if let Event::Depart(vertex, departure) = event {
            self.probe_aperture(path, vertex, departure);
        }
        let Event::Arrive(vertex) = event else { return ControlFlow::Continue(()) };
        if path.depth <= self.depth {
            self.probe(path, vertex);
        } else {
            self.probe_scatter(path, vertex);
        }
        if path.depth < self.depth + BEYOND {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    }
}

impl Sounding<'_> {
    fn probe(&mut self, path: &Path, vertex: &Vertex<'_>) {
        let facing = facing(self.scene, path, vertex);
        let normal = facing.facet;
        self.indices.push(facing.incidence.index_from);
        let across = Ray::new(vertex.point, normal);
        let far = self.scene.find_next(&across, &StartSurfaces::hits(vertex.hits), &path.inside);
        let half_way = far.map_or(f64::INFINITY, |hits| 0.5 * hits.distance());
        let face: FaceId = vertex.interface.acting.face;
        self.across.push(half_way.min((self.scene.face_area(face) / PI).sqrt()));
        for (source, distances) in self.scene.sources.iter().zip(&mut self.distances) {
            distances.push(source.emitter.bounds().center().distance(vertex.point));
        }
        self.surfaces.insert(self.scene.smooth(vertex.interface.acting.prim));
    }

    fn probe_aperture(&mut self, path: &Path, vertex: &Vertex<'_>, departure: &Departure) {
        let Incidence { normal, index_from, index_to, .. } =
            facing(self.scene, path, vertex).incidence;
        if path.depth <= self.depth + 1
            && departure.side == Side::Transmitted
            && index_to > index_from
        {
            let own = departure.dir.cross(normal).length().min(1.0).asin();
            let widest = (index_from / index_to).asin();
            self.to_aperture = self.to_aperture.min((widest - own).abs());
        }
    }

    fn probe_scatter(&mut self, path: &Path, vertex: &Vertex<'_>) {
        let faces = facing(self.scene, path, vertex).faces;
        for finish in [faces.own, faces.behind] {
            match finish.spread() {
                Spread::Narrow(sigma) => self.scatter = self.scatter.max(sigma),
                Spread::Discrete | Spread::Broad => {}
            }
        }
    }
}
