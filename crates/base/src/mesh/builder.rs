//! Collects triangles of any format, welds equal positions and refuses non-finite numbers.

use crate::mesh::{
    CopiedBody, MAX_COORDINATE_MM, MAX_TRIANGLES, MeshAssembly, TriangleMesh, UNNAMED_FACE,
    area_vector,
};
use glam::DVec3;
use indexmap::IndexSet;
use std::collections::HashMap;

/// Why triangles make no mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum UnusableMesh {
    /// There are more triangles than [`MAX_TRIANGLES`].
    #[error(
        "the mesh has more than {} million triangles; export a coarser mesh with smooth normals",
        MAX_TRIANGLES / 1_000_000
    )]
    TooManyTriangles,
    /// There is nothing to trace.
    #[error("the file holds no triangles; export the solid as a triangle mesh")]
    NoTriangles,
    /// A coordinate or a component of a normal is infinite or not a number.
    #[error(
        "triangle {triangle} has a {what} that is not a finite number; repair the mesh and export it again"
    )]
    NotFinite {
        /// The triangle, counted from 1.
        triangle: usize,
        /// `vertex` or `normal`.
        what: &'static str,
    },
    /// A vertex lies beyond `MAX_COORDINATE_MM`.
    #[error("triangle {triangle} has a vertex beyond 1000 km; check the unit of the mesh")]
    TooFar {
        /// The triangle, counted from 1.
        triangle: usize,
    },
}

/// A mesh under construction.
#[derive(Debug, Default)]
pub struct MeshBuilder {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Empty until the first triangle with normals; zero where the file has none.
    normals: Vec<[DVec3; 3]>,
    face_of: Vec<u32>,
    faces: IndexSet<String>,
    /// Looked up, never iterated.
    index_of: HashMap<[u64; 3], u32>,
}

impl MeshBuilder {
    /// Adds a triangle: corners in mm, normals of any length.
    ///
    /// # Errors
    ///
    /// [`UnusableMesh::NotFinite`] for a coordinate or a normal that is not finite, [`UnusableMesh::TooFar`] for a
    /// vertex beyond 1000 km, [`UnusableMesh::TooManyTriangles`] after [`MAX_TRIANGLES`]. Nothing is added then.
    pub fn add(
        &mut self,
        corners: [DVec3; 3],
        normals: Option<[DVec3; 3]>,
        face: &str,
    ) -> Result<(), UnusableMesh> {
        self.check(&corners, normals.as_ref())?;
        if let Some(normals) = normals {
            self.normals.resize(self.triangles.len(), [DVec3::ZERO; 3]);
            self.normals.push(normals.map(DVec3::normalize_or_zero));
        } else if !self.normals.is_empty() {
            self.normals.push([DVec3::ZERO; 3]);
        }
        let triangle = corners.map(|corner| self.vertex(corner));
        self.triangles.push(triangle);
        let face = self.face(face);
        self.face_of.push(face);
        Ok(())
    }

    /// The vertices so far, mm.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The mesh; corners without a normal get that of their facet if other corners have one.
    ///
    /// # Errors
    ///
    /// [`UnusableMesh::NoTriangles`] if none was added.
    pub fn finish(self) -> Result<TriangleMesh, UnusableMesh> {
        Ok(self.finish_with(Vec::new())?.mesh)
    }

    /// The same with bodies that have copies.
    ///
    /// # Errors
    ///
    /// [`UnusableMesh::NoTriangles`] if neither was added.
    pub fn finish_with(self, copied: Vec<CopiedBody>) -> Result<MeshAssembly, UnusableMesh> {
        if self.triangles.is_empty() && copied.is_empty() {
            return Err(UnusableMesh::NoTriangles);
        }
        Ok(MeshAssembly { copied, ..self.into_mesh().into() })
    }

