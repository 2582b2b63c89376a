//! Rows of mirror bounces within a straight wall whose section is any convex polygon.
//!
//! Mirrored by walls parallel to the axis, a path moves along it at a constant rate; its motion across is that of a billiard
//! in the polygon, followed from side to side.

use crate::scene::PrimId;
use crate::scene::plain_leg::reach::{LEAST, PathInLeg, RowReach};
use crate::scene::plain_leg::row::{AnglesOfRow, MOST_BOUNCES, MetWall, RowInLeg};
use glam::DVec2;

/// Most sides.
pub(in crate::scene) const MOST_SIDES: usize = 12;
/// Distance across the axis between crossings of two sides, relative to the section, below which a row ends before them, 1.
const AT_EDGE: f64 = 1e-9;
/// Share of the light below which a row ends, 1.
const LEAST_LEFT: f64 = 1e-6;

/// A side of the section.
#[derive(Debug, Clone, Copy)]
pub(in crate::scene) struct LegSide {
    /// Unit normal, away from the axis.
    pub(in crate::scene) normal: DVec2,
    /// Distance from the axis, mm.
    pub(in crate::scene) offset: f64,
    pub(in crate::scene) wall: PrimId,
}

/// What is known of a side that a row has met.
#[derive(Debug, Clone, Copy, Default)]
struct MetSide {
    /// Cosine of the angle of incidence of its steepest bounce, 1.
    steepness: f64,
    /// Share of light that is mirrored then and in flatter bounces, 1.
    share: f64,
    /// Share of the light at the start of the row that it absorbed, 1.
    absorbed: f64,
}

/// The row of bounces within a reach, see `LegSection::row`. It ends before a wall for which `share_of` is `None`, and where
/// hardly anything is left.
pub(super) fn row(
    (radius, sides): (f64, &[LegSide]),
    reach: &RowReach,
    mut share_of: impl FnMut(&MetWall) -> Option<f64>,
    mut absorb: impl FnMut(PrimId, f64),
) -> Option<RowInLeg> {
    let &RowReach { wall, is_one_face: _, path: PathInLeg { at, dir }, left, most } = reach;
    let (mut place, mut across) = (at.truncate(), dir.truncate());
    let mut last = sides.iter().position(|side| side.wall == wall)?;
    // It has left the wall inward.
    if across.dot(sides[last].normal) >= 0.0 {
        return None;
    }
    // Crossings of two sides this close along the path are at their edge.
    let edge = AT_EDGE * radius / across.length();
    let way = left / dir.z.abs();
    let (mut length, mut count, mut reflected) = (0.0, 0, 1.0);
    let mut met = [MetSide::default(); MOST_SIDES];
    while count < most.min(MOST_BOUNCES) && reflected >= LEAST_LEFT {
        let (next, step) = next_side((sides, edge), place, across);
        let Some(next) = next.filter(|_| length + step <= way) else { break };
        let LegSide { normal, offset, wall } = sides[next];
        let steepness = across.dot(normal);
        if steepness > met[next].steepness {
            let dir = across.extend(dir.z);
            let angles = AnglesOfRow::ThisAndFlatter;
            let Some(share) = share_of(&MetWall { wall, dir, angles }) else { break };
            met[next] = MetSide { steepness, share, ..met[next] };
        }
        let after = reflected * met[next].share;
        met[next].absorbed += reflected - after;
        reflected = after;
        place += step * across;
        place += (offset - place.dot(normal)) * normal;
        across -= 2.0 * steepness * normal;
        (length, last) = (length + step, next);
        count += 1;
    }
    if f64::from(count) < LEAST {
        return None;
    }
    for (side, met) in sides.iter().zip(&met).filter(|(_, met)| met.absorbed > 0.0) {
        absorb(side.wall, met.absorbed);
    }
    let end = PathInLeg { at: place.extend(at.z + length * dir.z), dir: across.extend(dir.z) };
    Some(RowInLeg { count, last: sides[last].wall, length, chord: None, reflected, end })
}

/// The side that a path within the section meets next, and the distance along the path, mm; none within `edge` of another one.
#[inline]
fn next_side(
    (sides, edge): (&[LegSide], f64),
    place: DVec2,
    across: DVec2,
) -> (Option<usize>, f64) {
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
    (nearest.filter(|_| second - step > edge), step)
}
