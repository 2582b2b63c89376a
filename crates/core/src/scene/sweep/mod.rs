//! A cross-section carried along straight legs, bends and corners: the exact surfaces of rods, tubes and ducts.
//!
//! Every piece is a quadric, a torus or a plane, never an approximation: a circle sweeps cylinders, cones and tori; an
//! edge of a polygon sweeps planes, and about a bend axis in its own plane a cylinder, a cone or a plane again. A sweep
//! knows geometry only: whether it is a solid (parts and ports are its faces) or a hollow duct (the parts alone) and
//! what its faces do to light is decided elsewhere.

mod chart;
mod check;
mod faceted;
mod leg;
mod path;
mod prisms;
mod profile;
mod round;
mod smooth;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
mod volume;

pub use leg::{CornerKind, Leg, SweepError, SweepProblem};
pub use prisms::{OutlineError, PrismNumber, Prisms};
pub use profile::{Profile, ProfileError};

use crate::scene::shape::{ChartRect, Flat, Region, Shape};
pub use chart::{Sector, Sense, Trapezoid, WallChart};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;

/// The surfaces of a swept profile.
#[derive(Debug, Clone)]
pub struct Sweep {
    /// The walls, from the entry to the exit; every front is outside.
    pub parts: Vec<Part>,
    /// The cross-sections at the entry and at the exit.
    pub ports: [Port; 2],
    /// Length of the path, mm; through a corner, the way to the point where the centre lines meet and on from there.
    pub length: f64,
    /// Length of the profile's outline at the entry, mm.
    pub perimeter: f64,
    /// Volume that is enclosed, mm³.
    pub volume: f64,
}

/// A wall of one piece of the path.
#[derive(Debug, Clone)]
pub struct Part {
    /// The surface; its front is outside.
    pub shape: Shape,
    /// Which wall of the sweep it belongs to.
    pub wall: Wall,
    /// Parts that continue each other without an edge have the same number.
    pub smooth: u32,
    /// Leads from the chart of the shape to that of the sweep.
    pub chart: WallChart,
}

/// A wall of a sweep, as faces are named by it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Wall {
    /// The one wall of a circle.
    Round,
    /// The wall on the edge of the polygon with this number.
    Edge(usize),
    /// The mirror plate across a corner.
    Mitre,
}

/// An end of a sweep.
#[derive(Debug, Clone)]
pub struct Port {
    /// The origin is on the path, z points out of the sweep.
    pub frame: Frame,
    /// The cross-section; its front is outside.
    pub shape: Shape,
}

/// Carries `profile` along `legs`, starting in `frame` toward its z with the profile's x and y along the frame's.
///
/// The frame goes along by rotation about the bend axes only, so that `toward` of each leg refers to the section as it
/// arrives there.
pub fn sweep(frame: Frame, profile: &Profile, legs: &[Leg]) -> Result<Sweep, SweepError> {
    let path = path::trace(frame, profile, legs)?;
    check::check(profile, &path)?;
    let parts = match profile {
        Profile::Circle { radius } => round::parts(*radius, &path),
        Profile::Polygon { points } => faceted::parts(points, &path),
    };
    let [_, mirrored] = profile.regions(1.0);
    let [at_exit, _] = profile.regions(path.exit.scale);
    // The entry looks back along the path: turned by half a turn about x.
    let entry = Frame { y: -frame.y, z: -frame.z, ..frame };
    Ok(Sweep {
        parts,
        ports: [port(entry, mirrored), port(path.exit.frame, at_exit)],
        length: path.exit.along,
        perimeter: profile.perimeter(),
        volume: volume::volume(profile, &path),
    })
}

fn port(frame: Frame, region: Region) -> Port {
    Port { frame, shape: Shape::Flat(Flat::new(frame, region)) }
}

impl Sweep {
    /// The rectangle that [`Part::chart`] covers, mm: once around the profile at the entry, and along the path.
    pub fn chart_bounds(&self) -> ChartRect {
        ChartRect { min: DVec2::ZERO, max: DVec2::new(self.perimeter, self.length) }
    }

    /// Area of all walls, without the ports, mm².
    pub fn wall_area(&self) -> f64 {
        self.parts.iter().map(|part| part.shape.area()).sum()
    }
}

impl Part {
    /// A piece of a mitre plate.
    fn mitre(shape: Shape, smooth: u32) -> Self {
        let chart = WallChart::Along { offset: DVec2::ZERO, scale: DVec2::ONE };
        Self { shape, wall: Wall::Mitre, smooth, chart }
    }

    /// The same wall seen from the other side: that of a bore, whose front is toward the path. `None` for walls of other
    /// legs than straight ones.
    pub fn turned(&self) -> Option<Self> {
        let turned = |shape, scale: DVec2| match self.chart {
            WallChart::Along { offset, scale: before } => {
                let chart = WallChart::Along { offset, scale: scale * before };
                Some(Self { shape, chart, ..self.clone() })
            }
            WallChart::Across { .. } | WallChart::Trapezoid { .. } | WallChart::Sector { .. } => {
                None
            }
        };
        match &self.shape {
            Shape::Cylinder(wall) => turned(Shape::Cylinder(wall.clone().inward()), DVec2::ONE),
            // Rectangles are the same seen from behind.
            Shape::Flat(wall) if matches!(wall.region(), Region::Rectangle { .. }) => {
                let frame = *wall.frame();
                let behind = Frame { x: -frame.x, z: -frame.z, ..frame };
                let flat = Flat::new(behind, wall.region().clone());
                turned(Shape::Flat(flat), DVec2::new(-1.0, 1.0))
            }
            Shape::Flat(_)
            | Shape::Cone(_)
            | Shape::Torus(_)
            | Shape::Sphere(_)
            | Shape::Paraboloid(_)
            | Shape::ParabolicCylinder(_)
            | Shape::CompoundParabola(_) => None,
        }
    }

    /// Unrolled coordinates of a point of the part in the chart of the whole sweep, mm: u around the profile, in
    /// lengths of the profile at the entry, from the azimuth 0 of a circle or point 0 of a polygon; v along the path.
    /// A taper stretches the chart, and the walls outside of a bend are longer than their share of v.
    ///
    /// A mitre plate is no part of that chart: it has coordinates of its own, from its centre, v along the bend axis.
    pub fn chart(&self, p: DVec3) -> DVec2 {
        self.chart.of(self.shape.chart(p))
    }

    /// Area of the part whose [`Self::chart`] lies in `rect`, mm².
    pub fn area_in(&self, rect: ChartRect) -> f64 {
        self.chart.area_in(&self.shape, rect)
    }
}
