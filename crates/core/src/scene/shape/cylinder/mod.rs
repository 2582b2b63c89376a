//! The wall of a circular cylinder: between two cross-sections, over a part of the azimuths, or cut by oblique planes
//! at a mitre.

mod unrolled;

use crate::scene::Ray;
use crate::scene::shape::wedge::{Wedge, arc_bounds, azimuth, point_on_circle, turn};
use crate::scene::shape::{
    ChartRect, Crossing, CrossingQuery, Flat, HalfSpace, RayStart, Region, Toward,
};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, quadratic, unit};
use unrolled::{Strip, UnrolledWall};

/// A piece of a cylinder's wall; the front is outside unless it has been turned `Self::inward`.
///
/// The chart: u = r φ from the frame's x axis, in [0, 2πr) or, of a sector, [0, r angle]; v = z.
#[derive(Debug, Clone)]
pub struct Cylinder {
    frame: Frame,
    radius: f64,
    z_min: f64,
    z_max: f64,
    /// The side toward which a ray passes as it leaves the cylinder.
    leaving: Toward,
    /// `None` for the plain wall, so that the usual ray needs only one test.
    trims: Option<Box<Trims>>,
}

/// A ray along the axis of the cylinder: z = origin + t dir.
#[derive(Debug, Clone, Copy)]
struct AxialRay {
    origin: f64,
    dir: f64,
}

/// Further conditions for points of the wall; all must hold.
#[derive(Debug, Clone, Default)]
struct Trims {
    wedge: Option<Wedge>,
    cuts: Vec<HalfSpace>,
}

impl Cylinder {
    /// The wall of radius `radius` about the z axis of `frame` for z in [0, `length`], mm.
    pub fn new(frame: Frame, radius: f64, length: f64) -> Self {
        Self { frame, radius, z_min: 0.0, z_max: length, leaving: Toward::Front, trims: None }
    }

    /// The wall between two oblique planes: only points inside all `cuts` remain. `z_min` and `z_max` must enclose them.
    pub(crate) fn cut(
        frame: Frame,
        radius: f64,
        z_min: f64,
        z_max: f64,
        cuts: Vec<HalfSpace>,
    ) -> Self {
        let trims = (!cuts.is_empty()).then(|| Box::new(Trims { wedge: None, cuts }));
        Self { frame, radius, z_min, z_max, leaving: Toward::Front, trims }
    }

    /// The wall for z in [`z_min`, `z_max`] and azimuths from the frame's x axis counter-clockwise to `angle`, rad.
    pub(crate) fn sector(frame: Frame, radius: f64, z_min: f64, z_max: f64, angle: f64) -> Self {
        let trims =
            Wedge::new(angle).map(|wedge| Box::new(Trims { wedge: Some(wedge), cuts: Vec::new() }));
        Self { frame, radius, z_min, z_max, leaving: Toward::Front, trims }
    }

    /// The same wall with its front toward the axis.
    pub(crate) fn inward(self) -> Self {
        Self { leaving: Toward::Back, ..self }
    }

    /// Whether it goes all around.
    pub fn is_closed(&self) -> bool {
        self.wedge().is_none()
    }

    /// Whether it is the plain wall all around, its front outside.
    pub(crate) fn is_whole(&self) -> bool {
        self.leaving == Toward::Front && self.trims.is_none()
    }

    /// Whether it goes all around between two cross-sections.
    pub(crate) fn is_uncut(&self) -> bool {
        self.trims.is_none()
    }

    /// z is the axis.
    pub(crate) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The coordinates along the axis that it lies between, mm.
    pub(crate) fn heights(&self) -> [f64; 2] {
        [self.z_min, self.z_max]
    }

    /// Radius, mm.
    pub(crate) fn radius(&self) -> f64 {
        self.radius
    }

    /// The largest coordinate of its points along a unit vector, mm, as if it were the wall all around.
    pub(crate) fn reach(&self, along: DVec3) -> f64 {
        let lean = along.dot(self.frame.z);
        let across = (along - lean * self.frame.z).length();
        self.frame.origin.dot(along)
            + (self.z_min * lean).max(self.z_max * lean)
            + self.radius * across
    }

