//! The wall of a compound parabolic concentrator of revolution.

use crate::scene::Ray;
use crate::scene::shape::support::{across, box_by_reach};
use crate::scene::shape::{ChartRect, Crossing, RayStart, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, bracketed_root, convex_roots};
use std::f64::consts::{PI, TAU};

/// A compound parabolic concentrator (Welford & Winston, High Collection Nonimaging Optics, 1989, ch. 4) or a
/// truncated one: a parabola whose axis is tilted by the acceptance half-angle θ and whose focus is the opposite rim
/// of the small end, turned about z. The small end lies at z = 0; it opens toward +z. The front is outside.
///
/// The chart: u = (largest radius) φ from the frame's x axis; v = z.
#[derive(Debug, Clone)]
pub struct CompoundParabola {
    frame: Frame,
    small_radius: f64,
    length: f64,
    /// (cos θ, sin θ).
    cos: f64,
    sin: f64,
    /// Focal length of the parabola, a' (1 + sin θ).
    focal_length: f64,
}

/// A line in the frame of a concentrator.
struct LocalLine {
    from: DVec3,
    dir: DVec3,
}

/// A point of the meridian plane in the parabola's coordinates, from the focus: x along the vertex
/// tangent, y along the axis.
struct Meridian {
    /// Distance from the concentrator's axis, mm.
    radius: f64,
    /// Its derivative along the line.
    radius_slope: f64,
    x: f64,
    y: f64,
}

impl CompoundParabola {
    /// The wall with radius `small_radius` at z = 0 of `frame`, accepting rays up to `acceptance_half_angle`, rad, from
    /// the axis, for z in [0, `length`], mm. The length is at most [`CompoundParabola::full_length`].
    pub fn new(frame: Frame, small_radius: f64, acceptance_half_angle: f64, length: f64) -> Self {
        let (sin, cos) = acceptance_half_angle.sin_cos();
        Self { frame, small_radius, length, cos, sin, focal_length: small_radius * (1.0 + sin) }
    }

    /// Length at which the wall becomes parallel to the axis, mm: (a + a') / tan θ with a = a' /
    /// sin θ.
    pub fn full_length(small_radius: f64, acceptance_half_angle: f64) -> f64 {
        small_radius * (1.0 + 1.0 / acceptance_half_angle.sin()) / acceptance_half_angle.tan()
    }

    /// Radius of the wall at height `z` above the small end, mm.
    pub fn radius_at(&self, z: f64) -> f64 {
        self.profile(self.parameter(z)).x
    }

    /// (r, z) of the wall at the parabola's parameter `w`, its slope relative to the vertex
    /// tangent: x = 2fw, y = f (w² - 1).
    fn profile(&self, w: f64) -> DVec2 {
        let (x, y) = (2.0 * self.focal_length * w, self.focal_length * (w * w - 1.0));
        DVec2::new(x * self.cos - y * self.sin - self.small_radius, x * self.sin + y * self.cos)
    }

    /// The parabola's parameter where the wall has the height `z`.
    fn parameter(&self, z: f64) -> f64 {
        // The positive root of z(w), without the difference of two numbers that diverge as 1/cos θ.
        let in_focal_lengths = z / self.focal_length;
        (self.cos + in_focal_lengths) / (self.sin + (1.0 + in_focal_lengths * self.cos).sqrt())
    }

    /// Area of the wall between the vertex and `w`, mm²: ∫ 2π r ds with ds = 2f sqrt(1 + w²) dw.
    fn area_to(&self, w: f64) -> f64 {
        let root = w.hypot(1.0);
        let of_one = 0.5 * (w * root + w.asinh());
        let of_w = root.powi(3) / 3.0;
        let of_w2 = 0.25 * (w * root.powi(3) - of_one);
        // r = (f sin θ - a') + 2 f cos θ w - f sin θ w².
        let f = self.focal_length;
        let constant = f * self.sin - self.small_radius;
        4.0 * PI * f * (constant * of_one + 2.0 * f * self.cos * of_w - f * self.sin * of_w2)
    }

    fn largest_radius(&self) -> f64 {
        self.radius_at(self.length)
    }

    pub(super) fn bounds(&self) -> Aabb {
        let [w_min, w_max] = [0.0, self.length].map(|z| self.parameter(z));
        box_by_reach(&self.frame, |e| {
            let reach = |w: f64| self.profile(w).dot(DVec2::new(across(e), e.z));
            // Stationary where the profile's tangent is perpendicular to e; elsewhere the ends
            // reach further.
            let stationary =
                (self.cos * across(e) + self.sin * e.z) / (self.sin * across(e) - self.cos * e.z);
            let stationary = stationary.max(w_min).min(w_max);
            reach(stationary).max(reach(w_min)).max(reach(w_max))
        })
    }

