//! The next surface that a ray meets.
//!
//! There are no epsilons against hitting the same surface twice. For a solid, only crossings of the
//! right orientation count: a path inside can only leave, a path outside can only enter. A start
//! point that rounding has put slightly beyond an edge is therefore still caught. For the surface
//! the ray starts on, the root at the start is excluded. Surfaces within [`Scene::tolerance`] of
//! the nearest hit are one event.

use crate::scene::crossing::accel::Accel;
use crate::scene::crossing::hit::{Hits, Nearest, PrimHit, StartSide};
use crate::scene::crossing::tree::SurfaceTree;
use crate::scene::mesh::MeshBody;
use crate::scene::shape::{Crossing, CrossingQuery, RayStart, Toward};
use crate::scene::{Inside, Owner, PrimId, Ray, Scene, StartSurfaces};
use smallvec::SmallVec;
use std::iter;

impl Scene {
    /// The next hit of a ray that starts on the surfaces `from`, inside the solids `inside`.
    #[inline(always)]
    pub fn find_next(&self, ray: &Ray, from: &StartSurfaces, inside: &Inside) -> Option<Hits> {
        let nearest = match &self.accel {
            Accel::Scan(_) => self.nearest_by_scan(ray, from, inside),
            Accel::Tree(tree) => self.nearest_in_tree(tree, &ray.lent(), from, inside),
        };
        let Nearest { prim, crossing, runner_up } = nearest;
        if crossing.t == f64::INFINITY {
            return None;
        }
        let others = if runner_up <= crossing.t + self.tolerance {
            self.find_others(&ray.lent(), from, inside, &nearest)
        } else {
            Box::default()
        };
        let nearest = self.hit(prim, crossing.toward);
        Some(Hits { distance: crossing.t.max(0.0), nearest, others })
    }

    #[inline(always)]
    fn nearest_by_scan(&self, ray: &Ray, from: &StartSurfaces, inside: &Inside) -> Nearest {
        let mut nearest = Nearest::NONE;
        for convex in &self.convex {
            if !inside.contains(convex.solid()) {
                if let Some((prim, crossing)) = convex.entry(ray, from, self.tolerance) {
                    nearest.consider(prim, crossing);
                }
            } else if let Some(exit) = convex.exit(ray, from, self.tolerance) {
                nearest.consider(exit.prim, exit.crossing);
                nearest.consider_runner_up(exit.runner_up);
            } else {
                return self.nearest_by_edges(&ray.lent(), from, inside);
            }
        }
        self.scan(self.loose.iter().copied(), ray, from, inside, &mut nearest);
        nearest
    }

    /// The same with all edges tested, for a path that rounding has put slightly off its position.
    #[inline(never)]
    fn nearest_by_edges(&self, ray: &Ray, from: &StartSurfaces, inside: &Inside) -> Nearest {
        let mut nearest = Nearest::NONE;
        self.scan((0..self.patches.len()).map(PrimId::new), ray, from, inside, &mut nearest);
        nearest
    }

    /// Tests patches one by one.
    #[inline(always)]
    fn scan(
        &self,
        prims: impl Iterator<Item = PrimId>,
        ray: &Ray,
        from: &StartSurfaces,
        inside: &Inside,
        nearest: &mut Nearest,
    ) {
        for prim in prims {
            let patch = &self.patches[prim.index()];
            let limit = nearest.crossing.t + self.tolerance;
            let Some(wanted) = self.wanted(patch.owner, inside, limit) else { continue };
            if let Some(crossing) = patch.first_crossing(ray, start_on(prim, from), &wanted) {
                nearest.consider(prim, crossing);
            }
        }
    }

    #[inline(never)]
    fn nearest_in_tree(
        &self,
        tree: &SurfaceTree,
        ray: &Ray,
        from: &StartSurfaces,
        inside: &Inside,
    ) -> Nearest {
        let mut nearest = Nearest::NONE;
        tree.visit(ray, |index| {
            if index < self.patches.len() {
                self.scan(iter::once(PrimId::new(index)), ray, from, inside, &mut nearest);
            } else {
                let body = self.mesh_body(index - self.patches.len());
                // Passed by value, so that it stays in registers.
                nearest = self.nearest_in_body(body, ray, from, inside, nearest);
            }
            nearest.crossing.t + self.tolerance
        });
        nearest
    }

    /// The nearest surface so far, or a nearer triangle.
    #[inline(never)]
    fn nearest_in_body(
        &self,
        body: &MeshBody,
        ray: &Ray,
        from: &StartSurfaces,
        inside: &Inside,
        mut nearest: Nearest,
    ) -> Nearest {
        let limit = nearest.crossing.t + self.tolerance;
        self.visit_body(body, ray, (from, inside), limit, |prim, crossing| {
            nearest.consider(prim, crossing);
            nearest.crossing.t + self.tolerance
        });
        nearest
    }

