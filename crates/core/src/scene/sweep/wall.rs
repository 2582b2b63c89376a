//! The walls of a sweep: one surface of each piece of the path.

use crate::scene::shape::{Flat, Region, Shape};
use crate::scene::sweep::chart::WallChart;
use glam::DVec2;
use lumiduct_base::math::Frame;

/// A wall of one piece of the path.
#[derive(Debug, Clone)]
pub struct WallPart {
    /// The surface; its front is outside.
    pub shape: Shape,
    /// The wall of the sweep that it belongs to.
    pub wall: Wall,
    /// Parts that continue each other without an edge have the same number.
    pub smooth: u32,
    /// Maps the chart of the shape to that of the sweep, mm: u around the profile, in lengths of the profile at the
    /// entry, from the azimuth 0 of a circle or point 0 of a polygon; v along the path. A taper stretches the chart, and
    /// the walls outside of a bend are longer than their share of v. A mitre plate is not part of that chart: its own
    /// coordinates start at its centre, with v along the bend axis.
    pub chart: WallChart,
}

/// A wall of a sweep, which gives its face a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Wall {
    /// The one wall of a circle.
    Round,
    /// The wall on the edge of the polygon with this number.
    Edge(usize),
    /// The mirror plate across a corner.
    Mitre,
}

impl WallPart {
    /// A piece of a mitre plate.
    pub(super) fn mitre(shape: Shape, smooth: u32) -> Self {
        let chart = WallChart::Along { offset: DVec2::ZERO, scale: DVec2::ONE };
        Self { shape, wall: Wall::Mitre, smooth, chart }
    }

    /// The same wall seen from the other side: that of a bore, with its front toward the path.
    /// `None` except for walls of straight legs.
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
        if let Some(wall) = self.shape.as_cylinder() {
            return turned(Shape::Cylinder(wall.clone().inward()), DVec2::ONE);
        }
        // Rectangles are the same seen from behind.
        let wall = self.shape.as_flat()?;
        if !matches!(wall.region(), Region::Rectangle { .. }) {
            return None;
        }
        let frame = *wall.frame();
        let behind = Frame { x: -frame.x, z: -frame.z, ..frame };
        let flat = Flat::new(behind, wall.region().clone());
        turned(Shape::Flat(flat), DVec2::new(-1.0, 1.0))
    }
}
