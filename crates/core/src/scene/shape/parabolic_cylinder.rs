//! A parabolic trough: half a two-dimensional concentrator, or a line reflector.

use crate::scene::Ray;
use crate::scene::shape::support::box_by_reach;
use crate::scene::shape::{ChartRect, Crossing, RayStart, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, bracketed_root, quadratic};

/// A piece of the parabolic cylinder z = x² / 4f, straight along y; the front is the concave side, that of the focal
/// line.
///
/// The chart unrolls it without distortion: u = length of the parabola from the vertex, with the sign of x; v = y.
#[derive(Debug, Clone)]
pub struct ParabolicCylinder {
    frame: Frame,
    focal_length: f64,
    x_min: f64,
    x_max: f64,
    half_length: f64,
}

impl ParabolicCylinder {
    /// The trough with its vertex line on the y axis of `frame` and its focal line `focal_length` above, for x in
    /// [`x_min`, `x_max`] and y in ±`length`/2, mm.
    pub fn new(frame: Frame, focal_length: f64, x_min: f64, x_max: f64, length: f64) -> Self {
        Self { frame, focal_length, x_min, x_max, half_length: 0.5 * length }
    }

    fn height(&self, x: f64) -> f64 {
        x * x / (4.0 * self.focal_length)
    }

    /// Length of the parabola from the vertex to `x`, with the sign of `x`, mm.
    fn arc_length(&self, x: f64) -> f64 {
        let w = x / (2.0 * self.focal_length);
        self.focal_length * (w * w.hypot(1.0) + w.asinh())
    }

    pub(super) fn bounds(&self) -> Aabb {
        box_by_reach(&self.frame, |e| {
            let reach = |x: f64| x * e.x + self.height(x) * e.z;
            // Stationary at x = -2f e_x / e_z; where that is a minimum or undefined, the ends reach further.
            let stationary = (-2.0 * self.focal_length * e.x / e.z).max(self.x_min).min(self.x_max);
            let in_section = reach(stationary).max(reach(self.x_min)).max(reach(self.x_max));
            in_section + self.half_length * e.y.abs()
        })
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, start: RayStart, mut visit: impl FnMut(Crossing)) {
        let from = self.frame.point_to_local(ray.origin());
        let dir = self.frame.to_local(ray.dir());
        let a = dir.x * dir.x;
        let half_b = |p: DVec3| p.x * dir.x - 2.0 * self.focal_length * dir.z;
        if dir.x == 0.0 && dir.z == 0.0 {
            return;
        }
        let mut offer = |t: f64, toward: Toward| {
            let p = from + t * dir;
            if p.x >= self.x_min && p.x <= self.x_max && p.y.abs() <= self.half_length {
                visit(Crossing { t, toward });
            }
        };
        match start {
            // On the surface c = 0. A ray in a plane x = constant has its other root at infinity.
            RayStart::On => {
                let t = -2.0 * half_b(from) / a;
                // The further root leaves the concave side, which is the front.
                offer(t, if t > 0.0 { Toward::Back } else { Toward::Front });
            }
            RayStart::Elsewhere => {
                // From the point nearest to the vertex line: from far away, x² - 4fz loses digits.
                let across = DVec2::new(dir.x, dir.z);
                let shift = -DVec2::new(from.x, from.z).dot(across) / across.length_squared();
                let near = from + shift * dir;
                let c = near.x * near.x - 4.0 * self.focal_length * near.z;
                if let Some([enter, leave]) = quadratic(a, half_b(near), c) {
                    offer(shift + enter, Toward::Front);
                    offer(shift + leave, Toward::Back);
                }
            }
        }
    }

    /// Unit vector along the trough.
    pub(super) fn along(&self) -> DVec3 {
        self.frame.y
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let x = (p - self.frame.origin).dot(self.frame.x);
        (2.0 * self.focal_length * self.frame.z - x * self.frame.x).normalize()
    }