    /// Calls `visit` with the crossings with triangles of a body that count, up to `limit` and the smallest distance that `visit` has
    /// returned, mm.
    #[inline(always)]
    fn visit_body(
        &self,
        body: &MeshBody,
        ray: &Ray,
        (from, inside): (&StartSurfaces, &Inside),
        limit: f64,
        mut visit: impl FnMut(PrimId, Crossing) -> f64,
    ) {
        let toward = inside.toward(body.solid);
        let mut limit = limit;
        body.visit_crossings(ray, toward, limit, |triangle, crossing| {
            let prim = PrimId::new(body.first + triangle);
            let counts = (-self.tolerance..=limit).contains(&crossing.t) && !from.contains(prim);
            if counts {
                limit = visit(prim, crossing);
            }
            limit
        });
    }

    /// The other surfaces at the nearest hit.
    #[inline(never)]
    fn find_others(
        &self,
        ray: &Ray,
        from: &StartSurfaces,
        inside: &Inside,
        nearest: &Nearest,
    ) -> Box<[PrimHit]> {
        let limit = nearest.crossing.t + self.tolerance;
        let mut others = Vec::new();
        let mut add = |prim: PrimId, crossing: Crossing| {
            if prim != nearest.prim {
                others.push(self.hit(prim, crossing.toward));
            }
            limit
        };
        self.accel.visit(ray, |index| {
            let Some(patch) = self.patches.get(index) else {
                let body = self.mesh_body(index - self.patches.len());
                self.visit_body(body, ray, (from, inside), limit, &mut add);
                return limit;
            };
            if let Some(wanted) = self.wanted(patch.owner, inside, limit) {
                let prim = PrimId::new(index);
                let crossing = patch.first_crossing(ray, start_on(prim, from), &wanted);
                crossing.map(|crossing| add(prim, crossing));
            }
            limit
        });
        others.sort_unstable_by_key(|hit: &PrimHit| hit.prim);
        others.into()
    }

    /// The crossings that count: for a solid, those of the right orientation.
    #[inline(always)]
    fn wanted(&self, owner: Owner, inside: &Inside, max: f64) -> Option<CrossingQuery> {
        let (toward, min) = match owner {
            Owner::Solid(solid) => (Some(inside.toward(solid)), -self.tolerance),
            Owner::Sheet => (None, 0.0f64.next_up()),
            Owner::Port => return None,
        };
        Some(CrossingQuery { toward, min, max })
    }

    #[inline]
    fn hit(&self, prim: PrimId, toward: Toward) -> PrimHit {
        let surface = self.surface(prim);
        PrimHit { prim, face: surface.face(), owner: surface.owner(), toward }
    }

    /// The solids that contain a path just ahead of its start or just behind.
    pub fn inside_at(&self, ray: &Ray, when: StartSide) -> Inside {
        // The nearest crossing of each solid beyond the start decides: leaving it means having been
        // in it.
        let mut nearest: SmallVec<[(f64, Toward); 8]> =
            SmallVec::from_elem((f64::INFINITY, Toward::Back), self.solids.len());
        let beyond = match when {
            StartSide::Ahead => self.tolerance,
            StartSide::Behind => -self.tolerance,
        };
        self.all_crossings(ray, |prim, crossing| {
            if let Owner::Solid(solid) = self.surface(prim).owner() {
                let slot = &mut nearest[solid.index()];
                if crossing.t > beyond && crossing.t < slot.0 {
                    *slot = (crossing.t, crossing.toward);
                }
            }
        });
        nearest
            .iter()
            .enumerate()
            .filter(|(_, (_, toward))| *toward == Toward::Front)
            .map(|(index, _)| crate::scene::SolidId::new(index))
            .collect()
    }

    /// Every crossing ahead of a ray with the surfaces of solids and sheets, in any order.
    pub fn all_crossings(&self, ray: &Ray, mut visit: impl FnMut(PrimId, Crossing)) {
        self.accel.visit(ray, |index| {
            if let Some(patch) = self.patches.get(index) {
                patch.crossings(ray, RayStart::Elsewhere, |crossing| {
                    visit(PrimId::new(index), crossing);
                });
                return f64::INFINITY;
            }
            let body = self.mesh_body(index - self.patches.len());
            for toward in [Toward::Front, Toward::Back] {
                body.visit_crossings(ray, toward, f64::INFINITY, |triangle, crossing| {
                    visit(PrimId::new(body.first + triangle), crossing);
                    f64::INFINITY
                });
            }
            f64::INFINITY
        });
    }
}

/// Whether a ray that starts on the surfaces `from` starts on this one.
#[inline(always)]
fn start_on(prim: PrimId, from: &StartSurfaces) -> RayStart {
    if from.contains(prim) { RayStart::On } else { RayStart::Elsewhere }
}
