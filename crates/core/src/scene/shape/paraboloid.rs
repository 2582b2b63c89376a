//! A zone of a paraboloid of revolution: the reflector that collimates a point source.

use crate::scene::Ray;
use crate::scene::shape::support::{across, box_by_reach};
use crate::scene::shape::{ChartRect, Crossing, RayStart, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, quadratic};
use std::f64::consts::{PI, TAU};

/// The part of the paraboloid z = r² / 4f between two radii; the front is outside, away from axis and
/// focus.
///
/// The chart: u = `radius_max` φ from the frame's x axis, in [0, 2π `radius_max`); v = z.
#[derive(Debug, Clone)]
pub struct Paraboloid {
    frame: Frame,
    focal_length: f64,
    radius_min: f64,
    radius_max: f64,
}

impl Paraboloid {
    /// The paraboloid with its vertex at the origin of `frame` and its focus `focal_length` above, for radii in
    /// [`radius_min`, `radius_max`], mm.
    pub fn new(frame: Frame, focal_length: f64, radius_min: f64, radius_max: f64) -> Self {
        Self { frame, focal_length, radius_min, radius_max }
    }

    fn height(&self, radius: f64) -> f64 {
        radius * radius / (4.0 * self.focal_length)
    }

    pub(super) fn bounds(&self) -> Aabb {
        box_by_reach(&self.frame, |e| {
            let reach = |radius: f64| radius * across(e) + self.height(radius) * e.z;
            // Stationary at r = -2f sin / cos; where that is a minimum or undefined, the ends reach further.
            let stationary = (-2.0 * self.focal_length * across(e) / e.z)
                .max(self.radius_min)
                .min(self.radius_max);
            reach(stationary).max(reach(self.radius_min)).max(reach(self.radius_max))
        })
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, start: RayStart, mut visit: impl FnMut(Crossing)) {
        let dir = self.frame.to_local(ray.dir());
        let from = self.frame.point_to_local(ray.origin());
        let along_axis = 2.0 * self.focal_length * dir.z;
        let a = dir.truncate().length_squared();
        let half_b = |p: DVec3| p.truncate().dot(dir.truncate()) - along_axis;
        let mut offer = |t: f64, toward: Toward| {
            if self.contains_height(from.z + t * dir.z) {
                visit(Crossing { t, toward });
            }
        };
        match start {
            // On the surface c = 0. A ray along the axis has its other root at infinity.
            RayStart::On => {
                let t = -2.0 * half_b(from) / a;
                offer(t, if t > 0.0 { Toward::Front } else { Toward::Back });
            }
            RayStart::Elsewhere => {
                // From the point nearest to the vertex: from far away, r² - 4fz loses digits.
                let shift = -from.dot(dir);
                let near = from + shift * dir;
                let c = near.truncate().length_squared() - 4.0 * self.focal_length * near.z;
                if let Some([enter, leave]) = quadratic(a, half_b(near), c) {
                    offer(shift + enter, Toward::Back);
                    offer(shift + leave, Toward::Front);
                }
            }
        }
    }

    /// Whether a height of the frame lies between the rims; without a hole there is no rim at the
    /// vertex.
    #[inline]
    fn contains_height(&self, z: f64) -> bool {
        z <= self.height(self.radius_max)
            && (self.radius_min == 0.0 || z >= self.height(self.radius_min))
    }

    /// Unit vector of the axis.
    pub(super) fn axis(&self) -> DVec3 {
        self.frame.z
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let p = self.frame.point_to_local(p);
        let outward = p.truncate().extend(-2.0 * self.focal_length).normalize();
        self.frame.to_world(outward)
    }

    pub(super) fn area(&self) -> f64 {
        self.area_in(self.chart_bounds())
    }

