//! Whether the pieces of a path fit: enough room between corners, no closed ring, no leg through
//! another one.

use crate::scene::shape::Polygon;
use crate::scene::sweep::path::{
    PathPiece, PieceForm, PrismEnd, SweptPath, bend_frame, direction, unit,
};
use crate::scene::sweep::{Profile, SweepError, SweepProblem};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, planar};
use std::f64::consts::TAU;

/// Touching is not overlap: points count as inside from this share of the profile's size on.
const MARGIN: f64 = 1e-9;
/// The most sections of a piece, and the most points of a section, at which an overlap is looked for.
const MAX_SECTIONS: usize = 400;
const MAX_SECTION_POINTS: usize = 64;

/// The first reason why the pieces of `path` are not a valid sweep of `profile`.
pub(super) fn check(profile: &Profile, path: &SweptPath) -> Result<(), SweepError> {
    let size = profile.size();
    for piece in &path.pieces {
        if let PieceForm::Prism { floor, ceiling } = &piece.form {
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

/// Depth by which the planes of the ceiling dip below those of the floor, mm; negative where there
/// is room to spare.
fn missing_length(profile: &Profile, scale: f64, floor: &PrismEnd, ceiling: &PrismEnd) -> f64 {
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
struct PieceBody<'a> {
    piece: &'a PathPiece,
    samples: Vec<DVec3>,
    bounds: Aabb,
}

/// Searches for points on the walls of a piece that lie within another piece. Legs that really
/// cross share much more than the distance between these points.
fn find_overlap(profile: &Profile, path: &SweptPath) -> Result<(), SweepError> {
    let outline = ProfileOutline::new(profile, path.exit.along);
    let bodies: Vec<PieceBody> = path
        .pieces
        .iter()
        .filter(|piece| !matches!(piece.form, PieceForm::Corner { .. }))
        .map(|piece| {
            let samples = samples(&outline, piece);
            let bounds = Aabb::of(samples.iter().copied()).grown(outline.size * piece.start.scale);
            PieceBody { piece, samples, bounds }
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

fn common_point(outline: &ProfileOutline, one: &PieceBody, other: &PieceBody) -> Option<DVec3> {
    let near = |p: &&DVec3| other.bounds.contains(**p);
    one.samples.iter().filter(near).find(|p| holds(outline, other.piece, **p)).copied()
}

/// The profile at the entry, prepared for queries.
struct ProfileOutline<'a> {
    profile: &'a Profile,
    polygon: Option<Polygon>,
    size: f64,
    margin: f64,
    /// Points on its outline and its centroid.
    points: Vec<DVec2>,
}

impl<'a> ProfileOutline<'a> {
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
fn samples(outline: &ProfileOutline, piece: &PathPiece) -> Vec<DVec3> {
    let start = &piece.start;
    let size = outline.size * start.scale;
    let count = |length: f64| (4.0 * length / size).ceil().clamp(8.0, MAX_SECTIONS as f64) as usize;
    let shares = |n: usize| (0..=n).map(move |i| i as f64 / n as f64);
    let at = |q: DVec2, z: f64| start.frame.origin + direction(&start.frame, q) + z * start.frame.z;
    let mut points = Vec::new();
    match &piece.form {
        PieceForm::Prism { floor, ceiling } => {
            for share in shares(count(ceiling.height - floor.height)) {
                points.extend(outline.points.iter().map(|q| {
                    let q = start.scale * *q;
                    let (from, to) = (floor.highest(q), ceiling.lowest(q));
                    at(q, from + share * (to - from))
                }));
            }
        }
        PieceForm::Taper { length, end_scale } => {
            for share in shares(count(*length)) {
                let scale = start.scale + share * (end_scale - start.scale);
                points.extend(outline.points.iter().map(|q| at(scale * *q, share * length)));
            }
        }
        PieceForm::Bend { angle, radius, toward } => {
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
        PieceForm::Corner { .. } => {}
    }
    points
}

/// Whether a point lies within a piece, not just on its surface.
fn holds(outline: &ProfileOutline, piece: &PathPiece, p: DVec3) -> bool {
    let start = &piece.start;
    let margin = outline.margin;
    let between = |x: f64, from: f64, to: f64| x > from + margin && x < to - margin;
    let local = start.frame.point_to_local(p);
    let q = local.truncate();
    match &piece.form {
        PieceForm::Prism { floor, ceiling } => {
            between(local.z, floor.highest(q), ceiling.lowest(q)) && outline.holds(q, start.scale)
        }
        PieceForm::Taper { length, end_scale } => {
            let scale = start.scale + local.z / length * (end_scale - start.scale);
            between(local.z, 0.0, *length) && outline.holds(q, scale)
        }
        PieceForm::Bend { angle, radius, toward } => {
            let around = bend_frame(&start.frame, *radius, *toward).point_to_local(p);
            let azimuth = around.y.atan2(around.x).rem_euclid(TAU);
            let from_axis = around.truncate().length();
            // The section's axes at that azimuth: inward, and along the bend axis.
            let q = (radius - from_axis) * *toward + around.z * toward.perp();
            between(azimuth * from_axis, 0.0, angle * from_axis) && outline.holds(q, start.scale)
        }
        PieceForm::Corner { .. } => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::sweep::{CornerKind, Leg, sweep};
    use lumiduct_base::math::Frame;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn straight(length: f64) -> Leg {
        Leg::Straight { length, end_scale: 1.0 }
    }

    fn taper(length: f64, end_scale: f64) -> Leg {
        Leg::Straight { length, end_scale }
    }

    fn bend(angle: f64, radius: f64) -> Leg {
        Leg::Bend { angle, radius, toward: 0.0 }
    }

    fn corner(angle: f64, toward: f64, kind: CornerKind) -> Leg {
        Leg::Corner { angle, toward, kind }
    }

    fn plain(angle: f64) -> Leg {
        corner(angle, 0.0, CornerKind::Plain)
    }

    fn frame() -> Frame {
        Frame::from_axis(DVec3::new(3.0, -2.0, 5.0), DVec3::new(0.3, 0.4, 0.7))
    }

    fn problem(profile: &Profile, legs: &[Leg]) -> (Option<usize>, SweepProblem) {
        let error = sweep(frame(), profile, legs).unwrap_err();
        (error.leg, error.problem)
    }

    #[test]
    fn paths_that_make_no_sweep_are_refused_at_their_leg() {
        let circle = Profile::circle(1.5).unwrap();
        let square = Profile::rectangle(2.0, 2.0).unwrap();
        assert_eq!(problem(&circle, &[]), (None, SweepProblem::NoLegs));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            for leg in [straight(bad), taper(1.0, bad), bend(1.0, bad)] {
                let (at, problem) = problem(&circle, &[straight(1.0), leg]);
                assert!(at == Some(1) && matches!(problem, SweepProblem::OutOfRange { .. }));
            }
            for leg in [bend(bad, 9.0), plain(bad)] {
                let (at, problem) = problem(&circle, &[leg]);
                assert!(at == Some(0) && matches!(problem, SweepProblem::Angle { .. }));
            }
        }
        assert!(matches!(problem(&circle, &[plain(PI)]).1, SweepProblem::Angle { .. }));
        assert!(matches!(
            problem(&circle, &[corner(1.0, f64::NAN, CornerKind::Plain)]).1,
            SweepProblem::Angle { .. }
        ));
        let shrinking = [taper(1.0, 1e-4), taper(1.0, 1e-4)];
        assert!(matches!(problem(&circle, &shrinking), (Some(1), SweepProblem::Scaled { .. })));
        let tight = [straight(1.0), bend(1.0, 1.5)];
        let expected = SweepProblem::TightBend { radius: 1.5, reach: 1.5 };
        assert_eq!(problem(&circle, &tight), (Some(1), expected));
        // The plate of a mitre by 45° reaches cot(22.5°) = 2.41 back into the leg, 2 mm more than the corner is long.
        let short = [straight(1.9), corner(0.25 * PI, 0.0, CornerKind::Mitred), straight(5.0)];
        let (at, SweepProblem::TooShort { missing }) = problem(&square, &short) else { panic!() };
        assert!(at == Some(0) && (missing - 0.1).abs() < 1e-12, "{missing}");
        assert!(
            sweep(
                frame(),
                &square,
                &[straight(2.1), corner(0.25 * PI, 0.0, CornerKind::Mitred), straight(5.0)]
            )
            .is_ok()
        );
    }

    #[test]
    fn paths_that_run_through_themselves_are_refused() {
        let circle = Profile::circle(1.0).unwrap();
        let square = Profile::rectangle(2.0, 2.0).unwrap();
        let ell = [(-1.0, -1.0), (2.0, -1.0), (2.0, 0.2), (0.4, 0.2), (0.4, 1.5), (-1.0, 1.5)];
        let ell = Profile::polygon(ell.map(DVec2::from).to_vec()).unwrap();
        for profile in [&circle, &square, &ell] {
            assert_eq!(problem(profile, &[bend(TAU, 5.0)]).1, SweepProblem::ClosedRing);
            let loops = [straight(20.0), bend(1.5 * PI, 5.0), straight(20.0)];
            let (at, found) = problem(profile, &loops);
            assert!(
                at == Some(2) && matches!(found, SweepProblem::Overlap { other: 1, .. }),
                "{found}"
            );
            let spiral = [bend(1.9 * PI, 5.0), straight(5.0)];
            assert!(matches!(problem(profile, &spiral).1, SweepProblem::Overlap { other: 1, .. }));
            let knot = [
                straight(6.0),
                plain(FRAC_PI_2),
                straight(3.0),
                plain(FRAC_PI_2),
                straight(3.0),
                plain(FRAC_PI_2),
                straight(9.0),
            ];
            assert!(matches!(problem(profile, &knot).1, SweepProblem::Overlap { .. }));
        }
        // Side by side, wall on wall, is no overlap.
        let hairpin = [straight(9.0), plain(FRAC_PI_2), plain(FRAC_PI_2), straight(9.0)];
        assert!(sweep(frame(), &square, &hairpin).is_ok());
    }
}
