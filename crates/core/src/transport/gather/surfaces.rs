//! The smooth surfaces and the media of a scene, numbered, for the index of records.

use crate::scene::{MediumId, PrimId, Scene, SmoothId};
use std::collections::BTreeMap;

/// A smooth surface by its index in the list of all, or a medium by its index after them.
pub(crate) type Slot = u32;

/// The smooth surfaces of a scene, numbered, followed by the media.
#[derive(Debug)]
pub struct SurfaceNumbers {
    slots: Vec<Slot>,
    pub(super) count: usize,
    pub(super) media: usize,
    /// By surface: its analytic pieces; none for a mesh.
    patches: Vec<Vec<PrimId>>,
}

impl SurfaceNumbers {
    /// The surfaces of a scene.
    pub fn new(scene: &Scene) -> Self {
        let triangles: usize = scene.meshes.iter().map(|body| body.mesh.triangle_count()).sum();
        let mut known: BTreeMap<SmoothId, Slot> = BTreeMap::new();
        let slots: Vec<Slot> = (0..scene.patches.len() + triangles)
            .map(|prim| {
                let next = known.len() as Slot;
                *known.entry(scene.smooth(PrimId::new(prim))).or_insert(next)
            })
            .collect();
        let count = known.len();
        let mut patches = vec![Vec::new(); count];
        for (index, &slot) in slots.iter().take(scene.patches.len()).enumerate() {
            patches[slot as usize].push(PrimId::new(index));
        }
        Self { slots, count, media: scene.media.len(), patches }
    }

    /// The analytic pieces of a surface; none for a mesh.
    pub(crate) fn patches(&self, surface: Slot) -> &[PrimId] {
        &self.patches[surface as usize]
    }

    /// The number of a medium for the records of light scattered within it.
    pub(crate) fn of_medium(&self, medium: MediumId) -> Slot {
        (self.count + medium.index()) as Slot
    }

    /// The smooth surface of a piece.
    #[inline]
    pub fn of(&self, prim: PrimId) -> Slot {
        self.slots[prim.index()]
    }
}