    pub(super) fn area(&self) -> f64 {
        self.chart_bounds().area()
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let chart = self.chart_bounds();
        let length = chart.min.x + u[0] * (chart.max.x - chart.min.x);
        let x = bracketed_root(self.x_min, self.x_max, |x| {
            (self.arc_length(x) - length, (x / (2.0 * self.focal_length)).hypot(1.0))
        });
        let y = (2.0 * u[1] - 1.0) * self.half_length;
        self.frame.point_to_world(DVec3::new(x, y, self.height(x)))
    }

    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        let p = self.frame.point_to_local(p);
        DVec2::new(self.arc_length(p.x), p.y)
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        ChartRect {
            min: DVec2::new(self.arc_length(self.x_min), -self.half_length),
            max: DVec2::new(self.arc_length(self.x_max), self.half_length),
        }
    }

    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        rect.intersection(&self.chart_bounds()).area()
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

    /// Positive on the concave side; a length near the surface.
    fn implicit(f: f64, p: DVec3) -> f64 {
        let p = tilted(1.0).point_to_local(p);
        p.z - p.x * p.x / (4.0 * f)
    }

    #[test]
    fn whole_and_half_troughs_keep_the_contract_of_shapes() {
        for (f, x_min, x_max) in [(2.0, -3.0, 3.0), (0.5, 0.4, 3.0), (1.0, -2.0, -1.0)] {
            let shape = ParabolicCylinder::new(tilted(1.0), f, x_min, x_max, 8.0);
            let shape = Shape::ParabolicCylinder(shape);
            let implicit = |p: DVec3| implicit(f, p);
            let inside_trim = |p: DVec3| {
                let p = tilted(1.0).point_to_local(p);
                (p.x - x_min).min(x_max - p.x).min(4.0 - p.y.abs())
            };
            let truth = Truth { shape: &shape, implicit: &implicit, inside_trim: &inside_trim };
            assert_crossings_match_a_scan(&truth, 400);
            assert_starting_on_it_drops_only_the_start(&shape, 4000);
            assert_hit_from_far_away(&truth, (3.0f64 / (2.0 * f)).hypot(1.0));
            assert_samples_are_uniform(&truth, 1e-13);
            assert_bounds_are_tight(&shape, 1e-4);
        }
    }

    #[test]
    fn the_area_is_the_length_of_the_parabola_times_that_of_the_trough() {
        let (f, x_min, x_max) = (0.7, -0.4, 2.0);
        let shape = ParabolicCylinder::new(tilted(1.0), f, x_min, x_max, 3.0);
        // By chords of the parabola.
        let n = 20_000;
        let point = |i: i32| {
            let x = x_min + (x_max - x_min) * f64::from(i) / f64::from(n);
            DVec2::new(x, x * x / (4.0 * f))
        };
        let length: f64 = (0..n).map(|i| (point(i + 1) - point(i)).length()).sum();
        assert!((shape.area() / (3.0 * length) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn rays_along_z_meet_in_the_focal_line_and_rays_along_y_miss() {
        let shape = ParabolicCylinder::new(Frame::WORLD, 2.0, -5.0, 5.0, 100.0);
        let shape = Shape::ParabolicCylinder(shape);
        for i in 0..50 {
            let ray = Ray::new(DVec3::new(-4.95 + 0.2 * f64::from(i), 1.0, 9.0), DVec3::NEG_Z);
            let found = crossings_of(&shape, &ray, RayStart::Elsewhere);
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].toward, Toward::Back);
            let p = ray.at(found[0].t);
            let normal = shape.normal(p);
            assert!(normal.z > 0.0);
            let reflected = ray.dir() - 2.0 * ray.dir().dot(normal) * normal;
            let to_focus = (DVec3::new(0.0, 1.0, 2.0) - p).normalize();
            assert!((reflected - to_focus).length() < 1e-14);
            assert!(crossings_of(&shape, &Ray::new(p, DVec3::Z), RayStart::On).is_empty());
        }
        let along = Ray::new(DVec3::new(0.0, -90.0, 0.0), DVec3::Y);
        assert!(crossings_of(&shape, &along, RayStart::Elsewhere).is_empty());
        assert!(crossings_of(&shape, &along, RayStart::On).is_empty());
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        assert_scales(|scale| {
            Shape::ParabolicCylinder(ParabolicCylinder::new(
                tilted(scale),
                2.0 * scale,
                -scale,
                5.0 * scale,
                9.0 * scale,
            ))
        });
    }

    #[test]
    fn a_thousand_mirror_bounces_inside_stay_on_the_trough_and_keep_their_slope_along_it() {
        let frame = tilted(1.0);
        let shape = ParabolicCylinder::new(frame, 2.0, -5.0, 5.0, 30.0);
        let shape = Shape::ParabolicCylinder(shape);
        let behind = |p: DVec3, normal| HalfSpace::behind(frame.point_to_world(p), normal);
        let lids = [
            behind(25.0 / 8.0 * DVec3::Z, frame.z),
            behind(15.0 * DVec3::Y, frame.y),
            behind(-15.0 * DVec3::Y, -frame.y),
        ];
        for path in 0..20 {
            let mut first = None;
            bounce(&shape, Toward::Back, &lids, path, |ray| {
                assert!(implicit(2.0, ray.origin()).abs() < 1e-12);
                // The end mirrors change its sign.
                let slope = ray.dir().dot(frame.y).abs();
                assert!((slope - *first.get_or_insert(slope)).abs() < 1e-12);
            });
        }
    }
}
