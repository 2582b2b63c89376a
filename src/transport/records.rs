//! Where gather paths end and wait for photons, indexed so that a photon finds the records it may belong to at once.
//!
//! Records are sorted into cells of position and of direction. A record stands in every cell that its window touches,
//! so that a photon looks into one cell only. Directions are keyed by their three components: there is no seam.
//! What a record is worth to a photon is not known here.

use crate::math::Aabb;
use crate::optics::Bsdf;
use crate::scene::{MediumId, PrimId, Scene, SmoothId};
use crate::transport::coverage::HEIGHT;
use crate::transport::window::{NESTED, Window};
use glam::{DVec3, Vec3};
use smallvec::SmallVec;
use std::collections::BTreeMap;

/// Size of the cells of position in radii, and of direction in chords of the angle: a photon then looks at about ten
/// records for each that takes it, and a record stands in about ten cells. By measurement, docs/method.md.
const POSITION_CELL: f64 = 4.0;
const DIRECTION_CELL: f64 = 2.5;
/// By how much single precision may err in the distance of two directions, 1: a few units of 2^-24 each.
const DIRECTION_ROUNDING: f64 = 1e-6;
/// Bits of the filter for each entry of an index: most photons meet no record, and one bit tells it.
const FILTER_BITS: usize = 8;

/// Where a gather path waits for photons.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GatherRecord<'s> {
    /// Where, mm.
    pub(crate) point: DVec3,
    /// Unit normal of the surface on the side that photons come from.
    pub(crate) normal: DVec3,
    /// Which smooth surface photons have to meet.
    pub(crate) surface: Slot,
    /// The medium they arrive in.
    pub(crate) medium: MediumId,
    /// Which photons it takes.
    pub(crate) wanted: Wanted<'s>,
    /// Etendue times throughput over n² and the area of the window, clipped at rims: sr (times mm²/mm²), per window.
    pub(crate) values: [f64; NESTED],
    /// The gather path, by its place in the list of paths.
    pub(crate) path: u32,
    /// Interfaces met from the sensor to the record, its own included.
    pub(crate) depth: u32,
}

/// Which photons a record takes.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wanted<'s> {
    /// Those that travel along this direction, up to the angle of the window: eq. (3).
    Along(DVec3),
    /// All, weighted by the broad part of a finish toward a direction: eq. (2).
    Scattered {
        /// The finish that acts on them.
        bsdf: &'s Bsdf,
        /// Unit direction in which the light has to leave.
        out: DVec3,
    },
}

/// A smooth surface by its place in the list of all.
pub(crate) type Slot = u32;

/// The smooth surfaces of a scene, numbered.
#[derive(Debug)]
pub(crate) struct Surfaces {
    slots: Vec<Slot>,
    count: usize,
    /// By surface: its analytic pieces; none of a mesh.
    patches: Vec<Vec<PrimId>>,
}

impl Surfaces {
    pub(crate) fn new(scene: &Scene) -> Self {
        let triangles: usize = scene.meshes.iter().map(|body| body.mesh.triangle_count()).sum();
        let mut known: BTreeMap<SmoothId, Slot> = BTreeMap::new();
        let slots: Vec<Slot> = (0..scene.patches.len() + triangles)
            .map(|prim| {
                let next = known.len() as Slot;
                *known.entry(scene.smooth(PrimId::new(prim))).or_insert(next)
            })
            .collect();
        let count = known.len();
        let mut patches = vec![Vec::new(); count];
        for (index, &slot) in slots.iter().take(scene.patches.len()).enumerate() {
            patches[slot as usize].push(PrimId::new(index));
        }
        Self { slots, count, patches }
    }

    /// The analytic pieces of a surface; none of a mesh.
    pub(crate) fn patches(&self, surface: Slot) -> &[PrimId] {
        &self.patches[surface as usize]
    }

    /// The smooth surface of a piece.
    #[inline]
    pub(crate) fn of(&self, prim: PrimId) -> Slot {
        self.slots[prim.index()]
    }
}

/// Records of a pass, to be looked up by photons.
#[derive(Debug)]
pub(crate) struct Records<'s> {
    pub(crate) all: Vec<GatherRecord<'s>>,
    /// By surface: where its records are, and in which directions they look.
    reach: Vec<Reach>,
    along: Index,
    scattered: Index,
}

/// Boxes around the windows of the records of a surface.
#[derive(Debug, Clone, Copy)]
struct Reach {
    positions: Aabb,
    directions: Aabb,
}

