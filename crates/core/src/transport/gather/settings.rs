//! Settings of the gather method: the user's values, and automatic values for the rest, from a few
//! pilot paths.

use crate::optics::{FinishModel, Spread};
use crate::plan::{RunPlan, Schedule};
use crate::rng::{Sampler, stream};
use crate::scene::{Arrivals, Emission, Emitter, FaceId, Ray, Scene, SensorId, StartSurfaces};
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::trial::{PASS_SEGMENTS, PhotonPilot};
use crate::transport::walk::emitters::Emitters;
use crate::transport::walk::follow::{Gathering, follow};
use crate::transport::walk::scatter::facing;
use crate::transport::{Event, Observer, Path, Vertex, Window};
use lumiduct_base::number::format_exact;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::fmt;
use std::ops::ControlFlow;

/// Pilot gather paths from each sensor.
const PILOT_PATHS: u64 = 64;
/// Radius of the first window over the inradius of the guide, 1 (measured on prototypes; docs/method.md).
const RADIUS_PER_INRADIUS: f64 = 0.2;
/// Largest radius as a share of the radius of the smallest source, 1.
const RADIUS_PER_SOURCE: f64 = 0.5;
/// A source of at least this share of the guide's inradius fills it, 1.
const FILLS: f64 = 0.8;
/// Bounds of the automatic angle, deg.
const THETA_DEG: [f64; 2] = [0.05, 3.0];
/// Bounds of the automatic depth.
const DEPTH: [f64; 2] = [1.0, 8.0];
/// Smallest number of photons of an automatic pass: in closed mirrors each has 100,000
/// segments.
const LEAST_PHOTONS: f64 = 32.0;
/// Cost of a gather path and its records in segments of photon paths, as measured, and their
/// work as a share of the work of the photons: limited by pairs, noise is least at equal shares;
/// fewer records are cheaper to look up.
const RECORD_SEGMENTS: f64 = 50.0;
const RECORD_SHARE: f64 = 0.27;

/// Settings of the gather method in a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GatherSettings {
    /// Vertex at which gather paths end, D; the first surface has depth 0.
    pub depth: u32,
    /// Window of the first stage.
    pub window: Window,
    /// Number of sensors.
    pub sensors: u64,
    /// Gather paths from each sensor in a pass of the first stage.
    pub gather_paths: u64,
    /// Photons in a pass.
    pub photons: u64,
    /// How the window shrinks.
    pub schedule: Schedule,
    /// Radius of the largest ball that fits the guide near the records, mm, as estimated.
    pub inradius: f64,
}

impl fmt::Display for GatherSettings {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { depth, window, gather_paths, photons, schedule, sensors: _, inradius: _ } = self;
        let schedule = match schedule {
            Schedule::Stages => "in stages",
            Schedule::PerPass => "from pass to pass",
        };
        write!(
            out,
            "depth {depth}, windows from {} mm and {} deg shrinking {schedule}, {photons} photons and {gather_paths} gather \
             paths from each sensor in the first passes",
            format_exact(window.radius),
            format_exact(window.theta_max.to_degrees())
        )
    }
}

impl PhotonPilot {
    /// Photons of an automatic pass.
    fn photons(self) -> u64 {
        let least = LEAST_PHOTONS * self.pass_segments / PASS_SEGMENTS;
        (self.pass_segments / self.segments_per_path).max(least).max(1.0) as u64
    }
}

/// Settings for gathering some sensors; `None` if stopped.
pub fn settle(
    scene: &Scene,
    plan: &RunPlan,
    sensors: &[SensorId],
    pilot: PhotonPilot,
    signal: &StopSignal,
) -> Option<GatherSettings> {
    let (seed, plan) = (plan.seed, &plan.gather);
    let depth = plan.depth.unwrap_or_else(|| {
        // K/3 of the K surfaces that a photon meets.
        ((pilot.segments_per_path - 1.0) / 3.0).clamp(DEPTH[0], DEPTH[1]) as u32
    });
    let pace = Pace::new(signal);
    let Sounded { inradius, from_sources } = sound(scene, sensors, (seed, depth), &pace)?;
    let source_radius = scene
        .sources
        .iter()
        .filter(|source| source.is_lit())
        .map(|source| half_width(&source.emitter))
        .fold(f64::INFINITY, f64::min);
    let radius = (RADIUS_PER_INRADIUS * inradius).min(RADIUS_PER_SOURCE * source_radius);
    let photons = plan.photons.unwrap_or_else(|| pilot.photons());
    let share = photons as f64 * pilot.segments_per_path * RECORD_SHARE / RECORD_SEGMENTS;
    let sensors = sensors.len().max(1) as u64;
    let gather_paths = plan.records.map_or(share as u64, |records| records) / sensors;
    Some(GatherSettings {
        depth,
        window: Window {
            radius: plan.radius_mm.unwrap_or(radius),
            theta_max: plan
                .angle_deg
                .map_or_else(|| angle(scene, inradius, &from_sources), f64::to_radians),
        },
        sensors,
        gather_paths: gather_paths.max(1),
        photons,
        schedule: plan.schedule.unwrap_or_default(),
        inradius,
    })
}

