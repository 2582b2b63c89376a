//! The surfaces that a ray meets at the nearest distance.

use crate::scene::crossing::inside::Inside;
use crate::scene::shape::{Crossing, Toward};
use crate::scene::{FaceId, Owner, PrimId, SolidId};
use std::hint::select_unpredictable;
use std::iter;

/// One of the surfaces met at a hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrimHit {
    /// The surface.
    pub prim: PrimId,
    /// Its face.
    pub face: FaceId,
    /// The owner of its face.
    pub owner: Owner,
    /// Direction in which the ray crosses it.
    pub toward: Toward,
}

/// The nearest hit: all surfaces at one place.
#[derive(Debug, Clone)]
pub struct Hits {
    pub(crate) distance: f64,
    pub(crate) nearest: PrimHit,
    /// Usually empty: on the heap, so that the usual hit stays in registers.
    pub(crate) others: Box<[PrimHit]>,
}

impl Hits {
    /// Distance to the hit, mm, never negative.
    #[inline]
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// The surface met first.
    #[inline]
    pub fn nearest(&self) -> &PrimHit {
        &self.nearest
    }

    /// Other surfaces at the same point.
    #[inline]
    pub(crate) fn others(&self) -> &[PrimHit] {
        &self.others
    }

    /// All surfaces that meet there.
    #[inline]
    pub(crate) fn all(&self) -> impl Iterator<Item = &PrimHit> {
        iter::once(&self.nearest).chain(&self.others)
    }

    /// Whether a face of `solid` is among them.
    #[inline]
    pub(crate) fn meet(&self, solid: SolidId) -> bool {
        self.all().any(|hit| hit.owner == Owner::Solid(solid))
    }

    /// Takes a path through all of them.
    #[inline]
    pub fn cross(&self, inside: &mut Inside) {
        for hit in self.all() {
            if let Owner::Solid(solid) = hit.owner {
                match hit.toward {
                    Toward::Front => inside.leave(solid),
                    Toward::Back => inside.enter(solid),
                }
            }
        }
    }
}

/// The search for the nearest hit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    pub(crate) prim: PrimId,
    pub(crate) crossing: Crossing,
    /// Distance of the next surface, as far as known, mm.
    pub(crate) runner_up: f64,
}

impl Nearest {
    pub(crate) const NONE: Self = Self {
        prim: PrimId::new(0),
        crossing: Crossing { t: f64::INFINITY, toward: Toward::Front },
        runner_up: f64::INFINITY,
    };

    #[inline(always)]
    pub(crate) fn consider(&mut self, prim: PrimId, crossing: Crossing) {
        if crossing.t < self.crossing.t {
            *self = Self { prim, crossing, runner_up: self.crossing.t };
        } else {
            self.consider_runner_up(crossing.t);
        }
    }

    /// The same with selects instead of jumps, where it is unpredictable which is nearer.
    #[inline(always)]
    pub(crate) fn choose(&mut self, prim: PrimId, crossing: Crossing) {
        let nearer = crossing.t < self.crossing.t;
        let further = if nearer { self.crossing.t } else { crossing.t };
        self.consider_runner_up(further);
        self.prim = select_unpredictable(nearer, prim, self.prim);
        self.crossing = Crossing {
            t: select_unpredictable(nearer, crossing.t, self.crossing.t),
            toward: select_unpredictable(nearer, crossing.toward, self.crossing.toward),
        };
    }

    #[inline(always)]
    pub(crate) fn consider_runner_up(&mut self, t: f64) {
        // Not `min`, which would check both for NaN.
        self.runner_up = if t < self.runner_up { t } else { self.runner_up };
    }
}

/// A point very near the start of a path, on its line: ahead of the start or behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartSide {
    /// Ahead, along its direction: past the face that a source lies on.
    Ahead,
    /// Behind: light of a source on a face must still cross the face.
    Behind,
}
