//! Where gather paths end and wait for photons, indexed so that a photon finds the records it may belong to at once.
//!
//! Records are sorted into cells of position and of direction. A record stands in every cell that its window touches,
//! so that a photon looks into one cell only. Directions are keyed by their three components: there is no seam.
//! What a record is worth to a photon is not known here.

use crate::math::Aabb;
use crate::optics::Bsdf;
use crate::scene::{MediumId, PrimId, Scene, SmoothId};
use crate::transport::window::{NESTED, Window};
use glam::DVec3;
use std::collections::BTreeMap;

/// Size of the cells of position in radii, and of direction in chords of the angle: a photon then looks at a few
/// records for each that takes it, and a record stands in about five cells. By measurement, docs/method.md.
const POSITION_CELL: f64 = 4.0;
const DIRECTION_CELL: f64 = 6.0;

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
        reach.positions.contains(point) && reach.directions.contains(dir)
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
        for ids in
            [self.along.cell(surface, point, Some(dir)), self.scattered.cell(surface, point, None)]
        {
            for id in ids {
                visit(&self.all[id as usize]);
            }
        }
    }
}

/// Cells of position and direction, hashed.
#[derive(Debug)]
struct Index {
    position_scale: f64,
    direction_scale: f64,
    /// Number of buckets less one: a power of two less one.
    mask: u64,
    /// Where the entries of each bucket start; one more at the end.
    starts: Vec<u32>,
    entries: Vec<Entry>,
}

/// A record in a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    record: u32,
    /// The part of the cell's hash that the bucket does not tell: cells that share a bucket are told apart by it.
    tag: u32,
}

impl Index {
    fn new<'a, 's: 'a>(
        records: impl Iterator<Item = (u32, &'a GatherRecord<'s>, Option<DVec3>)> + Clone,
        window: Window,
    ) -> Self {
        let position_scale = 1.0 / (POSITION_CELL * window.radius);
        let direction_scale = 1.0 / (DIRECTION_CELL * window.chord());
        let mut placed: Vec<(u64, u32)> = Vec::new();
        for (id, record, dir) in records {
            let positions = touched(record.point, window.radius, position_scale);
            match dir {
                None => each_cell(positions, |position| {
                    placed.push((hash(record.surface, position, [0; 3]), id));
                }),
                Some(dir) => {
                    let directions = touched(dir, window.chord(), direction_scale);
                    each_cell(positions, |position| {
                        each_cell(directions, |direction| {
                            placed.push((hash(record.surface, position, direction), id));
                        });
                    });
                }
            }
        }
        let buckets = placed.len().next_power_of_two();
        let mask = buckets as u64 - 1;
        let mut starts = vec![0u32; buckets + 1];
        placed.iter().for_each(|(hash, _)| starts[(hash & mask) as usize + 1] += 1);
        let mut sum = 0;
        starts.iter_mut().for_each(|start| {
            sum += *start;
            *start = sum;
        });
        let mut next = starts.clone();
        let mut entries = vec![Entry::default(); placed.len()];
        for (hash, record) in placed {
            let place = &mut next[(hash & mask) as usize];
            entries[*place as usize] = Entry { record, tag: tag(hash) };
            *place += 1;
        }
        Self { position_scale, direction_scale, mask, starts, entries }
    }

    /// The records in the cell of a photon.
    #[inline]
    fn cell(
        &self,
        surface: Slot,
        point: DVec3,
        dir: Option<DVec3>,
    ) -> impl Iterator<Item = u32> + '_ {
        let (mut bucket, mut wanted): (&[Entry], u32) = (&[], 0);
        if !self.entries.is_empty() {
            let position = cell_of(point, self.position_scale);
            let direction = dir.map_or([0; 3], |dir| cell_of(dir, self.direction_scale));
            let hash = hash(surface, position, direction);
            let place = (hash & self.mask) as usize;
            bucket = &self.entries[self.starts[place] as usize..self.starts[place + 1] as usize];
            wanted = tag(hash);
        }
        bucket.iter().filter(move |entry| entry.tag == wanted).map(|entry| entry.record)
    }
}

type Cell = [i32; 3];

#[inline]
fn cell_of(p: DVec3, scale: f64) -> Cell {
    let p = (p * scale).floor();
    [p.x as i32, p.y as i32, p.z as i32]
}

/// The corners of the block of cells that a ball about `p` may touch.
fn touched(p: DVec3, reach: f64, scale: f64) -> [Cell; 2] {
    [cell_of(p - reach, scale), cell_of(p + reach, scale)]
}

fn each_cell([min, max]: [Cell; 2], mut visit: impl FnMut(Cell)) {
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
