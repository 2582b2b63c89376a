//! A few paths to look at: their course and their end.

use crate::rng::{Sampler, stream};
use crate::scene::{FaceId, Ray, Scene, SensorId, SourceId, Wavelengths};
use crate::transport::forward::Forward;
use crate::transport::{Event, Path};
use glam::DVec3;
use lumiduct_base::math::Aabb;

/// Largest number of bounces drawn of a path: more only blacken the picture.
const BOUNCES_DRAWN: u32 = 500;

/// How a drawn path ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackEnd {
    /// A face absorbed the rest of it.
    Absorbed(FaceId),
    /// It left the scene.
    Escaped,
    /// Faces and media absorbed most of it, and roulette removed the rest.
    Faded,
    /// It was cut by the bounce limit, or continues undrawn.
    Cut,
    /// It was lost through a hole in the geometry.
    Leaked,
}

/// A path as a chain of points.
#[derive(Debug, Clone)]
pub struct Track {
    /// Its source.
    pub source: SourceId,
    /// Its start, its vertices, and a last point a little outside for one that escaped; mm.
    pub points: Vec<DVec3>,
    /// How it ended.
    pub end: TrackEnd,
    /// The sensors that counted it, the latest last.
    pub counted_by: Vec<SensorId>,
}

/// Traces `count` paths, the sources in turn.
pub fn tracks(scene: &Scene, seed: u64, bounce_limit: u32, count: usize) -> Vec<Track> {
    let lit = (0..scene.sources.len()).filter(|&source| scene.sources[source].is_lit());
    let lit: Vec<SourceId> = lit.map(SourceId::new).collect();
    if lit.is_empty() {
        return Vec::new();
    }
    let forward = Forward::new(scene, seed, bounce_limit.min(BOUNCES_DRAWN), 1);
    (0..count).map(|index| track(&forward, lit[index % lit.len()], index)).collect()
}

fn track(forward: &Forward<'_>, source: SourceId, index: usize) -> Track {
    let scene = forward.scene;
    let mut sampler = Sampler::for_path(forward.seed, stream::DRAWN, index as u64);
    let wavelength = scene.photon_wavelength(source, Wavelengths::All, &mut sampler);
    let emitted = scene.sources[source.index()].emit(scene, wavelength, &mut sampler);
    let (mut points, mut end) = (vec![emitted.ray.origin()], TrackEnd::Cut);
    let path = Path::emitted(scene, source, emitted);
    let mut see = |path: &Path, event: &Event<'_>| match event {
        Event::Arrive(vertex) => points.push(vertex.point),
        Event::Collide(collision) => points.push(collision.point),
        Event::Convert(conversion) => points.push(conversion.point),
        Event::Absorbed(vertex) => end = TrackEnd::Absorbed(vertex.interface.acting.face),
        Event::Escaped(_) => {
            // Out of the scene, with a stub that shows its direction.
            let way = way_out(&scene.bounds, &path.ray) + 0.05 * scene.bounds.diagonal();
            points.push(path.ray.at(way));
            end = TrackEnd::Escaped;
        }
        Event::Leaked(..) => end = TrackEnd::Leaked,
        // A survivor gains, and continues.
        Event::Roulette(taken) => {
            end = if *taken > 0.0 { TrackEnd::Faded } else { TrackEnd::Cut };
        }
        Event::Start(_)
        | Event::Travel(_)
        | Event::Jump(_)
        | Event::Depart(..)
        | Event::Detect(_)
        | Event::Meet(_)
        | Event::Cut(_) => {}
    };
    let counted_by = forward.show(source, path, &mut sampler, &mut see);
    Track { source, points, end, counted_by }
}

/// Distance along a ray to where it leaves a box, mm; 0 from outside it.
fn way_out(bounds: &Aabb, ray: &Ray) -> f64 {
    let (origin, dir) = (ray.origin(), ray.dir());
    let ahead = DVec3::select(dir.cmpgt(DVec3::ZERO), bounds.max, bounds.min);
    // Along a side of the box a ray never reaches the others: infinite, or NaN where it runs in
    // one.
    let ways = ((ahead - origin) / dir).to_array();
    ways.into_iter().filter(|way| way.is_finite()).fold(f64::INFINITY, f64::min).max(0.0)
}
