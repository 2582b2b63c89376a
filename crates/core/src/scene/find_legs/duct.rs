//! Four flat walls that form a straight rectangular duct, or the sides of a box.

use crate::scene::plain_leg::LegSection;
use crate::scene::shape::Region;
use crate::scene::{FaceId, Owner, Patch, PlainLeg, PrimId, Scene};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;
use smallvec::SmallVec;

/// Relative difference up to which lengths and directions are the same, 1.
pub(super) const SAME: f64 = 1e-12;

/// A rectangular wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct FlatWall {
    pub(super) prim: PrimId,
    pub(super) face: FaceId,
    pub(super) middle: DVec3,
    pub(super) normal: DVec3,
    /// Half of its sides as vectors, mm.
    pub(super) sides: [DVec3; 2],
}

impl FlatWall {
    pub(super) fn of(prim: PrimId, patch: &Patch) -> Option<Self> {
        let flat = patch.shape.as_flat()?;
        let Region::Rectangle { half_x, half_y } = flat.region() else { return None };
        let Frame { origin, x, y, z } = *flat.frame();
        Some(Self {
            prim,
            face: patch.face,
            middle: origin,
            normal: z,
            sides: [*half_x * x, *half_y * y],
        })
    }

    /// All rectangular walls of an owner.
    pub(super) fn all_of(scene: &Scene, owner: Owner) -> Vec<Self> {
        let owned = scene.patches.iter().enumerate().filter(|(_, patch)| patch.owner == owner);
        owned.filter_map(|(index, patch)| Self::of(PrimId::new(index), patch)).collect()
    }

    /// Half of its extent along a unit vector, mm.
    pub(super) fn extent(&self, along: DVec3) -> f64 {
        self.sides.iter().map(|side| side.dot(along).abs()).sum()
    }

    /// Whether it could be a side wall of a duct with this middle, if `half` is half of the vector between its first two walls.
    fn is_side_of(&self, middle: DVec3, half: DVec3) -> bool {
        let (offset, across) = (middle - self.middle, half.normalize());
        let size = offset.length() + half.length();
        self.normal.dot(across).abs() < SAME
            && (self.extent(across) - half.length()).abs() < SAME * size
            && (offset - offset.dot(self.normal) * self.normal).length() < SAME * size
    }

    /// Half of the vector to a parallel wall of the same size that faces it.
    fn toward_opposite(&self, other: &Self) -> Option<DVec3> {
        let half = 0.5 * (other.middle - self.middle);
        let apart = half.dot(self.normal);
        let size = half.length() + self.sides[0].length() + self.sides[1].length();
        let is_opposite = self.normal.distance(-other.normal) < SAME
            && (half - apart * self.normal).length() < SAME * size
            && self.sides.iter().all(|side| {
                let along = side.normalize();
                (other.extent(along) - side.length()).abs() < SAME * size
            });
        (is_opposite && apart != 0.0).then_some(half)
    }
}

/// The longest duct that a wall is part of.
pub(super) fn within(scene: &Scene, prim: PrimId) -> Option<PlainLeg> {
    let patch = &scene.patches[prim.index()];
    let wall = FlatWall::of(prim, patch)?;
    let walls = FlatWall::all_of(scene, patch.owner);
    let pairs = |of: &FlatWall| -> Vec<(FlatWall, DVec3)> {
        let of = *of;
        walls.iter().filter_map(|other| Some((*other, of.toward_opposite(other)?))).collect()
    };
    let mut best: Option<PlainLeg> = None;
    for (opposite, half_x) in pairs(&wall) {
        let middle = wall.middle + half_x;
        for low in walls.iter().filter(|other| other.is_side_of(middle, half_x)) {
            for (high, half_y) in pairs(low) {
                let leg = duct([wall, opposite, *low, high], middle, [half_x, half_y]);
                let length = |leg: &PlainLeg| leg.spans[0][1] - leg.spans[0][0];
                best = leg.into_iter().chain(best).max_by(|a, b| length(a).total_cmp(&length(b)));
            }
        }
    }
    best
}

/// The duct of two pairs of walls, if they meet at its edges.
fn duct(walls: [FlatWall; 4], middle: DVec3, [half_x, half_y]: [DVec3; 2]) -> Option<PlainLeg> {
    let [wall, _, low, high] = walls;
    let (x, y) = (half_x.normalize(), half_y.normalize());
    let frame = Frame { origin: middle, x, y, z: x.cross(y) };
    let half = DVec2::new(half_x.length(), half_y.length());
    let length = wall.extent(frame.z);
    let size = half.length() + length;
    let same = |a: f64, b: f64| (a - b).abs() < SAME * size;
    // All face inward, or all outward.
    let is_one_side = (wall.normal.dot(x) > 0.0) == (low.normal.dot(y) > 0.0);
    let fits = is_one_side
        && (low.middle + half_y - middle).length() < SAME * size
        && same(wall.extent(y), half.y)
        && same(low.extent(x), half.x)
        && same(low.extent(frame.z), length)
        && same(high.extent(frame.z), length);
    let is_one_face = walls.iter().all(|other| other.face == wall.face);
    let prims = walls.map(|wall| wall.prim);
    fits.then(|| PlainLeg {
        frame,
        section: LegSection::Rectangle { half, walls: prims },
        is_one_face,
        spans: SmallVec::from_elem([-length, length], 1),
    })
}