    pub(super) fn crossings(&self, ray: &Ray, start: RayStart, mut visit: impl FnMut(Crossing)) {
        let dir = self.frame.to_local(ray.dir());
        let from = self.frame.point_to_local(ray.origin());
        match start {
            RayStart::On => {
                if let Some(crossing) = self.other_from_surface(&LocalLine { from, dir }) {
                    visit(crossing);
                }
            }
            RayStart::Elsewhere => {
                // From the point nearest to the middle: from far away, differences lose digits.
                let shift = (0.5 * self.length * DVec3::Z - from).dot(dir);
                let line = LocalLine { from: from + shift * dir, dir };
                let Some([lo, hi]) = self.between_ends(&line) else { return };
                let [enter, leave] = convex_roots(lo, hi, |t| self.implicit(&line, t));
                for (t, toward) in [(enter, Toward::Back), (leave, Toward::Front)] {
                    if let Some(t) = t {
                        visit(Crossing { t: shift + t, toward });
                    }
                }
            }
        }
    }

    /// The interval of a line between the planes of the two ends, bounded by a sphere around the wall.
    fn between_ends(&self, line: &LocalLine) -> Option<[f64; 2]> {
        let half_length = 0.5 * self.length;
        let from_middle = line.from - half_length * DVec3::Z;
        let middle = -from_middle.dot(line.dir);
        // Twice the necessary size: the planes and the surface decide, not the sphere.
        let squared_reach = 4.0 * (half_length.powi(2) + self.largest_radius().powi(2));
        let squared_half_chord = squared_reach - (from_middle + middle * line.dir).length_squared();
        if squared_half_chord < 0.0 {
            return None;
        }
        let half_chord = squared_half_chord.sqrt();
        let [bottom, top] = [0.0, self.length].map(|z| (z - line.from.z) / line.dir.z);
        let lo = bottom.min(top).max(middle - half_chord);
        let hi = bottom.max(top).min(middle + half_chord);
        (lo < hi).then_some([lo, hi])
    }

    fn meridian(&self, line: &LocalLine, t: f64) -> Meridian {
        let p = line.from + t * line.dir;
        let radius = p.truncate().length();
        // On the axis any slope between those of both sides is valid.
        let radius_slope =
            if radius > 0.0 { p.truncate().dot(line.dir.truncate()) / radius } else { 0.0 };
        let from_focus = radius + self.small_radius;
        Meridian {
            radius,
            radius_slope,
            x: from_focus * self.cos + p.z * self.sin,
            y: p.z * self.cos - from_focus * self.sin,
        }
    }

    /// G = x² - 4f (y + f), negative inside, and its derivative along a line.
    ///
    /// That is eq. (r cosθ + z sinθ)² + 2a'(1+sinθ)² r - 2a' cosθ (2+sinθ) z - a'²(1+sinθ)(3+sinθ) of Welford &
    /// Winston. For z >= 0 it is convex along every line, as r is, and x, which is positive: no quartic is needed.
    fn implicit(&self, line: &LocalLine, t: f64) -> (f64, f64) {
        let at = self.meridian(line, t);
        let x_slope = at.radius_slope * self.cos + line.dir.z * self.sin;
        let y_slope = line.dir.z * self.cos - at.radius_slope * self.sin;
        (
            at.x * at.x - 4.0 * self.focal_length * (at.y + self.focal_length),
            2.0 * at.x * x_slope - 4.0 * self.focal_length * y_slope,
        )
    }

