//! How far a row of mirror bounces may go.

use crate::scene::PrimId;
use glam::DVec3;

/// Least bounces of a row: a single one is as quick step by step.
pub(super) const LEAST: f64 = 2.0;

/// The path within a leg: position, mm, and unit direction, in the frame of the leg.
#[derive(Debug, Clone, Copy)]
pub(super) struct PathInLeg {
    pub(super) at: DVec3,
    pub(super) dir: DVec3,
}

/// The reach of a row of mirror bounces: to the end of the plain part of its leg, or less if an observer shortens it.
#[derive(Debug, Clone, Copy)]
pub struct RowReach {
    /// The wall of the last bounce.
    pub(crate) wall: PrimId,
    /// Whether all walls of the leg belong to one face.
    pub(crate) is_one_face: bool,
    pub(super) path: PathInLeg,
    /// Distance along the axis, mm.
    pub(super) left: f64,
    /// Most bounces.
    pub(super) most: u32,
}

impl RowReach {
    /// Cosine of the angle between the path and the axis of the leg, the same all along a row.
    pub(crate) fn axial(&self) -> f64 {
        self.path.dir.z
    }

    /// Ends the row before it enters a part of the leg, from low to high along the axis, mm. A row that starts within that part
    /// has no length.
    pub(crate) fn end_before(&mut self, [low, high]: [f64; 2]) {
        let at = self.path.at.z;
        let [ahead, beyond] =
            if self.path.dir.z < 0.0 { [at - high, low - at] } else { [low - at, at - high] };
        if low <= high && beyond <= 0.0 {
            self.left = self.left.min(ahead.max(0.0));
        }
    }

    /// Ends the row after this many bounces.
    pub(crate) fn end_after(&mut self, bounces: u32) {
        self.most = self.most.min(bounces);
    }

    /// Whether there is no row of this reach.
    pub(crate) fn is_too_short(&self) -> bool {
        self.left <= 0.0 || f64::from(self.most) < LEAST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reach(at: f64, axial: f64) -> RowReach {
        let path = PathInLeg { at: DVec3::new(1.0, 0.0, at), dir: DVec3::new(-0.8, 0.0, axial) };
        RowReach { wall: PrimId::new(0), is_one_face: true, path, left: 100.0, most: 50 }
    }

    #[test]
    fn a_row_ends_before_a_part_that_lies_ahead() {
        let left = |at, axial, part| {
            let mut reach = reach(at, axial);
            reach.end_before(part);
            reach.left
        };
        assert_eq!(left(0.0, 0.6, [20.0, 30.0]), 20.0);
        assert_eq!(left(50.0, -0.6, [20.0, 30.0]), 20.0);
        assert_eq!(left(25.0, 0.6, [20.0, 30.0]), 0.0, "within");
        assert_eq!(left(40.0, 0.6, [20.0, 30.0]), 100.0, "behind");
        assert_eq!(left(0.0, -0.6, [20.0, 30.0]), 100.0, "behind");
        assert_eq!(left(0.0, 0.6, [f64::INFINITY, f64::NEG_INFINITY]), 100.0, "nowhere");
    }

    #[test]
    fn a_reach_without_bounces_or_way_has_no_row() {
        assert!(!reach(0.0, 0.6).is_too_short());
        let mut few = reach(0.0, 0.6);
        few.end_after(1);
        assert!(few.is_too_short());
        let mut within = reach(25.0, 0.6);
        within.end_before([20.0, 30.0]);
        assert!(within.is_too_short());
    }
}
