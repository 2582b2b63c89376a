//! The wall of a bent round tube: an arc of a torus.

mod line;
#[cfg(test)]
mod tests;

use crate::scene::Ray;
use crate::scene::shape::support::{across, box_by_reach};
use crate::scene::shape::torus::line::TorusLine;
use crate::scene::shape::wedge::{Wedge, turn};
use crate::scene::shape::{ChartRect, Crossing, CrossingQuery, RayStart, Toward};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, Root, SignChange, bracketed_root};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

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
        let all = CrossingQuery { toward: None, min: f64::NEG_INFINITY, max: f64::INFINITY };
        let _ = self.visit(ray, start, &all, |crossing| {
            visit(crossing);
            ControlFlow::Continue(())
        });
    }

    #[inline(never)]
    pub(super) fn first_crossing(
        &self,
        ray: &Ray,
        start: RayStart,
        wanted: &CrossingQuery,
    ) -> Option<Crossing> {
        let mut first = None;
        let _ = self.visit(ray, start, wanted, |crossing| {
            first = wanted.includes(&crossing).then_some(crossing);
            first.map_or(ControlFlow::Continue(()), |_| ControlFlow::Break(()))
        });
        first
    }

    /// Visits crossings, all wanted ones among them, along the ray.
    #[inline]
    fn visit(
        &self,
        ray: &Ray,
        start: RayStart,
        wanted: &CrossingQuery,
        mut visit: impl FnMut(Crossing) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        // In units of the major radius.
        let unit = self.major_radius;
        let from = self.frame.point_to_local(ray.origin()) / unit;
        let dir = self.frame.to_local(ray.dir());
        let line = TorusLine { from, dir, tube: self.minor_radius / unit };
        let span = [wanted.min / unit, wanted.max / unit];
        let span = self.arc.map_or(span, |arc| arc.clip(span, from.truncate(), dir.truncate()));
        // A ray rises out of the tube.
        let toward = |change: SignChange| match change {
            SignChange::Rise => Toward::Front,
            SignChange::Fall => Toward::Back,
        };
        let is_wanted = |change: SignChange| wanted.includes_way(toward(change));
        let visit = |(t, change): Root| {
            if self.arc_contains((from + t * dir).truncate()) {
                visit(Crossing { t: t * unit, toward: toward(change) })?;
            }
            ControlFlow::Continue(())
        };
        match start {
            RayStart::On => line.visit_others(span, is_wanted, visit),
            RayStart::Elsewhere => line.visit_all(span, is_wanted, visit),
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
