//! A piece of a plane.

use crate::math::{Aabb, Frame, disk};
use crate::scene::Ray;
use crate::scene::shape::{ChartRect, Crossing, Start, Toward};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// A piece of the plane z = 0 of a frame; the front is +z.
///
/// The chart is the frame's (x, y).
#[derive(Debug, Clone)]
pub struct Flat {
    frame: Frame,
    region: Region,
}

/// Which part of the plane.
#[derive(Debug, Clone)]
pub enum Region {
    /// Between two radii, mm; a disk when `inner` is 0.
    Annulus {
        /// Inner radius, mm.
        inner: f64,
        /// Outer radius, mm.
        outer: f64,
    },
    /// A rectangle about the origin, half sizes in mm.
    Rectangle {
        /// Half the size along x, mm.
        half_x: f64,
        /// Half the size along y, mm.
        half_y: f64,
    },
}

impl Flat {
    /// A region of the plane z = 0 of `frame`.
    pub fn new(frame: Frame, region: Region) -> Self {
        Self { frame, region }
    }

    pub(super) fn bounds(&self) -> Aabb {
        let rect = self.chart_bounds();
        Aabb::of(
            [
                (rect.min.x, rect.min.y),
                (rect.min.x, rect.max.y),
                (rect.max.x, rect.min.y),
                (rect.max.x, rect.max.y),
            ]
            .map(|(x, y)| self.frame.point_to_world(DVec3::new(x, y, 0.0))),
        )
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, start: Start, mut visit: impl FnMut(Crossing)) {
        if start == Start::On {
            return;
        }
        let across = ray.dir().dot(self.frame.z);
        let t = (self.frame.origin - ray.origin()).dot(self.frame.z) / across;
        // Parallel rays give an infinite or undefined t.
        if t.is_finite() && self.contains(ray.at(t)) {
            visit(Crossing { t, toward: if across > 0.0 { Toward::Front } else { Toward::Back } });
        }
    }

    #[inline]
    fn contains(&self, p: DVec3) -> bool {
        let from = p - self.frame.origin;
        match &self.region {
            Region::Annulus { inner, outer } => {
                let r2 = from.length_squared();
                r2 <= outer * outer && r2 >= inner * inner
            }
            Region::Rectangle { half_x, half_y } => {
                from.dot(self.frame.x).abs() <= *half_x && from.dot(self.frame.y).abs() <= *half_y
            }
        }
    }

    #[inline]
    pub(super) fn normal(&self) -> DVec3 {
        self.frame.z
    }

    pub(super) fn area(&self) -> f64 {
        match &self.region {
            Region::Annulus { inner, outer } => PI * (outer * outer - inner * inner),
            Region::Rectangle { half_x, half_y } => 4.0 * half_x * half_y,
        }
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let local = match &self.region {
            Region::Annulus { inner, outer } => {
                // Uniform in r² between the two radii.
                let r2 = inner * inner + u[0] * (outer * outer - inner * inner);
                disk([1.0, u[1]]) * r2.sqrt()
            }
            Region::Rectangle { half_x, half_y } => {
                DVec3::new((2.0 * u[0] - 1.0) * half_x, (2.0 * u[1] - 1.0) * half_y, 0.0)
            }
        };
        self.frame.point_to_world(local)
    }

    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        self.frame.point_to_local(p).truncate()
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        let half = match &self.region {
            Region::Annulus { outer, .. } => DVec2::splat(*outer),
            Region::Rectangle { half_x, half_y } => DVec2::new(*half_x, *half_y),
        };
        ChartRect { min: -half, max: half }
    }

    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        match &self.region {
            Region::Annulus { inner, outer } => disk_in(rect, *outer) - disk_in(rect, *inner),
            Region::Rectangle { .. } => {
                let bounds = self.chart_bounds();
                let size = rect.max.min(bounds.max) - rect.min.max(bounds.min);
                size.x.max(0.0) * size.y.max(0.0)
            }
        }
    }
}

/// Area that a disk about the origin shares with a rectangle, mm²: the four quadrant-like corner areas, added with signs.
fn disk_in(rect: ChartRect, radius: f64) -> f64 {
    let corner = |x: f64, y: f64| disk_below_left(x, y, radius);
    corner(rect.max.x, rect.max.y) - corner(rect.min.x, rect.max.y) - corner(rect.max.x, rect.min.y)
        + corner(rect.min.x, rect.min.y)
}

/// Area of the disk with x' < x and y' < y, mm².
fn disk_below_left(x: f64, y: f64, radius: f64) -> f64 {
    let x = x.clamp(-radius, radius);
    let y = y.clamp(-radius, radius);
    // ∫ over x' of the height below y: primitive of sqrt(r² - s²).
    let primitive = |s: f64| {
        0.5 * (s * (radius * radius - s * s).max(0.0).sqrt()
            + radius * radius * (s / radius).asin())
    };
    if radius == 0.0 {
        return 0.0;
    }
    // Where |x'| <= w the line y cuts the disk; beyond w the whole chord is below y (y > 0) or above it (y < 0).
    let w = (radius * radius - y * y).max(0.0).sqrt();
    let chord =
        |from: f64, to: f64| if to > from { 2.0 * (primitive(to) - primitive(from)) } else { 0.0 };
    let inner = |from: f64, to: f64| {
        if to > from { primitive(to) - primitive(from) + y * (to - from) } else { 0.0 }
    };
    let middle = inner(-w, x.min(w));
    if y > 0.0 { chord(-radius, x.min(-w)) + middle + chord(w, x) } else { middle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_a_disk_add_up_and_corners_are_cut() {
        let disk = Flat::new(Frame::WORLD, Region::Annulus { inner: 1.0, outer: 2.0 });
        let n = 7;
        let edge = |i: i32| -2.5 + 5.0 * f64::from(i) / f64::from(n);
        let mut sum = 0.0;
        for i in 0..n {
            for j in 0..n {
                let rect = ChartRect {
                    min: DVec2::new(edge(i), edge(j)),
                    max: DVec2::new(edge(i + 1), edge(j + 1)),
                };
                let area = disk.area_in(rect);
                assert!(area >= -1e-12);
                sum += area;
            }
        }
        assert!((sum - 3.0 * PI).abs() < 1e-12, "{sum}");
        let quarter = ChartRect { min: DVec2::ZERO, max: DVec2::splat(9.0) };
        assert!((disk.area_in(quarter) - 0.75 * PI).abs() < 1e-12);
    }
}