impl<'s> Records<'s> {
    /// Indexes records with a common widest window.
    pub(crate) fn new(all: Vec<GatherRecord<'s>>, window: Window, surfaces: &Surfaces) -> Self {
        let nowhere = Reach { positions: Aabb::EMPTY, directions: Aabb::EMPTY };
        let everywhere = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let mut reach = vec![nowhere; surfaces.count];
        for record in &all {
            let own = &mut reach[record.surface as usize];
            own.positions = own.positions.union(Aabb::of([record.point]).grown(window.radius));
            let directions = match record.wanted {
                Wanted::Along(dir) => Aabb::of([dir]).grown(window.chord()),
                Wanted::Scattered { .. } => everywhere,
            };
            own.directions = own.directions.union(directions);
        }
        let along = all.iter().enumerate().filter_map(|(id, record)| match record.wanted {
            Wanted::Along(dir) => Some((id as u32, record, Some(dir))),
            Wanted::Scattered { .. } => None,
        });
        let scattered = all.iter().enumerate().filter_map(|(id, record)| match record.wanted {
            Wanted::Along(_) => None,
            Wanted::Scattered { .. } => Some((id as u32, record, None)),
        });
        Self {
            along: Index::new(along, window),
            scattered: Index::new(scattered, window),
            reach,
            all,
        }
    }

    /// Whether a photon on a surface may belong to any record.
    #[inline(always)]
    pub(crate) fn may_take(&self, surface: Slot, point: DVec3, dir: DVec3) -> bool {
        let reach = &self.reach[surface as usize];
        reach.positions.contains(point)
            && reach.directions.contains(dir)
            && (self.along.may_hold(surface, point, dir)
                || self.scattered.may_hold(surface, point, NO_DIRECTION))
    }

    /// Visits the records that a photon may belong to, each once.
    #[inline]
    pub(crate) fn visit(
        &self,
        surface: Slot,
        point: DVec3,
        dir: DVec3,
        mut visit: impl FnMut(&GatherRecord<'s>),
    ) {
        for (index, dir) in [(&self.along, dir), (&self.scattered, NO_DIRECTION)] {
            index.visit_cell(index.hash(surface, point, dir), dir, |id| {
                visit(&self.all[id as usize]);
            });
        }
    }
}

/// The direction by which records are keyed that take photons of any direction.
const NO_DIRECTION: DVec3 = DVec3::ZERO;

/// Cells of position and direction, hashed.
#[derive(Debug)]
struct Index {
    position_scale: f64,
    direction_scale: f64,
    /// A bit for each of many parts of the hash: set where an entry has it.
    filter: Vec<u64>,
    /// Number of buckets less one: a power of two less one.
    mask: u64,
    /// Where the entries of each bucket start; one more at the end.
    starts: Vec<u32>,
    entries: Vec<Entry>,
    /// Square of the chord of the widest window, with room for rounding: records look no further.
    reach_squared: f32,
}

/// A record in a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    record: u32,
    /// The part of the cell's hash that the bucket does not tell: cells that share a bucket are told apart by it.
    tag: u32,
    /// The direction of the record: most entries of a cell look elsewhere, and need not be fetched.
    dir: [f32; 3],
}

impl Index {
    fn new<'a, 's: 'a>(
        records: impl Iterator<Item = (u32, &'a GatherRecord<'s>, Option<DVec3>)>,
        window: Window,
    ) -> Self {
        let position_scale = 1.0 / (POSITION_CELL * window.radius);
        let direction_scale = 1.0 / (DIRECTION_CELL * window.chord());
        let mut placed: Vec<(u64, Entry)> = Vec::new();
        for (id, record, dir) in records {
            let keyed = dir.unwrap_or(NO_DIRECTION).as_vec3().to_array();
            let place = |position: Cell, direction: Cell| {
                let hash = hash(record.surface, position, direction);
                placed.push((hash, Entry { record: id, tag: tag(hash), dir: keyed }));
            };
            each_pair_of_cells(record, dir, window, [position_scale, direction_scale], place);
        }
        let buckets = placed.len().next_power_of_two();
        let mask = buckets as u64 - 1;
        let mut filter = vec![0u64; (FILTER_BITS * buckets).div_ceil(64)];
        let mut starts = vec![0u32; buckets + 1];
        for (hash, _) in &placed {
            starts[(hash & mask) as usize + 1] += 1;
            let (word, bit) = filter_place(*hash, filter.len());
            filter[word] |= bit;
        }
        let mut sum = 0;
        starts.iter_mut().for_each(|start| {
            sum += *start;
            *start = sum;
        });
        let mut next = starts.clone();
        let mut entries = vec![Entry::default(); placed.len()];
        for (hash, entry) in placed {
            let place = &mut next[(hash & mask) as usize];
            entries[*place as usize] = entry;
            *place += 1;
        }
        let reach = window.chord() + DIRECTION_ROUNDING;
        let reach_squared = (reach * reach) as f32;
        Self { position_scale, direction_scale, filter, mask, starts, entries, reach_squared }
    }

    #[inline]
    fn hash(&self, surface: Slot, point: DVec3, dir: DVec3) -> u64 {
        hash(surface, cell_of(point, self.position_scale), cell_of(dir, self.direction_scale))
    }

    /// Whether there may be records in the cell of a photon.
    #[inline(always)]
    fn may_hold(&self, surface: Slot, point: DVec3, dir: DVec3) -> bool {
        if self.entries.is_empty() {
            return false;
        }
        let (word, bit) = filter_place(self.hash(surface, point, dir), self.filter.len());
        self.filter[word] & bit != 0
    }

    /// Visits the records in a cell, by its hash, that look about along `dir`.
    #[inline]
    fn visit_cell(&self, hash: u64, dir: DVec3, mut visit: impl FnMut(u32)) {
        let place = (hash & self.mask) as usize;
        let (tag, dir) = (tag(hash), dir.as_vec3());
        for entry in &self.entries[self.starts[place] as usize..self.starts[place + 1] as usize] {
            let apart = dir.distance_squared(Vec3::from_array(entry.dir));
            if entry.tag == tag && apart <= self.reach_squared {
                visit(entry.record);
            }
        }
    }
}