    fn into_mesh(self) -> TriangleMesh {
        let mut mesh = TriangleMesh {
            positions: self.positions,
            triangles: self.triangles,
            normals: None,
            face_of: self.face_of,
            faces: self.faces.into_iter().collect(),
        };
        mesh.positions.shrink_to_fit();
        mesh.triangles.shrink_to_fit();
        mesh.face_of.shrink_to_fit();
        let mut normals = self.normals;
        if normals.iter().flatten().all(|normal| *normal == DVec3::ZERO) {
            return mesh;
        }
        for (triangle, normals) in normals.iter_mut().enumerate() {
            let facet = area_vector(mesh.corners(triangle)).normalize_or(DVec3::Z);
            for normal in normals.iter_mut().filter(|normal| **normal == DVec3::ZERO) {
                *normal = facet;
            }
        }
        normals.shrink_to_fit();
        mesh.normals = Some(normals);
        mesh
    }

    fn check(
        &self,
        corners: &[DVec3; 3],
        normals: Option<&[DVec3; 3]>,
    ) -> Result<(), UnusableMesh> {
        if self.triangles.len() >= MAX_TRIANGLES {
            return Err(UnusableMesh::TooManyTriangles);
        }
        let triangle = self.triangles.len() + 1;
        if corners.iter().any(|corner| !corner.is_finite()) {
            return Err(UnusableMesh::NotFinite { triangle, what: "vertex" });
        }
        if corners.iter().any(|corner| corner.abs().max_element() > MAX_COORDINATE_MM) {
            return Err(UnusableMesh::TooFar { triangle });
        }
        if normals.is_some_and(|normals| normals.iter().any(|normal| !normal.is_finite())) {
            return Err(UnusableMesh::NotFinite { triangle, what: "normal" });
        }
        Ok(())
    }

    fn vertex(&mut self, position: DVec3) -> u32 {
        // Adding zero turns -0 into +0, the same position.
        let position = position + DVec3::ZERO;
        let next = self.positions.len() as u32;
        let index = *self.index_of.entry(position.to_array().map(f64::to_bits)).or_insert(next);
        if index == next {
            self.positions.push(position);
        }
        index
    }

    fn face(&mut self, name: &str) -> u32 {
        let name = name.trim();
        let name = if name.is_empty() { UNNAMED_FACE } else { name };
        let index = match self.faces.get_index_of(name) {
            Some(index) => index,
            None => self.faces.insert_full(name.to_owned()).0,
        };
        index as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_positions_are_one_vertex_and_minus_zero_is_zero() {
        let mut builder = MeshBuilder::default();
        builder.add([DVec3::ZERO, DVec3::X, DVec3::Y], None, "").unwrap();
        builder.add([-DVec3::ZERO, DVec3::Y, DVec3::Z], None, "wall").unwrap();
        let mesh = builder.finish().unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.faces, ["surface", "wall"]);
        assert_eq!(mesh.normals, None);
    }

    #[test]
    fn corners_without_a_normal_get_the_facets() {
        let mut builder = MeshBuilder::default();
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        builder.add(triangle, None, "").unwrap();
        builder.add(triangle, Some([3.0 * DVec3::X, DVec3::ZERO, DVec3::Y]), "").unwrap();
        let normals = builder.finish().unwrap().normals.unwrap();
        assert_eq!(normals, [[DVec3::Z; 3], [DVec3::X, DVec3::Z, DVec3::Y]]);
    }

    #[test]
    fn numbers_that_are_none_are_named_with_their_triangle() {
        let mut builder = MeshBuilder::default();
        let good = [DVec3::ZERO, DVec3::X, DVec3::Y];
        builder.add(good, None, "").unwrap();
        let bad = [DVec3::ZERO, DVec3::NAN, DVec3::Y];
        let error = builder.add(bad, None, "").unwrap_err();
        assert!(matches!(error, UnusableMesh::NotFinite { triangle: 2, what: "vertex" }));
        let error = builder.add(good, Some([DVec3::INFINITY; 3]), "").unwrap_err();
        assert!(matches!(error, UnusableMesh::NotFinite { triangle: 2, what: "normal" }));
        let error = builder.add([1e10 * DVec3::X; 3], None, "").unwrap_err();
        assert!(matches!(error, UnusableMesh::TooFar { triangle: 2 }));
    }
}
