//! Whether the pieces of a path fit: enough room between corners, no ring, no leg through another one.

use crate::math::{Aabb, planar};
use crate::scene::shape::Polygon;
use crate::scene::sweep::Profile;
use crate::scene::sweep::path::{
    End, Form, Path, Piece, SweepError, SweepProblem, bend_frame, direction, unit,
};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Touching is no overlap: points count as inside from this share of the profile's size on.
const MARGIN: f64 = 1e-9;
/// The most sections of a piece, and the most points of a section, at which an overlap is looked for.
const MAX_SECTIONS: usize = 400;
const MAX_SECTION_POINTS: usize = 32;

/// The first reason why the pieces of `path` make no sweep of `profile`.
pub(super) fn check(profile: &Profile, path: &Path) -> Result<(), SweepError> {
    let size = profile.size();
    for piece in &path.pieces {
        if let Form::Prism { floor, ceiling } = &piece.form {
            let missing = missing_length(profile, piece.start.scale, floor, ceiling);
            if missing > 1e-12 * (size + ceiling.height.abs()) {
                let problem = SweepProblem::TooShort { missing };
                return Err(SweepError { leg: Some(piece.leg), problem });
            }
        }
    }
    let (entry, exit) = (&path.pieces[0].start, &path.exit);
    if entry.frame.origin.distance(exit.frame.origin) <= MARGIN * size {
        let leg = path.pieces.last().map(|piece| piece.leg);
        return Err(SweepError { leg, problem: SweepProblem::ClosedRing });
    }
    find_overlap(profile, path)
}

/// By how much the planes of the ceiling dip below those of the floor, mm; negative where there is room to spare.
fn missing_length(profile: &Profile, scale: f64, floor: &End, ceiling: &End) -> f64 {
    let mut missing = f64::NEG_INFINITY;
    for below in &floor.slopes {
        for above in &ceiling.slopes {
            // The height between two planes is linear over the profile: least at its extreme point.
            let falls = scale * profile.reach(*below * floor.toward - *above * ceiling.toward);
            missing = missing.max(falls - (ceiling.height - floor.height));
        }
    }
    missing
}

/// A piece as a set of points.
struct Body<'a> {
    piece: &'a Piece,
    samples: Vec<DVec3>,
    bounds: Aabb,
}

/// Looks for points on the walls of a piece that lie within another piece. Legs that really cross share much more than
/// the distance between these points.
fn find_overlap(profile: &Profile, path: &Path) -> Result<(), SweepError> {
    let outline = Outline::new(profile, path.exit.along);
    let bodies: Vec<Body> = path
        .pieces
        .iter()
        .filter(|piece| !matches!(piece.form, Form::Corner { .. }))
        .map(|piece| {
            let samples = samples(&outline, piece);
            let bounds = Aabb::of(samples.iter().copied()).grown(outline.size * piece.start.scale);
            Body { piece, samples, bounds }
        })
        .collect();
    for (i, later) in bodies.iter().enumerate() {
        for earlier in &bodies[..i] {
            if !later.bounds.overlaps(&earlier.bounds) {
                continue;
            }
            let common = common_point(&outline, later, earlier)
                .or_else(|| common_point(&outline, earlier, later));
            if let Some(DVec3 { x, y, z }) = common {
                let problem = SweepProblem::Overlap { other: earlier.piece.leg + 1, x, y, z };
                return Err(SweepError { leg: Some(later.piece.leg), problem });
            }
        }
    }
    Ok(())
}

fn common_point(outline: &Outline, one: &Body, other: &Body) -> Option<DVec3> {
    let near = |p: &&DVec3| other.bounds.contains(**p);
    one.samples.iter().filter(near).find(|p| holds(outline, other.piece, **p)).copied()
}

/// The profile at the entry, made ready for questions.
struct Outline<'a> {
    profile: &'a Profile,
    polygon: Option<Polygon>,
    size: f64,
    margin: f64,
    /// Points on its outline and its centroid.
    points: Vec<DVec2>,
}