/// The word and the bit of a filter of some words, a power of two, for a hash.
#[inline(always)]
fn filter_place(hash: u64, words: usize) -> (usize, u64) {
    // Bits that the buckets do not use first: the filter is finer than they are.
    let place = hash >> 20;
    ((place >> 6) as usize & (words - 1), 1 << (place & 63))
}

type Cell = [i32; 3];

#[inline(always)]
fn cell_of(p: DVec3, scale: f64) -> Cell {
    // Far from zero cutting off digits rounds down, at a quarter of the cost.
    const FAR: i32 = 1 << 30;
    let p = p * scale + f64::from(FAR);
    [p.x as i32 - FAR, p.y as i32 - FAR, p.z as i32 - FAR]
}

/// Every cell of position with every cell of direction that photons of a record may lie in.
fn each_pair_of_cells(
    record: &GatherRecord<'_>,
    dir: Option<DVec3>,
    window: Window,
    [position_scale, direction_scale]: [f64; 2],
    mut place: impl FnMut(Cell, Cell),
) {
    let mut directions: SmallVec<[Cell; 27]> = SmallVec::new();
    match dir {
        None => directions.push([0; 3]),
        Some(dir) => {
            let size = 1.0 / direction_scale;
            each_cell(dir, window.chord(), direction_scale, |cell| {
                // Directions lie on the unit sphere: cells wholly inside or outside of it hold none.
                let (near, far) = corner_distances(cell, size);
                if near <= 1.0 && far >= 1.0 {
                    directions.push(cell);
                }
            });
        }
    }
    let size = 1.0 / position_scale;
    // Half of the cell's extent along the normal, and how far the surface may bend away within the window.
    let half = 0.5 * size * record.normal.abs().element_sum() + HEIGHT * window.radius;
    each_cell(record.point, window.radius * 1f64.hypot(HEIGHT), position_scale, |cell| {
        let middle = (DVec3::from(cell.map(f64::from)) + 0.5) * size;
        if (middle - record.point).dot(record.normal).abs() <= half {
            directions.iter().for_each(|direction| place(cell, *direction));
        }
    });
}

/// Distances from the origin to the nearest and the farthest point of a cell, with room for rounding.
fn corner_distances(cell: Cell, size: f64) -> (f64, f64) {
    let (mut near, mut far) = (0.0, 0.0);
    for at in cell {
        let (low, high) = (f64::from(at) * size, f64::from(at + 1) * size);
        let outside = low.max(-high).max(0.0);
        near += outside * outside;
        far += low.abs().max(high.abs()).powi(2);
    }
    (near.sqrt() * (1.0 - 1e-9), far.sqrt() * (1.0 + 1e-9))
}

/// The block of cells that a ball about `p` may touch.
fn each_cell(p: DVec3, reach: f64, scale: f64, mut visit: impl FnMut(Cell)) {
    let (min, max) = (cell_of(p - reach, scale), cell_of(p + reach, scale));
    for x in min[0]..=max[0] {
        for y in min[1]..=max[1] {
            for z in min[2]..=max[2] {
                visit([x, y, z]);
            }
        }
    }
}

/// The bits of a hash that tell cells of one bucket apart.
#[inline]
fn tag(hash: u64) -> u32 {
    (hash >> 32) as u32
}

/// A well mixed number of a cell on a surface (multiply and fold, after Steele, Lea & Flood's `SplitMix64`).
#[inline]
fn hash(surface: Slot, position: Cell, direction: Cell) -> u64 {
    let pair = |a: i32, b: i32| u64::from(a as u32) << 32 | u64::from(b as u32);
    let mut key = u64::from(surface);
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
