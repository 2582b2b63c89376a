//! What a ray meets next.
//!
//! There are no epsilons against hitting the same surface twice. Of a solid, only crossings whose orientation fits
//! count: a path inside can only leave, a path outside can only enter; with that, a start point that rounding has put
//! a hair beyond an edge is still caught. Of the surface the ray starts on, the root at the start is no root.
//! Surfaces within [`Scene::tolerance`] of the nearest hit are one event.

use crate::scene::mesh::Line;
use crate::scene::shape::{Crossing, Start, Toward};
use crate::scene::{Accel, FaceId, Inside, Owner, PrimId, Ray, Scene, SolidId};
use smallvec::SmallVec;

/// One of the surfaces met at a hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrimHit {
    /// Which surface.
    pub prim: PrimId,
    /// Its face.
    pub face: FaceId,
    /// What its face belongs to.
    pub owner: Owner,
    /// Distance along the ray, mm.
    pub t: f64,
    /// Which way the ray goes through it.
    pub toward: Toward,
}

/// The nearest hit: all surfaces at one place.
#[derive(Debug, Clone, Default)]
pub struct Hits(SmallVec<[PrimHit; 2]>);

impl Hits {
    /// Distance to the place, mm; `None` when nothing is hit. Never negative.
    #[inline]
    pub fn distance(&self) -> Option<f64> {
        self.0.first().map(|first| first.t.max(0.0))
    }

    /// The surfaces that meet there.
    #[inline]
    pub fn all(&self) -> &[PrimHit] {
        &self.0
    }

    /// Whether a face of `solid` is among them.
    #[inline]
    pub fn meet(&self, solid: SolidId) -> bool {
        self.0.iter().any(|hit| hit.owner == Owner::Solid(solid))
    }

    /// Takes a path through all of them.
    #[inline]
    pub fn cross(&self, inside: &mut Inside) {
        for hit in &self.0 {
            if let Owner::Solid(solid) = hit.owner {
                match hit.toward {
                    Toward::Front => inside.leave(solid),
                    Toward::Back => inside.enter(solid),
                }
            }
        }
    }

    /// Takes in a candidate within [`Self::limit`]: keeps those within `tolerance` of the nearest, the nearest first.
    #[inline]
    fn take(&mut self, hit: PrimHit, tolerance: f64) {
        match self.0.as_mut_slice() {
            // Usually a nearer surface puts the only one so far out of reach.
            [only] if only.t > hit.t + tolerance => *only = hit,
            [first, ..] if hit.t < first.t => {
                self.0.retain(|kept| kept.t <= hit.t + tolerance);
                self.0.insert(0, hit);
            }
            _ => self.0.push(hit),
        }
    }

    /// Beyond this distance nothing can matter any more, mm.
    #[inline]
    fn limit(&self, tolerance: f64) -> f64 {
        self.0.first().map_or(f64::INFINITY, |first| first.t + tolerance)
    }
}

impl Scene {
    /// What a ray meets next that starts on the surfaces `from`, inside the solids `inside`; `hits` is filled anew,
    /// in place.
    #[inline]
    pub fn find_next(&self, ray: &Ray, from: &[PrimId], inside: &Inside, hits: &mut Hits) {
        hits.0.clear();
        match &self.accel {
            Accel::Scan(count) => {
                for index in 0..*count {
                    self.meet(PrimId::new(index), ray, None, from, inside, hits);
                }
            }
            Accel::Tree(tree) => {
                let line = self.line(ray);
                tree.visit(ray, |index| {
                    self.meet(PrimId::new(index), ray, line.as_ref(), from, inside, hits);
                    hits.limit(self.tolerance)
                });
            }
        }
    }

    /// Adds the crossings of a ray with a surface that count and are no farther than the nearest so far.
    #[inline(always)]
    fn meet(
        &self,
        prim: PrimId,
        ray: &Ray,
        line: Option<&Line>,
        from: &[PrimId],
        inside: &Inside,
        hits: &mut Hits,
    ) {
        let start = if from.contains(&prim) { Start::On } else { Start::Elsewhere };
        let surface = self.surface(prim);
        surface.crossings(ray, line, start, |crossing| {
            let Crossing { t, toward } = crossing;
            if t <= hits.limit(self.tolerance) && self.counts(surface.owner(), crossing, inside) {
                let (face, owner) = (surface.face(), surface.owner());
                hits.take(PrimHit { prim, face, owner, t, toward }, self.tolerance);
            }
        });
    }

    /// The solids in which a path finds itself just ahead of its start (`Toward::Front` of the start) or just behind.
    pub fn inside_at(&self, ray: &Ray, when: Just) -> Inside {
        // The nearest crossing of each solid beyond the start tells: leaving it means having been in it.
        let mut nearest: SmallVec<[(f64, Toward); 8]> =
            SmallVec::from_elem((f64::INFINITY, Toward::Back), self.solids.len());
        let beyond = match when {
            Just::Ahead => self.tolerance,
            Just::Behind => -self.tolerance,
        };
        let line = self.line(ray);
        self.accel.visit(ray, |index| {
            let surface = self.surface(PrimId::new(index));
            surface.crossings(ray, line.as_ref(), Start::Elsewhere, |crossing| {
                if let Owner::Solid(solid) = surface.owner() {
                    let slot = &mut nearest[solid.index()];
                    if crossing.t > beyond && crossing.t < slot.0 {
                        *slot = (crossing.t, crossing.toward);
                    }
                }
            });
            f64::INFINITY
        });
        nearest
            .iter()
            .enumerate()
            .filter(|(_, (_, toward))| *toward == Toward::Front)
            .map(|(index, _)| crate::scene::SolidId::new(index))
            .collect()
    }

    /// Every crossing ahead of a ray with the surfaces of solids and sheets, in any order.
    pub(crate) fn all_crossings(&self, ray: &Ray, mut visit: impl FnMut(PrimId, Crossing)) {
        let line = self.line(ray);
        self.accel.visit(ray, |index| {
            let prim = PrimId::new(index);
            let visit = |crossing| visit(prim, crossing);
            self.surface(prim).crossings(ray, line.as_ref(), Start::Elsewhere, visit);
            f64::INFINITY
        });
    }

    /// The form of a ray that triangles are asked with, made once; none without meshes.
    #[inline]
    fn line(&self, ray: &Ray) -> Option<Line> {
        (!self.meshes.is_empty()).then(|| Line::of(ray))
    }

    #[inline]
    fn counts(&self, owner: Owner, crossing: Crossing, inside: &Inside) -> bool {
        match owner {
            Owner::Solid(solid) => {
                crossing.t >= -self.tolerance
                    && inside.contains(solid) == (crossing.toward == Toward::Front)
            }
            Owner::Sheet => crossing.t > 0.0,
            Owner::Port => false,
        }
    }
}

/// On which side of its start point a path is asked about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Just {
    /// Just ahead along its direction: a source on a face is already beyond it.
    Ahead,
    /// Just behind: light of a source on a face still has to cross it.
    Behind,
}
