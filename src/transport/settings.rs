//! How the gather method is set: what was asked for, and automatic values for the rest, from a few pilot paths.

use crate::optics::Spread;
use crate::rng::Sampler;
use crate::scene::plan::{GatherPlan, Schedule};
use crate::scene::{Arrivals, Emission, Emitter, FaceId, On, Ray, Scene, SensorId};
use crate::transport::emitters::{Emitters, Met};
use crate::transport::follow::{Collector, Gathering, follow};
use crate::transport::scatter::facing;
use crate::transport::{Departure, Path, Vertex, Window};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Stream of random numbers of the pilot's gather paths.
const STREAM: u64 = 4 << 32;
/// Pilot gather paths from each sensor.
const PILOT_PATHS: u64 = 64;
/// Radius of the first window over the inradius of the guide, 1 (measured on prototypes; docs/method.md).
const RADIUS_PER_INRADIUS: f64 = 0.2;
/// And at most this share of the radius of the smallest source, 1.
const RADIUS_PER_SOURCE: f64 = 0.5;
/// Bounds of the automatic angle, deg.
const THETA_DEG: [f64; 2] = [0.05, 3.0];
/// Bounds of the automatic depth.
const DEPTH: [f64; 2] = [1.0, 8.0];
/// Straight pieces of photon paths in an automatic pass: seconds of work, so that the first stage ends soon.
const PASS_SEGMENTS: f64 = 4e6;
/// Straight pieces of photon paths that a gather path and its records cost, as measured, and what share of the work of
/// the photons they get: limited by pairs, noise is least at equal shares; looking them up costs less with fewer.
const RECORD_SEGMENTS: f64 = 50.0;
const RECORD_SHARE: f64 = 0.4;

/// How the gather method works in a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GatherSettings {
    /// Vertex at which gather paths end, D; the first surface has depth 0.
    pub depth: u32,
    /// Window of the first stage.
    pub window: Window,
    /// Gather paths from each sensor in a pass of the first stage.
    pub gather_paths: u64,
    /// Photons in a pass.
    pub photons: u64,
    /// How the window shrinks.
    pub schedule: Schedule,
    /// Radius of the largest ball that fits the guide near the records, mm, as estimated.
    pub inradius: f64,
}

/// What pilot photons have told.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PhotonPilot {
    /// Straight pieces of a photon path, mean.
    pub(crate) segments_per_path: f64,
}

/// Settles how some sensors are gathered.
pub(crate) fn settle(
    scene: &Scene,
    plan: &GatherPlan,
    sensors: &[SensorId],
    seed: u64,
    pilot: PhotonPilot,
) -> GatherSettings {
    let depth = plan.depth.unwrap_or_else(|| {
        // K/3 of the K surfaces that a photon meets.
        ((pilot.segments_per_path - 1.0) / 3.0).clamp(DEPTH[0], DEPTH[1]) as u32
    });
    let inradius = inradius(scene, sensors, seed, depth);
    let source = scene.sources.iter().filter_map(|source| source.emitter.area());
    let source_radius = source.map(|area| (area / PI).sqrt()).fold(f64::INFINITY, f64::min);
    let radius = (RADIUS_PER_INRADIUS * inradius).min(RADIUS_PER_SOURCE * source_radius);
    let photons = plan
        .photons
        .unwrap_or_else(|| (PASS_SEGMENTS / pilot.segments_per_path).max(1000.0) as u64);
    let share = photons as f64 * pilot.segments_per_path * RECORD_SHARE / RECORD_SEGMENTS;
    let sensors = sensors.len().max(1) as u64;
    let gather_paths = plan.records.map_or(share as u64, |records| records) / sensors;
    GatherSettings {
        depth,
        window: Window {
            radius: plan.radius.unwrap_or(radius),
            theta_max: plan.theta_max.unwrap_or_else(|| angle(scene)),
        },
        gather_paths: gather_paths.max(1),
        photons,
        schedule: plan.schedule,
        inradius,
    }
}

/// Half of the angular half-width of the narrowest source, or twice the scatter of the walls if that is more, rad.
fn angle(scene: &Scene) -> f64 {
    let sources = scene.sources.iter().map(|source| match (source.emission, &source.emitter) {
        (Emission::Cone { half_angle, .. }, _) => half_angle,
        (Emission::Collimated { .. }, _) => 0.0,
        (
            Emission::Lambertian | Emission::CosinePower(_) | Emission::Isotropic,
            Emitter::Point(_),
        )
        | (Emission::Lambertian | Emission::CosinePower(_) | Emission::Isotropic, _) => 0.5 * PI,
    });
    let narrowest = sources.fold(PI, f64::min);
    let scatter = scene.finishes.iter().map(|finish| match finish.bsdf.kind() {
        Spread::Narrow(sigma) => sigma,
        Spread::Discrete | Spread::Broad => 0.0,
    });
    let widest = scatter.fold(0.0, f64::max);
    let [least, most] = THETA_DEG.map(f64::to_radians);
    (0.5 * narrowest).max(2.0 * widest).clamp(least, most)
}

/// Median over the vertices of pilot paths of half the way across the guide there, or of the radius of a disk of the
/// area of the face, whichever is less; mm.
fn inradius(scene: &Scene, sensors: &[SensorId], seed: u64, depth: u32) -> f64 {
    let emitters = Emitters::new(scene);
    let mut sounding = Sounding { scene, depth, found: Vec::new() };
    for &sensor in sensors {
        let arrivals = Arrivals::new(scene, sensor);
        let gathering = Gathering { scene, emitters: &emitters, sensor, bounce_limit: u32::MAX };
        for index in 0..PILOT_PATHS {
            let mut sampler = Sampler::for_path(seed, STREAM + sensor.index() as u64, index);
            if let Some(arrival) = arrivals.draw(&mut sampler) {
                follow(gathering, &arrival, &mut sampler, &mut sounding);
            }
        }
    }
    let mut found = sounding.found;
    found.sort_by(f64::total_cmp);
    // Without any vertex there is nothing to gather from, and any window will do.
    found.get(found.len() / 2).copied().unwrap_or(0.1 * scene.bounds.diagonal())
}

/// Sounds how wide the guide is where gather paths meet it.
struct Sounding<'s> {
    scene: &'s Scene,
    depth: u32,
    found: Vec<f64>,
}

impl Collector for Sounding<'_> {
    fn meet(&mut self, _: &Path, _: Met) {}

    fn arrive(&mut self, path: &Path, vertex: &Vertex<'_>) -> ControlFlow<()> {
        let normal = facing(self.scene, path, vertex).facet;
        let across = Ray::new(vertex.point, normal);
        let far = self.scene.find_next(&across, &On::hits(vertex.hits), &path.inside);
        let half_way = far.map_or(f64::INFINITY, |hits| 0.5 * hits.distance());
        let face: FaceId = vertex.interface.acting.face;
        self.found.push(half_way.min((self.scene.face_area(face) / PI).sqrt()));
        if path.depth < self.depth { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }

    fn depart(&mut self, _: &Path, _: &Vertex<'_>, _: &Departure) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
