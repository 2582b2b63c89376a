//! A zone of a sphere: ball, cap, lens face.

use crate::scene::Ray;
use crate::scene::shape::support::{across, box_by_reach, front};
use crate::scene::shape::{ChartRect, Crossing, RayStart, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame};
use std::f64::consts::TAU;

/// The part of a sphere between two planes; the front is outside, or the centre's side if turned [`Sphere::inward`].
///
/// The chart: u = r φ from the frame's x axis, in [0, 2πr); v = z, so equal rectangles have equal areas (Archimedes).
#[derive(Debug, Clone)]
pub struct Sphere {
    frame: Frame,
    radius: f64,
    z_min: f64,
    z_max: f64,
    /// Direction in which a ray crosses as it leaves the ball.
    leaving: Toward,
}

impl Sphere {
    /// The sphere of radius `radius`, mm, about the origin of `frame`, for z of the frame in [`z_min`, `z_max`], mm.
    /// The whole sphere for -`radius` and `radius` or beyond.
    pub fn zone(frame: Frame, radius: f64, z_min: f64, z_max: f64) -> Self {
        let (z_min, z_max) = (z_min.max(-radius), z_max.min(radius));
        Self { frame, radius, z_min, z_max, leaving: Toward::Front }
    }

    /// The same surface with the front on the other side, toward the centre.
    pub fn inward(self) -> Self {
        Self { leaving: Toward::Back, ..self }
    }

    pub(super) fn bounds(&self) -> Aabb {
        box_by_reach(&self.frame, |e| {
            // sqrt(r² - z²) sin + z cos is largest at z = r cos, and falls on both sides of it.
            let z = (self.radius * e.z).clamp(self.z_min, self.z_max);
            let circle = (self.radius * self.radius - z * z).max(0.0).sqrt();
            circle * across(e) + z * e.z
        })
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, start: RayStart, mut visit: impl FnMut(Crossing)) {
        let from = ray.origin() - self.frame.origin;
        let middle = -from.dot(ray.dir()) / ray.dir().length_squared();
        let mut offer = |t: f64, toward: Toward| {
            if self.contains_height((from + t * ray.dir()).dot(self.frame.z)) {
                visit(Crossing { t, toward });
            }
        };
        match start {
            // The chord lies symmetrically about the point nearest to the centre.
            RayStart::On => {
                let t = 2.0 * middle;
                offer(t, if t > 0.0 { self.leaving } else { self.leaving.opposite() });
            }
            RayStart::Elsewhere => {
                let nearest = (from + middle * ray.dir()).length();
                if nearest <= self.radius {
                    let half_chord = ((self.radius - nearest) * (self.radius + nearest)).sqrt();
                    offer(middle - half_chord, self.leaving.opposite());
                    offer(middle + half_chord, self.leaving);
                }
            }
        }
    }

    /// Whether a height of the frame lies between the planes; a pole that is not cut off has no
    /// rim.
    #[inline]
    fn contains_height(&self, z: f64) -> bool {
        (z >= self.z_min || self.z_min <= -self.radius)
            && (z <= self.z_max || self.z_max >= self.radius)
    }

    /// Unit vector of the axis.
    pub(super) fn axis(&self) -> DVec3 {
        self.frame.z
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        front((p - self.frame.origin).normalize(), self.leaving)
    }

    pub(super) fn area(&self) -> f64 {
        self.area_in(self.chart_bounds())
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let z = self.z_min + u[1] * (self.z_max - self.z_min);
        let circle = ((self.radius - z) * (self.radius + z)).max(0.0).sqrt();
        let (sin, cos) = (TAU * u[0]).sin_cos();
        self.frame.point_to_world(DVec3::new(circle * cos, circle * sin, z))
    }

    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        let p = self.frame.point_to_local(p);
        DVec2::new(self.radius * p.y.atan2(p.x).rem_euclid(TAU), p.z)
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        ChartRect {
            min: DVec2::new(0.0, self.z_min),
            max: DVec2::new(TAU * self.radius, self.z_max),
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
        Truth, assert_bounds_are_tight, assert_crossings_match_a_scan,
        assert_grazing_rays_come_back, assert_hit_from_far_away, assert_samples_are_uniform,
        assert_scales, assert_starting_on_it_drops_only_the_start, bounce, crossings_of, tilted,
    };
    use crate::scene::shape::{HalfSpace, Shape};
    use std::f64::consts::PI;

