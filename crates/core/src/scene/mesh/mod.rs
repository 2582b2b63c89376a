//! Closed triangle meshes for tracing: where a line crosses a triangle, and the normal of the
//! surface there.
//!
//! Light cannot leak between triangles: both triangles at an edge use identical numbers for the
//! side of a line ([`TriangleLine`]), and a line exactly through an edge or a vertex crosses every triangle
//! there. A path that leaves a triangle skips that triangle; otherwise orientation decides, not a
//! small distance. The mesh does not know finishes or media.

mod body;
mod chart;
mod face;
mod facing;
mod four;
mod line;
mod patch;
mod tree;

pub use body::{MeshBody, MeshPlace};
pub use line::TriangleLine;

use crate::scene::Ray;
use crate::scene::crossing::tree::{NONE, Tree};
use crate::scene::mesh::face::{MeshFace, faces};
use crate::scene::mesh::tree::{MeshTree, Sight};
use crate::scene::shape::{Crossing, Toward};
use glam::DVec3;
use lumiduct_base::math::{Aabb, Frame};
use lumiduct_base::mesh::{TriangleMesh, area_vector};

/// Rounding of coordinates in single precision, relative to the largest of them: two bits more than
/// the 2^-24 of one f32, for a vertex and a plane through three of them. The facets of real curved
/// surfaces differ by far more.
const FLATNESS: f64 = 1.0 / (1u64 << 22) as f64;

/// A mesh of triangles.
#[derive(Debug, Clone)]
pub struct Mesh {
    /// Positions of the vertices, mm.
    positions: Vec<DVec3>,
    /// Its triangles, which gives them their numbers.
    tree: MeshTree,
    corner_normals: Option<Vec<[DVec3; 3]>>,
    smooth_ids: Vec<u32>,
    face_of: Vec<u32>,
    faces: Vec<MeshFace>,
    /// Largest distance of vertices of a flat face from its plane, mm.
    flatness: f64,
}

/// A point of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MeshPoint {
    /// Its triangle.
    pub triangle: usize,
    /// The point, mm.
    pub point: DVec3,
}

impl Mesh {
    /// A copy of a mesh of one or more triangles in the frame `at`. Indices of `mesh` must be valid, as those of every mesh from a
    /// file are.
    pub fn new(mesh: &TriangleMesh, at: &Frame) -> Self {
        Self::moved(mesh.clone(), at)
    }

    /// The same without a copy.
    pub fn moved(mesh: TriangleMesh, at: &Frame) -> Self {
        let flatness = FLATNESS * mesh.bounds().largest_coordinate();
        let smooth_ids = patch::smooth_ids(&mesh, flatness);
        let mut mesh = mesh;
        // Vertex by vertex, so that triangles share a common vertex to the last bit.
        mesh.positions.iter_mut().for_each(|position| *position = at.point_to_world(*position));
        for normal in mesh.normals.iter_mut().flatten().flatten() {
            *normal = at.to_world(*normal);
        }
        let (tree, leaves) =
            Tree::over(mesh.triangles.len(), |triangle| Aabb::of(mesh.corners(triangle)));
        let places = leaves.as_flattened();
        // First: with normals in both orders they take more memory than all else.
        let corner_normals = mesh.normals.take().map(|normals| arranged(places, &normals));
        let tree = MeshTree::new(tree, &leaves, &mesh);
        let mut number = vec![0; mesh.triangles.len()];
        for (place, triangle) in places.iter().enumerate().filter(|(_, own)| **own != NONE) {
            number[*triangle as usize] = place as u32;
        }
        Self {
            tree,
            faces: faces(&mesh, &number),
            smooth_ids: arranged(places, &smooth_ids),
            flatness,
            face_of: arranged(places, &mesh.face_of),
            corner_normals,
            positions: mesh.positions,
        }
    }

    /// Triangles have numbers below this one, but some of these numbers have no triangle.
    pub fn number_limit(&self) -> usize {
        self.face_of.len()
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.faces.iter().map(|face| face.triangles.len()).sum()
    }

    /// The numbers of its triangles, face by face.
    pub fn triangles(&self) -> impl Iterator<Item = usize> {
        self.faces.iter().flat_map(|face| &face.triangles).map(|triangle| *triangle as usize)
    }