/// Half of the angular half-width of the narrowest source, or the scatter of the walls if that is
/// more, rad. (Twice the scatter gave a bias of 1.7 %; this gives a quarter of it: docs/method.md.)
///
/// A source that fills the guide is as wide as its emission: the images of its rim in the walls
/// join. A smaller one is seen from the records at its distance in `from_sources`, mm.
fn angle(scene: &Scene, inradius: f64, from_sources: &[f64]) -> f64 {
    let lit = scene.sources.iter().zip(from_sources).filter(|(source, _)| source.is_lit());
    let sources = lit.map(|(source, distance)| {
        let radius = half_width(&source.emitter);
        let seen = if radius < FILLS * inradius { radius / distance } else { 0.5 * PI };
        match source.emission {
            Emission::Cone { half_angle, .. } => half_angle.min(seen),
            Emission::Collimated { .. } => 0.0,
            Emission::Lambertian
            | Emission::CosinePower(_)
            | Emission::Isotropic
            | Emission::Sky(_) => seen,
        }
    });
    let narrowest = sources.fold(PI, f64::min);
    let scatter = scene.finishes.iter().map(|named| match named.finish.spread() {
        Spread::Narrow(sigma) => sigma,
        Spread::Discrete | Spread::Broad => 0.0,
    });
    let widest = scatter.fold(0.0, f64::max);
    let [least, most] = THETA_DEG.map(f64::to_radians);
    (0.5 * narrowest).max(widest).clamp(least, most)
}

/// Half of the width of a source, mm: for a flat one, of the shorter side; for a round one, the
/// radius.
fn half_width(emitter: &Emitter) -> f64 {
    let bounds = emitter.bounds();
    let mut extents = (bounds.max - bounds.min).to_array();
    extents.sort_by(f64::total_cmp);
    let [_, middle, _] = extents;
    0.5 * middle
}

/// Pilot measurements of the guide, medians in mm.
struct Sounded {
    inradius: f64,
    /// Distance of the records from each source.
    from_sources: Vec<f64>,
}

/// Probes the vertices of pilot paths: half the distance across the guide there, or the radius of a
/// disk with the area of the face, whichever is less, and the distances of the sources. `None` if
/// stopped.
fn sound(
    scene: &Scene,
    sensors: &[SensorId],
    (seed, depth): (u64, u32),
    pace: &Pace<'_>,
) -> Option<Sounded> {
    let emitters = Emitters::new(scene);
    let mut sounding = Sounding {
        scene,
        depth,
        across: Vec::new(),
        distances: vec![Vec::new(); scene.sources.len()],
    };
    for &sensor in sensors {
        let arrivals = Arrivals::new(scene, sensor);
        let (emitters, bounce_limit) = (&emitters, u32::MAX);
        let gathering = Gathering { scene, emitters, sensor, bounce_limit, pace: Some(pace) };
        for index in 0..PILOT_PATHS {
            if pace.spend(1).is_break() {
                return None;
            }
            let mut sampler =
                Sampler::for_path(seed, stream::GATHER_PILOT + sensor.index() as u64, index);
            if let Some(arrival) = arrivals.draw(&mut sampler) {
                follow(gathering, &arrival, &mut sampler, &mut sounding);
            }
        }
    }
    // Without any vertex there is nothing to gather from, and any window works.
    let size = scene.bounds.diagonal();
    let sounded = Sounded {
        inradius: median(sounding.across).unwrap_or(0.1 * size),
        from_sources: sounding
            .distances
            .into_iter()
            .map(|of_one| median(of_one).unwrap_or(size))
            .collect(),
    };
    (!pace.is_stopped()).then_some(sounded)
}

fn median(mut found: Vec<f64>) -> Option<f64> {
    found.sort_by(f64::total_cmp);
    found.get(found.len() / 2).copied()
}

/// Probes the guide where gather paths meet it.
struct Sounding<'s> {
    scene: &'s Scene,
    depth: u32,
    /// Half the distance across, mm.
    across: Vec<f64>,
    /// Distances to each source, mm.
    distances: Vec<Vec<f64>>,
}

impl Observer for Sounding<'_> {
    fn see(&mut self, path: &Path, event: Event<'_>) -> ControlFlow<()> {
        let Event::Arrive(vertex) = event else { return ControlFlow::Continue(()) };
        self.probe(path, vertex)
    }
}

impl Sounding<'_> {
    fn probe(&mut self, path: &Path, vertex: &Vertex<'_>) -> ControlFlow<()> {
        let normal = facing(self.scene, path, vertex).facet;
        let across = Ray::new(vertex.point, normal);
        let far = self.scene.find_next(&across, &StartSurfaces::hits(vertex.hits), &path.inside);
        let half_way = far.map_or(f64::INFINITY, |hits| 0.5 * hits.distance());
        let face: FaceId = vertex.interface.acting.face;
        self.across.push(half_way.min((self.scene.face_area(face) / PI).sqrt()));
        for (source, distances) in self.scene.sources.iter().zip(&mut self.distances) {
            distances.push(source.emitter.bounds().center().distance(vertex.point));
        }
        if path.depth < self.depth { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    }
}
