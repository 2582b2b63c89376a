//! The same guides traced by hand-written loops, one for each guide, with nothing general.
//!
//! They measure the cost of the general tracer. The physics is the same: Lambertian disk, mirror or
//! Fresnel coin, roulette below the same throughput, flux by batch, a map of the exit and for the
//! round rod the far field. Each goes step by step, or takes all bounces between the ends at once.

use crate::guides::{FAR_RINGS, MAP_CELLS, Rod, Section, Tube};
use glam::DVec3;
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::f64::consts::{PI, TAU};

/// What a loop counts. Flux is relative to that of the source.
#[derive(Debug, Clone)]
pub(crate) struct Counted {
    /// Segments, including the last one that leaves the scene.
    pub(crate) segments: u64,
    /// Flux through the exit in each batch.
    pub(crate) batches: Vec<f64>,
    /// Flux of each cell of the exit, a mean over batches, and the mean of its square.
    pub(crate) map: Vec<[f64; 2]>,
    pub(crate) far: Vec<f64>,
}

/// How much to trace.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Work {
    pub(crate) stepping: Steps,
    pub(crate) batches: usize,
    pub(crate) batch_paths: u64,
    pub(crate) roulette_below: f64,
    pub(crate) seed: u64,
}

/// How a path gets through a guide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Steps {
    /// From wall to wall.
    Single,
    /// From end to end. All light in a rod is totally reflected by its walls.
    Rows,
}

struct Tracer {
    random: Xoshiro256PlusPlus,
    roulette_below: f64,
    half_map: f64,
    counted: Counted,
    /// Flux of the batch, and of its cells.
    flux: f64,
    cells: Vec<f64>,
}

/// Traces a mirror tube.
pub(crate) fn trace_tube(tube: &Tube, work: &Work) -> Counted {
    match work.stepping {
        Steps::Single => trace(work, tube.radius, |tracer| tube_path(tube, tracer)),
        Steps::Rows => trace(work, tube.radius, |tracer| tube_row(tube, tracer)),
    }
}

/// Traces a rod.
pub(crate) fn trace_rod(rod: &Rod, work: &Work) -> Counted {
    match (rod.section, work.stepping) {
        (Section::Round(radius), Steps::Single) => {
            trace(work, radius, |tracer| round_path(rod, radius, tracer))
        }
        (Section::Square(half), Steps::Single) => {
            trace(work, half, |tracer| square_path(rod, half, tracer))
        }
        (Section::Round(radius), Steps::Rows) => trace(work, radius, |tracer| {
            let hits = |p: DVec3| p.x * p.x + p.y * p.y <= radius * radius;
            rod_rows(rod, tracer, hits, |p, d, t| round_row(p, d, t, radius).0);
        }),
        (Section::Square(half), Steps::Rows) => trace(work, half, |tracer| {
            let hits = |p: DVec3| p.x.abs() <= half && p.y.abs() <= half;
            rod_rows(rod, tracer, hits, |p, d, t| square_row(p, d, t, half));
        }),
    }
}

fn trace(work: &Work, half_map: f64, mut path: impl FnMut(&mut Tracer)) -> Counted {
    let cells = MAP_CELLS * MAP_CELLS;
    let mut tracer = Tracer {
        random: Xoshiro256PlusPlus::seed_from_u64(work.seed),
        roulette_below: work.roulette_below,
        half_map,
        counted: Counted {
            segments: 0,
            batches: Vec::new(),
            map: vec![[0.0; 2]; cells],
            far: vec![0.0; FAR_RINGS],
        },
        flux: 0.0,
        cells: vec![0.0; cells],
    };
    let paths = work.batch_paths as f64;
    for _ in 0..work.batches {
        for _ in 0..work.batch_paths {
            path(&mut tracer);
        }
        tracer.counted.batches.push(std::mem::take(&mut tracer.flux) / paths);
        for (sums, cell) in tracer.counted.map.iter_mut().zip(&mut tracer.cells) {
            let mean = std::mem::take(cell) / paths;
            sums[0] += mean / work.batches as f64;
            sums[1] += mean * mean / work.batches as f64;
        }
    }
    tracer.counted
}

fn tube_path(tube: &Tube, tracer: &mut Tracer) {
    let (mut p, mut d) = tracer.lambertian_disk(DVec3::ZERO, tube.radius);
    let mut weight = 1.0;
    loop {
        tracer.counted.segments += 1;
        let t = distance_to_cylinder(p, d, tube.radius);
        let z = p.z + t * d.z;
        if z >= tube.length {
            tracer.count_map(p + (tube.length - p.z) / d.z * d, weight);
            return;
        }
        if z <= 0.0 {
            return;
        }
        p += t * d;
        let normal = DVec3::new(-p.x / tube.radius, -p.y / tube.radius, 0.0);
        d = mirrored(d, normal, -d.dot(normal));
        weight *= tube.reflectance;
        if !tracer.survives(&mut weight) {
            return;
        }
    }
}

