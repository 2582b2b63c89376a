//! The wall of a circular cylinder, between two cross-sections, or cut by oblique planes at a mitre.

use crate::math::{Aabb, Frame, quadratic};
use crate::scene::Ray;
use crate::scene::shape::{ChartRect, Crossing, HalfSpace, Start, Toward};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// A piece of a cylinder's wall; the front is outside.
///
/// The chart: u = r φ from the frame's x axis, in [0, 2πr); v = z.
#[derive(Debug, Clone)]
pub struct Cylinder {
    frame: Frame,
    radius: f64,
    z_min: f64,
    z_max: f64,
    /// Further trims, all to be fulfilled.
    cuts: Vec<HalfSpace>,
}

impl Cylinder {
    /// The wall of radius `radius` about the z axis of `frame` for z in [0, `length`], mm.
    pub fn new(frame: Frame, radius: f64, length: f64) -> Self {
        Self { frame, radius, z_min: 0.0, z_max: length, cuts: Vec::new() }
    }

    /// The wall between two oblique planes: only points inside all `cuts` remain. `z_min` and `z_max` must enclose them.
    pub fn cut(frame: Frame, radius: f64, z_min: f64, z_max: f64, cuts: Vec<HalfSpace>) -> Self {
        Self { frame, radius, z_min, z_max, cuts }
    }

    pub(super) fn bounds(&self) -> Aabb {
        // A circle about axis z reaches r sqrt(1 - z_i²) along coordinate i.
        let reach = self.radius
            * (DVec3::ONE - self.frame.z * self.frame.z).max(DVec3::ZERO).map(f64::sqrt);
        let (a, b) = (
            self.frame.origin + self.z_min * self.frame.z,
            self.frame.origin + self.z_max * self.frame.z,
        );
        Aabb { min: a.min(b) - reach, max: a.max(b) + reach }
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, start: Start, mut visit: impl FnMut(Crossing)) {
        let axis = self.frame.z;
        let from = ray.origin() - self.frame.origin;
        let (along_origin, along_dir) = (from.dot(axis), ray.dir().dot(axis));
        // Perpendicular parts as vectors: 1 - (d·a)² would lose the digits of rays nearly along the axis.
        let across_origin = from - along_origin * axis;
        let across_dir = ray.dir() - along_dir * axis;
        let a = across_dir.length_squared();
        if a == 0.0 {
            return;
        }
        let half_b = across_origin.dot(across_dir);
        let mut offer = |t: f64, toward: Toward| {
            let z = along_origin + t * along_dir;
            if z >= self.z_min
                && z <= self.z_max
                && self.cuts.iter().all(|cut| cut.contains(ray.at(t)))
            {
                visit(Crossing { t, toward });
            }
        };
        match start {
            // On the wall c = 0, so the other root is -2b/a, whatever the angle.
            Start::On => {
                let t = -2.0 * half_b / a;
                // The further root leaves the cylinder, the nearer one enters it.
                offer(t, if t > 0.0 { Toward::Front } else { Toward::Back });
            }
            Start::Elsewhere => {
                let c = across_origin.length_squared() - self.radius * self.radius;
                if let Some([enter, leave]) = quadratic(a, half_b, c) {
                    offer(enter, Toward::Back);
                    offer(leave, Toward::Front);
                }
            }
        }
    }

    #[inline]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let from = p - self.frame.origin;
        (from - from.dot(self.frame.z) * self.frame.z).normalize()
    }

    pub(super) fn area(&self) -> f64 {
        self.area_in(self.chart_bounds())
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let (sin, cos) = (TAU * u[0]).sin_cos();
        let z = self.z_min + u[1] * (self.z_max - self.z_min);
        self.frame.point_to_world(DVec3::new(self.radius * cos, self.radius * sin, z))
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
        let bounds = self.chart_bounds();
        let size = rect.max.min(bounds.max) - rect.min.max(bounds.min);
        size.x.max(0.0) * size.y.max(0.0)
    }
}
