//! Faces of meshes, with fine triangles joined.

use crate::scene::mesh::MeshBody;
use crate::scene::picture::facets::triangles::Triangulation;
use glam::{DVec3, I64Vec3};
use std::collections::{HashMap, HashSet};

/// Largest number of triangles that are drawn for a face.
const MOST_TRIANGLES: usize = 3000;
/// Cubes grow by this factor until the limit is met, 1.
const GROWTH: f64 = 1.4;

/// Faces of bodies with fine triangles joined: in cubes of `cell` mm, or in larger ones where there are very many.
pub(super) fn facets(faces: Vec<(&MeshBody, usize)>, cell: f64) -> Triangulation {
    let mut cell = cell;
    loop {
        if let Some(facets) = joined(&faces, cell) {
            return facets;
        }
        cell *= GROWTH;
    }
}

/// Faces with all corners in a cube merged, and without the triangles that this collapses; `None` if too many remain.
fn joined(faces: &[(&MeshBody, usize)], cell: f64) -> Option<Triangulation> {
    let mut facets = Triangulation::default();
    let mut corner_of: HashMap<[i64; 3], usize> = HashMap::new();
    let mut known: HashSet<[usize; 3]> = HashSet::new();
    let triangles = faces.iter().flat_map(|(body, face)| {
        body.mesh.face_triangles(*face).iter().map(|triangle| body.corners(*triangle as usize))
    });
    for corners in triangles {
        let corners = corners.map(|point| {
            let next = facets.points.len();
            let corner = *corner_of.entry(cube(point, cell)).or_insert(next);
            if corner == next {
                facets.points.push(point);
            }
            corner
        });
        let [a, b, c] = corners;
        let mut sorted = corners;
        sorted.sort_unstable();
        if a != b && b != c && c != a && known.insert(sorted) {
            facets.triangles.push(corners);
        }
        if facets.triangles.len() > MOST_TRIANGLES {
            return None;
        }
    }
    Some(facets)
}

fn cube(point: DVec3, cell: f64) -> [i64; 3] {
    let I64Vec3 { x, y, z } = (point / cell).floor().as_i64vec3();
    [x, y, z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::mesh::Mesh;
    use crate::scene::{FaceId, SolidId};
    use lumiduct_base::math::Frame;
    use lumiduct_base::mesh::bodies::{Normals, icosphere};

    #[test]
    fn coarse_meshes_stay_as_they_are_and_fine_ones_keep_their_size_with_fewer_triangles() {
        let of = |level: u32| {
            let mesh = Mesh::new(&icosphere(3.0, level, Normals::None), &Frame::WORLD);
            facets(vec![(&MeshBody::new(mesh, SolidId::new(0), vec![FaceId::new(0)]), 0)], 1e-3)
        };
        let coarse = of(2);
        assert_eq!((coarse.points.len(), coarse.triangles.len()), (162, 320));
        let fine = of(5);
        assert!((500..=MOST_TRIANGLES).contains(&fine.triangles.len()), "{}", fine.triangles.len());
        assert!(fine.points.iter().all(|point| (point.length() - 3.0).abs() < 1e-12));
    }
}
