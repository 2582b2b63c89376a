//! A few paths to look at: where they went and how they ended.

use crate::math::Aabb;
use crate::rng::Sampler;
use crate::scene::{Ray, Scene, SourceId};
use crate::transport::{Event, Path, walk};
use glam::DVec3;
use std::ops::ControlFlow;

/// Stream of random numbers of the paths that are drawn.
const STREAM: u64 = 2;

/// Bounces that are drawn of a path: more only blacken the picture.
const BOUNCES_DRAWN: u32 = 500;

/// How a drawn path ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackEnd {
    /// A face took the rest of it.
    Absorbed,
    /// It left the scene.
    Escaped,
    /// It was cut by the bounce limit or by roulette, or goes on undrawn.
    Cut,
    /// It was lost through a hole in the geometry.
    Leaked,
}

/// A path as a chain of points.
#[derive(Debug, Clone)]
pub struct Track {
    /// Its start, its vertices, and a last point a little outside for one that escaped; mm.
    pub points: Vec<DVec3>,
    /// How it ended.
    pub end: TrackEnd,
}

/// Traces `count` paths, the sources in turn.
pub fn tracks(scene: &Scene, seed: u64, bounce_limit: u32, count: usize) -> Vec<Track> {
    if scene.sources.is_empty() {
        return Vec::new();
    }
    let source = |index: usize| SourceId::new(index % scene.sources.len());
    (0..count).map(|index| track(scene, source(index), seed, bounce_limit, index)).collect()
}

fn track(scene: &Scene, source: SourceId, seed: u64, bounce_limit: u32, index: usize) -> Track {
    let mut sampler = Sampler::for_path(seed, STREAM, index as u64);
    let emitted = scene.sources[source.index()].emit(scene, &mut sampler);
    let mut track = Track { points: vec![emitted.ray.origin()], end: TrackEnd::Cut };
    let path = Path::emitted(scene, source, emitted);
    let limit = bounce_limit.min(BOUNCES_DRAWN);
    walk(scene, path, limit, &mut sampler, &mut |path: &Path, event: Event<'_>| {
        match event {
            Event::Arrive(vertex) => track.points.push(vertex.point),
            Event::Collide(collision) => track.points.push(collision.point),
            Event::Absorbed(_) => track.end = TrackEnd::Absorbed,
            Event::Escaped(_) => {
                // Out of the scene, and a stub to show where it went.
                let way = way_out(&scene.bounds, &path.ray) + 0.05 * scene.bounds.diagonal();
                track.points.push(path.ray.at(way));
                track.end = TrackEnd::Escaped;
            }
            Event::Leaked(..) => track.end = TrackEnd::Leaked,
            Event::Travel(_) | Event::Depart(..) | Event::Roulette(_) | Event::Cut(_) => {}
        }
        ControlFlow::Continue(())
    });
    track
}

/// How far it is along a ray to where it leaves a box, mm; 0 from outside of it.
fn way_out(bounds: &Aabb, ray: &Ray) -> f64 {
    let (origin, dir) = (ray.origin(), ray.dir());
    let ahead = DVec3::select(dir.cmpgt(DVec3::ZERO), bounds.max, bounds.min);
    // Along a side of the box a ray never comes to the others: infinite, or no number where it runs in one.
    let ways = ((ahead - origin) / dir).to_array();
    ways.into_iter().filter(|way| way.is_finite()).fold(f64::INFINITY, f64::min).max(0.0)
}
