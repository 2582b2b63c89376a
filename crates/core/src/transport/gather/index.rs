//! An index of records by position and direction: one look-up gives the records a photon may belong
//! to.
//!
//! Records are sorted into hashed cells of position and direction. A record is entered in every
//! cell that its window touches, so a photon needs only one cell. Directions are keyed by their
//! three components, so there is no seam. A filter first rejects most photons in empty cells.

#[cfg(test)]
mod tests;

use crate::transport::gather::coverage::HEIGHT;
use crate::transport::gather::filter::Filter;
use crate::transport::gather::surfaces::Slot;
use crate::transport::stop::Pace;
use crate::transport::window::Window;
use glam::{DVec3, Vec3};
use smallvec::SmallVec;
use std::ops::Range;
use wide::f32x8;

/// Size of the cells of position in radii, and of direction in chords of the angle. The cost of a look-up is memory, so smaller
/// tables beat sharper ones: docs/method.md.
const POSITION_CELL: f64 = 8.0;
const DIRECTION_CELL: f64 = 4.0;
/// Photons that are looked up together: enough to overlap memory latency, few enough to stay in
/// cache, and no more than a word has bits.
pub(crate) const TOGETHER: usize = 64;
/// Entries that are compared with a photon together.
const BLOCK: usize = 8;
/// Single-precision error in the distance of two points, relative to their coordinates: a few units
/// of 2^-24 each.
const SINGLE_ROUNDING: f64 = 1e-6;

/// A record in the index.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Indexed {
    /// Its position in the list of records.
    pub(crate) record: u32,
    /// The smooth surface it is on.
    pub(crate) surface: Slot,
    /// The band of its wavelength.
    pub(crate) band: u32,
    /// Position, mm.
    pub(crate) point: DVec3,
    /// Unit normal of the surface; `None` within a medium, where the window is a ball.
    pub(crate) normal: Option<DVec3>,
    /// Unit direction of the photons that it takes; the same for all records of an index that takes
    /// any direction.
    pub(crate) dir: DVec3,
}

/// The key by which a photon is looked up.
#[derive(Debug, Clone, Copy)]
pub struct PhotonKey {
    /// The smooth surface it is on.
    pub surface: Slot,
    /// The band of its wavelength.
    pub band: u32,
    /// Position, mm.
    pub point: DVec3,
    /// Unit direction of travel.
    pub dir: DVec3,
}

/// Records by position and direction.
#[derive(Debug)]
pub(crate) struct Index {
    filter: Filter,
    lattice: Lattice,
    /// Number of buckets less one: a power of two less one.
    mask: u64,
    /// Start of the entries of each bucket; one more at the end.
    starts: Vec<u32>,
    entries: Vec<EntryBlock>,
    /// Squares of the largest distances, with room for rounding, between a photon and a record:
    /// points, mm², and directions.
    point_reach_squared: f32,
    dir_reach_squared: f32,
}

/// A record in a cell.
#[derive(Debug, Clone, Copy, Default)]
struct IndexEntry {
    record: u32,
    /// The part of the cell's hash beyond the bucket, which separates cells that share a bucket.
    tag: u32,
    /// Point and direction of the record: most entries of a cell are out of range, and their
    /// records need not be fetched.
    point: [f32; 3],
    dir: [f32; 3],
}

/// Entries next to each other, which are compared with a photon together.
#[derive(Debug, Clone, Copy, Default)]
struct EntryBlock {
    record: [u32; BLOCK],
    tag: [u32; BLOCK],
    point: [[f32; BLOCK]; 3],
    dir: [[f32; BLOCK]; 3],
}

impl EntryBlock {
    fn set(&mut self, lane: usize, entry: &IndexEntry) {
        self.record[lane] = entry.record;
        self.tag[lane] = entry.tag;
        for axis in 0..3 {
            self.point[axis][lane] = entry.point[axis];
            self.dir[axis][lane] = entry.dir[axis];
        }
    }

    /// The entries within both reaches of a photon, one bit each.
    #[inline(always)]
    fn near(&self, (point, dir): (Vec3, Vec3), [point_reach, dir_reach]: [f32; 2]) -> u32 {
        let distance_squared = |from: &[[f32; BLOCK]; 3], to: Vec3| {
            let [x, y, z] = [(0, to.x), (1, to.y), (2, to.z)]
                .map(|(axis, to)| f32x8::new(from[axis]) - f32x8::splat(to));
            x * x + y * y + z * z
        };
        let near_dir = distance_squared(&self.dir, dir).simd_le(f32x8::splat(dir_reach));
        let near_point = distance_squared(&self.point, point).simd_le(f32x8::splat(point_reach));
        (near_dir & near_point).to_bitmask()
    }
}

