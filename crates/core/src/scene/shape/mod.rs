//! Analytic surfaces in f64, one file each.
//!
//! A shape is a trimmed, oriented surface: its normal is the *front*. A shape knows where a ray
//! crosses it, but not finishes, solids or photons. There are no epsilons: for a ray that starts on
//! a quadric ([`RayStart::On`]) the root at the start is removed from the equation, not compared with
//! a small number.
//!
//! Every shape has a chart: it unrolls the surface into a rectangle of millimetres, for flux maps on curved walls.

mod chart;
mod compound_parabola;
mod cone;
mod crossing;
mod cylinder;
mod flat;
mod parabolic_cylinder;
mod paraboloid;
mod sphere;
mod support;
#[cfg(test)]
mod testing;
mod torus;
mod wedge;

pub use chart::ChartRect;
pub use compound_parabola::CompoundParabola;
pub use cone::Cone;
pub(crate) use crossing::CrossingQuery;
pub use crossing::{Crossing, RayStart, Toward};
pub use cylinder::Cylinder;
pub use flat::{Flat, Polygon, Region};
pub use parabolic_cylinder::ParabolicCylinder;
pub use paraboloid::Paraboloid;
pub use sphere::Sphere;
pub use torus::Torus;

use crate::scene::Ray;
use glam::{DVec2, DVec3};
use lumiduct_base::math::Aabb;

/// The points on one side of a plane: `normal · p <= offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HalfSpace {
    /// Unit normal, out of the half space.
    pub normal: DVec3,
    /// Distance of the plane from the origin along the normal, mm.
    pub offset: f64,
}

impl HalfSpace {
    /// The half space behind the plane through `point` with `normal`.
    pub(crate) fn behind(point: DVec3, normal: DVec3) -> Self {
        let normal = normal.normalize();
        Self { normal, offset: point.dot(normal) }
    }

    /// Whether a point is inside or on the plane.
    #[inline]
    pub(crate) fn contains(&self, p: DVec3) -> bool {
        self.normal.dot(p) <= self.offset
    }
}

/// A trimmed, oriented analytic surface. A separate tag, rather than one hidden in a field, is the
/// fastest to read.
#[derive(Debug, Clone)]
#[repr(u8)]
pub enum Shape {
    /// A piece of a plane: disk, ring, sector, ellipse, rectangle or polygon.
    Flat(Flat),
    /// A piece of a circular cylinder's wall.
    Cylinder(Cylinder),
    /// A piece of a cone frustum's wall.
    Cone(Cone),
    /// The wall of a bent round tube.
    Torus(Torus),
    /// A zone of a sphere.
    Sphere(Sphere),
    /// A zone of a paraboloid of revolution.
    Paraboloid(Paraboloid),
    /// A piece of a parabolic trough.
    ParabolicCylinder(ParabolicCylinder),
    /// The wall of a compound parabolic concentrator.
    CompoundParabola(CompoundParabola),
}

impl Shape {
    /// The shape as a flat one; `None` for all others.
    pub fn as_flat(&self) -> Option<&Flat> {
        match self {
            Self::Flat(flat) => Some(flat),
            Self::Cylinder(_)
            | Self::Cone(_)
            | Self::Torus(_)
            | Self::Sphere(_)
            | Self::Paraboloid(_)
            | Self::ParabolicCylinder(_)
            | Self::CompoundParabola(_) => None,
        }
    }

    /// The shape as a cylinder; `None` for all others.
    pub fn as_cylinder(&self) -> Option<&Cylinder> {
        match self {
            Self::Cylinder(cylinder) => Some(cylinder),
            Self::Flat(_)
            | Self::Cone(_)
            | Self::Torus(_)
            | Self::Sphere(_)
            | Self::Paraboloid(_)
            | Self::ParabolicCylinder(_)
            | Self::CompoundParabola(_) => None,
        }
    }

