//! What a ray meets next.
//!
//! There are no epsilons against hitting the same surface twice. Of a solid, only crossings whose orientation fits
//! count: a path inside can only leave, a path outside can only enter; with that, a start point that rounding has put
//! a hair beyond an edge is still caught. Of the surface the ray starts on, the root at the start is no root.
//! Surfaces within [`Scene::tolerance`] of the nearest hit are one event.

use crate::scene::shape::{Crossing, Start, Toward};
use crate::scene::mesh::Line;
use crate::scene::pieces::Surface;
use crate::scene::{Inside, Owner, PrimId, Ray, Scene};
use smallvec::SmallVec;

/// One of the surfaces met at a hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrimHit {
    /// Which surface.
    pub prim: PrimId,
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

    /// Takes in a candidate: keeps those within `tolerance` of the nearest, the nearest first.
    #[inline]
    fn offer(&mut self, hit: PrimHit, tolerance: f64) {
        let Some(nearest) = self.0.first().map(|first| first.t) else {
            self.0.push(hit);
            return;
        };
        if hit.t > nearest + tolerance {
            return;
        }
        if hit.t < nearest {
            self.0.retain(|kept| kept.t <= hit.t + tolerance);
            self.0.insert(0, hit);
        } else {
            self.0.push(hit);
        }
    }

    /// Beyond this distance nothing can matter any more, mm.
    #[inline]
    fn limit(&self, tolerance: f64) -> f64 {
        self.0.first().map_or(f64::INFINITY, |first| first.t + tolerance)
    }
}

impl Scene {
    /// What a ray meets next that starts on the surfaces `from`, inside the solids `inside`.
    #[inline]
    pub fn next_hit(&self, ray: &Ray, from: &[PrimId], inside: &Inside) -> Hits {
        let mut hits = Hits::default();
        let line = self.line(ray);
        self.accel.visit(ray, |index| {
            let prim = PrimId::new(index);
            let start = if from.contains(&prim) { Start::On } else { Start::Elsewhere };
            self.crossings(prim, ray, line.as_ref(), start, |owner, crossing| {
                if self.counts(owner, crossing, inside) {
                    let Crossing { t, toward } = crossing;
                    hits.offer(PrimHit { prim, owner, t, toward }, self.tolerance);
                }
            });
            hits.limit(self.tolerance)
        });
        hits
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
            self.crossings(PrimId::new(index), ray, line.as_ref(), Start::Elsewhere, |owner, crossing| {
                if let Owner::Solid(solid) = owner {
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
            self.crossings(prim, ray, line.as_ref(), Start::Elsewhere, |_, crossing| visit(prim, crossing));
            f64::INFINITY
        });
    }

    /// The form of a ray that triangles are asked with, made once; none without meshes.
    #[inline]
    fn line(&self, ray: &Ray) -> Option<Line> {
        (!self.meshes.is_empty()).then(|| Line::of(ray))
    }

    /// Every crossing of a ray's line with a surface. A triangle is never met again from itself.
    #[inline]
    fn crossings(
        &self,
        prim: PrimId,
        ray: &Ray,
        line: Option<&Line>,
        start: Start,
        mut visit: impl FnMut(Owner, Crossing),
    ) {
        match (self.surface(prim), line) {
            (Surface::Patch(patch), _) => {
                patch.shape.crossings(ray, start, |crossing| visit(patch.owner, crossing));
            }
            (Surface::Triangle(body, triangle), Some(line)) if start == Start::Elsewhere => {
                if let Some(crossing) = body.mesh.crossing_of(triangle, line) {
                    visit(body.owner, crossing);
                }
            }
            (Surface::Triangle(..), _) => {}
        }
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