    /// The three vertices of a triangle, mm; counter-clockwise seen from outside.
    #[inline]
    pub(crate) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.tree.corners(triangle)
    }

    /// A box around a triangle, mm.
    pub fn bounds(&self, triangle: usize) -> Aabb {
        Aabb::of(self.corners(triangle))
    }

    /// Area of a triangle, mm².
    pub(crate) fn area(&self, triangle: usize) -> f64 {
        0.5 * area_vector(self.corners(triangle)).length()
    }

    /// Where the line of a ray crosses a triangle. Edges and vertices belong to all of their
    /// triangles. For many triangles make the [`TriangleLine`] once and call [`Self::crossing_of`].
    pub(crate) fn crossing(&self, triangle: usize, ray: &Ray) -> Option<Crossing> {
        self.crossing_of(triangle, &TriangleLine::of(ray))
    }

    /// Where a line crosses a triangle.
    #[inline(always)]
    pub fn crossing_of(&self, triangle: usize, line: &TriangleLine) -> Option<Crossing> {
        let corners = self.corners(triangle);
        let toward = line.passes(&corners)?;
        Some(self.crossing_at(triangle, &corners, line, toward))
    }

    /// The crossing of a line with a triangle that it is known to cross.
    #[inline(always)]
    fn crossing_at(
        &self,
        triangle: usize,
        corners: &[DVec3; 3],
        line: &TriangleLine,
        toward: Toward,
    ) -> Crossing {
        Crossing { t: line.distance(corners, self.plane_normal(triangle, corners)), toward }
    }

    /// Calls `visit` with the crossings of a line with triangles in this direction, and with their numbers, at least those before `limit`
    /// and the smallest distance that `visit` has returned. Both are in the coordinates of the mesh; distances of crossings are in mm.
    #[inline(always)]
    fn visit_crossings(
        &self,
        sight: Sight<'_>,
        toward: Toward,
        limit: f64,
        mut visit: impl FnMut(usize, Crossing) -> f64,
    ) {
        self.tree.visit(sight, toward, limit, |triangle| {
            let corners = self.corners(triangle);
            visit(triangle, self.crossing_at(triangle, &corners, sight.line, toward))
        });
    }

    /// Unit normal of a triangle's plane, outward.
    pub(crate) fn facet_normal(&self, triangle: usize) -> DVec3 {
        self.plane_normal(triangle, &self.corners(triangle))
    }

    /// The same with its vertices at hand.
    #[inline(always)]
    fn plane_normal(&self, triangle: usize, corners: &[DVec3; 3]) -> DVec3 {
        let normals = || self.corner_normals.as_ref().map(|all| &all[triangle]);
        let normal = area_vector(*corners).try_normalize();
        normal.unwrap_or_else(|| normal_without_area(corners, normals()))
    }

    /// Unit normal of the surface that the mesh approximates, outward: the corner normals
    /// interpolated at a point of the triangle (Phong, Commun. ACM 18 (1975) 311), or the facet's
    /// if there are no corner normals or they contradict it.
    pub(crate) fn shading_normal(&self, triangle: usize, point: DVec3) -> DVec3 {
        let corners = self.corners(triangle);
        let facet = self.plane_normal(triangle, &corners);
        let Some(normals) = &self.corner_normals else { return facet };
        let weights = weights(&corners, facet, point);
        let [a, b, c] = normals[triangle];
        let normal = (weights.x * a + weights.y * b + weights.z * c).normalize_or_zero();
        if normal.dot(facet) > 0.0 { normal } else { facet }
    }

    /// The smooth patch that a triangle belongs to: connected triangles share an id where their corner normals agree
    /// along the common edge, or where they lie in one plane.
    #[inline]
    pub(crate) fn smooth_id(&self, triangle: usize) -> u32 {
        self.smooth_ids[triangle]
    }

    /// Number of smooth patches.
    pub(crate) fn patch_count(&self) -> usize {
        self.smooth_ids.iter().max().map_or(0, |last| *last as usize + 1)
    }

    /// The face of a triangle; faces are numbered from 0.
    #[inline]
    pub(crate) fn face_of(&self, triangle: usize) -> usize {
        self.face_of[triangle] as usize
    }

    /// Names of the faces, in the order of their numbers.
    pub fn face_names(&self) -> impl Iterator<Item = &str> {
        self.faces.iter().map(|face| face.name.as_str())
    }

    /// The triangles of a face.
    pub(crate) fn face_triangles(&self, face: usize) -> &[u32] {
        &self.faces[face].triangles
    }

    /// Area of a face, mm².
    pub(crate) fn face_area(&self, face: usize) -> f64 {
        self.faces[face].area()
    }

    /// A point of a face, uniform over its area for uniform `u`; `None` for a face without area.
    pub(crate) fn sample(&self, face: usize, u: [f64; 2]) -> Option<MeshPoint> {
        let (triangle, rest) = self.faces[face].pick(u[0])?;
        let [a, b, c] = self.corners(triangle);
        // Uniform over a triangle: Turk, Graphics Gems (1990) 24.
        let root = rest.sqrt();
        let point = (1.0 - root) * a + root * (1.0 - u[1]) * b + root * u[1] * c;
        Some(MeshPoint { triangle, point })
    }
}

