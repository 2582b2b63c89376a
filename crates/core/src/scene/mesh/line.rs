//! A line–triangle test that leaves no gap between neighbours.
//!
//! Vertices are projected along the line onto a plane across it; the line crosses a triangle if its
//! point is on the same side of the three edges. The projection of a vertex does not depend on the
//! triangle, and the side of an edge is the sign of a difference of two products: rounding is
//! monotonic, so the sign is right or zero, and zero counts as a crossing on both sides. So the
//! plane is covered without gaps whatever the rounding (Woop, Benthin & Wald, JCGT 2 (2013) 1,
//! section 3; there by shear, here by an orthonormal pair).

use crate::scene::Ray;
use crate::scene::shape::Toward;
use glam::{DVec2, DVec3};

/// The line of a ray, prepared for many triangles.
#[derive(Debug, Clone, Copy)]
pub struct TriangleLine {
    pub(super) origin: DVec3,
    dir: DVec3,
    /// Two directions across the line; with `dir` they form a right-handed frame.
    pub(super) across: [DVec3; 2],
    /// Distance in the scene over that along the line, 1.
    scale: f64,
}

impl TriangleLine {
    /// The line of a ray.
    #[inline]
    pub fn of(ray: &Ray) -> Self {
        Self::scaled(ray, 1.0)
    }

    /// The line of a ray in coordinates in which lengths are those of the scene over `scale`.
    #[inline]
    pub(super) fn scaled(ray: &Ray, scale: f64) -> Self {
        let (x, y) = ray.dir().any_orthonormal_pair();
        Self { origin: ray.origin(), dir: ray.dir(), across: [x, y], scale }
    }

    /// The direction in which the line crosses a triangle, if it does. Edges and vertices count,
    /// triangles seen edge-on do not.
    #[inline]
    pub(super) fn passes(&self, corners: &[DVec3; 3]) -> Option<Toward> {
        let [a, b, c] = corners.map(|corner| self.seen(corner));
        let sides = [side(b, c), side(c, a), side(a, b)];
        // Seen along the line, a triangle that faces along it is counter-clockwise in the
        // right-handed frame.
        if sides.iter().all(|side| *side >= 0.0) && sides.iter().any(|side| *side > 0.0) {
            Some(Toward::Front)
        } else if sides.iter().all(|side| *side <= 0.0) && sides.iter().any(|side| *side < 0.0) {
            Some(Toward::Back)
        } else {
            None
        }
    }

    /// Distance to the plane of a triangle that the line crosses, mm, limited to the range of the
    /// vertices: at grazing incidence the plane alone would be wrong, and for a triangle without
    /// area undefined.
    #[inline]
    pub(super) fn distance(&self, corners: &[DVec3; 3], normal: DVec3) -> f64 {
        let along = corners.map(|corner| (corner - self.origin).dot(self.dir));
        let nearest = along[0].min(along[1]).min(along[2]);
        let farthest = along[0].max(along[1]).max(along[2]);
        let t = (corners[0] - self.origin).dot(normal) / self.dir.dot(normal);
        // `max` also replaces a NaN t.
        self.scale * t.max(nearest).min(farthest)
    }

    #[inline]
    fn seen(&self, vertex: DVec3) -> DVec2 {
        let from = vertex - self.origin;
        DVec2::new(from.dot(self.across[0]), from.dot(self.across[1]))
    }
}

