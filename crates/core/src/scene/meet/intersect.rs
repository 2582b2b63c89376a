//! The next surface that a ray meets.
//!
//! There are no epsilons against hitting the same surface twice. For a solid, only crossings of the
//! right orientation count: a path inside can only leave, a path outside can only enter. A start
//! point that rounding has put slightly beyond an edge is therefore still caught. For the surface
//! the ray starts on, the root at the start is excluded. Surfaces within [`Scene::tolerance`] of
//! the nearest hit are one event.

use crate::scene::crossing::accel::Accel;
use crate::scene::crossing::hit::{Hits, Nearest, PrimHit, StartSide};
use crate::scene::crossing::tree::Tree;
use crate::scene::mesh::{MeshBody, TriangleLine};
use crate::scene::shape::{Crossing, CrossingQuery, RayStart, Toward};
use crate::scene::{Inside, Owner, PrimId, Ray, Scene, StartSurfaces, Surface};
use smallvec::SmallVec;

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
        tree: &Tree,
        ray: &Ray,
        from: &StartSurfaces,
        inside: &Inside,
    ) -> Nearest {
        let line = self.line(ray);
        let mut nearest = Nearest::NONE;
        tree.visit(ray, f64::INFINITY, |index| {
            if let Some(copy) = self.copy_at(index) {
                // Passed by value, so that it stays in registers.
                nearest = self.nearest_in_copy(copy, ray, from, inside, nearest);
            } else {
                let prim = PrimId::new(index);
                let met = Met { surface: self.surface(prim), line: line.as_ref() };
                let limit = nearest.crossing.t + self.tolerance;
                if let Some(crossing) = self.crossing(prim, met, ray, from, (inside, limit)) {
                    nearest.consider(prim, crossing);
                }
            }
            nearest.crossing.t + self.tolerance
        });
        nearest
    }

    /// The nearest surface so far, or a nearer triangle of a copy.
    #[inline(never)]
    fn nearest_in_copy(
        &self,
        copy: &MeshBody,
        ray: &Ray,
        from: &StartSurfaces,
        inside: &Inside,
        mut nearest: Nearest,
    ) -> Nearest {
        copy.visit_copy(ray, nearest.crossing.t + self.tolerance, |prim, met| {
            let limit = nearest.crossing.t + self.tolerance;
            if let Some(crossing) = self.crossing(prim, met, ray, from, (inside, limit)) {
                nearest.consider(prim, crossing);
            }
            nearest.crossing.t + self.tolerance
        });
        nearest
    }

    /// The copy of a mesh with this number in the tree, after all surfaces that are not copied.
    #[inline(always)]
    fn copy_at(&self, index: usize) -> Option<&MeshBody> {
        self.copies.get(index.wrapping_sub(self.first_of_copies))
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
        self.visit(ray, limit, |prim, met| {
            if prim != nearest.prim {
                let crossing = self.crossing(prim, met, ray, from, (inside, limit));
                others.extend(crossing.map(|crossing| self.hit(prim, crossing.toward)));
            }
        });
        others.sort_unstable_by_key(|hit: &PrimHit| hit.prim);
        others.into()
    }

    /// Calls `visit` with every surface whose box the ray meets before `limit`, mm; a scan visits all.
    fn visit(&self, ray: &Ray, limit: f64, mut visit: impl FnMut(PrimId, Met<'_>)) {
        let line = self.line(ray);
        self.accel.visit(ray, |index| {
            if let Some(copy) = self.copy_at(index) {
                copy.visit_copy(ray, limit, |prim, met| {
                    visit(prim, met);
                    limit
                });
            } else {
                let prim = PrimId::new(index);
                visit(prim, Met { surface: self.surface(prim), line: line.as_ref() });
            }
            limit
        });
    }

    /// The first crossing of a ray with a surface that counts, up to a distance.
    #[inline(always)]
    fn crossing(
        &self,
        prim: PrimId,
        met: Met<'_>,
        ray: &Ray,
        from: &StartSurfaces,
        (inside, limit): (&Inside, f64),
    ) -> Option<Crossing> {
        match met.surface {
            Surface::Patch(patch) => {
                let wanted = self.wanted(patch.owner, inside, limit)?;
                patch.first_crossing(ray, start_on(prim, from), &wanted)
            }
            Surface::Triangle(body, triangle) => {
                // Most triangles are missed; whether a crossing counts is checked only for the
                // others.
                let crossing = body.mesh.crossing_of(triangle, met.line?)?;
                let wanted = self.wanted(body.owner, inside, limit)?;
                (wanted.includes(&crossing) && !from.contains(prim)).then_some(crossing)
            }
        }
    }

    /// The crossings that count: for a solid, those of the right orientation.
    #[inline(always)]
    fn wanted(&self, owner: Owner, inside: &Inside, max: f64) -> Option<CrossingQuery> {
        let (toward, min) = match owner {
            Owner::Solid(solid) if inside.contains(solid) => (Some(Toward::Front), -self.tolerance),
            Owner::Solid(_) => (Some(Toward::Back), -self.tolerance),
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
        self.visit(ray, f64::INFINITY, |_, Met { surface, line }| {
            surface.crossings(ray, line, RayStart::Elsewhere, |crossing| {
                if let Owner::Solid(solid) = surface.owner() {
                    let slot = &mut nearest[solid.index()];
                    if crossing.t > beyond && crossing.t < slot.0 {
                        *slot = (crossing.t, crossing.toward);
                    }
                }
            });
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
        self.visit(ray, f64::INFINITY, |prim, Met { surface, line }| {
            surface.crossings(ray, line, RayStart::Elsewhere, |crossing| visit(prim, crossing));
        });
    }

    /// The form of a ray for triangle tests, made once; none without meshes.
    #[inline]
    fn line(&self, ray: &Ray) -> Option<TriangleLine> {
        (!self.meshes.is_empty()).then(|| TriangleLine::of(ray))
    }
}

/// A surface that a ray may cross.
#[derive(Clone, Copy)]
struct Met<'s> {
    surface: Surface<'s>,
    /// The line of the ray in the coordinates of a triangle; none without triangles.
    line: Option<&'s TriangleLine>,
}

impl MeshBody {
    /// Calls `visit` with every triangle of a copy whose box the ray meets before `limit`, mm, and the smallest distance that
    /// `visit` has returned.
    #[inline(always)]
    fn visit_copy(&self, ray: &Ray, limit: f64, mut visit: impl FnMut(PrimId, Met<'_>) -> f64) {
        self.visit_triangles(ray, limit, |triangle, line| {
            let surface = Surface::Triangle(self, triangle);
            visit(PrimId::new(self.first + triangle), Met { surface, line: Some(line) })
        });
    }
}

/// Whether a ray that starts on the surfaces `from` starts on this one.
#[inline(always)]
fn start_on(prim: PrimId, from: &StartSurfaces) -> RayStart {
    if from.contains(prim) { RayStart::On } else { RayStart::Elsewhere }
}