    #[test]
    fn balls_caps_and_zones_keep_the_contract_of_shapes() {
        for (z_min, z_max) in [(-2.0, 2.0), (1.5, 2.0), (-9.0, -1.0), (-0.3, 1.2)] {
            let frame = tilted(1.0);
            let shape = Shape::Sphere(Sphere::zone(frame, 2.0, z_min, z_max));
            let implicit = |p: DVec3| (p - frame.origin).length() - 2.0;
            let inside_trim = |p: DVec3| {
                let z = frame.point_to_local(p).z;
                let below = if z_max < 2.0 { z_max - z } else { 1.0 };
                let above = if z_min > -2.0 { z - z_min } else { 1.0 };
                below.min(above)
            };
            let truth = Truth { shape: &shape, implicit: &implicit, inside_trim: &inside_trim };
            assert_crossings_match_a_scan(&truth, 400);
            assert_starting_on_it_drops_only_the_start(&shape, 4000);
            assert_hit_from_far_away(&truth, 1.0);
            assert_samples_are_uniform(&truth, 1e-14);
            assert_bounds_are_tight(&shape, 1e-4);
            let height = z_max.min(2.0) - z_min.max(-2.0);
            assert!((shape.area() - 2.0 * PI * 2.0 * height).abs() < 1e-13);
        }
    }

    #[test]
    fn a_ray_that_grazes_the_ball_inward_always_comes_back_to_it() {
        let ball = Sphere::zone(tilted(1.0), 2.0, -2.0, 2.0);
        assert_grazing_rays_come_back(&Shape::Sphere(ball));
    }

    #[test]
    fn turned_inward_the_front_is_the_centre() {
        let outward = Sphere::zone(tilted(1.0), 2.0, 0.5, 2.0);
        let inward = Shape::Sphere(outward.clone().inward());
        let outward = Shape::Sphere(outward);
        let p = inward.sample([0.3, 0.4]);
        assert!(inward.normal(p).dot(tilted(1.0).origin - p) > 1.999);
        assert_eq!(inward.normal(p), -outward.normal(p));
        let ray = Ray::new(tilted(1.0).origin, p - tilted(1.0).origin);
        let toward = |shape| crossings_of(shape, &ray, RayStart::Elsewhere)[0].toward;
        assert_eq!((toward(&outward), toward(&inward)), (Toward::Front, Toward::Back));
        assert_starting_on_it_drops_only_the_start(&inward, 1000);
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        assert_scales(|scale| {
            Shape::Sphere(Sphere::zone(tilted(scale), 2.0 * scale, -scale, 1.5 * scale))
        });
    }

    #[test]
    fn a_thousand_mirror_bounces_inside_stay_on_the_ball_and_keep_their_angular_momentum() {
        let frame = tilted(1.0);
        let ball = Shape::Sphere(Sphere::zone(frame, 2.0, -2.0, 2.0));
        let cut = Shape::Sphere(Sphere::zone(frame, 2.0, -2.0, 0.7));
        let lid = HalfSpace::behind(frame.point_to_world(0.7 * DVec3::Z), frame.z);
        for path in 0..20 {
            let mut first = None;
            bounce(&ball, Toward::Front, &[], path, |ray| {
                assert!(((ray.origin() - frame.origin).length() - 2.0).abs() < 1e-12);
                let momentum = (ray.origin() - frame.origin).cross(ray.dir());
                assert!((momentum - *first.get_or_insert(momentum)).length() < 1e-12);
            });
            let mut first = None;
            bounce(&cut, Toward::Front, &[lid], path, |ray| {
                assert!(((ray.origin() - frame.origin).length() - 2.0).abs() < 1e-12);
                let skew = (ray.origin() - frame.origin).cross(ray.dir()).dot(frame.z);
                assert!((skew - *first.get_or_insert(skew)).abs() < 1e-12);
            });
        }
    }
}