    /// A box around the shape, mm.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Flat(shape) => shape.bounds(),
            Self::Cylinder(shape) => shape.bounds(),
            Self::Cone(shape) => shape.bounds(),
            Self::Torus(shape) => shape.bounds(),
            Self::Sphere(shape) => shape.bounds(),
            Self::Paraboloid(shape) => shape.bounds(),
            Self::ParabolicCylinder(shape) => shape.bounds(),
            Self::CompoundParabola(shape) => shape.bounds(),
        }
    }

    /// Calls `visit` for every crossing of the ray's whole line with the surface, in any order.
    #[inline]
    pub fn crossings(&self, ray: &Ray, start: RayStart, visit: impl FnMut(Crossing)) {
        match self {
            Self::Flat(shape) => shape.crossings(ray, start, visit),
            Self::Cylinder(shape) => shape.crossings(ray, start, visit),
            Self::Cone(shape) => shape.crossings(ray, start, visit),
            Self::Torus(shape) => shape.crossings(ray, start, visit),
            Self::Sphere(shape) => shape.crossings(ray, start, visit),
            Self::Paraboloid(shape) => shape.crossings(ray, start, visit),
            Self::ParabolicCylinder(shape) => shape.crossings(ray, start, visit),
            Self::CompoundParabola(shape) => shape.crossings(ray, start, visit),
        }
    }

    /// The first crossing of the ray's line that is `wanted`. Planes and cylinders, which are most
    /// of all surfaces, and tori compute it faster than a list of all crossings.
    #[inline(always)]
    pub(crate) fn first_crossing(
        &self,
        ray: &Ray,
        start: RayStart,
        wanted: &CrossingQuery,
    ) -> Option<Crossing> {
        match self {
            Self::Flat(shape) => shape.first_crossing(ray, start, wanted),
            Self::Cylinder(shape) => shape.first_crossing(ray, start, wanted),
            Self::Torus(shape) => shape.first_crossing(&ray.lent(), start, wanted),
            Self::Cone(_)
            | Self::Sphere(_)
            | Self::Paraboloid(_)
            | Self::ParabolicCylinder(_)
            | Self::CompoundParabola(_) => self.first_of_all(&ray.lent(), start, wanted),
        }
    }

    #[inline(never)]
    fn first_of_all(&self, ray: &Ray, start: RayStart, wanted: &CrossingQuery) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        self.crossings(ray, start, |crossing| {
            if wanted.includes(&crossing) && first.is_none_or(|first| crossing.t < first.t) {
                first = Some(crossing);
            }
        });
        first
    }

    /// Unit normal of the front at a point of the surface.
    pub(crate) fn normal(&self, p: DVec3) -> DVec3 {
        match self {
            Self::Flat(shape) => shape.normal(),
            Self::Cylinder(shape) => shape.normal(p),
            Self::Cone(shape) => shape.normal(p),
            Self::Torus(shape) => shape.normal(p),
            Self::Sphere(shape) => shape.normal(p),
            Self::Paraboloid(shape) => shape.normal(p),
            Self::ParabolicCylinder(shape) => shape.normal(p),
            Self::CompoundParabola(shape) => shape.normal(p),
        }
    }

    /// Unit normal on the side from which a ray comes that crosses `toward`. Planes and cylinders
    /// return it in registers; a factor in every arm prevents a normal returned in memory from
    /// spoiling that.
    #[inline(always)]
    pub(crate) fn normal_against(&self, toward: Toward, p: DVec3) -> DVec3 {
        let sign = match toward {
            Toward::Front => -1.0,
            Toward::Back => 1.0,
        };
        match self {
            Self::Flat(shape) => sign * shape.normal(),
            Self::Cylinder(shape) => sign * shape.normal(p),
            Self::Cone(_)
            | Self::Torus(_)
            | Self::Sphere(_)
            | Self::Paraboloid(_)
            | Self::ParabolicCylinder(_)
            | Self::CompoundParabola(_) => sign * self.normal(p),
        }
    }

    /// Unit tangent at a point of the surface along which v of the chart grows at constant u.
    pub(crate) fn along(&self, p: DVec3) -> DVec3 {
        match self {
            Self::Flat(shape) => shape.frame().y,
            Self::ParabolicCylinder(shape) => shape.along(),
            Self::Torus(shape) => shape.along(p),
            Self::Cylinder(shape) => shape.axis(),
            Self::Cone(shape) => up_the_meridian(shape.axis(), shape.normal(p)),
            Self::Sphere(shape) => up_the_meridian(shape.axis(), shape.normal(p)),
            Self::Paraboloid(shape) => up_the_meridian(shape.axis(), shape.normal(p)),
            Self::CompoundParabola(shape) => up_the_meridian(shape.axis(), shape.normal(p)),
        }
    }

    /// Area, mm².
    pub fn area(&self) -> f64 {
        match self {
            Self::Flat(shape) => shape.area(),
            Self::Cylinder(shape) => shape.area(),
            Self::Cone(shape) => shape.area(),
            Self::Torus(shape) => shape.area(),
            Self::Sphere(shape) => shape.area(),
            Self::Paraboloid(shape) => shape.area(),
            Self::ParabolicCylinder(shape) => shape.area(),
            Self::CompoundParabola(shape) => shape.area(),
        }
    }

    /// A point of the surface, uniform over its area for uniform `u`.
    pub(crate) fn sample(&self, u: [f64; 2]) -> DVec3 {
        match self {
            Self::Flat(shape) => shape.sample(u),
            Self::Cylinder(shape) => shape.sample(u),
            Self::Cone(shape) => shape.sample(u),
            Self::Torus(shape) => shape.sample(u),
            Self::Sphere(shape) => shape.sample(u),
            Self::Paraboloid(shape) => shape.sample(u),
            Self::ParabolicCylinder(shape) => shape.sample(u),
            Self::CompoundParabola(shape) => shape.sample(u),
        }
    }

    /// Unrolled coordinates (u, v) of a point of the surface, mm.
    pub(crate) fn chart(&self, p: DVec3) -> DVec2 {
        match self {
            Self::Flat(shape) => shape.chart(p),
            Self::Cylinder(shape) => shape.chart(p),
            Self::Cone(shape) => shape.chart(p),
            Self::Torus(shape) => shape.chart(p),
            Self::Sphere(shape) => shape.chart(p),
            Self::Paraboloid(shape) => shape.chart(p),
            Self::ParabolicCylinder(shape) => shape.chart(p),
            Self::CompoundParabola(shape) => shape.chart(p),
        }
    }

    /// The rectangle that the chart covers, mm.
    pub fn chart_bounds(&self) -> ChartRect {
        match self {
            Self::Flat(shape) => shape.chart_bounds(),
            Self::Cylinder(shape) => shape.chart_bounds(),
            Self::Cone(shape) => shape.chart_bounds(),
            Self::Torus(shape) => shape.chart_bounds(),
            Self::Sphere(shape) => shape.chart_bounds(),
            Self::Paraboloid(shape) => shape.chart_bounds(),
            Self::ParabolicCylinder(shape) => shape.chart_bounds(),
            Self::CompoundParabola(shape) => shape.chart_bounds(),
        }
    }

    /// Area of the surface whose chart lies in `rect`, mm².
    pub(crate) fn area_in(&self, rect: ChartRect) -> f64 {
        match self {
            Self::Flat(shape) => shape.area_in(rect),
            Self::Cylinder(shape) => shape.area_in(rect),
            Self::Cone(shape) => shape.area_in(rect),
            Self::Torus(shape) => shape.area_in(rect),
            Self::Sphere(shape) => shape.area_in(rect),
            Self::Paraboloid(shape) => shape.area_in(rect),
            Self::ParabolicCylinder(shape) => shape.area_in(rect),
            Self::CompoundParabola(shape) => shape.area_in(rect),
        }
    }

    /// Area in `rect` that the chart fills, mm²: that of the surface, unless the chart stretches it. Charts that stretch fill
    /// their rectangle.
    pub(crate) fn charted_in(&self, rect: ChartRect) -> f64 {
        match self {
            Self::Flat(_) | Self::Cylinder(_) | Self::Sphere(_) | Self::ParabolicCylinder(_) => {
                self.area_in(rect)
            }
            Self::Cone(_) | Self::Torus(_) | Self::Paraboloid(_) | Self::CompoundParabola(_) => {
                rect.intersection(&self.chart_bounds()).area()
            }
        }
    }
}

/// The unit tangent toward larger z of a surface of revolution; any direction perpendicular to the
/// normal where that is along the axis.
fn up_the_meridian(axis: DVec3, normal: DVec3) -> DVec3 {
    (axis - axis.dot(normal) * normal)
        .try_normalize()
        .unwrap_or_else(|| normal.any_orthonormal_vector())
}
