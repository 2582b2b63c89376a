//! A mesh with closed bodies that are shown at several places and share their triangles.

use crate::math::Aabb;
use crate::mesh::TriangleMesh;
use crate::mesh::health::{CoarseFacets, MeshHealth, health};
use glam::{DAffine3, DVec3};
use indexmap::IndexMap;
use std::collections::BTreeMap;

/// Most triangles of an assembly, those of a copied body counted at each of its places.
pub const MAX_SHOWN_TRIANGLES: u64 = 1_000_000_000;

/// Memory of a triangle without and with normals while its scene is built, bytes: measured (docs/cad.md).
pub const TRIANGLE_BYTES: [u64; 2] = [160, 240];
/// The same of a copy.
const COPY_BYTES: u64 = 500;

/// Triangles at their places, and copies of bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshAssembly {
    /// Triangles at their places; perhaps none.
    pub mesh: TriangleMesh,
    /// Bodies with copies.
    pub copied: Vec<CopiedBody>,
    /// How many nodes of a file show a mesh that others show, too, but have triangles of their own in `mesh`, and why.
    pub joined: BTreeMap<WhyJoined, usize>,
}

/// Why a node of a file does not share the triangles of its mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum WhyJoined {
    /// All copies together have few triangles, which one tree over all finds faster.
    Few,
    /// It may touch another part, by their boxes.
    Touching,
    /// Its mesh is not closed by itself.
    Open,
    /// It stretches or shears its mesh.
    Distorted,
    /// It is far smaller than another copy.
    Tiny,
}

/// A body and the places of its copies.
#[derive(Debug, Clone, PartialEq)]
pub struct CopiedBody {
    /// The body, in coordinates of its own.
    pub body: TriangleMesh,
    /// Rotation, uniform scale and translation of each copy, mm.
    pub places: Vec<DAffine3>,
}

/// How large a face is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FaceSize {
    /// Its triangles.
    pub triangles: u64,
    /// Its area, mm².
    pub area_mm2: f64,
}

impl From<TriangleMesh> for MeshAssembly {
    fn from(mesh: TriangleMesh) -> Self {
        Self { mesh, copied: Vec::new(), joined: BTreeMap::new() }
    }
}

impl MeshAssembly {
    /// Names and sizes of the faces, in order of appearance; those of a body belong to faces of the same names.
    pub fn faces(&self) -> IndexMap<&str, FaceSize> {
        let mut faces: IndexMap<&str, FaceSize> = IndexMap::new();
        let copied = self
            .copied
            .iter()
            .map(|copied| (&copied.body, copied.places.len() as u64, copied.power_of_scales(2)));
        for (mesh, count, squares) in std::iter::once((&self.mesh, 1, 1.0)).chain(copied) {
            for (name, size) in mesh.faces.iter().zip(mesh.face_sizes()) {
                let face = faces.entry(name.as_str()).or_default();
                face.triangles += count * size.triangles;
                face.area_mm2 += squares * size.area_mm2;
            }
        }
        faces
    }

    /// Number of triangles, those of copied bodies at each of their places.
    pub fn triangle_count(&self) -> u64 {
        self.count(|mesh| mesh.triangles.len())
    }

    /// Number of vertices, those of copied bodies at each of their places.
    pub fn vertex_count(&self) -> u64 {
        self.count(|mesh| mesh.positions.len())
    }

    fn count(&self, of: impl Fn(&TriangleMesh) -> usize) -> u64 {
        let copied = self.copied.iter().map(|own| of(&own.body) as u64 * own.places.len() as u64);
        of(&self.mesh) as u64 + copied.sum::<u64>()
    }

    /// The smallest box around all vertices, mm.
    pub fn bounds(&self) -> Aabb {
        let copies = self.copied.iter().flat_map(CopiedBody::boxes);
        copies.fold(self.mesh.bounds(), Aabb::union)
    }

    /// Memory that it takes while its scene is built, about, bytes.
    pub fn memory_bytes(&self) -> u64 {
        let of = |mesh: &TriangleMesh| {
            let bytes = TRIANGLE_BYTES[usize::from(mesh.normals.is_some())];
            bytes * mesh.triangles.len() as u64
        };
        let copied = self.copied.iter();
        let copied = copied.map(|own| of(&own.body) + COPY_BYTES * own.places.len() as u64);
        of(&self.mesh) + copied.sum::<u64>()
    }