    /// Whether a disk across the axis lies within the infinite cylinder; false for any other flat.
    pub(crate) fn encloses(&self, flat: &Flat, tolerance: f64) -> bool {
        let (plane, Region::Annulus { outer, .. }) = (flat.frame(), flat.region()) else {
            return false;
        };
        let (lean, aside) =
            (plane.z.dot(self.frame.z) * self.frame.z, self.across(plane.origin).length());
        (plane.z - lean).length() * outer <= tolerance && aside + outer <= self.radius + tolerance
    }

    /// The distance at which a ray inside leaves the infinite cylinder, mm; infinite along the
    /// axis.
    #[inline(always)]
    pub(crate) fn exit(&self, ray: &Ray, start: RayStart) -> f64 {
        match self.roots(ray, start) {
            Some((_, _, Some(exit))) => exit.t,
            Some((_, Crossing { t, .. }, None)) if t > 0.0 => t,
            Some((_, _, None)) | None => f64::INFINITY,
        }
    }

    /// The distances between which a line is in the infinite cylinder, mm; infinite along the axis.
    #[inline(always)]
    pub(crate) fn span(&self, ray: &Ray) -> Option<[f64; 2]> {
        match self.roots(ray, RayStart::Elsewhere) {
            Some((_, enter, leave)) => Some([enter.t, leave?.t]),
            None => {
                let along = ray.dir().cross(self.frame.z) == DVec3::ZERO;
                let within = self.across(ray.origin()).length() <= self.radius;
                (along && within).then_some([f64::NEG_INFINITY, f64::INFINITY])
            }
        }
    }

    pub(super) fn bounds(&self) -> Aabb {
        [self.z_min, self.z_max]
            .map(|z| arc_bounds(&self.frame, self.radius, z, self.wedge()))
            .into_iter()
            .fold(Aabb::EMPTY, Aabb::union)
    }

    #[inline]
    pub(super) fn crossings(&self, ray: &Ray, start: RayStart, visit: impl FnMut(Crossing)) {
        let Some((along, first, second)) = self.roots(ray, start) else { return };
        let on_wall = |crossing: &Crossing| self.holds(ray, &along, crossing);
        [Some(first), second].into_iter().flatten().filter(on_wall).for_each(visit);
    }

    #[inline(always)]
    pub(super) fn first_crossing(
        &self,
        ray: &Ray,
        start: RayStart,
        wanted: &CrossingQuery,
    ) -> Option<Crossing> {
        let (along, first, second) = self.roots(ray, start)?;
        if wanted.includes(&first) && self.holds(ray, &along, &first) {
            return Some(first);
        }
        let second = second?;
        (wanted.includes(&second) && self.holds(ray, &along, &second)).then_some(second)
    }

    /// Where the line of a ray crosses the infinite cylinder, in ascending order; for a ray that
    /// starts on the wall the second is omitted, since it is the start.
    #[inline(always)]
    fn roots(&self, ray: &Ray, start: RayStart) -> Option<(AxialRay, Crossing, Option<Crossing>)> {
        let axis = self.frame.z;
        let from = ray.origin() - self.frame.origin;
        let along = AxialRay { origin: from.dot(axis), dir: ray.dir().dot(axis) };
        // Perpendicular parts as vectors: 1 - (d·a)² would lose the digits of rays nearly along the axis.
        let across_origin = from - along.origin * axis;
        let across_dir = ray.dir() - along.dir * axis;
        let a = across_dir.length_squared();
        if a == 0.0 {
            return None;
        }
        let half_b = across_origin.dot(across_dir);
        match start {
            // On the wall c = 0, so the other root is -2b/a, whatever the angle.
            RayStart::On => {
                let t = -2.0 * half_b / a;
                // The further root leaves the cylinder, the nearer one enters it.
                let toward = if t > 0.0 { self.leaving } else { self.leaving.opposite() };
                Some((along, Crossing { t, toward }, None))
            }
            RayStart::Elsewhere => {
                let c = across_origin.length_squared() - self.radius * self.radius;
                let [enter, leave] = quadratic(a, half_b, c)?;
                let enter = Crossing { t: enter, toward: self.leaving.opposite() };
                Some((along, enter, Some(Crossing { t: leave, toward: self.leaving })))
            }
        }
    }

    /// Whether a point of the infinite cylinder belongs to this wall.
    #[inline(always)]
    fn holds(&self, ray: &Ray, along: &AxialRay, crossing: &Crossing) -> bool {
        let z = along.origin + crossing.t * along.dir;
        z >= self.z_min && z <= self.z_max && self.keeps(ray, crossing.t)
    }

