//! Plain legs: parts of a straight wall within which a path meets nothing but that wall, and the elements of patterns on it if it
//! is round. A row of mirror bounces has a closed form there in round and rectangular walls; in other polygons the motion
//! across the axis is followed from side to side.
//!
//! This module computes where such a row ends. It does not know what the wall does to light, nor how legs are found.

mod polygon;
mod reach;
mod row;
mod section;

pub(in crate::scene) use crate::scene::plain_leg::polygon::{LegSide, MOST_SIDES};
use crate::scene::plain_leg::reach::PathInLeg;
pub use crate::scene::plain_leg::reach::RowReach;
pub(in crate::scene) use crate::scene::plain_leg::row::ElementBand;
use crate::scene::plain_leg::row::RowInLeg;
pub(crate) use crate::scene::plain_leg::row::{AnglesOfRow, MetWall};
pub(in crate::scene) use crate::scene::plain_leg::section::LegSection;
use crate::scene::{PrimId, Ray};
use glam::DVec3;
use lumiduct_base::math::Frame;
use smallvec::{SmallVec, smallvec};

/// The plain parts within a straight wall.
#[derive(Debug, Clone)]
pub(crate) struct PlainLeg {
    /// z is the axis.
    pub(super) frame: Frame,
    pub(super) section: LegSection,
    /// Whether its walls belong to one face.
    pub(super) is_one_face: bool,
    /// Where along the axis nothing else is, mm.
    pub(super) spans: SmallVec<[[f64; 2]; 1]>,
}

/// A row of mirror bounces on a plain leg.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BounceRow {
    /// Their number.
    pub(crate) count: u32,
    /// The wall of the last.
    pub(crate) last: PrimId,
    /// Distance along the path, mm.
    pub(crate) length: f64,
    /// Distance from each bounce to the next, mm, if it is the same for all: on a round wall.
    pub(crate) chord: Option<f64>,
    /// Share of the light that the walls mirror, 1.
    pub(crate) reflected: f64,
    /// The path after the last.
    pub(crate) ray: Ray,
}

impl PlainLeg {
    /// How far a row of at most `most` bounces may go from a path that has just been mirrored by a wall; `None` if that is not
    /// on a plain part.
    #[inline]
    pub(crate) fn reach(&self, ray: &Ray, (wall, most): (PrimId, u32)) -> Option<RowReach> {
        let at = self.frame.point_to_local(ray.origin());
        let dir = self.frame.to_local(ray.dir());
        let &[low, high] = self.spans.iter().find(|[low, high]| at.z >= *low && at.z <= *high)?;
        let left = if dir.z < 0.0 { at.z - low } else { high - at.z };
        let is_one_face = self.is_one_face;
        Some(RowReach { wall, is_one_face, path: PathInLeg { at, dir }, left, most })
    }

    /// The row of bounces within a reach; `share_of` gives the share of light that a wall mirrors, or `None` where no row may
    /// meet it. `absorb` takes what each flat wall absorbs of the light at the start of the row, where nothing else absorbs.
    #[inline]
    pub(crate) fn row(
        &self,
        reach: &RowReach,
        mut share_of: impl FnMut(&MetWall) -> Option<f64>,
        absorb: impl FnMut(PrimId, f64),
    ) -> Option<BounceRow> {
        let in_scene =
            |met: &MetWall| share_of(&MetWall { dir: self.frame.to_world(met.dir), ..*met });
        let RowInLeg { count, last, length, chord, reflected, end } =
            self.section.row(reach, in_scene, absorb)?;
        let ray = Ray::new(self.frame.point_to_world(end.at), self.frame.to_world(end.dir));
        Some(BounceRow { count, last, length, chord, reflected, ray })
    }

    /// All pieces of its wall.
    pub(crate) fn walls(&self) -> SmallVec<[PrimId; 4]> {
        match &self.section {
            LegSection::Round { wall, .. } => smallvec![*wall],
            LegSection::Rectangle { walls, .. } => SmallVec::from(*walls),
            LegSection::Polygon { sides, .. } => sides.iter().map(|side| side.wall).collect(),
        }
    }

    /// Position of a point along the axis, mm.
    pub(crate) fn along(&self, point: DVec3) -> f64 {
        (point - self.frame.origin).dot(self.frame.z)
    }

    /// Unit vector of the axis.
    pub(crate) fn axis(&self) -> DVec3 {
        self.frame.z
    }
}
