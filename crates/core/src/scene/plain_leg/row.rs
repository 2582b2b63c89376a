//! Where a row of mirror bounces within a round or a rectangular wall ends.

use crate::scene::PrimId;
use crate::scene::plain_leg::reach::{LEAST, PathInLeg, RowReach};
use glam::DVec2;
use smallvec::{SmallVec, smallvec};

/// Distance between the last bounces on two adjacent walls, relative to the section, below which the path is taken to end at
/// their edge, where there is no row, 1.
const AT_EDGE: f64 = 1e-9;

/// The cross-section of a wall about the origin, and its pieces.
#[derive(Debug, Clone)]
pub(in crate::scene) enum LegSection {
    /// A circle.
    Round { radius: f64, wall: PrimId },
    /// A rectangle: half of its size, and its walls at -x, +x, -y and +y.
    Rectangle { half: DVec2, walls: [PrimId; 4] },
}

/// A row of bounces in the frame of the leg.
#[derive(Debug)]
pub(super) struct RowInLeg {
    /// Bounces by wall.
    pub(super) bounces: SmallVec<[(PrimId, u32); 4]>,
    /// The wall of the last.
    pub(super) last: PrimId,
    /// Distance along the path, mm.
    pub(super) length: f64,
    /// The path after it.
    pub(super) end: PathInLeg,
}

impl LegSection {
    /// The row of bounces within a reach.
    pub(super) fn row(&self, reach: &RowReach) -> Option<RowInLeg> {
        match self {
            Self::Round { radius: _, wall: _ } => round(reach),
            Self::Rectangle { half, walls } => rectangle((*half, walls), reach),
        }
    }
}

/// Across the axis all chords of a mirrored path in a circle are equal. Every bounce rotates position and direction about the
/// axis by the same angle δ and moves the position along it by the same length. With the position p, |p| = r, and the
/// direction d across the axis, the chord is t = -2 p·d/d², and δ is the angle between p and p + t d: sin δ = t (p×d)/r²,
/// cos δ = 1 + t (p·d)/r². After n bounces both are rotated by n δ.
fn round(reach: &RowReach) -> Option<RowInLeg> {
    let &RowReach { wall, is_one_face: _, path: PathInLeg { at, dir }, left, most } = reach;
    let (place, across) = (at.truncate(), dir.truncate());
    let inward = place.dot(across);
    let chord = -2.0 * inward / across.length_squared();
    let advance = chord * dir.z;
    let count = (left / advance.abs()).floor().min(f64::from(most));
    // Also false for NaN, where the path runs along the axis.
    if !(chord > 0.0 && count >= LEAST) {
        return None;
    }
    let turn = (chord * place.perp_dot(across)).atan2(place.length_squared() + chord * inward);
    let turned = DVec2::from_angle(count * turn);
    Some(RowInLeg {
        bounces: smallvec![(wall, count as u32)],
        last: wall,
        length: count * chord,
        end: PathInLeg {
            at: turned.rotate(place).extend(at.z + count * advance),
            dir: turned.rotate(across).extend(dir.z),
        },
    })
}

/// Between two parallel walls a path is mirrored to and fro, independently of its motion in the other two directions: it
/// meets the two walls alternately, at equal distances along the path. Unfolded, the path is straight.
fn rectangle((half, walls): (DVec2, &[PrimId; 4]), reach: &RowReach) -> Option<RowInLeg> {
    let &RowReach { wall, is_one_face: _, path, left, most } = reach;
    let PathInLeg { at, dir } = path;
    let start = walls.iter().position(|own| *own == wall)?;
    // It has left the wall inward.
    let [axis, is_high] = [start / 2, start % 2];
    if (dir[axis] < 0.0) != (is_high == 1) || dir[axis] == 0.0 {
        return None;
    }
    let pairs = [0, 1].map(|axis| ParallelWalls::new(at[axis], dir[axis], half[axis]));
    let rate = pairs.iter().map(|pair| 1.0 / pair.period).sum::<f64>();
    // Each pair may be met once more than its rate says.
    let distance = (left / dir.z.abs()).min((f64::from(most) - 2.0).max(0.0) / rate);
    let met = pairs.map(|pair| pair.met(distance));
    let last = met.map(|met| met.at);
    let ends = usize::from(last[1] > last[0]);
    let count = met.iter().map(|met| met.count).sum::<u32>();
    if f64::from(count) < LEAST || (last[0] - last[1]).abs() < AT_EDGE * half.max_element() {
        return None;
    }
    let length = last[ends];
    let (mut end, mut bounces) = (path, SmallVec::new());
    end.at.z += length * dir.z;
    for axis in [0, 1] {
        let (pair, met) = (&pairs[axis], &met[axis]);
        (end.at[axis], end.dir[axis]) = pair.after(met, length);
        // The first is the wall toward which it went.
        let [first, second] = if dir[axis] < 0.0 { [0, 1] } else { [1, 0] };
        let by_wall = [(first, met.count.div_ceil(2)), (second, met.count / 2)];
        bounces.extend(
            by_wall
                .into_iter()
                .filter(|(_, count)| *count > 0)
                .map(|(side, count)| (walls[2 * axis + side], count)),
        );
    }
    let toward = dir[ends] < 0.0;
    let is_low = toward == (met[ends].count % 2 == 1);
    Some(RowInLeg { bounces, last: walls[2 * ends + usize::from(!is_low)], length, end })
}

/// Motion to and fro between two parallel walls.
#[derive(Debug, Clone, Copy)]
struct ParallelWalls {
    at: f64,
    dir: f64,
    half: f64,
    /// Distance along the path to the first wall, and from each to the next, mm.
    first: f64,
    period: f64,
}

/// The bounces on a pair of walls.
#[derive(Debug, Clone, Copy)]
struct WallBounces {
    count: u32,
    /// Distance along the path of the last, mm; 0 without any.
    at: f64,
}

impl ParallelWalls {
    fn new(at: f64, dir: f64, half: f64) -> Self {
        let first = (half.copysign(dir) - at) / dir;
        Self {
            at,
            dir,
            half,
            first: if dir == 0.0 { f64::INFINITY } else { first },
            period: (2.0 * half / dir).abs(),
        }
    }

    /// The bounces up to a distance along the path.
    fn met(&self, distance: f64) -> WallBounces {
        if distance < self.first {
            return WallBounces { count: 0, at: 0.0 };
        }
        let after_first = ((distance - self.first) / self.period).floor();
        WallBounces { count: after_first as u32 + 1, at: self.first + after_first * self.period }
    }

    /// Position and direction at a distance along the path, after these bounces.
    fn after(&self, met: &WallBounces, length: f64) -> (f64, f64) {
        if met.count == 0 {
            return (self.at + length * self.dir, self.dir);
        }
        let sign = if met.count % 2 == 1 { -1.0 } else { 1.0 };
        let dir = sign * self.dir;
        // The last wall lies behind it.
        (self.half.copysign(-dir) + (length - met.at) * dir, dir)
    }
}
