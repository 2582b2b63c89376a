//! Records where gather paths end, stored so that a photon finds those it may belong to with one
//! look-up.
//!
//! This module does not know the contribution of a photon to a record.

use crate::optics::{Bsdf, VolumeScattering};
use crate::scene::MediumId;
use crate::transport::gather::index::{Index, Indexed, Key, TOGETHER};
use crate::transport::gather::surfaces::{Slot, Surfaces};
use crate::transport::gather::window::{NESTED, Window};
use crate::transport::stop::Pace;
use glam::DVec3;
use lumiduct_base::math::Aabb;
use smallvec::SmallVec;

/// A point where a gather path waits for photons.
#[derive(Debug, Clone, Copy)]
pub struct GatherRecord<'s> {
    /// Position, mm.
    pub point: DVec3,
    /// Unit normal of the surface on the side that photons come from; zero within a medium.
    pub normal: DVec3,
    /// The smooth surface that photons must meet, or the medium in which they must be scattered.
    pub surface: Slot,
    /// The medium they arrive in.
    pub medium: MediumId,
    /// The photons it takes.
    pub wanted: Wanted<'s>,
    /// Etendue times throughput over n² and the area of the window, clipped at rims: sr (times mm²/mm²), per window; within
    /// a medium over n², the scattering coefficient and the volume of the window, clipped at its bounds.
    pub values: [f64; NESTED],
    /// The gather path, by its index in the list of paths.
    pub path: u32,
    /// Interfaces met from the sensor to the record, including its own.
    pub depth: u32,
}

/// The photons that a record takes.
#[derive(Debug, Clone, Copy)]
pub enum Wanted<'s> {
    /// Photons that travel along this direction, up to the angle of the window: docs/method.md, eq.
    /// (15).
    Along(DVec3),
    /// All photons, weighted by the broad part of a finish toward a direction: docs/method.md, eq.
    /// (22).
    Scattered {
        /// The finish that acts on them.
        bsdf: &'s Bsdf,
        /// Unit direction in which the light must leave.
        out: DVec3,
    },
    /// All photons that are scattered within a medium, weighted by the phase function:
    /// docs/method.md, eq. (24).
    Collided {
        /// Scattering of the medium.
        scattering: VolumeScattering,
        /// Unit direction of the light after scattering.
        out: DVec3,
    },
}

/// Records of a pass, to be looked up by photons.
#[derive(Debug)]
pub struct Records<'s> {
    pub(crate) all: Vec<GatherRecord<'s>>,
    /// By surface: the positions of its records, and their directions.
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
    /// Indexes records with a common widest window; `None` if stopped.
    pub fn new(
        all: Vec<GatherRecord<'s>>,
        window: Window,
        surfaces: &Surfaces,
        pace: &Pace<'_>,
    ) -> Option<Self> {
        let nowhere = Reach { positions: Aabb::EMPTY, directions: Aabb::EMPTY };
        let everywhere = Aabb { min: DVec3::NEG_ONE, max: DVec3::ONE };
        let mut reach = vec![nowhere; surfaces.count + surfaces.media];
        for record in &all {
            let own = &mut reach[record.surface as usize];
            own.positions = own.positions.union(Aabb::of([record.point]).grown(window.radius));
            let directions = match record.wanted {
                Wanted::Along(dir) => Aabb::of([dir]).grown(window.chord()),
                Wanted::Scattered { .. } | Wanted::Collided { .. } => everywhere,
            };
            own.directions = own.directions.union(directions);
        }
        let indexed = |id: usize, record: &GatherRecord<'_>, dir: DVec3| Indexed {
            record: id as u32,
            surface: record.surface,
            point: record.point,
            normal: record.normal,
            dir,
        };
        let along = all.iter().enumerate().filter_map(|(id, record)| match record.wanted {
            Wanted::Along(dir) => Some(indexed(id, record, dir)),
            Wanted::Scattered { .. } | Wanted::Collided { .. } => None,
        });
        let scattered = all.iter().enumerate().filter_map(|(id, record)| match record.wanted {
            Wanted::Along(_) => None,
            Wanted::Scattered { .. } | Wanted::Collided { .. } => {
                Some(indexed(id, record, NO_DIRECTION))
            }
        });
        Some(Self {
            along: Index::new(along, window, pace)?,
            scattered: Index::new(scattered, window, pace)?,
            reach,
            all,
        })
    }

    /// Whether a photon on a surface may belong to any record.
    #[inline(always)]
    pub fn may_take(&self, surface: Slot, point: DVec3, dir: DVec3) -> bool {
        let reach = &self.reach[surface as usize];
        reach.positions.contains(point)
            && reach.directions.contains(dir)
            && (self.along.may_hold(surface, point, dir)
                || self.scattered.may_hold(surface, point, NO_DIRECTION))
    }

    /// Visits the records that each of some photons may belong to, each once: photon by photon
    /// those with a direction, then photon by photon those that take all.
    pub fn visit(&self, photons: &[Key], mut visit: impl FnMut(usize, &GatherRecord<'s>)) {
        self.along.visit(photons, |photon, id| visit(photon, &self.all[id as usize]));
        let keyed = photons.iter().map(|key| Key { dir: NO_DIRECTION, ..*key });
        let keyed: SmallVec<[Key; TOGETHER]> = keyed.collect();
        self.scattered.visit(&keyed, |photon, id| visit(photon, &self.all[id as usize]));
    }
}

/// The key direction of records that take photons of any direction.
const NO_DIRECTION: DVec3 = DVec3::ZERO;
