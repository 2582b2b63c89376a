//! Rows of mirror bounces within a straight wall whose section is any convex polygon.
//!
//! Mirrored by walls parallel to the axis, a path moves along it at a constant rate; its motion across is that of a billiard
//! in the polygon, followed from side to side.

use crate::scene::PrimId;
use crate::scene::plain_leg::reach::{LEAST, PathInLeg, RowReach};
use crate::scene::plain_leg::row::{AnglesOfRow, BouncesOnWall, RowInLeg};
use glam::DVec2;

/// Most sides.
pub(in crate::scene) const MOST_SIDES: usize = 12;
/// Most bounces of a row, after which a path may end by roulette.
const MOST_BOUNCES: u32 = 512;
/// Distance between crossings of two sides, relative to the section, below which a row ends before them, at their edge, 1.
const AT_EDGE: f64 = 1e-9;

/// A side of the section.
#[derive(Debug, Clone, Copy)]
pub(in crate::scene) struct LegSide {
    /// Unit normal, away from the axis.
    pub(in crate::scene) normal: DVec2,
    /// Distance from the axis, mm.
    pub(in crate::scene) offset: f64,
    pub(in crate::scene) wall: PrimId,
}

/// The bounces of a row on a side.
#[derive(Debug, Clone, Copy, Default)]
struct SideBounces {
    count: u32,
    /// The motion across the axis before the steepest, and its part toward the wall, 1.
    arriving: DVec2,
    steepness: f64,
}

/// The row of bounces within a reach; `visit` is told those on each wall, and may reject the row.
pub(super) fn row(
    sides: &[LegSide],
    reach: &RowReach,
    mut visit: impl FnMut(&BouncesOnWall) -> Option<()>,
) -> Option<RowInLeg> {
    let &RowReach { wall, is_one_face: _, path: PathInLeg { at, dir }, left, most } = reach;
    let (mut place, mut across) = (at.truncate(), dir.truncate());
    let start = sides.iter().position(|side| side.wall == wall)?;
    // It has left the wall inward.
    if across.dot(sides[start].normal) >= 0.0 {
        return None;
    }
    let way = left / dir.z.abs();
    let (mut length, mut count, mut last) = (0.0, 0, start);
    let mut by_side = [SideBounces::default(); MOST_SIDES];
    while count < most.min(MOST_BOUNCES) {
        let (next, step) = next_side(sides, place, across);
        let Some(next) = next.filter(|_| length + step <= way) else { break };
        let side = &sides[next];
        let steepness = across.dot(side.normal);
        let own = &mut by_side[next];
        own.count += 1;
        if steepness > own.steepness {
            (own.arriving, own.steepness) = (across, steepness);
        }
        place += step * across;
        place += (side.offset - place.dot(side.normal)) * side.normal;
        across -= 2.0 * steepness * side.normal;
        (length, last) = (length + step, next);
        count += 1;
    }
    if f64::from(count) < LEAST {
        return None;
    }
    for (side, SideBounces { count, arriving, .. }) in sides.iter().zip(by_side) {
        if count > 0 {
            let dir = arriving.extend(dir.z);
            visit(&BouncesOnWall { wall: side.wall, count, dir, angles: AnglesOfRow::Several })?;
        }
    }
    let end = PathInLeg { at: place.extend(at.z + length * dir.z), dir: across.extend(dir.z) };
    Some(RowInLeg { count, last: sides[last].wall, length, end })
}

/// The side that a path within the section meets next, and the distance along the path, mm; none where it may be an edge.
#[inline]
fn next_side(sides: &[LegSide], place: DVec2, across: DVec2) -> (Option<usize>, f64) {
    let (mut nearest, mut step, mut second) = (None, f64::INFINITY, f64::INFINITY);
    for (index, side) in sides.iter().enumerate() {
        let toward = across.dot(side.normal);
        if toward > 0.0 {
            let t = (side.offset - place.dot(side.normal)) / toward;
            if t < step {
                (nearest, step, second) = (Some(index), t, step);
            } else {
                second = second.min(t);
            }
        }
    }
    (nearest.filter(|_| second - step > AT_EDGE * sides[0].offset), step)
}