/// The entries of a block that belong to a range.
#[inline]
fn lanes_within(range: &Range<usize>, block: usize) -> u32 {
    let lanes_from =
        |place: usize| u32::MAX.checked_shl(place.saturating_sub(BLOCK * block) as u32);
    lanes_from(range.start).unwrap_or(0) & !lanes_from(range.end).unwrap_or(0)
}

impl Index {
    /// Indexes records with a common window; `None` if stopped.
    pub(crate) fn new(
        records: impl Iterator<Item = Indexed>,
        window: Window,
        pace: &Pace<'_>,
    ) -> Option<Self> {
        let lattice = Lattice::new(window);
        let mut placed: Vec<(u64, IndexEntry)> = Vec::new();
        let mut farthest: f64 = 0.0;
        for record in records {
            farthest = farthest.max(record.point.abs().max_element());
            let own = IndexEntry {
                record: record.record,
                tag: 0,
                point: record.point.as_vec3().to_array(),
                dir: record.dir.as_vec3().to_array(),
            };
            let before = placed.len();
            lattice.each_cell(&record, window, |hash| {
                placed.push((hash, IndexEntry { tag: tag(hash), ..own }));
            });
            if pace.spend(1 + (placed.len() - before) as u32).is_break() {
                return None;
            }
        }
        let mask = placed.len().div_ceil(BLOCK).next_power_of_two() as u64 - 1;
        let filter = Filter::new(placed.iter().map(|(hash, _)| *hash), pace)?;
        let (starts, entries) = sorted(placed, mask, pace)?;
        let reach = ball(window);
        let point_reach = reach + SINGLE_ROUNDING * (farthest + reach);
        let dir_reach = window.chord() + SINGLE_ROUNDING;
        Some(Self {
            filter,
            lattice,
            mask,
            starts,
            entries,
            point_reach_squared: point_reach.powi(2) as f32,
            dir_reach_squared: dir_reach.powi(2) as f32,
        })
    }

    /// Whether there may be records near a photon.
    #[inline(always)]
    pub(crate) fn may_hold(&self, photon: &PhotonKey) -> bool {
        !self.entries.is_empty() && self.filter.may_hold(self.lattice.hash(photon))
    }

    /// Visits the records that each of some photons may belong to, each once, photon by photon.
    ///
    /// Every step is done for all photons before the next, so that many memory accesses overlap.
    pub(crate) fn visit(&self, photons: &[PhotonKey], mut visit: impl FnMut(usize, u32)) {
        if self.entries.is_empty() {
            return;
        }
        let keyed = photons.iter().map(|key| {
            let hash = self.lattice.hash(key);
            let place = (hash & self.mask) as usize;
            (tag(hash), self.starts[place] as usize..self.starts[place + 1] as usize)
        });
        let buckets: SmallVec<[(u32, Range<usize>); TOGETHER]> = keyed.collect();
        let blocks = |bucket: &Range<usize>| bucket.start / BLOCK..bucket.end.div_ceil(BLOCK);
        let reaches = [self.point_reach_squared, self.dir_reach_squared];
        let near = |photon: &PhotonKey, bucket: &Range<usize>, number: usize| {
            let place = (photon.point.as_vec3(), photon.dir.as_vec3());
            self.entries[number].near(place, reaches) & lanes_within(bucket, number)
        };
        let first = |(photon, (_, bucket)): (&PhotonKey, &(u32, Range<usize>))| {
            blocks(bucket).next().map_or(0, |number| near(photon, bucket, number))
        };
        let firsts: SmallVec<[u32; TOGETHER]> = photons.iter().zip(&buckets).map(first).collect();
        for (index, ((tag, bucket), first)) in buckets.into_iter().zip(firsts).enumerate() {
            for number in blocks(&bucket) {
                let is_first = number == bucket.start / BLOCK;
                let mut near =
                    if is_first { first } else { near(&photons[index], &bucket, number) };
                let block = &self.entries[number];
                while near != 0 {
                    let lane = near.trailing_zeros() as usize;
                    near &= near - 1;
                    if block.tag[lane] == tag {
                        visit(index, block.record[lane]);
                    }
                }
            }
        }
    }
}

/// Entries in the order of their buckets, and the start of each bucket; `None` if stopped.
fn sorted(
    placed: Vec<(u64, IndexEntry)>,
    mask: u64,
    pace: &Pace<'_>,
) -> Option<(Vec<u32>, Vec<EntryBlock>)> {
    let mut starts = vec![0u32; mask as usize + 2];
    for (hash, _) in &placed {
        starts[(hash & mask) as usize + 1] += 1;
        if pace.spend(1).is_break() {
            return None;
        }
    }
    let mut sum = 0;
    starts.iter_mut().for_each(|start| {
        sum += *start;
        *start = sum;
    });
    let mut next = starts.clone();
    let mut entries = vec![EntryBlock::default(); placed.len().div_ceil(BLOCK)];
    for (hash, entry) in placed {
        let next = &mut next[(hash & mask) as usize];
        let place = *next as usize;
        entries[place / BLOCK].set(place % BLOCK, &entry);
        *next += 1;
        if pace.spend(1).is_break() {
            return None;
        }
    }
    Some((starts, entries))
}