fn round_path(rod: &Rod, radius: f64, tracer: &mut Tracer) {
    let Some((mut p, mut d)) = tracer.enter(rod, |p| p.x * p.x + p.y * p.y <= radius * radius)
    else {
        return;
    };
    loop {
        tracer.counted.segments += 1;
        let mut t = distance_to_cylinder(p, d, radius);
        let z = p.z + t * d.z;
        let end = z <= 0.0 || z >= rod.length;
        let normal = if end {
            let face = if d.z > 0.0 { rod.length } else { 0.0 };
            t = (face - p.z) / d.z;
            DVec3::new(0.0, 0.0, -d.z.signum())
        } else {
            let p = p + t * d;
            DVec3::new(-p.x / radius, -p.y / radius, 0.0)
        };
        p += t * d;
        match tracer.reflect_or_refract(d, normal, rod.index) {
            Leg::Reflected(dir) => d = dir,
            Leg::Refracted(dir) => {
                tracer.leave(p, dir, rod.length, end);
                return;
            }
        }
    }
}

fn square_path(rod: &Rod, half: f64, tracer: &mut Tracer) {
    let Some((mut p, mut d)) = tracer.enter(rod, |p| p.x.abs() <= half && p.y.abs() <= half) else {
        return;
    };
    loop {
        tracer.counted.segments += 1;
        let to = |d: f64, p: f64, low: f64, high: f64| {
            if d > 0.0 { (high - p) / d } else { (low - p) / d }
        };
        let tx = to(d.x, p.x, -half, half);
        let ty = to(d.y, p.y, -half, half);
        let tz = to(d.z, p.z, 0.0, rod.length);
        let (t, normal) = if tz < tx && tz < ty {
            (tz, DVec3::new(0.0, 0.0, -d.z.signum()))
        } else if tx < ty {
            (tx, DVec3::new(-d.x.signum(), 0.0, 0.0))
        } else {
            (ty, DVec3::new(0.0, -d.y.signum(), 0.0))
        };
        p += t * d;
        match tracer.reflect_or_refract(d, normal, rod.index) {
            Leg::Reflected(dir) => d = dir,
            Leg::Refracted(dir) => {
                tracer.leave(p, dir, rod.length, normal.z != 0.0);
                return;
            }
        }
    }
}

fn tube_row(tube: &Tube, tracer: &mut Tracer) {
    let (p, d) = tracer.lambertian_disk(DVec3::ZERO, tube.radius);
    tracer.counted.segments += 1;
    let ((p, _), bounces) = round_row(p, d, tube.length / d.z, tube.radius);
    tracer.count_map(p, tube.reflectance.powf(bounces));
}

fn rod_rows(
    rod: &Rod,
    tracer: &mut Tracer,
    hits: impl Fn(DVec3) -> bool,
    row: impl Fn(DVec3, DVec3, f64) -> (DVec3, DVec3),
) {
    let Some((mut p, mut d)) = tracer.enter(rod, hits) else { return };
    loop {
        tracer.counted.segments += 1;
        let end = if d.z > 0.0 { rod.length } else { 0.0 };
        (p, d) = row(p, d, (end - p.z) / d.z);
        match tracer.reflect_or_refract(d, DVec3::new(0.0, 0.0, -d.z.signum()), rod.index) {
            Leg::Reflected(dir) => d = dir,
            Leg::Refracted(dir) => return tracer.leave(p, dir, rod.length, true),
        }
    }
}

/// Where light is in a round guide after a way `t`, its direction there, and how often it has bounced: the chords of a path
/// have one length and one turn.
fn round_row(p: DVec3, d: DVec3, t: f64, radius: f64) -> ((DVec3, DVec3), f64) {
    let first = distance_to_cylinder(p, d, radius);
    if t <= first {
        return ((p + t * d, d), 0.0);
    }
    let wall = p + first * d;
    let normal = DVec3::new(-wall.x / radius, -wall.y / radius, 0.0);
    let cos = -d.dot(normal);
    let across2 = d.x * d.x + d.y * d.y;
    let chord = 2.0 * radius * cos / across2;
    let further = ((t - first) / chord).floor();
    let turn = 2.0 * (cos / across2.sqrt()).min(1.0).asin();
    let sense = (wall.x * d.y - wall.y * d.x).signum();
    let (sin, cos_turn) = (sense * further * turn).sin_cos();
    let turned = |v: DVec3| DVec3::new(cos_turn * v.x - sin * v.y, sin * v.x + cos_turn * v.y, v.z);
    let after = mirrored(d, normal, cos);
    let left = t - first - further * chord;
    let along = DVec3::new(0.0, 0.0, (t - left - first) * d.z);
    ((turned(wall + left * after) + along, turned(after)), 1.0 + further)
}

