//! A piece of a plane.

mod polygon;
mod region;

pub use polygon::Polygon;
pub use region::Region;

use crate::scene::Ray;
use crate::scene::shape::{ChartRect, Crossing, CrossingQuery, RayStart, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame};

/// A piece of the plane z = 0 of a frame; the front is +z.
///
/// The chart is the frame's (x, y).
#[derive(Debug, Clone)]
pub struct Flat {
    frame: Frame,
    region: Region,
}

impl Flat {
    /// A region of the plane z = 0 of `frame`.
    pub fn new(frame: Frame, region: Region) -> Self {
        Self { frame, region }
    }

    /// The frame of the plane; z is the front.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The part of the plane that is covered.
    pub fn region(&self) -> &Region {
        &self.region
    }

    /// The largest coordinate of its points along a unit vector, mm.
    pub(crate) fn reach(&self, along: DVec3) -> f64 {
        let across = DVec2::new(along.dot(self.frame.x), along.dot(self.frame.y));
        self.frame.origin.dot(along) + self.region.reach(across)
    }

    pub(super) fn bounds(&self) -> Aabb {
        Aabb::of(self.chart_bounds().corners().map(|p| self.frame.point_to_world(p.extend(0.0))))
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, start: RayStart, mut visit: impl FnMut(Crossing)) {
        let any = CrossingQuery { toward: None, min: f64::MIN, max: f64::MAX };
        if let Some(crossing) = self.first_crossing(ray, start, &any) {
            visit(crossing);
        }
    }

    /// The crossing, if it is wanted: cheap tests come first.
    #[inline(always)]
    pub(super) fn first_crossing(
        &self,
        ray: &Ray,
        start: RayStart,
        wanted: &CrossingQuery,
    ) -> Option<Crossing> {
        let across = ray.dir().dot(self.frame.z);
        let toward = if across > 0.0 { Toward::Front } else { Toward::Back };
        if !wanted.includes_way(toward) || start == RayStart::On {
            return None;
        }
        let t = (self.frame.origin - ray.origin()).dot(self.frame.z) / across;
        // Parallel rays give an infinite or undefined t, which no finite limit includes.
        let crossing = Crossing { t, toward };
        (wanted.includes(&crossing) && t < f64::INFINITY && self.contains(ray.at(t)))
            .then_some(crossing)
    }

    #[inline(always)]
    fn contains(&self, p: DVec3) -> bool {
        self.region.contains(self.chart(p))
    }

    #[inline]
    pub(super) fn normal(&self) -> DVec3 {
        self.frame.z
    }

    pub(super) fn area(&self) -> f64 {
        self.region.area()
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        self.frame.point_to_world(self.region.sample(u).extend(0.0))
    }

    #[inline(always)]
    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        let from = p - self.frame.origin;
        DVec2::new(from.dot(self.frame.x), from.dot(self.frame.y))
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        self.region.bounds()
    }

    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        self.region.area_in(rect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_through_a_notched_polygon_is_told_its_side() {
        let notched = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.5), (0.0, 2.0)];
        let flat = Flat::new(
            Frame::from_axis(DVec3::new(0.0, 0.0, 3.0), -DVec3::Z),
            Region::polygon(notched.map(DVec2::from).to_vec()),
        );
        let hits = |local: DVec2| {
            let target = flat.frame().point_to_world(local.extend(0.0));
            let mut found = Vec::new();
            let ray = Ray::new(target - DVec3::Z, DVec3::Z);
            flat.crossings(&ray, RayStart::Elsewhere, |crossing| found.push(crossing));
            found
        };
        let back = Crossing { t: 1.0, toward: Toward::Back };
        assert_eq!(hits(DVec2::new(0.5, 0.5)), [back]);
        assert_eq!(hits(DVec2::new(1.0, 1.0)), []);
        let along = Ray::new(DVec3::new(0.5, 0.5, 3.0), DVec3::X);
        flat.crossings(&along, RayStart::Elsewhere, |crossing| panic!("{crossing:?}"));
    }
}
