//! The sphere around everything in a scene, from which far fields start.

use crate::scene::Scene;
use crate::scene::mesh::MeshBody;
use glam::DVec3;
use lumiduct_base::math::Aabb;

/// A ball around everything that light can meet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Around {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

impl Around {
    /// That of a scene.
    pub(super) fn of(scene: &Scene) -> Self {
        let solids = scene.patches.iter().map(|patch| patch.shape.bounds());
        let meshes = scene.mesh_bodies().map(MeshBody::bounds);
        let sources = scene.sources.iter().map(|source| source.emitter.bounds());
        let bounds = solids.chain(meshes).chain(sources).fold(Aabb::EMPTY, Aabb::union);
        // Slightly larger, for rounding, and a nanometre around a point that is alone.
        let radius = (0.5 * bounds.diagonal() * (1.0 + 1e-9)).max(1e-6);
        Self { center: bounds.center(), radius }
    }
}