/// Where light is in a square guide after a way `t`, and its direction there: a straight line, folded.
fn square_row(p: DVec3, d: DVec3, t: f64, half: f64) -> (DVec3, DVec3) {
    let folded = |p: f64, d: f64| {
        let turns = ((p + t * d + half) / (2.0 * half)).floor();
        let offset = p + t * d - 2.0 * half * turns;
        if turns.rem_euclid(2.0) == 0.0 { (offset, d) } else { (-offset, -d) }
    };
    let ((x, dx), (y, dy)) = (folded(p.x, d.x), folded(p.y, d.y));
    (DVec3::new(x, y, p.z + t * d.z), DVec3::new(dx, dy, d.z))
}

/// How light continues from an interface.
enum Leg {
    Reflected(DVec3),
    Refracted(DVec3),
}

/// The further root: the start is inside or on the wall.
fn distance_to_cylinder(p: DVec3, d: DVec3, radius: f64) -> f64 {
    let a = d.x * d.x + d.y * d.y;
    let b = p.x * d.x + p.y * d.y;
    let c = p.x * p.x + p.y * p.y - radius * radius;
    (-b + (b * b - a * c).max(0.0).sqrt()) / a
}

fn mirrored(d: DVec3, normal: DVec3, cos: f64) -> DVec3 {
    (d + 2.0 * cos * normal).normalize()
}

impl Tracer {
    fn one(&mut self) -> f64 {
        (self.random.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    fn lambertian_disk(&mut self, center: DVec3, radius: f64) -> (DVec3, DVec3) {
        let r = radius * self.one().sqrt();
        let (sin, cos) = (TAU * self.one()).sin_cos();
        let p = center + DVec3::new(r * cos, r * sin, 0.0);
        let u = self.one();
        let s = u.sqrt();
        let (sin, cos) = (TAU * self.one()).sin_cos();
        (p, DVec3::new(s * cos, s * sin, (1.0 - u).sqrt()))
    }

    /// Starts a path before the rod and refracts it into the rod; `None` when it misses the entry
    /// or is reflected.
    fn enter(&mut self, rod: &Rod, hits: impl Fn(DVec3) -> bool) -> Option<(DVec3, DVec3)> {
        let center = DVec3::new(rod.source_at[0], rod.source_at[1], -rod.gap);
        let (p, d) = self.lambertian_disk(center, rod.source_radius);
        self.counted.segments += 1;
        let p = p + rod.gap / d.z * d;
        if !hits(p) {
            self.count_far(d);
            return None;
        }
        match self.reflect_or_refract(d, -DVec3::Z, 1.0 / rod.index) {
            Leg::Refracted(dir) => Some((p, dir)),
            Leg::Reflected(dir) => {
                self.counted.segments += 1;
                self.count_far(dir);
                None
            }
        }
    }

    /// Fresnel for unpolarised light, where the index ahead is `index` times that behind.
    fn reflect_or_refract(&mut self, d: DVec3, normal: DVec3, index: f64) -> Leg {
        let cos = -d.dot(normal);
        let sin2 = index * index * (1.0 - cos * cos);
        if sin2 < 1.0 {
            let cos_t = (1.0 - sin2).sqrt();
            let s = (index * cos - cos_t) / (index * cos + cos_t);
            let p = (cos - index * cos_t) / (cos + index * cos_t);
            if self.one() >= 0.5 * (s * s + p * p) {
                return Leg::Refracted((index * d + (index * cos - cos_t) * normal).normalize());
            }
        }
        Leg::Reflected(mirrored(d, normal, cos))
    }

    /// A path of throughput 1 leaves the rod; `end` is true if it leaves through entry or exit.
    fn leave(&mut self, p: DVec3, d: DVec3, length: f64, end: bool) {
        self.counted.segments += 1;
        if end && p.z > 0.5 * length {
            self.count_map(p, 1.0);
        }
        self.count_far(d);
    }

    fn survives(&mut self, weight: &mut f64) -> bool {
        if *weight < self.roulette_below {
            if self.one() * self.roulette_below >= *weight {
                return false;
            }
            *weight = self.roulette_below;
        }
        true
    }

    fn count_map(&mut self, p: DVec3, weight: f64) {
        self.flux += weight;
        let cell = |x: f64| {
            let place = (x + self.half_map) / (2.0 * self.half_map) * MAP_CELLS as f64;
            (place as usize).min(MAP_CELLS - 1)
        };
        let cell = cell(p.y) * MAP_CELLS + cell(p.x);
        self.cells[cell] += weight;
    }

    fn count_far(&mut self, d: DVec3) {
        let gamma = d.z.clamp(-1.0, 1.0).acos();
        let ring = (gamma / PI * FAR_RINGS as f64) as usize;
        self.counted.far[ring.min(FAR_RINGS - 1)] += 1.0;
    }
}
