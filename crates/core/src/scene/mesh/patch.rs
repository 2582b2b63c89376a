//! Grouping of triangles into smooth surfaces.

use lumiduct_base::mesh::topology::{Groups, HalfEdge, half_edges, same_edge};
use lumiduct_base::mesh::{TriangleMesh, area_vector, normals_agree};

/// The smooth patch of each triangle, numbered from 0 in order of appearance; `flatness` is the
/// largest distance, mm, of a vertex of a plane from it.
pub(super) fn smooth_ids(mesh: &TriangleMesh, flatness: f64) -> Vec<u32> {
    let mut groups = Groups::new(mesh.triangles.len());
    for edge in half_edges(&mesh.triangles).chunk_by(same_edge) {
        // Where more than two meet, none continues another.
        let [one, other] = edge else { continue };
        if normals_agree(mesh, one, other) || in_one_plane(mesh, one, other, flatness) {
            groups.join(one.triangle, other.triangle);
        }
    }
    groups.numbered()
}

/// Whether each triangle's opposite vertex lies in the plane of the other one, and both face the
/// same way.
fn in_one_plane(mesh: &TriangleMesh, one: &HalfEdge, other: &HalfEdge, flatness: f64) -> bool {
    let [a, b] = [one, other].map(|side| mesh.corners(side.triangle as usize));
    let [normal_a, normal_b] = [a, b].map(|corners| area_vector(corners).normalize_or_zero());
    let off = |far: &HalfEdge, corners: [glam::DVec3; 3], normal: glam::DVec3| {
        let vertex = mesh.corners(far.triangle as usize)[far.opposite_corner()];
        (vertex - corners[0]).dot(normal).abs()
    };
    normal_a.dot(normal_b) > 0.0
        && off(other, a, normal_a) <= flatness
        && off(one, b, normal_b) <= flatness
}

#[cfg(test)]
mod tests {
    use crate::scene::mesh::Mesh;
    use glam::DVec3;
    use lumiduct_base::math::Frame;
    use lumiduct_base::mesh::TriangleMesh;
    use lumiduct_base::mesh::bodies::{Normals, block, icosphere, rod};

    #[test]
    fn a_round_wall_is_one_patch_and_so_is_every_side_of_a_block() {
        let patches = |sample: &TriangleMesh| {
            let mesh = Mesh::new(sample, &Frame::WORLD);
            mesh.triangles().map(|t| mesh.smooth_id(t)).max().unwrap() + 1
        };
        assert_eq!(patches(&rod(2.0, 40.0, 48, Normals::Smooth)), 3);
        assert_eq!(patches(&rod(2.0, 40.0, 48, Normals::None)), 50);
        assert_eq!(patches(&block(DVec3::ONE)), 6);
        assert_eq!(patches(&icosphere(1.0, 2, Normals::Smooth)), 1);
    }
}
