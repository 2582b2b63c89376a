//! The wall of a bent round tube: an arc of a torus.

use crate::scene::Ray;
use crate::scene::shape::support::{across, box_by_reach};
use crate::scene::shape::wedge::{Wedge, turn};
use crate::scene::shape::{ChartRect, Crossing, RayStart, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, Roots, bracketed_root, cubic, quartic};
use std::f64::consts::TAU;

/// An arc of a torus about the z axis of its frame; the front is the outside of the tube.
///
/// The arc starts at the frame's x axis and goes counter-clockwise. The chart: v = R θ along the
/// arc; u = r φ around the tube's section, in [0, 2πr), where φ counts counter-clockwise about the
/// direction of the arc, so that it continues the chart of a cylinder with its z axis in the same
/// direction. φ = 0 is the outermost point, away from the bend axis (R + r), unless set by
/// `Torus::with_section_zero`.
#[derive(Debug, Clone)]
pub struct Torus {
    frame: Frame,
    major_radius: f64,
    minor_radius: f64,
    /// The arc; `None` for the whole torus.
    arc: Option<Wedge>,
    section_zero: f64,
}

impl Torus {
    /// The wall of a tube of radius `minor_radius` whose centre line is the arc of radius
    /// `major_radius`, mm, about the z axis of `frame`, from its x axis by `angle`, rad, up to 2π.
    /// The minor radius must be smaller than the major one.
    pub(crate) fn new(frame: Frame, major_radius: f64, minor_radius: f64, angle: f64) -> Self {
        let arc = Wedge::new(angle);
        Self { frame, major_radius, minor_radius, arc, section_zero: 0.0 }
    }

    /// The same wall with the zero of the chart's u moved to the section angle `section_zero`, rad, counted like φ.
    ///
    /// To continue the chart of a straight leg whose cylinder frame has the axes x and z = direction of the arc:
    /// `section_zero = (-x·axis).atan2(x·outward)`, where `axis` is the torus frame's z and `outward` points from it to
    /// the centre of the joint.
    pub(crate) fn with_section_zero(self, section_zero: f64) -> Self {
        Self { section_zero, ..self }
    }

    pub(super) fn bounds(&self) -> Aabb {
        box_by_reach(&self.frame, |e| {
            // R m + r sqrt(m² + e_z²) with m = (direction to the section) · e grows with m, as r < R.
            let m = self.arc.map_or_else(|| across(e), |arc| arc.range(e.truncate())[1]);
            self.major_radius * m + self.minor_radius * m.hypot(e.z)
        })
    }

    pub(super) fn crossings(&self, ray: &Ray, start: RayStart, mut visit: impl FnMut(Crossing)) {
        // In units of the major radius.
        let unit = self.major_radius;
        let from = self.frame.point_to_local(ray.origin()) / unit;
        let dir = self.frame.to_local(ray.dir());
        let tube = self.minor_radius / unit;
        let roots = match start {
            RayStart::On => with_start(others_from_surface(from, dir, tube)),
            RayStart::Elsewhere => all_roots(from, dir, tube),
        };
        // A line is outside at both ends, so it enters and leaves alternately, even where it
        // grazes.
        for (i, &t) in roots.iter().enumerate() {
            let is_start = start == RayStart::On && t == 0.0;
            if !is_start && self.arc_contains((from + t * dir).truncate()) {
                let toward = if i % 2 == 0 { Toward::Back } else { Toward::Front };
                visit(Crossing { t: t * unit, toward });
            }
        }
    }

    /// Whether the half plane through the axis and a point, in the frame, cuts the arc.
    #[inline]
    fn arc_contains(&self, p: DVec2) -> bool {
        self.arc.is_none_or(|arc| arc.contains(p))
    }

    /// Length of the arc, rad.
    fn angle(&self) -> f64 {
        turn(self.arc.as_ref())
    }

    /// Unit tangent along the arc.
    pub(super) fn along(&self, p: DVec3) -> DVec3 {
        self.frame.z.cross(p - self.frame.origin).normalize()
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        // The same operations as in the crossings: for a thin tube ρ - 1 has lost digits, but the
        // same ones, so a ray that grazes the wall inward is inside there too.
        let from = self.frame.point_to_local(p) / self.major_radius;
        let distance = from.truncate().length();
        let outward = ((distance - 1.0) / distance * from.truncate()).extend(from.z);
        self.frame.to_world(outward).normalize()
    }

