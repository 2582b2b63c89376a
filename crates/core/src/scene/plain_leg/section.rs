//! The cross-section of a plain leg, and the row of bounces within it.

use crate::scene::PrimId;
use crate::scene::plain_leg::polygon::{self, LegSide};
use crate::scene::plain_leg::reach::RowReach;
use crate::scene::plain_leg::row::{ElementBand, MetWall, RowInLeg, rectangle, round};
use glam::DVec2;

/// The cross-section of a wall about the origin, and its pieces.
#[derive(Debug, Clone)]
pub(in crate::scene) enum LegSection {
    /// A circle, and the parts of its wall where the elements of patterns are.
    Round { radius: f64, wall: PrimId, elements: Box<[ElementBand]> },
    /// A rectangle: half of its size, and its walls at -x, +x, -y and +y.
    Rectangle { half: DVec2, walls: [PrimId; 4] },
    /// Another convex polygon about the origin: the radius of a circle around it, and its sides.
    Polygon { radius: f64, sides: Box<[LegSide]> },
}

impl LegSection {
    /// The row of bounces within a reach; `share_of` gives the share of light that a wall mirrors, or `None` where no row may
    /// meet it. `absorb` takes what each flat wall absorbs of the light at the start of the row, where nothing else absorbs.
    #[inline]
    pub(super) fn row(
        &self,
        reach: &RowReach,
        share_of: impl FnMut(&MetWall) -> Option<f64>,
        absorb: impl FnMut(PrimId, f64),
    ) -> Option<RowInLeg> {
        match self {
            Self::Round { radius: _, wall: _, elements } => round(elements, reach, share_of),
            Self::Rectangle { half, walls } => rectangle((*half, walls), reach, share_of, absorb),
            Self::Polygon { radius, sides } => {
                polygon::row((*radius, sides), reach, share_of, absorb)
            }
        }
    }
}
