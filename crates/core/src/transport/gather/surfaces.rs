//! The smooth surfaces and the media of a scene, numbered, for the index of records.

use crate::scene::mesh::{Mesh, MeshBody};
use crate::scene::{MediumId, PrimId, Scene, SmoothId};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A smooth surface by its index in the list of all, or a medium by its index after them.
pub(crate) type Slot = u32;

/// The smooth surfaces of a scene, numbered, followed by the media.
#[derive(Debug)]
pub struct SurfaceNumbers {
    /// By patch.
    slots: Vec<Slot>,
    /// Those of bodies of triangles, in the order of their triangles.
    bodies: Vec<BodySlots>,
    pub(super) count: usize,
    pub(super) media: usize,
    /// By surface: its analytic pieces; none for a mesh.
    patches: Vec<Vec<PrimId>>,
}

impl SurfaceNumbers {
    /// The surfaces of a scene.
    pub fn new(scene: &Scene) -> Self {
        let mut known: BTreeMap<SmoothId, Slot> = BTreeMap::new();
        let slots: Vec<Slot> = (0..scene.patches.len())
            .map(|prim| {
                let next = known.len() as Slot;
                *known.entry(scene.smooth(PrimId::new(prim))).or_insert(next)
            })
            .collect();
        let mut count = known.len();
        // Without a number for each triangle: there may be very many.
        let of_body = |body: &MeshBody| {
            let first = count as Slot;
            count += body.mesh.patch_count();
            BodySlots { first_triangle: body.first, first, mesh: Arc::clone(&body.mesh) }
        };
        let bodies = scene.mesh_bodies().map(of_body).collect();
        let mut patches = vec![Vec::new(); known.len()];
        for (index, &slot) in slots.iter().enumerate() {
            patches[slot as usize].push(PrimId::new(index));
        }
        Self { slots, bodies, count, media: scene.media.len(), patches }
    }

    /// The analytic pieces of a surface; none for a mesh.
    pub(crate) fn patches(&self, surface: Slot) -> &[PrimId] {
        self.patches.get(surface as usize).map_or(&[], Vec::as_slice)
    }

    /// The number of a medium for the records of light scattered within it.
    pub(crate) fn of_medium(&self, medium: MediumId) -> Slot {
        (self.count + medium.index()) as Slot
    }

    /// The smooth surface of a piece.
    #[inline]
    pub fn of(&self, prim: PrimId) -> Slot {
        let index = prim.index();
        self.slots.get(index).copied().unwrap_or_else(|| self.of_triangle(index))
    }

    #[inline(never)]
    fn of_triangle(&self, index: usize) -> Slot {
        let after = self.bodies.partition_point(|body| body.first_triangle <= index);
        let body = &self.bodies[after - 1];
        body.first + body.mesh.smooth_id(index - body.first_triangle)
    }
}

/// The smooth surfaces of a mesh or of a copy.
#[derive(Debug)]
struct BodySlots {
    /// Number of its first triangle among all surfaces.
    first_triangle: usize,
    /// Number of the first of its smooth surfaces.
    first: Slot,
    mesh: Arc<Mesh>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Medium;
    use crate::scene::mesh::MeshPlace;
    use crate::scene::{Builder, Solid};
    use glam::{DAffine3, DVec3};
    use lumiduct_base::math::{Aabb, Frame};
    use lumiduct_base::mesh::bodies::{Normals, rod};
    use lumiduct_base::units::FluxUnit;

    #[test]
    fn triangles_have_the_same_number_where_they_are_of_one_smooth_surface() {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let medium = builder.add_medium(Medium::new("glass", 1.5, 0.0));
        let (name, bounds) = ("rods".to_owned(), Aabb::EMPTY);
        let solid = builder.add_solid(Solid { name, medium, priority: 0, bounds, volume: None });
        let finishes = [[None; 2]; 3];
        let rods = [Normals::Smooth, Normals::None].map(|normals| rod(2.0, 9.0, 6, normals));
        for (step, rod) in rods.iter().enumerate() {
            let mesh = Mesh::new(rod, &Frame::WORLD);
            let place = |x: f64| {
                let at = DAffine3::from_translation(DVec3::new(x, 9.0 * step as f64, 0.0));
                MeshPlace::new(&at, &Frame::WORLD)
            };
            let places = [10.0, 20.0, 30.0].map(place).to_vec();
            builder.add_mesh_copies("rods", solid, (mesh, places), &finishes);
        }
        builder.add_mesh("other", solid, Mesh::new(&rods[0], &Frame::WORLD), &finishes);
        let scene = builder.build();
        let numbers = SurfaceNumbers::new(&scene);
        let triangles = 7 * 24;
        // Three for each of four rods with normals, and eight for each of three without.
        assert_eq!(numbers.count, 4 * 3 + 3 * 8);
        for one in 0..triangles {
            for other in 0..triangles {
                let prims = [one, other].map(PrimId::new);
                let [a, b] = prims.map(|prim| numbers.of(prim));
                let [c, d] = prims.map(|prim| scene.smooth(prim));
                assert_eq!(a == b, c == d, "{one} {other}");
                assert!((a as usize) < numbers.count);
            }
        }
    }
}
