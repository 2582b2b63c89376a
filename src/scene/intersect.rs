//! What a ray meets next.
//!
//! There are no epsilons against hitting the same surface twice. Of a solid, only crossings whose orientation fits
//! count: a path inside can only leave, a path outside can only enter; with that, a start point that rounding has put
//! a hair beyond an edge is still caught. Of the surface the ray starts on, the root at the start is no root.
//! Surfaces within [`Scene::tolerance`] of the nearest hit are one event.

use crate::scene::accel::{Accel, Tree};
use crate::scene::mesh::Line;
use crate::scene::shape::{Crossing, Start, Toward, Wanted};
use crate::scene::{FaceId, Inside, Owner, PrimId, Ray, Scene, SolidId};
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
pub struct Hits(SmallVec<[PrimHit; 1]>);

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

    /// The nearest of at least one surface, and the others.
    #[inline]
    pub(crate) fn first_and_others(&self) -> (&PrimHit, &[PrimHit]) {
        self.0.split_first().expect("a ray that meets nothing makes no interface")
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
}

/// The search for the nearest hit.
#[derive(Debug, Clone, Copy)]
struct Nearest {
    prim: PrimId,
    crossing: Crossing,
    /// Distance of the next one, as far as it was seen, mm.
    runner_up: f64,
}

impl Nearest {
    const NONE: Self = Self {
        prim: PrimId::new(0),
        crossing: Crossing { t: f64::INFINITY, toward: Toward::Front },
        runner_up: f64::INFINITY,
    };

    #[inline]
    fn consider(&mut self, prim: PrimId, crossing: Crossing) {
        if crossing.t < self.crossing.t {
            *self = Self { prim, crossing, runner_up: self.crossing.t };
        } else {
            self.runner_up = self.runner_up.min(crossing.t);
        }
    }
}

impl Scene {
    /// What a ray meets next that starts on the surfaces `from`, inside the solids `inside`: fills `hits` anew and
    /// returns the distance, mm; infinite when nothing is hit, never negative.
    #[inline(always)]
    pub fn find_next(&self, ray: &Ray, from: &[PrimId], inside: &Inside, hits: &mut Hits) -> f64 {
        hits.0.clear();
        let nearest = match &self.accel {
            Accel::Scan(_) => self.nearest_by_scan(ray, from, inside),
            Accel::Tree(tree) => self.nearest_in_tree(tree, ray, from, inside),
        };
        let Nearest { prim, crossing, runner_up } = nearest;
        if crossing.t < f64::INFINITY {
            hits.0.push(self.hit(prim, crossing));
            if runner_up <= crossing.t + self.tolerance {
                self.find_others(ray, from, inside, hits);
            }
        }
        crossing.t.max(0.0)
    }

    #[inline(always)]
    fn nearest_by_scan(&self, ray: &Ray, from: &[PrimId], inside: &Inside) -> Nearest {
        let mut nearest = Nearest::NONE;
        for (index, patch) in self.patches.iter().enumerate() {
            let prim = PrimId::new(index);
            let limit = nearest.crossing.t + self.tolerance;
            let Some(wanted) = self.wanted(patch.owner, inside, limit) else { continue };
            if let Some(crossing) = patch.shape.first_crossing(ray, start_on(prim, from), &wanted) {
                nearest.consider(prim, crossing);
            }
        }
        nearest
    }

    fn nearest_in_tree(&self, tree: &Tree, ray: &Ray, from: &[PrimId], inside: &Inside) -> Nearest {
        let line = self.line(ray);
        let mut nearest = Nearest::NONE;
        tree.visit(ray, |index| {
            let prim = PrimId::new(index);
            let limit = nearest.crossing.t + self.tolerance;
            if let Some(crossing) = self.crossing(prim, ray, line.as_ref(), from, inside, limit) {
                nearest.consider(prim, crossing);
            }
            nearest.crossing.t + self.tolerance
        });
        nearest
    }

    /// Adds the other surfaces at the place of the nearest hit.
    #[cold]
    fn find_others(&self, ray: &Ray, from: &[PrimId], inside: &Inside, hits: &mut Hits) {
        let nearest = hits.0[0];
        let limit = nearest.t + self.tolerance;
        let line = self.line(ray);
        self.accel.visit(ray, |index| {
            let prim = PrimId::new(index);
            if prim != nearest.prim {
                let crossing = self.crossing(prim, ray, line.as_ref(), from, inside, limit);
                hits.0.extend(crossing.map(|crossing| self.hit(prim, crossing)));
            }
            limit
        });
        hits.0[1..].sort_unstable_by_key(|hit| hit.prim);
    }

    /// The first crossing of a ray with a surface that counts, up to a distance.
    #[inline]
    fn crossing(
        &self,
        prim: PrimId,
        ray: &Ray,
        line: Option<&Line>,
        from: &[PrimId],
        inside: &Inside,
        limit: f64,
    ) -> Option<Crossing> {
        let surface = self.surface(prim);
        let wanted = self.wanted(surface.owner(), inside, limit)?;
        surface.first_crossing(ray, line, start_on(prim, from), &wanted)
    }

    /// Which crossings count: of a solid, those whose orientation fits.
    #[inline]
    fn wanted(&self, owner: Owner, inside: &Inside, max: f64) -> Option<Wanted> {
        let (toward, min) = match owner {
            Owner::Solid(solid) if inside.contains(solid) => (Some(Toward::Front), -self.tolerance),
            Owner::Solid(_) => (Some(Toward::Back), -self.tolerance),
            Owner::Sheet => (None, 0.0f64.next_up()),
            Owner::Port => return None,
        };
        Some(Wanted { toward, min, max })
    }

    #[inline]
    fn hit(&self, prim: PrimId, Crossing { t, toward }: Crossing) -> PrimHit {
        let surface = self.surface(prim);
        PrimHit { prim, face: surface.face(), owner: surface.owner(), t, toward }
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
}

/// Whether a ray that starts on the surfaces `from` starts on this one.
#[inline]
fn start_on(prim: PrimId, from: &[PrimId]) -> Start {
    if from.contains(&prim) { Start::On } else { Start::Elsewhere }
}

/// On which side of its start point a path is asked about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Just {
    /// Just ahead along its direction: a source on a face is already beyond it.
    Ahead,
    /// Just behind: light of a source on a face still has to cross it.
    Behind,
}