/// A division of positions and directions into cubes.
#[derive(Debug, Clone, Copy)]
struct Lattice {
    /// Cells per mm, and per unit of a direction.
    position_scale: f64,
    direction_scale: f64,
}

/// A cube of a division, by the position of its middle in multiples of its size.
type Cell = [i32; 3];

impl Lattice {
    fn new(window: Window) -> Self {
        Self {
            position_scale: 1.0 / (POSITION_CELL * window.radius),
            direction_scale: 1.0 / (DIRECTION_CELL * window.chord()),
        }
    }

    #[inline(always)]
    fn hash(&self, &PhotonKey { surface, band, point, dir }: &PhotonKey) -> u64 {
        let cells = (cell_of(point, self.position_scale), cell_of(dir, self.direction_scale));
        hash((surface, band), cells)
    }

    /// Visits the hashes of all cells in which photons of a record may lie.
    fn each_cell(&self, record: &Indexed, window: Window, mut visit: impl FnMut(u64)) {
        let mut directions: SmallVec<[Cell; 27]> = SmallVec::new();
        if record.dir == DVec3::ZERO {
            directions.push([0; 3]);
        } else {
            let size = 1.0 / self.direction_scale;
            each_near(record.dir, window.chord(), self.direction_scale, |cell| {
                // Directions lie on the unit sphere: cells wholly inside or outside it are empty.
                let (near, far) = corner_distances(cell, size);
                if near <= 1.0 && far >= 1.0 {
                    directions.push(cell);
                }
            });
        }
        let (place, size) = ((record.surface, record.band), 1.0 / self.position_scale);
        // Half of the cell's extent along the normal, and the largest sag of the surface within the
        // window.
        let half = |normal: DVec3| 0.5 * size * normal.abs().element_sum() + HEIGHT * window.radius;
        let is_near = |middle: DVec3| {
            let reaches = |normal| (middle - record.point).dot(normal).abs() <= half(normal);
            record.normal.is_none_or(reaches)
        };
        each_near(record.point, ball(window), self.position_scale, |cell| {
            let middle = DVec3::from(cell.map(f64::from)) * size;
            if is_near(middle) {
                directions.iter().for_each(|dir| visit(hash(place, (cell, *dir))));
            }
        });
    }
}

/// Radius of the ball about a record that contains its window on the surface, mm.
pub(super) fn ball(window: Window) -> f64 {
    window.radius * 1f64.hypot(HEIGHT)
}

#[inline(always)]
fn cell_of(p: DVec3, scale: f64) -> Cell {
    // Numbers of this size have no fractional digits, so their last bits are integers, including
    // negative ones.
    const WHOLE: f64 = 1.5 * (1u64 << 52) as f64;
    (p * scale + WHOLE).to_array().map(|whole| whole.to_bits() as i32)
}

/// Distances from the origin to the nearest and the farthest point of a cell, with room for rounding.
fn corner_distances(cell: Cell, size: f64) -> (f64, f64) {
    let (mut near, mut far) = (0.0, 0.0);
    for at in cell.map(f64::from) {
        let (low, high) = ((at - 0.5) * size, (at + 0.5) * size);
        let outside = low.max(-high).max(0.0);
        near += outside * outside;
        far += low.abs().max(high.abs()).powi(2);
    }
    (near.sqrt() * (1.0 - 1e-9), far.sqrt() * (1.0 + 1e-9))
}

/// The block of cells that a ball about `p` may touch.
fn each_near(p: DVec3, reach: f64, scale: f64, mut visit: impl FnMut(Cell)) {
    let (min, max) = (cell_of(p - reach, scale), cell_of(p + reach, scale));
    for x in min[0]..=max[0] {
        for y in min[1]..=max[1] {
            for z in min[2]..=max[2] {
                visit([x, y, z]);
            }
        }
    }
}

/// The bits of a hash that separate cells of one bucket.
#[inline]
fn tag(hash: u64) -> u32 {
    (hash >> 32) as u32
}

/// A well mixed hash of a cell on a surface (multiply and fold, after Steele, Lea & Flood's
/// `SplitMix64`).
#[inline]
fn hash((surface, band): (Slot, u32), (position, direction): (Cell, Cell)) -> u64 {
    let pair = |a: i32, b: i32| u64::from(a as u32) << 32 | u64::from(b as u32);
    let mut key = u64::from(surface) ^ u64::from(band).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    for word in [
        pair(position[0], position[1]),
        pair(position[2], direction[0]),
        pair(direction[1], direction[2]),
    ] {
        key = (key ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        key ^= key >> 29;
    }
    key.wrapping_mul(0xbf58_476d_1ce4_e5b9) ^ (key >> 32)
}