/// For a triangle without area, the mean of the corner normals, or else any direction across it.
#[cold]
fn normal_without_area(corners: &[DVec3; 3], normals: Option<&[DVec3; 3]>) -> DVec3 {
    normals
        .and_then(|normals| normals.iter().sum::<DVec3>().try_normalize())
        .or_else(|| {
            (corners[1] - corners[0]).try_normalize().map(|edge| edge.any_orthonormal_vector())
        })
        .unwrap_or(DVec3::Z)
}

/// Barycentric weights of a point, none negative; not normalised. The sum is zero without area.
fn weights([a, b, c]: &[DVec3; 3], facet: DVec3, point: DVec3) -> DVec3 {
    let (a, b, c) = (*a - point, *b - point, *c - point);
    let weights = DVec3::new(b.cross(c).dot(facet), c.cross(a).dot(facet), a.cross(b).dot(facet));
    weights.max(DVec3::ZERO)
}

/// Values of triangles by the places of these; any where there is none.
fn arranged<T: Copy>(places: &[u32], values: &[T]) -> Vec<T> {
    places.iter().map(|place| *values.get(*place as usize).unwrap_or(&values[0])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_base::mesh::bodies::{Normals, block, icosphere};

    /// Largest error of the shading normal, rad, over a point of each triangle of an ellipsoid with half axes 6, 3, 3.
    fn worst_normal(level: u32) -> f64 {
        let mut sample = icosphere(3.0, level, Normals::Smooth);
        sample.positions.iter_mut().for_each(|position| position.x *= 2.0);
        for normal in sample.normals.iter_mut().flatten().flatten() {
            *normal = DVec3::new(0.5 * normal.x, normal.y, normal.z).normalize();
        }
        let mesh = Mesh::new(&sample, &Frame::WORLD);
        mesh.triangles()
            .map(|triangle| {
                let [a, b, c] = mesh.corners(triangle);
                let point = 0.5 * a + 0.3 * b + 0.2 * c;
                let gradient = DVec3::new(0.25 * point.x, point.y, point.z);
                mesh.shading_normal(triangle, point).distance(gradient.normalize())
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn interpolated_normals_approach_the_surface_quadratically() {
        let worst = [2, 3, 4, 5].map(worst_normal);
        for pair in worst.windows(2) {
            // Half the edge, a quarter of the error.
            assert!((0.2..0.32).contains(&(pair[1] / pair[0])), "{worst:?}");
        }
        assert!(worst[3] < 5e-4, "{worst:?}");
    }

    #[test]
    fn interpolated_normals_of_a_sphere_are_exact() {
        let mesh = Mesh::new(&icosphere(3.0, 1, Normals::Smooth), &Frame::WORLD);
        for triangle in mesh.triangles() {
            let [a, b, c] = mesh.corners(triangle);
            let point = 0.7 * a + 0.1 * b + 0.2 * c;
            let normal = mesh.shading_normal(triangle, point);
            assert!(normal.distance(point.normalize()) < 1e-14);
        }
    }

    #[test]
    fn without_normals_or_against_them_the_facet_counts() {
        let plain = Mesh::new(&icosphere(3.0, 1, Normals::None), &Frame::WORLD);
        assert_eq!(plain.shading_normal(7, plain.corners(7)[0]), plain.facet_normal(7));
        let mut sample = icosphere(3.0, 1, Normals::Smooth);
        sample.normals.iter_mut().flatten().flatten().for_each(|normal| *normal = -*normal);
        let opposed = Mesh::new(&sample, &Frame::WORLD);
        assert_eq!(opposed.shading_normal(7, opposed.corners(7)[0]), opposed.facet_normal(7));
    }

    #[test]
    fn a_triangle_without_area_has_a_unit_normal_and_is_never_sampled() {
        let mut sample = block(DVec3::ONE);
        sample.triangles.push([0, 0, 1]);
        sample.triangles.push([3, 3, 3]);
        sample.face_of.extend([0, 5]);
        let mesh = Mesh::new(&sample, &Frame::WORLD);
        let flat = [0, 5].map(|face| *mesh.face_triangles(face).last().unwrap() as usize);
        for triangle in flat {
            assert!((mesh.facet_normal(triangle).length() - 1.0).abs() < 1e-15);
            let ray = Ray::new(DVec3::splat(0.5), mesh.corners(triangle)[0] - 0.5);
            assert_eq!(mesh.crossing(triangle, &ray), None);
        }
        for face in [0, 5] {
            let end = mesh.sample(face, [1.0 - f64::EPSILON / 2.0, 0.5]).unwrap();
            assert!(!flat.contains(&end.triangle) && end.point.is_finite());
        }
    }
}
