//! A digest to distinguish inputs: 64-bit FNV-1a (Fowler, Noll & Vo; draft-eastlake-fnv).

use crate::mesh::{MeshAssembly, TriangleMesh};
use glam::DVec3;
use std::fmt;

/// A digest of everything added so far, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Digest {
    /// Adds a piece with its length, so that it matters where one piece ends.
    pub fn add(&mut self, piece: &[u8]) {
        self.add_bytes(&piece.len().to_le_bytes());
        self.add_bytes(piece);
    }

    /// Adds everything read from a file with meshes.
    pub fn add_assembly(&mut self, assembly: &MeshAssembly) {
        self.add_mesh(&assembly.mesh);
        for copied in &assembly.copied {
            self.add_mesh(&copied.body);
            self.add_bytes(&copied.places.len().to_le_bytes());
            let numbers = copied.places.iter().flat_map(|place| place.to_cols_array());
            numbers.for_each(|number| self.add_bytes(&number.to_le_bytes()));
        }
    }

    fn add_mesh(&mut self, mesh: &TriangleMesh) {
        self.add_bytes(&mesh.positions.len().to_le_bytes());
        mesh.positions.iter().for_each(|position| self.add_vector(*position));
        self.add_bytes(&mesh.triangles.len().to_le_bytes());
        for index in mesh.triangles.iter().flatten().chain(&mesh.face_of) {
            self.add_bytes(&index.to_le_bytes());
        }
        mesh.normals.iter().flatten().flatten().for_each(|normal| self.add_vector(*normal));
        mesh.faces.iter().for_each(|face| self.add(face.as_bytes()));
    }

    fn add_vector(&mut self, vector: DVec3) {
        vector.to_array().iter().for_each(|x| self.add_bytes(&x.to_le_bytes()));
    }

    fn add_bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(pieces: &[&str]) -> Digest {
        let mut digest = Digest::default();
        pieces.iter().for_each(|piece| digest.add(piece.as_bytes()));
        digest
    }

    /// Vectors of draft-eastlake-fnv, section 8.
    #[test]
    fn bytes_have_the_digest_that_is_published() {
        for (text, expected) in
            [("", "cbf29ce484222325"), ("a", "af63dc4c8601ec8c"), ("foobar", "85944171f73967e8")]
        {
            let mut digest = Digest::default();
            digest.add_bytes(text.as_bytes());
            assert_eq!(digest.to_string(), expected);
        }
    }

    #[test]
    fn the_end_of_a_piece_counts() {
        assert_ne!(of(&["ab", "c"]), of(&["a", "bc"]));
        assert_ne!(of(&["ab"]), of(&["ab", ""]));
    }

    #[test]
    fn a_vertex_that_moves_by_the_last_bit_counts() {
        let mut mesh = TriangleMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            normals: None,
            face_of: vec![0],
            faces: vec!["wall".into()],
        };
        let digest = |mesh: &TriangleMesh| {
            let mut digest = Digest::default();
            digest.add_mesh(mesh);
            digest
        };
        let before = digest(&mesh);
        mesh.positions[1].x = 1f64.next_up();
        assert_ne!(digest(&mesh), before);
    }
}
