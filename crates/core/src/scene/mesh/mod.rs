//! Closed triangle meshes for tracing: where a line crosses a triangle, and the normal of the
//! surface there.
//!
//! Light cannot leak between triangles: both triangles at an edge use identical numbers for the
//! side of a line ([`TriangleLine`]), and a line exactly through an edge or a vertex crosses every triangle
//! there. A path that leaves a triangle skips that triangle; otherwise orientation decides, not a
//! small distance. The mesh does not know finishes, media, or the tree that finds the candidates.

mod body;
mod chart;
mod line;
mod patch;

pub use body::{MeshBody, MeshPlace};
pub use line::TriangleLine;

use crate::scene::Ray;
use crate::scene::shape::Crossing;
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
    /// Positions of the vertices, mm; triangles share them, so that more of a mesh fits in the cache.
    positions: Vec<DVec3>,
    /// Vertices of each triangle, as indices of `positions`.
    triangles: Vec<[u32; 3]>,
    facet_normals: Vec<DVec3>,
    corner_normals: Option<Vec<[DVec3; 3]>>,
    smooth_ids: Vec<u32>,
    face_of: Vec<u32>,
    faces: Vec<MeshFace>,
    /// Largest distance of vertices of a flat face from its plane, mm.
    flatness: f64,
}

/// The triangles of one material or group.
#[derive(Debug, Clone)]
struct MeshFace {
    name: String,
    triangles: Vec<u32>,
    /// Area of the triangles up to and including each one, mm².
    area_up_to: Vec<f64>,
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
    /// A copy of a mesh in the frame `at`. Indices of `mesh` must be valid, as those of every mesh from a
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
        let normals = |triangle: usize| mesh.normals.as_ref().map(|all| &all[triangle]);
        let facet_normals = (0..mesh.triangles.len())
            .map(|triangle| facet_normal(&mesh.corners(triangle), normals(triangle)))
            .collect();
        Self {
            faces: faces(&mesh),
            smooth_ids,
            facet_normals,
            flatness,
            face_of: mesh.face_of,
            corner_normals: mesh.normals,
            triangles: mesh.triangles,
            positions: mesh.positions,
        }
    }

    /// Number of triangles; they are numbered from 0.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The three vertices of a triangle, mm; counter-clockwise seen from outside.
    #[inline]
    pub(crate) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|index| self.positions[index as usize])
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
        Some(Crossing { t: line.distance(&corners, self.facet_normals[triangle]), toward })
    }

    /// Unit normal of a triangle's plane, outward.
    #[inline]
    pub(crate) fn facet_normal(&self, triangle: usize) -> DVec3 {
        self.facet_normals[triangle]
    }

    /// Unit normal of the surface that the mesh approximates, outward: the corner normals
    /// interpolated at a point of the triangle (Phong, Commun. ACM 18 (1975) 311), or the facet's
    /// if there are no corner normals or they contradict it.
    pub(crate) fn shading_normal(&self, triangle: usize, point: DVec3) -> DVec3 {
        let facet = self.facet_normals[triangle];
        let Some(normals) = &self.corner_normals else { return facet };
        let weights = weights(&self.corners(triangle), facet, point);
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
        self.faces[face].area_up_to.last().copied().unwrap_or(0.0)
    }

    /// A point of a face, uniform over its area for uniform `u`; `None` for a face without area.
    pub(crate) fn sample(&self, face: usize, u: [f64; 2]) -> Option<MeshPoint> {
        let face = &self.faces[face];
        let total = *face.area_up_to.last().filter(|total| **total > 0.0)?;
        // Below the total even after rounding, so that there is a triangle, and one with an area.
        let wanted = (u[0] * total).min(total.next_down());
        let index = face.area_up_to.partition_point(|area| *area <= wanted);
        let before = if index == 0 { 0.0 } else { face.area_up_to[index - 1] };
        let triangle = face.triangles[index] as usize;
        // The remainder of the first number is again uniform within the triangle.
        let rest = ((wanted - before) / (face.area_up_to[index] - before)).clamp(0.0, 1.0);
        let [a, b, c] = self.corners(triangle);
        // Uniform over a triangle: Turk, Graphics Gems (1990) 24.
        let root = rest.sqrt();
        let point = (1.0 - root) * a + root * (1.0 - u[1]) * b + root * u[1] * c;
        Some(MeshPoint { triangle, point })
    }
}