    pub(super) fn area(&self) -> f64 {
        self.area_in(self.chart_bounds())
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        // Area up to the section angle φ from the outermost point: R φ + r sin φ out of 2πR.
        let ratio = self.minor_radius / self.major_radius;
        let phi = bracketed_root(0.0, TAU, |phi| {
            let (sin, cos) = phi.sin_cos();
            (phi + ratio * sin - TAU * u[0], 1.0 + ratio * cos)
        });
        let (sin, cos) = phi.sin_cos();
        let outward = DVec2::from_angle(u[1] * self.angle());
        let center_distance = self.major_radius + self.minor_radius * cos;
        self.frame.point_to_world((center_distance * outward).extend(-self.minor_radius * sin))
    }

    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        let p = self.frame.point_to_local(p);
        // Counter-clockwise about the direction of the arc: from outward toward -z.
        let phi = (-p.z).atan2(p.truncate().length() - self.major_radius) - self.section_zero;
        let theta = p.y.atan2(p.x).rem_euclid(TAU);
        // The start of an arc may be rounded to just below a full turn.
        let theta = if theta > 0.5 * (self.angle() + TAU) { theta - TAU } else { theta };
        DVec2::new(self.minor_radius * phi.rem_euclid(TAU), self.major_radius * theta)
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        ChartRect {
            min: DVec2::ZERO,
            max: DVec2::new(TAU * self.minor_radius, self.angle() * self.major_radius),
        }
    }

    /// ∫∫ (R + r cos φ) r dφ dθ.
    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        let bounds = self.chart_bounds();
        let (min, max) = (rect.min.max(bounds.min), rect.max.min(bounds.max));
        if min.x >= max.x || min.y >= max.y {
            return 0.0;
        }
        let [from, to] = [min.x, max.x].map(|u| u / self.minor_radius + self.section_zero);
        let theta = (max.y - min.y) / self.major_radius;
        let around = self.major_radius * (to - from) + self.minor_radius * (to.sin() - from.sin());
        theta * self.minor_radius * around
    }
}

/// Parameters of all crossings of a line with the torus of major radius 1 and minor radius `tube`.
///
/// With A = |p|² + 1 - r² the torus is A² = 4 (x² + y²). From the line's point q nearest to the centre, q·d = 0, the
/// quartic has no cubic term: A(t) = A + d² t². (d² differs from 1 by the rounding of the frame.)
fn all_roots(from: DVec3, dir: DVec3, tube: f64) -> Roots {
    let dir2 = dir.length_squared();
    let coarse = -from.dot(dir) / dir2;
    let near = from + coarse * dir;
    // Once more: seen from far away, q·d is not yet zero to rounding.
    let fine = -near.dot(dir) / dir2;
    let (shift, nearest) = (coarse + fine, near + fine * dir);
    let reach = (1.0 + tube) * (1.0 + tube) - nearest.length_squared();
    if reach < 0.0 {
        return Roots::new();
    }
    let across_axis = nearest.truncate();
    let distance = across_axis.length();
    let along = across_axis.dot(dir.truncate());
    let coefficients = [
        // A² - 4ρ² as a product: A - 2ρ is the squared distance to the centre line less r².
        ((distance - 1.0).powi(2) + nearest.z * nearest.z - tube * tube)
            * ((distance + 1.0).powi(2) + nearest.z * nearest.z - tube * tube),
        -8.0 * along,
        2.0 * ((nearest.length_squared() - 1.0 - tube * tube) * dir2 + 2.0 * dir.z * dir.z),
        0.0,
        dir2 * dir2,
    ];
    let half_chord = bracket(reach);
    let roots = quartic(coefficients, -half_chord, half_chord);
    // (ρ - 1)² + z² - r² and half its derivative.
    let polished = polish(roots, |t| {
        let p = nearest + t * dir;
        let distance = p.truncate().length();
        let distance_slope = p.truncate().dot(dir.truncate()) / distance;
        (
            0.5 * ((distance - 1.0).powi(2) + p.z * p.z - tube * tube),
            (distance - 1.0) * distance_slope + p.z * dir.z,
        )
    });
    polished.into_iter().map(|t| shift + t).collect()
}