impl<'a> Outline<'a> {
    fn new(profile: &'a Profile, path_length: f64) -> Self {
        let size = profile.size();
        // The second term is the rounding of coordinates.
        let margin = MARGIN * size + 1e-14 * path_length;
        match profile {
            Profile::Circle { radius } => {
                let azimuth = |i: usize| TAU * i as f64 / MAX_SECTION_POINTS as f64;
                let rim = (0..MAX_SECTION_POINTS).map(|i| *radius * unit(azimuth(i)));
                let points = rim.chain([DVec2::ZERO]).collect();
                Self { profile, polygon: None, size, margin, points }
            }
            Profile::Polygon { points } => {
                let step = points.len().div_ceil(MAX_SECTION_POINTS / 2);
                let centroid = planar::area_moment(points) / planar::signed_area(points);
                let outline = planar::edges(points).step_by(step);
                let rim = outline.flat_map(|(a, b)| [a, 0.5 * (a + b)]);
                let samples = rim.chain([centroid]).collect();
                let polygon = Some(Polygon::new(points.clone()));
                Self { profile, polygon, size, margin, points: samples }
            }
        }
    }

    /// Whether a point lies within the profile scaled by `scale`, not just on its outline.
    fn holds(&self, q: DVec2, scale: f64) -> bool {
        let (q, margin) = (q / scale, self.margin);
        match self.profile {
            Profile::Circle { radius } => q.length() < radius - margin,
            Profile::Polygon { points } => {
                self.polygon.as_ref().is_some_and(|polygon| polygon.contains(q))
                    && planar::edges(points).all(|(a, b)| distance(q, a, b) > margin)
            }
        }
    }
}

/// Distance of a point from a line segment, mm.
fn distance(q: DVec2, a: DVec2, b: DVec2) -> f64 {
    let share = (q - a).dot(b - a) / (b - a).length_squared();
    q.distance(a.lerp(b, share.clamp(0.0, 1.0)))
}

/// Points of a piece: sections along it at most a quarter of the profile's size apart, unless it is very long.
fn samples(outline: &Outline, piece: &Piece) -> Vec<DVec3> {
    let start = &piece.start;
    let size = outline.size * start.scale;
    let count = |length: f64| (4.0 * length / size).ceil().clamp(2.0, MAX_SECTIONS as f64) as usize;
    let shares = |n: usize| (0..=n).map(move |i| i as f64 / n as f64);
    let at = |q: DVec2, z: f64| start.frame.origin + direction(&start.frame, q) + z * start.frame.z;
    let mut points = Vec::new();
    match &piece.form {
        Form::Prism { floor, ceiling } => {
            for share in shares(count(ceiling.height - floor.height)) {
                points.extend(outline.points.iter().map(|q| {
                    let q = start.scale * *q;
                    let (from, to) = (floor.highest(q), ceiling.lowest(q));
                    at(q, from + share * (to - from))
                }));
            }
        }
        Form::Taper { length, end_scale } => {
            for share in shares(count(*length)) {
                let scale = start.scale + share * (end_scale - start.scale);
                points.extend(outline.points.iter().map(|q| at(scale * *q, share * length)));
            }
        }
        Form::Bend { angle, radius, toward } => {
            let about = bend_frame(&start.frame, *radius, *toward);
            for share in shares(count(radius * angle)) {
                let outward = direction(&about, unit(share * angle));
                points.extend(outline.points.iter().map(|q| {
                    let q = start.scale * *q;
                    about.origin
                        + (radius - q.dot(*toward)) * outward
                        + toward.perp_dot(q) * about.z
                }));
            }
        }
        Form::Corner { .. } => {}
    }
    points
}

/// Whether a point lies within a piece, not just on its surface.
fn holds(outline: &Outline, piece: &Piece, p: DVec3) -> bool {
    let start = &piece.start;
    let margin = outline.margin;
    let between = |x: f64, from: f64, to: f64| x > from + margin && x < to - margin;
    let local = start.frame.point_to_local(p);
    let q = local.truncate();
    match &piece.form {
        Form::Prism { floor, ceiling } => {
            between(local.z, floor.highest(q), ceiling.lowest(q)) && outline.holds(q, start.scale)
        }
        Form::Taper { length, end_scale } => {
            let scale = start.scale + local.z / length * (end_scale - start.scale);
            between(local.z, 0.0, *length) && outline.holds(q, scale)
        }
        Form::Bend { angle, radius, toward } => {
            let around = bend_frame(&start.frame, *radius, *toward).point_to_local(p);
            let azimuth = around.y.atan2(around.x).rem_euclid(TAU);
            let from_axis = around.truncate().length();
            // The section's axes at that azimuth: inward, and along the bend axis.
            let q = (radius - from_axis) * *toward + around.z * toward.perp();
            between(azimuth * from_axis, 0.0, angle * from_axis) && outline.holds(q, start.scale)
        }
        Form::Corner { .. } => false,
    }
}