    /// Area from the vertex up to height `z`, mm²: 8πf²/3 ((1 + z/f)^(3/2) - 1).
    fn area_below(&self, z: f64) -> f64 {
        let f = self.focal_length;
        8.0 * PI / 3.0 * f * f * (1.5 * (z / f).ln_1p()).exp_m1()
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let f = self.focal_length;
        let [from, to] =
            [self.radius_min, self.radius_max].map(|r| self.area_below(self.height(r)));
        let area = from + u[1] * (to - from);
        let z = f * ((3.0 * area / (8.0 * PI * f * f)).ln_1p() / 1.5).exp_m1();
        let radius = (4.0 * f * z).sqrt();
        let (sin, cos) = (TAU * u[0]).sin_cos();
        self.frame.point_to_world(DVec3::new(radius * cos, radius * sin, z))
    }

    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        let p = self.frame.point_to_local(p);
        DVec2::new(self.radius_max * p.y.atan2(p.x).rem_euclid(TAU), p.z)
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        ChartRect {
            min: DVec2::new(0.0, self.height(self.radius_min)),
            max: DVec2::new(TAU * self.radius_max, self.height(self.radius_max)),
        }
    }

    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        let rect = rect.intersection(&self.chart_bounds());
        if rect.is_empty() {
            return 0.0;
        }
        let part_of_turn = (rect.max.x - rect.min.x) / (TAU * self.radius_max);
        part_of_turn * (self.area_below(rect.max.y) - self.area_below(rect.min.y))
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

    /// Approximately (r² - 4fz) / 4f, in the frame: a length near the surface.
    fn implicit(f: f64, p: DVec3) -> f64 {
        let p = tilted(1.0).point_to_local(p);
        (p.truncate().length_squared() - 4.0 * f * p.z) / (4.0 * f)
    }

    #[test]
    fn shallow_and_deep_dishes_keep_the_contract_of_shapes() {
        for (f, radius_min, radius_max) in [(2.0, 0.0, 3.0), (20.0, 1.0, 3.0), (0.2, 0.5, 2.0)] {
            let shape = Shape::Paraboloid(Paraboloid::new(tilted(1.0), f, radius_min, radius_max));
            let inside_trim = |p: DVec3| {
                let z = tilted(1.0).point_to_local(p).z;
                let above = if radius_min > 0.0 { z - radius_min.powi(2) / (4.0 * f) } else { 1.0 };
                (radius_max.powi(2) / (4.0 * f) - z).min(above)
            };
            let implicit = |p: DVec3| implicit(f, p);
            let truth = Truth { shape: &shape, implicit: &implicit, inside_trim: &inside_trim };
            assert_crossings_match_a_scan(&truth, 400);
            assert_starting_on_it_drops_only_the_start(&shape, 4000);
            assert_hit_from_far_away(&truth, (radius_max / (2.0 * f)).hypot(1.0));
            assert_samples_are_uniform(&truth, 1e-13);
            assert_bounds_are_tight(&shape, 1e-4);
        }
    }

    #[test]
    fn the_area_of_a_dish_is_the_integral_of_its_rings() {
        let (f, radius_min, radius_max) = (0.7, 0.4, 2.0);
        let shape = Paraboloid::new(tilted(1.0), f, radius_min, radius_max);
        // 2π r sqrt(1 + (r/2f)²) dr by the midpoint rule.
        let n = 100_000;
        let dr = (radius_max - radius_min) / f64::from(n);
        let ring = |i: i32| {
            let r = radius_min + dr * (f64::from(i) + 0.5);
            TAU * r * (r / (2.0 * f)).hypot(1.0) * dr
        };
        let rings: f64 = (0..n).map(ring).sum();
        assert!((shape.area() / rings - 1.0).abs() < 1e-9, "{} {rings}", shape.area());
        // Almost flat: no digits are lost.
        let flat = Paraboloid::new(tilted(1.0), 1e9, 0.0, 1.0);
        assert!((flat.area() / PI - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_focus_is_imaged_to_infinity() {
        let frame = tilted(1.0);
        let bowl = Shape::Paraboloid(Paraboloid::new(frame, 2.0, 0.0, 5.0));
        let focus = frame.point_to_world(2.0 * DVec3::Z);
        for i in 0..50 {
            let target = bowl.sample([f64::from(i) / 50.0, (f64::from(i) * 0.618).fract()]);
            let ray = Ray::new(focus, target - focus);
            let hit = *crossings_of(&bowl, &ray, RayStart::Elsewhere).last().unwrap();
            assert!((ray.at(hit.t) - target).length() < 1e-13);
            assert_eq!(hit.toward, Toward::Front);
            let normal = bowl.normal(target);
            let reflected = ray.dir() - 2.0 * ray.dir().dot(normal) * normal;
            assert!((reflected - frame.z).length() < 1e-14);
        }
        assert_starting_on_it_drops_only_the_start(&bowl, 1000);
    }

    #[test]
    fn a_ray_along_the_axis_crosses_once() {
        let shape = Shape::Paraboloid(Paraboloid::new(Frame::WORLD, 2.0, 0.0, 5.0));
        for (dir, toward) in [(DVec3::Z, Toward::Back), (DVec3::NEG_Z, Toward::Front)] {
            let ray = Ray::new(DVec3::new(4.0, 0.0, 1.0), dir);
            let found = crossings_of(&shape, &ray, RayStart::Elsewhere);
            assert_eq!(found, [Crossing { t: dir.z, toward }]);
            assert!(crossings_of(&shape, &ray.advanced(dir.z), RayStart::On).is_empty());
        }
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        assert_scales(|scale| {
            Shape::Paraboloid(Paraboloid::new(tilted(scale), 2.0 * scale, 0.5 * scale, 5.0 * scale))
        });
    }

    #[test]
    fn a_thousand_mirror_bounces_inside_stay_on_the_dish_and_keep_their_skew() {
        let frame = tilted(1.0);
        let shape = Shape::Paraboloid(Paraboloid::new(frame, 2.0, 0.0, 5.0));
        let lid = HalfSpace::behind(frame.point_to_world(25.0 / 8.0 * DVec3::Z), frame.z);
        for path in 0..20 {
            let mut first = None;
            bounce(&shape, Toward::Front, &[lid], path, |ray| {
                assert!(implicit(2.0, ray.origin()).abs() < 1e-12);
                let skew = (ray.origin() - frame.origin).cross(ray.dir()).dot(frame.z);
                assert!((skew - *first.get_or_insert(skew)).abs() < 1e-12);
            });
        }
    }
}
