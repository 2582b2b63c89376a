//! Triangle meshes with named faces, from any source.
//!
//! A [`TriangleMesh`] has positions in f64 millimetres, welded where they coincide exactly, normals
//! per corner, and a face for every triangle. [`MeshBuilder`] builds one from single triangles;
//! [`health()`] reports whether it is closed and the right way out. This module knows no optical
//! properties and no file format.

mod assembly;
pub mod bodies;
mod builder;
mod health;
pub mod topology;

pub use assembly::{
    CopiedBody, FaceSize, MAX_SHOWN_TRIANGLES, MeshAssembly, TRIANGLE_BYTES, WhyJoined,
};
pub use builder::{MeshBuilder, UnusableMesh};
pub use health::{Defects, MeshHealth, health, normals_agree};
pub use topology::is_closed;

use crate::math::Aabb;
use glam::DVec3;

/// Most triangles that a mesh may have: 5 GB as a [`TriangleMesh`] with normals.
pub const MAX_TRIANGLES: usize = 50_000_000;
/// Largest coordinate, mm: a thousand kilometres. Squares and cubes of it are far from overflow.
pub const MAX_COORDINATE_MM: f64 = 1.0e9;
/// Name of the face of triangles that have neither material nor group.
pub const UNNAMED_FACE: &str = "surface";

/// Triangles with their faces and normals.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    /// Vertices, mm; no two are equal.
    pub positions: Vec<DVec3>,
    /// Three indices into `positions` each; counter-clockwise seen from outside, if the file is
    /// correct.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals of the three corners of each triangle, if the file has normals.
    pub normals: Option<Vec<[DVec3; 3]>>,
    /// Index into `faces` of each triangle.
    pub face_of: Vec<u32>,
    /// Names of materials or groups, in order of appearance; every one has triangles.
    pub faces: Vec<String>,
}

impl TriangleMesh {
    /// The three vertices of a triangle, mm.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|index| self.positions[index as usize])
    }

    /// The smallest box around all vertices, mm.
    pub fn bounds(&self) -> Aabb {
        Aabb::of(self.positions.iter().copied())
    }

    /// Sizes of the faces, in their order.
    pub fn face_sizes(&self) -> Vec<FaceSize> {
        // In one pass: an OBJ file may have as many groups as triangles.
        let mut sizes = vec![FaceSize::default(); self.faces.len()];
        for (triangle, face) in self.face_of.iter().enumerate() {
            let size = &mut sizes[*face as usize];
            size.triangles += 1;
            size.area_mm2 += 0.5 * area_vector(self.corners(triangle)).length();
        }
        sizes
    }
}

/// Twice the area of a triangle times its unit normal, mm².
pub fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}
