//! Rays that a sensor counts, for files. They are traced on their own, after a run, so that they need no memory during it and do not
//! depend on how its sensor was estimated.

use crate::rng::{Dimension, Sampler, stream};
use crate::scene::{Scene, SensorId};
use crate::transport::forward::Forward;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::{Event, Path};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Paths of a batch.
const BATCH_PATHS: u64 = 1 << 14;
/// Batches between two looks at the number of rays.
const ROUND: u64 = 16;
/// Paths that are traced at most for each ray that is asked for.
const MAX_PATHS_PER_RAY: u64 = 256;

/// A ray that a sensor counted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CountedRay {
    /// Position on the sensor, mm; for a far field, any point of the path.
    pub point: DVec3,
    /// Unit direction of travel.
    pub dir: DVec3,
    /// Flux, lm or W: all rays together carry that of the sensor.
    pub flux: f64,
}

/// How many rays are collected, and from which numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RayCollection {
    /// The sensor.
    pub sensor: SensorId,
    /// Number of rays.
    pub count: usize,
    /// Seed of the run.
    pub seed: u64,
    /// Bounce limit of the run.
    pub bounce_limit: u32,
}

/// Rays that a sensor counts: as many as asked for, drawn at random from whole batches of photons, or fewer if 256 photons for each do not
/// give them.
pub fn counted_rays(scene: &Scene, asked: &RayCollection) -> Vec<CountedRay> {
    let forward = Forward::new(scene, asked.seed, asked.bounce_limit, BATCH_PATHS);
    let most = (asked.count as u64).saturating_mul(MAX_PATHS_PER_RAY).div_ceil(BATCH_PATHS);
    let (mut rays, mut batches) = (Vec::new(), 0);
    while rays.len() < asked.count && batches < most.max(ROUND) {
        let round = batches..batches + ROUND;
        let found: Vec<_> =
            round.into_par_iter().map(|batch| of_batch(&forward, asked.sensor, batch)).collect();
        rays.extend(found.into_iter().flatten());
        batches += ROUND;
    }
    // The photons of a batch share the whole flux of their source.
    let found = rays.len();
    draw(&mut rays, asked);
    let share = found as f64 / (rays.len() as f64 * batches as f64);
    rays.iter_mut().for_each(|ray| ray.flux *= share);
    rays
}

fn of_batch(forward: &Forward<'_>, sensor: SensorId, batch: u64) -> Vec<CountedRay> {
    let mut rays = Vec::new();
    let mut note = |_: &Path, event: Event<'_>| {
        if let Event::Detect(light) = event
            && light.sensor == sensor
            && !light.cells.is_empty()
        {
            rays.push(CountedRay { point: light.point, dir: light.dir, flux: light.flux });
        }
        ControlFlow::Continue(())
    };
    // Nothing stops it.
    _ = forward.batch_observed(batch, &mut note, &Pace::new(&StopSignal::default()));
    rays
}

/// Keeps as many as asked for, each set of them with the same probability (Fisher & Yates), in an order of chance.
fn draw(rays: &mut Vec<CountedRay>, asked: &RayCollection) {
    let mut sampler = Sampler::for_path(asked.seed, stream::EXPORTED, 0);
    let found = rays.len();
    for place in 0..asked.count.min(found) {
        let step = (sampler.one(Dimension::Resampling) * (found - place) as f64) as usize;
        rays.swap(place, (place + step).min(found - 1));
    }
    rays.truncate(asked.count);
}
