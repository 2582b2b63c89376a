//! Where a row of mirror bounces within a round or a rectangular wall ends.

use crate::scene::PrimId;
use crate::scene::plain_leg::reach::{LEAST, PathInLeg, RowReach};
use glam::{DVec2, DVec3};

/// Distance between the last bounces on two adjacent walls, relative to the section, below which the path is taken to end at
/// their edge, where there is no row, 1.
const AT_EDGE: f64 = 1e-9;
/// Most bounces of a row that are followed one by one, after which a path may end by roulette.
pub(super) const MOST_BOUNCES: u32 = 512;
/// Share of the light below which the rest vanishes in the rounding of what the walls absorbed before, 1.
const NOTHING_LEFT: f64 = 1e-20;

/// A part of a round wall, along the axis and around it, that contains all elements of a pattern.
#[derive(Debug, Clone, Copy)]
pub(in crate::scene) struct ElementBand {
    /// Unit vector from the axis to its middle, across the axis.
    pub(in crate::scene) toward: DVec2,
    /// Least component along it of the points of the band, mm.
    pub(in crate::scene) least: f64,
    /// Its extent along the axis, mm.
    pub(in crate::scene) along: [f64; 2],
}

impl ElementBand {
    /// Whether a point of the wall, across and along the axis, may be on an element.
    #[inline]
    fn contains(&self, place: DVec2, z: f64) -> bool {
        z >= self.along[0] && z <= self.along[1] && place.dot(self.toward) >= self.least
    }
}

/// A wall that a row meets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MetWall {
    pub(crate) wall: PrimId,
    /// Unit direction of the path before or after a bounce on it.
    pub(crate) dir: DVec3,
    pub(crate) angles: AnglesOfRow,
}

/// The angles at which the bounces of a row meet one wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AnglesOfRow {
    /// The same for all.
    One,
    /// This one and flatter ones, farther from the normal.
    ThisAndFlatter,
}

/// A row of bounces in the frame of the leg.
#[derive(Debug)]
pub(super) struct RowInLeg {
    /// Their number.
    pub(super) count: u32,
    /// The wall of the last.
    pub(super) last: PrimId,
    /// Distance along the path, mm.
    pub(super) length: f64,
    /// Distance from each bounce to the next, mm, if it is the same for all.
    pub(super) chord: Option<f64>,
    /// Share of the light that the walls mirror, 1.
    pub(super) reflected: f64,
    /// The path after it.
    pub(super) end: PathInLeg,
}

/// Across the axis all chords of a mirrored path in a circle are equal. Every bounce rotates position and direction about the
/// axis by the same angle δ and moves the position along it by the same length. With the position p, |p| = r, and the
/// direction d across the axis, the chord is t = -2 p·d/d², and δ is the angle between p and p + t d: sin δ = t (p×d)/r²,
/// cos δ = 1 + t (p·d)/r². After n bounces both are rotated by n δ.
#[inline]
pub(super) fn round(
    elements: &[ElementBand],
    reach: &RowReach,
    mut share_of: impl FnMut(&MetWall) -> Option<f64>,
) -> Option<RowInLeg> {
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
    let turn = DVec2::new(place.length_squared() + chord * inward, chord * place.perp_dot(across));
    let count = clear_bounces(elements, (at, turn, advance), count as u32);
    if f64::from(count) < LEAST {
        return None;
    }
    let share = share_of(&MetWall { wall, dir, angles: AnglesOfRow::One })?;
    let turn = turn.y.atan2(turn.x);
    let bounces = f64::from(count);
    let turned = DVec2::from_angle(bounces * turn);
    Some(RowInLeg {
        count,
        last: wall,
        length: bounces * chord,
        chord: Some(chord),
        reflected: share.powi(count as i32),
        end: PathInLeg {
            at: turned.rotate(place).extend(at.z + bounces * advance),
            dir: turned.rotate(across).extend(dir.z),
        },
    })
}