    /// The other crossing of a line that starts on the wall.
    ///
    /// (G(t) - G(0)) / t, written without that difference, has no root at the start, and increases,
    /// as G is convex.
    fn other_from_surface(&self, line: &LocalLine) -> Option<Crossing> {
        let start = self.meridian(line, 0.0);
        let across_dir = line.dir.truncate();
        let along = line.from.truncate().dot(across_dir);
        let deflated = |t: f64| {
            let at = self.meridian(line, t);
            // (r(t) - r(0)) / t, and its derivative.
            let radii = at.radius + start.radius;
            let numerator = 2.0 * along + t * across_dir.length_squared();
            let rise = numerator / radii;
            let rise_slope = (across_dir.length_squared() - rise * at.radius_slope) / radii;
            // The same for x, then for y.
            let x_rise = rise * self.cos + line.dir.z * self.sin;
            let y_rise = line.dir.z * self.cos - rise * self.sin;
            let x_sum = 2.0 * start.x + t * x_rise;
            let x_rise_slope = rise_slope * self.cos;
            (
                x_rise * x_sum - 4.0 * self.focal_length * y_rise,
                x_rise_slope * x_sum
                    + x_rise * (x_rise + t * x_rise_slope)
                    + 4.0 * self.focal_length * self.sin * rise_slope,
            )
        };
        let [lo, hi] = self.between_ends(line)?;
        if deflated(0.0).0 < 0.0 {
            (hi > 0.0 && deflated(hi).0 >= 0.0)
                .then(|| Crossing { t: bracketed_root(0.0, hi, deflated), toward: Toward::Front })
        } else {
            (lo < 0.0 && deflated(lo).0 < 0.0)
                .then(|| Crossing { t: bracketed_root(lo, 0.0, deflated), toward: Toward::Back })
        }
    }

    /// Unit vector of the axis.
    pub(super) fn axis(&self) -> DVec3 {
        self.frame.z
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let p = self.frame.point_to_local(p);
        let radius = p.truncate().length();
        let x = (radius + self.small_radius) * self.cos + p.z * self.sin;
        // Gradient of G over (r, z), halved.
        let over_radius = x * self.cos + 2.0 * self.focal_length * self.sin;
        let over_z = x * self.sin - 2.0 * self.focal_length * self.cos;
        let outward = (over_radius / radius * p.truncate()).extend(over_z);
        self.frame.to_world(outward).normalize()
    }

