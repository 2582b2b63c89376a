//! A few paths to look at: where they went and how they ended.

use crate::rng::Sampler;
use crate::scene::{Scene, SourceId};
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
                // A stub shows where it went.
                track.points.push(path.ray.at(0.1 * scene.bounds.diagonal()));
                track.end = TrackEnd::Escaped;
            }
            Event::Leaked(..) => track.end = TrackEnd::Leaked,
            Event::Travel(_) | Event::Depart(..) | Event::Roulette(_) | Event::Cut(_) => {}
        }
        ControlFlow::Continue(())
    });
    track
}