/// Number of bounces, at most `most`, before the first that may be on an element. Each turns the path by the angle of `turn` and
/// advances it along the axis.
#[inline]
fn clear_bounces(
    elements: &[ElementBand],
    (at, turn, advance): (DVec3, DVec2, f64),
    most: u32,
) -> u32 {
    if elements.is_empty() {
        return most;
    }
    let turn = turn.normalize_or_zero();
    let (mut place, mut z) = (at.truncate(), at.z);
    let is_clear = |_: &u32| {
        (place, z) = (turn.rotate(place), z + advance);
        !elements.iter().any(|band| band.contains(place, z))
    };
    (1..=most.min(MOST_BOUNCES)).take_while(is_clear).last().unwrap_or(0)
}

/// Between two parallel walls a path is mirrored to and fro, independently of its motion in the other two directions: it
/// meets the two walls alternately, at equal distances along the path. Unfolded, the path is straight.
#[inline]
pub(super) fn rectangle(
    (half, walls): (DVec2, &[PrimId; 4]),
    reach: &RowReach,
    mut share_of: impl FnMut(&MetWall) -> Option<f64>,
    mut absorb: impl FnMut(PrimId, f64),
) -> Option<RowInLeg> {
    let &RowReach { wall, is_one_face, path, left, most } = reach;
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
    let (mut end, mut reflected) = (path, 1.0);
    end.at.z += length * dir.z;
    for axis in [0, 1] {
        (end.at[axis], end.dir[axis]) = pairs[axis].after(&met[axis], length);
    }
    let mut shares = [[1.0; 2]; 2];
    for axis in [0, 1] {
        let bounces = met[axis].count;
        for (order, count) in [bounces.div_ceil(2), bounces / 2].into_iter().enumerate() {
            if count > 0 {
                let wall = walls[pairs[axis].wall(axis, order)];
                let met = MetWall { wall, dir: end.dir, angles: AnglesOfRow::One };
                shares[axis][order] = share_of(&met)?;
                reflected *= shares[axis][order].powi(count as i32);
            }
        }
    }
    if reflected < 1.0 && is_one_face {
        absorb(wall, 1.0 - reflected);
    } else if reflected < 1.0 {
        let absorbed = absorbed(&pairs, met, shares);
        for axis in [0, 1] {
            for order in [0, 1] {
                absorb(walls[pairs[axis].wall(axis, order)], absorbed[axis][order]);
            }
        }
    }
    let toward = dir[ends] < 0.0;
    let is_low = toward == (met[ends].count % 2 == 1);
    let last = walls[2 * ends + usize::from(!is_low)];
    Some(RowInLeg { count, last, length, chord: None, reflected, end })
}

/// What each wall absorbs of a light of 1, by pair, the wall that is met first before the other, in the order of the bounces.
fn absorbed(
    pairs: &[ParallelWalls; 2],
    met: [WallBounces; 2],
    shares: [[f64; 2]; 2],
) -> [[f64; 2]; 2] {
    let mut absorbed = [[0.0; 2]; 2];
    let (mut next, mut order, mut left) = (pairs.map(|pair| pair.first), [0, 0], 1.0);
    let mut to_go = met.map(|met| met.count);
    while to_go != [0, 0] && left > NOTHING_LEFT {
        let axis = usize::from(to_go[0] == 0 || (to_go[1] > 0 && next[1] < next[0]));
        let after = left * shares[axis][order[axis]];
        absorbed[axis][order[axis]] += left - after;
        left = after;
        next[axis] += pairs[axis].period;
        order[axis] = 1 - order[axis];
        to_go[axis] -= 1;
    }
    absorbed
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

    /// The place among the walls of a rectangle of the one that is met first, or of the other: -x, +x, -y, +y.
    fn wall(&self, axis: usize, order: usize) -> usize {
        let first = usize::from(self.dir >= 0.0);
        2 * axis + if order == 0 { first } else { 1 - first }
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