/// Parameters of the crossings of a line that starts on the torus, except the start.
///
/// On the surface A = 2ρ exactly, and the quartic's constant term is zero; what remains is a cubic, here written so
/// that its terms are small where the tube is thin.
fn others_from_surface(from: DVec3, dir: DVec3, tube: f64) -> Roots {
    let dir2 = dir.length_squared();
    let (across_axis, across_dir) = (from.truncate(), dir.truncate());
    let distance = across_axis.length();
    let along = from.dot(dir);
    let (across_along, across_dir2) = (across_axis.dot(across_dir), across_dir.length_squared());
    let coefficients = [
        8.0 * (distance * from.z * dir.z + across_along * (distance - 1.0)),
        4.0 * (along * along + (distance - 1.0) * dir2 + dir.z * dir.z),
        4.0 * along * dir2,
        dir2 * dir2,
    ];
    let reach = along * along + (1.0 + tube) * (1.0 + tube) - from.length_squared();
    let half_chord = bracket(reach.max(0.0));
    let roots = cubic(coefficients, -along - half_chord, -along + half_chord);
    // For F = (ρ - 1)² + z², the change (F(t) - F(0)) / t, written without that difference, and its
    // derivative.
    polish(roots, |t| {
        let now = (across_axis + t * across_dir).length();
        let now_slope = (across_along + t * across_dir2) / now;
        let rise = (2.0 * across_along + t * across_dir2) / (now + distance);
        let rise_slope = (across_dir2 - rise * now_slope) / (now + distance);
        let sum = (now - 1.0) + (distance - 1.0);
        (
            rise * sum + dir.z * (2.0 * from.z + t * dir.z),
            rise_slope * sum + rise * now_slope + dir.z * dir.z,
        )
    })
}

/// Roots of the squared equation, improved by a step of Newton's method on an unsquared one, which loses fewer digits
/// near the axis and for thin tubes.
fn polish(mut roots: Roots, unsquared: impl Fn(f64) -> (f64, f64)) -> Roots {
    // Steps are about 1e-15. They are larger than this only for grazing rays, where two roots
    // nearly meet and the step may miss; there the distance from the surface is already small.
    const LARGEST_STEP: f64 = 1e-11;
    for t in &mut roots {
        let (value, slope) = unsquared(*t);
        let step = value / slope;
        if step.abs() < LARGEST_STEP {
            *t -= step;
        }
    }
    roots
}

/// Half an interval that certainly contains all crossings, from the squared half chord of the
/// enclosing sphere.
fn bracket(squared_half_chord: f64) -> f64 {
    // Any margin above rounding works: there are no roots beyond the sphere.
    squared_half_chord.sqrt() + 0.01
}

