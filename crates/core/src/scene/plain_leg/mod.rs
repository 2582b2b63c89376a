//! Plain legs: parts of straight round or rectangular walls between which a path meets nothing but the wall, so that a
//! row of mirror bounces there is known in closed form.
//!
//! This module knows where a row ends; not what the wall does to light, nor how legs are found.

mod row;

pub(in crate::scene) use crate::scene::plain_leg::row::LegSection;
use crate::scene::plain_leg::row::{PathInLeg, RowInLeg};
use crate::scene::{PrimId, Ray};
use lumiduct_base::math::Frame;
use smallvec::SmallVec;

/// The plain parts within a straight round or rectangular wall.
#[derive(Debug, Clone)]
pub(crate) struct PlainLeg {
    /// z is the axis.
    pub(super) frame: Frame,
    pub(super) section: LegSection,
    /// Where along the axis nothing else is, mm.
    pub(super) spans: SmallVec<[[f64; 2]; 1]>,
}

/// A row of mirror bounces on a plain leg.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BounceRow {
    /// Bounces by wall.
    pub(crate) bounces: SmallVec<[(PrimId, u32); 4]>,
    /// The wall of the last.
    pub(crate) last: PrimId,
    /// Distance along the path, mm.
    pub(crate) length: f64,
    /// The path after the last.
    pub(crate) ray: Ray,
}

impl PlainLeg {
    /// The row of bounces of a path that has just been mirrored by a wall, as far as it is plain, `most` at most.
    pub(crate) fn row(&self, ray: &Ray, (wall, most): (PrimId, u32)) -> Option<BounceRow> {
        let at = self.frame.point_to_local(ray.origin());
        let dir = self.frame.to_local(ray.dir());
        let &[low, high] = self.spans.iter().find(|[low, high]| at.z >= *low && at.z <= *high)?;
        let left = if dir.z < 0.0 { at.z - low } else { high - at.z };
        let RowInLeg { bounces, last, length, end } =
            self.section.row(PathInLeg { at, dir }, left, (wall, most))?;
        let ray = Ray::new(self.frame.point_to_world(end.at), self.frame.to_world(end.dir));
        Some(BounceRow { bounces, last, length, ray })
    }
}
