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
    /// By surface that is not of a copy.
    slots: Vec<Slot>,
    copies: Vec<CopySlots>,
    pub(super) count: usize,
    pub(super) media: usize,
    /// By surface: its analytic pieces; none for a mesh.
    patches: Vec<Vec<PrimId>>,
}

impl SurfaceNumbers {
    /// The surfaces of a scene.
    pub fn new(scene: &Scene) -> Self {
        let triangles: usize = scene.meshes.iter().map(MeshBody::triangle_count).sum();
        let mut known: BTreeMap<SmoothId, Slot> = BTreeMap::new();
        let slots: Vec<Slot> = (0..scene.patches.len() + triangles)
            .map(|prim| {
                let next = known.len() as Slot;
                *known.entry(scene.smooth(PrimId::new(prim))).or_insert(next)
            })
            .collect();
        let mut count = known.len();
        // Without a number for each triangle: copies may have very many.
        let of_copy = |copy: &MeshBody| {
            let first = count as Slot;
            count += copy.mesh.patch_count();
            CopySlots { first_triangle: copy.first, first, mesh: Arc::clone(&copy.mesh) }
        };
        let copies = scene.copies.iter().map(of_copy).collect();
        let mut patches = vec![Vec::new(); known.len()];
        for (index, &slot) in slots.iter().take(scene.patches.len()).enumerate() {
            patches[slot as usize].push(PrimId::new(index));
        }
        Self { slots, copies, count, media: scene.media.len(), patches }
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
        self.slots.get(index).copied().unwrap_or_else(|| self.of_copied(index))
    }

    #[inline(never)]
    fn of_copied(&self, index: usize) -> Slot {
        let after = self.copies.partition_point(|copy| copy.first_triangle <= index);
        let copy = &self.copies[after - 1];
        copy.first + copy.mesh.smooth_id(index - copy.first_triangle)
    }
}

/// The smooth surfaces of a copy of a mesh.
#[derive(Debug)]
struct CopySlots {
    /// Number of its first triangle among all surfaces.
    first_triangle: usize,
    /// Number of the first of its smooth surfaces.
    first: Slot,
    mesh: Arc<Mesh>,
}