/// The normal of the plane; for a triangle without area, the mean of the corner normals, or else
/// any direction across it.
fn facet_normal(corners: &[DVec3; 3], normals: Option<&[DVec3; 3]>) -> DVec3 {
    area_vector(*corners)
        .try_normalize()
        .or_else(|| normals?.iter().sum::<DVec3>().try_normalize())
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

fn faces(mesh: &TriangleMesh) -> Vec<MeshFace> {
    let empty = |name: &String| MeshFace {
        name: name.clone(),
        triangles: Vec::new(),
        area_up_to: Vec::new(),
    };
    let mut faces: Vec<MeshFace> = mesh.faces.iter().map(empty).collect();
    for (triangle, face) in mesh.face_of.iter().enumerate() {
        let face = &mut faces[*face as usize];
        let before = face.area_up_to.last().copied().unwrap_or(0.0);
        face.triangles.push(triangle as u32);
        face.area_up_to.push(before + 0.5 * area_vector(mesh.corners(triangle)).length());
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Dimension, Sampler};
    use crate::scene::shape::Toward;
    use lumiduct_base::math::cone_direction;
    use lumiduct_base::mesh::bodies::{Normals, block, icosphere, rod};
    use lumiduct_files::mesh::{LengthUnit, read};
    use std::path::Path;

    /// Largest error of the shading normal, rad, over a point of each triangle of an ellipsoid with half axes 6, 3, 3.
    fn worst_normal(level: u32) -> f64 {
        let mut sample = icosphere(3.0, level, Normals::Smooth);
        sample.positions.iter_mut().for_each(|position| position.x *= 2.0);
        for normal in sample.normals.iter_mut().flatten().flatten() {
            *normal = DVec3::new(0.5 * normal.x, normal.y, normal.z).normalize();
        }
        let mesh = Mesh::new(&sample, &Frame::WORLD);
        (0..mesh.triangle_count())
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
        for triangle in 0..mesh.triangle_count() {
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
        for triangle in [12, 13] {
            assert!((mesh.facet_normal(triangle).length() - 1.0).abs() < 1e-15);
            let ray = Ray::new(DVec3::splat(0.5), mesh.corners(triangle)[0] - 0.5);
            assert_eq!(mesh.crossing(triangle, &ray), None);
        }
        for face in [0, 5] {
            let end = mesh.sample(face, [1.0 - f64::EPSILON / 2.0, 0.5]).unwrap();
            assert!(end.triangle < 12 && end.point.is_finite());
        }
    }

    #[test]
    fn samples_are_uniform_over_a_face() {
        let mesh = Mesh::new(&block(DVec3::new(1.0, 2.0, 3.0)), &Frame::WORLD);
        let face = mesh.face_names().position(|name| name == "plus_x").unwrap();
        let n = 20_000u64;
        let mut bins = [0u32; 16];
        for index in 0..n {
            let u = Sampler::for_path(31, 0, index).pair(Dimension::EmitPosition);
            let sample = mesh.sample(face, u).unwrap();
            assert_eq!(mesh.face_of(sample.triangle), face);
            assert!((sample.point.x - 1.0).abs() < 1e-15);
            let (y, z) = (sample.point.y / 2.0 * 4.0, sample.point.z / 3.0 * 4.0);
            bins[(y as usize).min(3) * 4 + (z as usize).min(3)] += 1;
        }
        let expected = n as f64 / 16.0;
        let chi2: f64 = bins.iter().map(|&b| (f64::from(b) - expected).powi(2) / expected).sum();
        // 99.9 % point of chi-square with 15 degrees of freedom: 37.7.
        assert!(chi2 < 37.7, "chi-square {chi2}");
        assert!((mesh.face_area(face) - 6.0).abs() < 1e-14);
    }

    #[test]
    fn a_round_wall_is_one_patch_and_so_is_every_side_of_a_block() {
        let patches = |sample: &TriangleMesh| {
            let mesh = Mesh::new(sample, &Frame::WORLD);
            (0..mesh.triangle_count()).map(|t| mesh.smooth_id(t)).max().unwrap() + 1
        };
        assert_eq!(patches(&rod(2.0, 40.0, 48, Normals::Smooth)), 3);
        assert_eq!(patches(&rod(2.0, 40.0, 48, Normals::None)), 50);
        assert_eq!(patches(&block(DVec3::ONE)), 6);
        assert_eq!(patches(&icosphere(1.0, 2, Normals::Smooth)), 1);
    }

    /// The nearest exit from a mesh for a path inside, other than the triangle that it is on.
    fn next_exit(mesh: &Mesh, ray: &Ray, on: usize) -> Option<(usize, f64)> {
        let line = TriangleLine::of(ray);
        (0..mesh.triangle_count())
            .filter(|triangle| *triangle != on)
            .filter_map(|triangle| Some((triangle, mesh.crossing_of(triangle, &line)?)))
            .filter(|(_, crossing)| crossing.toward == Toward::Front && crossing.t > 0.0)
            .map(|(triangle, crossing)| (triangle, crossing.t))
            .min_by(|one, other| one.1.total_cmp(&other.1))
    }

    #[test]
    fn light_in_the_guide_of_the_scenes_stays_in_until_an_end() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/meshes/lightguide.glb");
        let mesh = Mesh::new(&read(&path, LengthUnit::Metre).unwrap().mesh, &Frame::WORLD);
        let face = |name| mesh.face_names().position(|other| other == name).unwrap();
        let (entry, wall, exit) = (face("entry"), face("wall"), face("exit"));
        assert!(mesh.chart_plane(entry).is_some() && mesh.chart_plane(exit).is_some());
        assert_eq!((0..mesh.triangle_count()).map(|t| mesh.smooth_id(t)).max(), Some(2));
        let mut bounces = 0;
        for index in 0..40 {
            let mut sampler = Sampler::for_path(41, 0, index);
            let start = mesh.sample(entry, sampler.pair(Dimension::EmitPosition)).unwrap();
            // Inside acrylic: within 42 degrees of the axis.
            let dir = cone_direction(0.73, sampler.pair(Dimension::EmitDirection));
            let (mut ray, mut on) = (Ray::new(start.point, dir), start.triangle);
            loop {
                let (triangle, t) = next_exit(&mesh, &ray, on).expect("a leak");
                if mesh.face_of(triangle) != wall {
                    assert!([entry, exit].contains(&mesh.face_of(triangle)));
                    break;
                }
                let (point, facet) = (ray.at(t), mesh.facet_normal(triangle));
                let mut dir = ray.dir().reflect(mesh.shading_normal(triangle, point));
                if dir.dot(facet) >= 0.0 {
                    dir = dir.reflect(facet);
                }
                (ray, on) = (Ray::new(point, dir), triangle);
                bounces += 1;
            }
        }
        assert!(bounces > 200, "{bounces}");
    }
}