    /// Forgets the normals of corners.
    pub fn drop_normals(&mut self) {
        self.mesh.normals = None;
        self.copied.iter_mut().for_each(|copied| copied.body.normals = None);
    }

    /// Examines it.
    pub fn health(&self) -> MeshHealth {
        let mut all = health(&self.mesh);
        for copied in &self.copied {
            copied.add_to(&mut all);
        }
        all
    }
}

impl CopiedBody {
    /// The smallest box around the vertices of each copy, mm.
    pub fn boxes(&self) -> impl Iterator<Item = Aabb> {
        self.places.iter().map(|place| {
            Aabb::of(self.body.positions.iter().map(|position| place.transform_point3(*position)))
        })
    }

    /// Adds its copies to the health of others.
    fn add_to(&self, all: &mut MeshHealth) {
        let body = health(&self.body);
        for (all, own) in [
            (&mut all.open_edges, &body.open_edges),
            (&mut all.crowded_edges, &body.crowded_edges),
            (&mut all.inconsistent_edges, &body.inconsistent_edges),
            (&mut all.degenerate_triangles, &body.degenerate_triangles),
            (&mut all.slivers, &body.slivers),
            (&mut all.opposed_normals, &body.opposed_normals),
        ] {
            all.count += own.count * self.places.len();
            all.first = all.first.or(own.first.map(|place| self.in_first_copy(place)));
        }
        let rise = body.sagitta_mm.map(|rise| rise * self.scales().fold(0.0, f64::max));
        all.sagitta_mm = all.sagitta_mm.into_iter().chain(rise).reduce(f64::max);
        let squares = self.power_of_scales(2);
        let [own, added] = [all.faceted_mm2(), squares * body.faceted_mm2()];
        all.area_mm2 += squares * body.area_mm2;
        // The larger faceted part is typical of all.
        let typical = if added > own { &body.facets } else { &all.facets };
        all.facets = typical
            .map(|facets| CoarseFacets { area_share: (own + added) / all.area_mm2, ..facets });
        all.signed_volume_mm3 += self.power_of_scales(3) * body.signed_volume_mm3;
        all.shells += body.shells * self.places.len();
    }

    /// Sum of a power of the scales of all copies, 1.
    fn power_of_scales(&self, power: i32) -> f64 {
        self.scales().map(|scale| scale.powi(power)).sum()
    }

    /// A point of the body in its first copy, mm.
    fn in_first_copy(&self, point: DVec3) -> DVec3 {
        self.places.first().map_or(point, |place| place.transform_point3(point))
    }

    fn scales(&self) -> impl Iterator<Item = f64> {
        self.places.iter().map(|place| place.matrix3.determinant().cbrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::bodies::{Normals, icosphere};
    use glam::DQuat;

    #[test]
    fn copies_count_at_each_place_with_their_scales() {
        let ball = icosphere(1.0, 2, Normals::None);
        let place = |scale: f64, x: f64| {
            let turned = DQuat::from_rotation_y(x);
            DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turned, x * DVec3::X)
        };
        let copied =
            CopiedBody { body: ball.clone(), places: vec![place(1.0, 5.0), place(2.0, 9.0)] };
        let assembly = MeshAssembly { copied: vec![copied], ..ball.clone().into() };
        let (one, all) = (health(&ball), assembly.health());
        assert!(all.is_sound());
        assert_eq!((all.shells, assembly.triangle_count()), (3, 960));
        assert!((all.signed_volume_mm3 / one.signed_volume_mm3 - 10.0).abs() < 1e-12);
        assert!((all.area_mm2 / one.area_mm2 - 6.0).abs() < 1e-12);
        let [one, all] = [one, all].map(|health| health.facets.unwrap());
        assert_eq!(one.turn_deg, all.turn_deg);
        assert!((one.area_share - all.area_share).abs() < 1e-12);
        let faces = assembly.faces();
        assert_eq!(faces.len(), 1);
        assert_eq!(faces["surface"].triangles, 960);
        assert!((assembly.bounds().max.x - 11.0).abs() < 0.1);
    }
}