    pub(super) fn area(&self) -> f64 {
        self.area_in(self.chart_bounds())
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let [w_min, w_max] = [0.0, self.length].map(|z| self.parameter(z));
        let [below, all] = [w_min, w_max].map(|w| self.area_to(w));
        let area = below + u[1] * (all - below);
        let w = bracketed_root(w_min, w_max, |w| {
            let circumference = TAU * self.profile(w).x;
            (self.area_to(w) - area, circumference * 2.0 * self.focal_length * w.hypot(1.0))
        });
        let on_profile = self.profile(w);
        let (sin, cos) = (TAU * u[0]).sin_cos();
        let p = DVec3::new(on_profile.x * cos, on_profile.x * sin, on_profile.y);
        self.frame.point_to_world(p)
    }

    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        let p = self.frame.point_to_local(p);
        DVec2::new(self.largest_radius() * p.y.atan2(p.x).rem_euclid(TAU), p.z)
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        ChartRect { min: DVec2::ZERO, max: DVec2::new(TAU * self.largest_radius(), self.length) }
    }

    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        let rect = rect.intersection(&self.chart_bounds());
        if rect.is_empty() {
            return 0.0;
        }
        let part_of_turn = (rect.max.x - rect.min.x) / (TAU * self.largest_radius());
        let [below, above] = [rect.min.y, rect.max.y].map(|z| self.area_to(self.parameter(z)));
        part_of_turn * (above - below)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::shape::testing::{
        Truth, assert_bounds_are_tight, assert_crossings_match_a_scan, assert_hit_from_far_away,
        assert_samples_are_uniform, assert_scales, assert_starting_on_it_drops_only_the_start,
        bounce, crossings_of, tilted,
    };
    use crate::scene::shape::{HalfSpace, Shape};

    fn concentrator(frame: Frame, half_angle: f64, part: f64) -> (CompoundParabola, f64) {
        let length = part * CompoundParabola::full_length(1.0, half_angle);
        (CompoundParabola::new(frame, 1.0, half_angle, length), length)
    }

    /// Welford & Winston's equation as printed, divided by its gradient at the small rim: a length near the surface.
    fn implicit(half_angle: f64, p: DVec3) -> f64 {
        let (s, c) = half_angle.sin_cos();
        let p = tilted(1.0).point_to_local(p);
        let (r, z) = (p.truncate().length(), p.z);
        let value = (r * c + z * s).powi(2) + 2.0 * (1.0 + s).powi(2) * r
            - 2.0 * c * (2.0 + s) * z
            - (1.0 + s) * (3.0 + s);
        value / (2.0 * (1.0 + s).powi(2) + 2.0 * c * c)
    }

    #[test]
    fn wide_narrow_and_truncated_concentrators_keep_the_contract_of_shapes() {
        for (degrees, part) in [(30.0f64, 1.0), (8.0, 0.5), (70.0, 1.0), (20.0, 0.1)] {
            let half_angle = degrees.to_radians();
            let (shape, length) = concentrator(tilted(1.0), half_angle, part);
            let shape = Shape::CompoundParabola(shape);
            let implicit = |p: DVec3| implicit(half_angle, p);
            let inside_trim = |p: DVec3| {
                let z = tilted(1.0).point_to_local(p).z;
                z.min(length - z)
            };
            let truth = Truth { shape: &shape, implicit: &implicit, inside_trim: &inside_trim };
            assert_crossings_match_a_scan(&truth, 400);
            assert_starting_on_it_drops_only_the_start(&shape, 4000);
            assert_hit_from_far_away(&truth, 1.0 + length);
            assert_samples_are_uniform(&truth, 1e-13 * (1.0 + length));
            assert_bounds_are_tight(&shape, 1e-4);
        }
    }

    #[test]
    fn the_full_concentrator_has_the_textbook_radii_and_ends_parallel_to_its_axis() {
        let half_angle = 0.4f64;
        let (shape, length) = concentrator(tilted(1.0), half_angle, 1.0);
        let large = 1.0 / half_angle.sin();
        assert!((length - (large + 1.0) / half_angle.tan()).abs() < 1e-14);
        assert!((shape.radius_at(0.0) - 1.0).abs() < 1e-15);
        assert!((shape.radius_at(length) - large).abs() < 1e-14);
        let rim = tilted(1.0).point_to_world(DVec3::new(large, 0.0, length));
        assert!((shape.normal(rim) - tilted(1.0).x).length() < 1e-14);
    }

    #[test]
    fn meridional_rays_at_the_acceptance_angle_go_to_the_opposite_rim() {
        let half_angle = 0.4f64;
        let (shape, length) = concentrator(tilted(1.0), half_angle, 1.0);
        let (frame, shape) = (tilted(1.0), Shape::CompoundParabola(shape));
        let dir = frame.to_world(DVec3::new(half_angle.sin(), 0.0, -half_angle.cos()));
        let rim = frame.point_to_world(DVec3::NEG_X);
        let large = 1.0 / half_angle.sin();
        for i in 1..50 {
            let x = -large + 2.0 * large * f64::from(i) / 50.0;
            let ray = Ray::new(frame.point_to_world(DVec3::new(x, 0.0, length)), dir);
            let hit = *crossings_of(&shape, &ray, RayStart::Elsewhere).last().unwrap();
            assert_eq!(hit.toward, Toward::Front);
            let p = ray.at(hit.t);
            let normal = shape.normal(p);
            let reflected = ray.dir() - 2.0 * ray.dir().dot(normal) * normal;
            assert!((reflected - (rim - p).normalize()).length() < 1e-13, "{x}");
        }
    }

    #[test]
    fn the_area_is_the_sum_of_its_rings() {
        let (shape, length) = concentrator(tilted(1.0), 0.3, 0.8);
        let n = 20_000;
        let point = |i: i32| {
            let z = length * f64::from(i) / f64::from(n);
            DVec2::new(shape.radius_at(z), z)
        };
        let ring = |i: i32| PI * (point(i).x + point(i + 1).x) * (point(i + 1) - point(i)).length();
        let rings: f64 = (0..n).map(ring).sum();
        assert!((shape.area() / rings - 1.0).abs() < 1e-8, "{} {rings}", shape.area());
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        assert_scales(|scale| {
            let length = 0.7 * CompoundParabola::full_length(scale, 0.3);
            Shape::CompoundParabola(CompoundParabola::new(tilted(scale), scale, 0.3, length))
        });
    }

    #[test]
    fn a_thousand_mirror_bounces_inside_stay_on_the_wall_and_keep_their_skew() {
        let frame = tilted(1.0);
        for half_angle in [0.2, 0.5] {
            let (shape, length) = concentrator(frame, half_angle, 1.0);
            let shape = Shape::CompoundParabola(shape);
            let lids = [
                HalfSpace::behind(frame.origin, -frame.z),
                HalfSpace::behind(frame.point_to_world(length * DVec3::Z), frame.z),
            ];
            for path in 0..20 {
                let mut first = None;
                bounce(&shape, Toward::Front, &lids, path, |ray| {
                    let off = implicit(half_angle, ray.origin()).abs();
                    assert!(off < 1e-12 * length, "{off}");
                    let skew = (ray.origin() - frame.origin).cross(ray.dir()).dot(frame.z);
                    assert!((skew - *first.get_or_insert(skew)).abs() < 1e-12);
                });
            }
        }
    }
}