/// Positive if the origin is to the left of the way from p to q; exactly the negative for the way
/// back.
#[inline]
fn side(p: DVec2, q: DVec2) -> f64 {
    p.x * q.y - p.y * q.x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Dimension, Sampler};
    use crate::scene::mesh::Mesh;
    use crate::scene::shape::Crossing;
    use lumiduct_base::math::{Frame, cone_direction, uniform_sphere};
    use lumiduct_base::mesh::bodies::{Normals, block, icosphere, rod};
    use lumiduct_base::mesh::{TriangleMesh, area_vector};
    use lumiduct_files::mesh::{LengthUnit, read};
    use std::path::Path;

    /// Crossings of a ray's line with all triangles.
    fn all_crossings(mesh: &Mesh, ray: &Ray) -> Vec<Crossing> {
        mesh.triangles().filter_map(|triangle| mesh.crossing(triangle, ray)).collect()
    }

    fn count(crossings: &[Crossing], toward: Toward) -> usize {
        crossings.iter().filter(|crossing| crossing.toward == toward).count()
    }

    /// Möller & Trumbore, J. Graphics Tools 2 (1997) 21: t and both weights, from the definition.
    fn by_definition([a, b, c]: &[DVec3; 3], ray: &Ray) -> Option<(f64, DVec3)> {
        let (ab, ac, from) = (*b - *a, *c - *a, ray.origin() - *a);
        let p = ray.dir().cross(ac);
        let q = from.cross(ab);
        let scale = 1.0 / ab.dot(p);
        let (u, v) = (from.dot(p) * scale, ray.dir().dot(q) * scale);
        let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0;
        inside.then_some((ac.dot(q) * scale, DVec3::new(1.0 - u - v, u, v)))
    }

    fn placed(mesh: &TriangleMesh) -> Mesh {
        // An oblique frame, so that no coordinate is round.
        let at = Frame::from_axis(DVec3::new(12.3, -4.5, 6.7), DVec3::new(0.3, -0.5, 0.8));
        Mesh::new(mesh, &at)
    }

    #[test]
    fn random_rays_cross_where_the_definition_says() {
        let mesh = placed(&icosphere(3.0, 3, Normals::None));
        let mut hits = 0;
        for index in 0..300 {
            let mut sampler = Sampler::for_path(21, 0, index);
            let origin = DVec3::new(12.3, -4.5, 6.7)
                + 5.0 * uniform_sphere(sampler.pair(Dimension::EmitPosition));
            let ray = Ray::new(origin, uniform_sphere(sampler.pair(Dimension::EmitDirection)));
            for triangle in mesh.triangles() {
                let corners = mesh.corners(triangle);
                let ours = mesh.crossing(triangle, &ray);
                let expected = by_definition(&corners, &ray);
                let Some((t, weights)) = expected else {
                    // Allowed only where rounding decides: none of these rays is that close to an
                    // edge.
                    assert_eq!(ours, None);
                    continue;
                };
                let ours = ours.unwrap();
                hits += 1;
                assert!(weights.min_element() > 1e-12);
                assert!((ours.t - t).abs() < 1e-9, "{} {t}", ours.t);
                assert_eq!(ours.toward, Toward::of(ray.dir(), area_vector(corners)));
            }
        }
        assert!(hits > 50, "{hits}");
    }

    /// Points of a closed mesh at which rounding errors are most likely.
    fn delicate_points(mesh: &Mesh) -> Vec<DVec3> {
        let of_triangle = |triangle: usize| {
            let [a, b, c] = mesh.corners(triangle);
            let on_edge =
                |from: DVec3, to: DVec3| [0.5, 0.1, 1.0 / 3.0].map(|s| from + s * (to - from));
            [vec![a, b, c], on_edge(a, b).into(), on_edge(b, c).into(), on_edge(c, a).into()]
                .concat()
        };
        mesh.triangles().flat_map(of_triangle).collect()
    }

    #[test]
    fn rays_at_edges_and_vertices_never_slip_through() {
        let meshes = [
            icosphere(3.0, 2, Normals::None),
            block(DVec3::new(1.0, 2.0, 3.0)),
            rod(2.0, 40.0, 24, Normals::None),
        ];
        for (number, sample) in meshes.iter().enumerate() {
            for mesh in [placed(sample), Mesh::new(sample, &Frame::WORLD)] {
                let inside = mesh
                    .triangles()
                    .map(|triangle| mesh.corners(triangle).iter().sum::<DVec3>() / 3.0)
                    .sum::<DVec3>()
                    / mesh.triangle_count() as f64;
                for (index, target) in delicate_points(&mesh).into_iter().enumerate() {
                    let mut sampler = Sampler::for_path(22, number as u64, index as u64);
                    let away = uniform_sphere(sampler.pair(Dimension::EmitDirection));
                    for origin in [inside, inside + 1e-3 * away, target + 1e-9 * (inside - target)]
                    {
                        // Convex and started inside: the ray leaves ahead, and entered behind.
                        let ray = Ray::new(origin, target - origin);
                        let crossings = all_crossings(&mesh, &ray);
                        let ahead: Vec<_> =
                            crossings.iter().filter(|c| c.t > 0.0).copied().collect();
                        assert!(count(&ahead, Toward::Front) >= 1, "{number} {target}");
                        assert_eq!(count(&ahead, Toward::Back), 0, "{number} {target}");
                        assert!(count(&crossings, Toward::Back) >= 1, "{number} {target}");
                    }
                }
            }
        }
    }

    #[test]
    fn lines_that_touch_from_outside_go_in_as_often_as_out() {
        let mesh = placed(&icosphere(3.0, 2, Normals::None));
        for (index, target) in delicate_points(&mesh).into_iter().enumerate() {
            let mut sampler = Sampler::for_path(23, 0, index as u64);
            let origin = target + 7.0 * uniform_sphere(sampler.pair(Dimension::EmitDirection));
            let crossings = all_crossings(&mesh, &Ray::new(origin, target - origin));
            let (front, back) =
                (count(&crossings, Toward::Front) > 0, count(&crossings, Toward::Back) > 0);
            assert_eq!(front, back, "{target}: {crossings:?}");
        }
    }

    #[test]
    fn axis_parallel_rays_through_the_edges_of_a_block_hit_every_triangle_there() {
        let mesh = Mesh::new(&block(DVec3::ONE), &Frame::WORLD);
        // Through the diagonals of two opposite sides, and along an edge.
        let middle = Ray::new(DVec3::new(0.5, 0.5, 0.5), DVec3::Z);
        let crossings = all_crossings(&mesh, &middle);
        assert_eq!((count(&crossings, Toward::Front), count(&crossings, Toward::Back)), (2, 2));
        let edge = Ray::new(DVec3::new(0.0, 0.0, 0.5), DVec3::Z);
        let crossings = all_crossings(&mesh, &edge);
        assert!(count(&crossings, Toward::Front) >= 1 && count(&crossings, Toward::Back) >= 1);
        assert!(crossings.iter().all(|crossing| crossing.t.abs() == 0.5));
    }

    /// The nearest exit from a mesh for a path inside, other than the triangle that it is on.
    fn next_exit(mesh: &Mesh, ray: &Ray, on: usize) -> Option<(usize, f64)> {
        let line = TriangleLine::of(ray);
        mesh.triangles()
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
        assert_eq!(mesh.triangles().map(|t| mesh.smooth_id(t)).max(), Some(2));
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