    /// Whether the point of the wall at distance `t` meets the further conditions.
    #[inline(always)]
    fn keeps(&self, ray: &Ray, t: f64) -> bool {
        self.trims.as_ref().is_none_or(|trims| {
            let p = ray.at(t);
            trims.wedge.is_none_or(|wedge| wedge.contains(self.across(p)))
                && trims.cuts.iter().all(|cut| cut.contains(p))
        })
    }

    /// The frame's x and y of a point.
    #[inline]
    fn across(&self, p: DVec3) -> DVec2 {
        let from = p - self.frame.origin;
        DVec2::new(from.dot(self.frame.x), from.dot(self.frame.y))
    }

    /// Unit vector of the axis.
    pub(super) fn axis(&self) -> DVec3 {
        self.frame.z
    }

    #[inline(always)]
    pub(super) fn normal(&self, p: DVec3) -> DVec3 {
        let from = p - self.frame.origin;
        let sign = match self.leaving {
            Toward::Front => 1.0,
            Toward::Back => -1.0,
        };
        let across = from - from.dot(self.frame.z) * self.frame.z;
        // Far along the axis rounding leaves some of it, which would turn paths a little at every bounce.
        let across = across - across.dot(self.frame.z) * self.frame.z;
        unit((sign / self.radius) * across)
    }

    pub(super) fn area(&self) -> f64 {
        self.area_in(self.chart_bounds())
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let (azimuth, [low, high]) = if self.cuts().is_empty() {
            (u[0] * turn(self.wedge()), [self.z_min, self.z_max])
        } else {
            self.sample_cut(u[0])
        };
        point_on_circle(&self.frame, self.radius, azimuth, low + u[1] * (high - low))
    }

    /// The azimuth with the share `u` of the area below it, and the limits of z there.
    fn sample_cut(&self, u: f64) -> (f64, [f64; 2]) {
        let strips = self.strips(self.chart_bounds());
        let mut target = u * strips.iter().map(Strip::area).sum::<f64>();
        for strip in &strips {
            if target <= strip.area() {
                let azimuth = strip.azimuth_of_share(target / strip.area());
                return (azimuth, strip.heights(azimuth));
            }
            target -= strip.area();
        }
        // Rounding of the sum, or nothing left by the cuts: use the end of the wall.
        let last = turn(self.wedge());
        (last, strips.last().map_or([self.z_min; 2], |strip| strip.heights(last)))
    }

    /// The point with these unrolled coordinates on the whole wall, mm: the inverse of
    /// [`Self::chart`].
    pub(in crate::scene) fn unrolled(&self, at: DVec2) -> DVec3 {
        let across = DVec2::from_angle(at.x / self.radius) * self.radius;
        self.frame.point_to_world(across.extend(at.y))
    }

    pub(super) fn chart(&self, p: DVec3) -> DVec2 {
        let across = self.across(p);
        let azimuth = self.wedge().map_or_else(|| azimuth(across), |wedge| wedge.azimuth(across));
        DVec2::new(self.radius * azimuth, (p - self.frame.origin).dot(self.frame.z))
    }

    pub(super) fn chart_bounds(&self) -> ChartRect {
        ChartRect {
            min: DVec2::new(0.0, self.z_min),
            max: DVec2::new(self.radius * turn(self.wedge()), self.z_max),
        }
    }

    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        let rect = rect.intersection(&self.chart_bounds());
        if rect.is_empty() {
            return 0.0;
        }
        if self.cuts().is_empty() {
            return rect.area();
        }
        self.radius * self.strips(rect).iter().map(Strip::area).sum::<f64>()
    }

    fn strips(&self, rect: ChartRect) -> Vec<Strip> {
        UnrolledWall::new(&self.frame, self.radius, [rect.min.y, rect.max.y], self.cuts())
            .strips(rect.min.x / self.radius, rect.max.x / self.radius)
    }

    fn wedge(&self) -> Option<&Wedge> {
        self.trims.as_ref().and_then(|trims| trims.wedge.as_ref())
    }

    fn cuts(&self) -> &[HalfSpace] {
        self.trims.as_ref().map_or(&[], |trims| &trims.cuts)
    }
}

#[cfg(test)]
mod tests;
