//! Records where gather paths end, stored so that a photon finds those it may belong to with one
//! look-up.
//!
//! This module does not know the contribution of a photon to a record.

use crate::optics::{Finish, VolumeScattering};
use crate::scene::MediumId;
use crate::transport::gather::index::{Index, Indexed, PhotonKey, TOGETHER};
use crate::transport::gather::kernel::Kernels;
use crate::transport::gather::surfaces::{Slot, SurfaceNumbers};
use crate::transport::stop::Pace;
use crate::transport::window::Window;
use glam::DVec3;
use lumiduct_base::math::Aabb;
use smallvec::SmallVec;

/// A point where a gather path waits for photons.
#[derive(Debug, Clone, Copy)]
pub enum GatherRecord<'s> {
    /// On a surface.
    Surface(SurfaceRecord<'s>),
    /// Within a medium.
    Volume(VolumeRecord),
}

/// A record on a surface.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceRecord<'s> {
    /// Position, mm.
    pub point: DVec3,
    /// Unit normal of the surface on the side that photons come from.
    pub normal: DVec3,
    /// The smooth surface that photons must meet.
    pub surface: Slot,
    /// The medium they arrive in.
    pub medium: MediumId,
    /// The photons it takes.
    pub kind: RecordKind<'s>,
    /// Etendue times throughput over n² and the area of the window, clipped at rims: sr (times mm²/mm²).
    pub value: f64,
    /// Kernels of the position in the window.
    pub kernels: Kernels,
    /// Slope of their linear term, 1/mm.
    pub slope: DVec3,
    /// The gather path.
    pub path: RecordPath,
}

/// A record within a medium. It takes all photons that are scattered there, weighted by the phase
/// function: docs/method.md, eq. (23).
#[derive(Debug, Clone, Copy)]
pub struct VolumeRecord {
    /// Position, mm.
    pub point: DVec3,
    /// The medium in which photons must be scattered, by its place among surfaces and media.
    pub medium: Slot,
    /// Scattering of the medium.
    pub scattering: VolumeScattering,
    /// Unit direction of the light after scattering.
    pub out: DVec3,
    /// Etendue times throughput over n², the scattering coefficient and the volume of the window, clipped at its bounds.
    pub value: f64,
    /// Kernels of the position in the window.
    pub kernels: Kernels,
    /// The gather path.
    pub path: RecordPath,
}

/// The gather path that ends in a record.
#[derive(Debug, Clone, Copy)]
pub struct RecordPath {
    /// Its place in the list of paths.
    pub place: u32,
    /// Interfaces met and scatterings within media from the sensor to the record, including its own.
    pub depth: u32,
    /// The band of its wavelength.
    pub band: u32,
}

/// The photons that a record on a surface takes.
#[derive(Debug, Clone, Copy)]
pub enum RecordKind<'s> {
    /// Photons that travel along this direction, up to the angle of the window: docs/method.md, eq.
    /// (15).
    Along(DVec3),
    /// All photons, weighted by the broad part of a finish toward a direction: docs/method.md, eq.
    /// (22).
    Scattered {
        /// The finish that acts on them.
        finish: &'s Finish,
        /// Unit direction in which the light must leave.
        out: DVec3,
    },
}

impl GatherRecord<'_> {
    /// The gather path that ends in it.
    pub fn path(&self) -> RecordPath {
        match self {
            Self::Surface(record) => record.path,
            Self::Volume(record) => record.path,
        }
    }

    /// Its entry in the index, and the direction of the photons it takes if it takes no others.
    pub(super) fn indexed(&self, id: usize) -> (Indexed, Option<DVec3>) {
        let (surface, point, normal, dir) = match self {
            Self::Surface(SurfaceRecord { surface, point, normal, kind, .. }) => {
                let dir = match kind {
                    RecordKind::Along(dir) => Some(*dir),
                    RecordKind::Scattered { .. } => None,
                };
                (*surface, *point, Some(*normal), dir)
            }
            Self::Volume(VolumeRecord { medium, point, .. }) => (*medium, *point, None, None),
        };
        let indexed = Indexed {
            record: id as u32,
            surface,
            band: self.path().band,
            point,
            normal,
            dir: dir.unwrap_or(NO_DIRECTION),
        };
        (indexed, dir)
    }
}

/// Records of a pass, to be looked up by photons.
#[derive(Debug)]
pub struct Records<'s> {
    pub(crate) all: Vec<GatherRecord<'s>>,
    /// By surface, or by the last bits of its number where there are very many: positions and directions of its records.
    reach: Vec<Reach>,
    along: Index,
    scattered: Index,
}

/// Most boxes of that kind: every facet of a mesh may be a surface of its own.
const MOST_REACHES: usize = 1 << 12;

/// Boxes around the windows of the records of a surface.
#[derive(Debug, Clone, Copy)]
struct Reach {
    positions: Aabb,
    directions: Aabb,
}

impl<'s> Records<'s> {
    /// Indexes records with a common window; `None` if stopped.
    pub fn new(
        all: Vec<GatherRecord<'s>>,
        window: Window,
        surfaces: &SurfaceNumbers,
        pace: &Pace<'_>,
    ) -> Option<Self> {
        let nowhere = Reach { positions: Aabb::EMPTY, directions: Aabb::EMPTY };
        let everywhere = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let count = (surfaces.count + surfaces.media).next_power_of_two().min(MOST_REACHES);
        let mut reach = vec![nowhere; count];
        let (mut along, mut scattered) = (Vec::new(), Vec::new());
        for (id, record) in all.iter().enumerate() {
            let (indexed, dir) = record.indexed(id);
            let own = &mut reach[indexed.surface as usize & (count - 1)];
            own.positions = own.positions.union(Aabb::of([indexed.point]).grown(window.radius));
            let directions = dir.map_or(everywhere, |dir| Aabb::of([dir]).grown(window.chord()));
            own.directions = own.directions.union(directions);
            if dir.is_some() { along.push(indexed) } else { scattered.push(indexed) }
        }
        Some(Self {
            along: Index::new(along.into_iter(), window, pace)?,
            scattered: Index::new(scattered.into_iter(), window, pace)?,
            reach,
            all,
        })
    }

    /// Whether a photon on a surface may belong to any record.
    #[inline(always)]
    pub fn may_take(&self, photon: &PhotonKey) -> bool {
        let reach = &self.reach[photon.surface as usize & (self.reach.len() - 1)];
        reach.positions.contains(photon.point)
            && reach.directions.contains(photon.dir)
            && (self.along.may_hold(photon)
                || self.scattered.may_hold(&PhotonKey { dir: NO_DIRECTION, ..*photon }))
    }

    /// Visits the records that each of some photons may belong to, each once: photon by photon
    /// those with a direction, then photon by photon those that take all.
    pub fn visit(&self, photons: &[PhotonKey], mut visit: impl FnMut(usize, &GatherRecord<'s>)) {
        self.along.visit(photons, |photon, id| visit(photon, &self.all[id as usize]));
        let keyed = photons.iter().map(|key| PhotonKey { dir: NO_DIRECTION, ..*key });
        let keyed: SmallVec<[PhotonKey; TOGETHER]> = keyed.collect();
        self.scattered.visit(&keyed, |photon, id| visit(photon, &self.all[id as usize]));
    }
}

/// The key direction of records that take photons of any direction.
const NO_DIRECTION: DVec3 = DVec3::ZERO;