/// Adds the root at the start, in order.
fn with_start(mut roots: Roots) -> Roots {
    let at = roots.partition_point(|t| *t < 0.0);
    roots.insert(at, 0.0);
    roots
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::testing::{
        Truth, assert_bounds_are_tight, assert_crossings_match_a_scan,
        assert_grazing_rays_come_back, assert_hit_from_far_away, assert_samples_are_uniform,
        assert_scales, assert_starting_on_it_drops_only_the_start, bounce, crossings_of, tilted,
    };
    use crate::scene::shape::{Cylinder, Shape};
    use std::f64::consts::PI;

    /// Signed distance to the wall of the whole torus.
    fn distance(frame: &Frame, major: f64, minor: f64, p: DVec3) -> f64 {
        let p = frame.point_to_local(p);
        (p.truncate().length() - major).hypot(p.z) - minor
    }

    /// Depth of a point inside the arc, as a length.
    fn inside_arc(frame: &Frame, angle: f64, p: DVec3) -> f64 {
        let p = frame.point_to_local(p);
        let theta = p.y.atan2(p.x).rem_euclid(TAU);
        p.length() * theta.min(angle - theta).max(-(TAU - theta))
    }

    #[test]
    fn arcs_of_thin_and_fat_tubes_keep_the_contract_of_shapes() {
        for (major, minor, angle) in
            [(8.0, 1.5, 0.25 * TAU), (8.0, 0.1, 4.0), (3.0, 2.9, 2.0), (3.0, 1.0, TAU)]
        {
            let frame = tilted(1.0);
            let shape = Shape::Torus(Torus::new(frame, major, minor, angle).with_section_zero(0.4));
            let implicit = |p: DVec3| distance(&frame, major, minor, p);
            let inside_trim =
                |p: DVec3| if angle < TAU { inside_arc(&frame, angle, p) } else { 1.0 };
            let truth = Truth { shape: &shape, implicit: &implicit, inside_trim: &inside_trim };
            assert_crossings_match_a_scan(&truth, 400);
            assert_starting_on_it_drops_only_the_start(&shape, 4000);
            assert_hit_from_far_away(&truth, 1.0);
            assert_samples_are_uniform(&truth, 1e-14 * (major + 6.0));
            assert_bounds_are_tight(&shape, 1e-4);
        }
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        assert_scales(|scale| {
            Shape::Torus(Torus::new(tilted(scale), 8.0 * scale, 1.5 * scale, 2.0))
        });
    }

    #[test]
    fn a_thousand_mirror_bounces_inside_stay_on_the_wall_and_keep_their_skew() {
        for (major, minor) in [(8.0, 1.5), (8.0, 0.2), (3.0, 2.7)] {
            let frame = tilted(1.0);
            let shape = Shape::Torus(Torus::new(frame, major, minor, TAU));
            for path in 0..20 {
                let mut skew = None;
                let (mut off, mut drift) = (0.0f64, 0.0f64);
                bounce(&shape, Toward::Front, &[], path, |ray| {
                    off = off.max(distance(&frame, major, minor, ray.origin()).abs());
                    let now = (ray.origin() - frame.origin).cross(ray.dir()).dot(frame.z);
                    drift = drift.max((now - *skew.get_or_insert(now)).abs());
                });
                assert!(off < 2e-13 && drift < 1e-12 * major, "off {off}, skew {drift}");
            }
        }
    }

    #[test]
    fn a_ray_that_grazes_the_wall_inward_always_comes_back_to_it() {
        for (major, minor) in [(8.0, 1.5), (8.0, 0.2), (3.0, 2.7)] {
            let shape = Shape::Torus(Torus::new(tilted(1.0), major, minor, TAU));
            assert_grazing_rays_come_back(&shape);
        }
    }

    #[test]
    fn the_chart_continues_that_of_a_straight_leg() {
        // A leg along +y whose profile x axis is 0.7 rad from outward, then an arc about z from x.
        let profile_x = DVec3::new((0.7f64).cos(), 0.0, -(0.7f64).sin());
        let end = DVec3::new(8.0, 0.0, 0.0);
        let leg_frame = Frame::from_axis_and_x(end - 10.0 * DVec3::Y, DVec3::Y, profile_x).unwrap();
        let leg = Shape::Cylinder(Cylinder::new(leg_frame, 1.5, 10.0));
        let zero = (-profile_x.z).atan2(profile_x.x);
        let bend = Shape::Torus(Torus::new(Frame::WORLD, 8.0, 1.5, 1.0).with_section_zero(zero));
        for i in 0..50 {
            let p = bend.sample([(f64::from(i) + 0.5) / 50.0, 0.0]);
            let (on_leg, on_bend) = (leg.chart(p), bend.chart(p));
            assert!((on_leg.x - on_bend.x).abs() < 1e-13, "{on_leg} {on_bend}");
            assert!((on_leg.y - 10.0).abs() < 1e-13 && on_bend.y.abs() < 1e-13);
        }
    }

    #[test]
    fn the_area_is_pappus() {
        let torus = Torus::new(Frame::WORLD, 8.0, 1.5, 0.25 * TAU);
        assert!((torus.area() - 0.25 * TAU * 8.0 * TAU * 1.5).abs() < 1e-12);
        // The outer half of the section is larger by 4 r² per radian.
        let outer =
            |u: f64| ChartRect { min: DVec2::new(u, 0.0), max: DVec2::new(u + 0.75 * PI, 100.0) };
        let outer_half = torus.area_in(outer(0.0)) + torus.area_in(outer(2.25 * PI));
        assert!((outer_half - 0.5 * PI * (8.0 * PI * 1.5 + 2.0 * 2.25)).abs() < 1e-12);
    }

    #[test]
    fn a_ray_along_the_axis_misses_and_one_through_the_equator_crosses_four_times() {
        let shape = Shape::Torus(Torus::new(Frame::WORLD, 8.0, 1.5, TAU));
        let along_axis = Ray::new(DVec3::ZERO, DVec3::Z);
        assert!(crossings_of(&shape, &along_axis, RayStart::Elsewhere).is_empty());
        let equator = Ray::new(DVec3::ZERO, DVec3::X);
        let found: Vec<f64> =
            crossings_of(&shape, &equator, RayStart::Elsewhere).iter().map(|c| c.t).collect();
        for (t, expected) in found.iter().zip([-9.5, -6.5, 6.5, 9.5]) {
            assert!((t - expected).abs() < 1e-14);
        }
        assert_eq!(found.len(), 4);
        let from_outermost = Ray::new(9.5 * DVec3::X, -DVec3::X);
        assert_eq!(crossings_of(&shape, &from_outermost, RayStart::On).len(), 3);
    }
}
