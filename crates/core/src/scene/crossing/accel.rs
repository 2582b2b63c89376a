//! The surfaces that a ray may meet, nearest first.
//!
//! Boxes cull only: shapes intersect in f64 inside the closure. Up to a handful of shapes a linear scan is faster.

use crate::scene::Ray;
use crate::scene::crossing::tree::SurfaceTree;
use lumiduct_base::math::Aabb;

/// Up to this many patches are scanned one by one.
const SCAN_LIMIT: usize = 12;

/// A culling structure over the boxes of all surfaces.
#[derive(Debug, Clone)]
pub(crate) enum Accel {
    /// A scan over this many patches.
    Scan(usize),
    /// A tree over more, or over patches and bodies of triangles.
    Tree(SurfaceTree),
}

impl Accel {
    /// A structure over this many patches and bodies of triangles with these boxes, patches first. Ray origins have coordinates up to `largest_coordinate`, mm.
    pub(crate) fn new(
        [patches, bodies]: [usize; 2],
        bounds: impl Fn(usize) -> Aabb,
        largest_coordinate: f64,
    ) -> Self {
        if bodies == 0 && patches <= SCAN_LIMIT {
            return Self::Scan(patches);
        }
        Self::Tree(SurfaceTree::over(patches + bodies, bounds, largest_coordinate))
    }

    /// Calls `visit` with the index of every surface whose box the ray meets before the smallest distance that `visit` has
    /// returned; a scan visits all.
    #[inline]
    pub(crate) fn visit(&self, ray: &Ray, mut visit: impl FnMut(usize) -> f64) {
        match self {
            Self::Scan(count) => {
                for index in 0..*count {
                    visit(index);
                }
            }
            Self::Tree(tree) => tree.visit(ray, visit),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::optics::Medium;
    use crate::rng::{Dimension, Sampler};
    use crate::scene::mesh::Mesh;
    use crate::scene::shape::Toward;
    use crate::scene::{Builder, Inside, Ray, Scene, Solid, SolidId, StartSurfaces};
    use glam::{DVec2, DVec3};
    use lumiduct_base::math::{Aabb, Frame, uniform_sphere};
    use lumiduct_base::mesh::bodies::{Normals, block, icosphere, rod};
    use lumiduct_base::mesh::{TriangleMesh, is_closed};
    use lumiduct_base::units::FluxUnit;

    /// A body of glass with this surface.
    fn body(mesh: &TriangleMesh) -> (Scene, SolidId) {
        body_at(mesh, &Frame::WORLD)
    }

    fn body_at(mesh: &TriangleMesh, at: &Frame) -> (Scene, SolidId) {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let medium = builder.add_medium(Medium::new("glass", 1.5, 0.0));
        let solid = builder.add_solid(Solid {
            name: "body".into(),
            medium,
            priority: 0,
            bounds: Aabb::EMPTY,
            volume: None,
        });
        let finishes = vec![[None; 2]; mesh.faces.len()];
        builder.add_mesh("body", solid, Mesh::new(mesh, at), &finishes);
        (builder.build(), solid)
    }

    #[test]
    fn a_body_of_as_few_triangles_as_possible_is_met() {
        let mesh = TriangleMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            normals: None,
            face_of: vec![0; 4],
            faces: vec!["all".into()],
        };
        let (scene, solid) = body(&mesh);
        let ray = Ray::new(DVec3::new(0.2, 0.3, -1.0), DVec3::Z);
        let entry = scene.find_next(&ray, &StartSurfaces::default(), &Inside::default()).unwrap();
        assert!((entry.distance() - 1.0).abs() < 1e-12);
        let within: Inside = [solid].into_iter().collect();
        let exit =
            scene.find_next(&ray.advanced(1.0), &StartSurfaces::hits(&entry), &within).unwrap();
        assert!((exit.distance() - 0.5).abs() < 1e-12);
    }

    /// A housing of 60 mm. One of its sides is cut into strips, the narrowest 1e-7 mm wide, and both ends are fans of slivers.
    fn housing() -> TriangleMesh {
        let strips = (0..200).map(|index| DVec2::new(20.0 * 0.91_f64.powi(index), 10.0));
        let corners = [DVec2::ZERO, DVec2::new(20.0, 0.0)];
        let outline: Vec<DVec2> =
            corners.into_iter().chain(strips).chain([DVec2::new(0.0, 10.0)]).collect();
        let count = outline.len() as u32;
        let [low, high] = [0.0, 60.0].map(|z| outline.iter().map(move |point| point.extend(z)));
        let walls = (0..count).flat_map(|one| {
            let next = (one + 1) % count;
            [[one, next, next + count], [one, next + count, one + count]]
        });
        // Ends from the corner at the origin, which is on no strip.
        let ends = (1..count - 1)
            .flat_map(|one| [[0, one + 1, one], [count, count + one, count + one + 1]]);
        let triangles: Vec<[u32; 3]> = walls.chain(ends).collect();
        TriangleMesh {
            positions: low.chain(high).collect(),
            normals: None,
            face_of: vec![0; triangles.len()],
            triangles,
            faces: vec!["all".into()],
        }
    }

    #[test]
    fn light_in_a_housing_with_slivers_stays_in_and_meets_what_a_test_of_all_triangles_finds() {
        let mesh = housing();
        assert!(is_closed(&mesh));
        for at in [
            Frame::WORLD,
            Frame::from_axis(DVec3::new(12.3, -4.5, 6.7), DVec3::new(0.3, -0.5, 0.8)),
        ] {
            let (bare, (scene, solid)) = (Mesh::new(&mesh, &at), body_at(&mesh, &at));
            let inside: Inside = [solid].into_iter().collect();
            let mut sampler = Sampler::for_path(63, 0, 0);
            let middle = at.point_to_world(DVec3::new(10.0, 5.0, 30.0));
            let mut ray = Ray::new(middle, uniform_sphere(sampler.pair(Dimension::EmitDirection)));
            let mut from = StartSurfaces::default();
            for step in 0..20_000 {
                let hits = scene.find_next(&ray, &from, &inside).expect("a leak");
                if step % 50 == 0 {
                    let exits =
                        bare.triangles().filter_map(|triangle| bare.crossing(triangle, &ray));
                    let wanted = exits
                        .filter(|own| own.toward == Toward::Front && own.t > 1e-9)
                        .fold(f64::INFINITY, |nearest, own| nearest.min(own.t));
                    assert!((hits.distance() - wanted).abs() < 1e-9, "{step} {ray:?}");
                }
                let on = ray.advanced(hits.distance());
                let normal = scene.normal(hits.nearest.prim, on.origin());
                // Every tenth time along an axis, and very near an edge.
                let wanted = match step % 10 {
                    0 => at.to_world([DVec3::X, DVec3::Y, DVec3::Z][step / 10 % 3]),
                    5 => {
                        let triangle = bare.triangles().nth(step % bare.triangle_count());
                        let [a, b, c] = bare.corners(triangle.unwrap());
                        0.3 * a + 0.699_999 * b + 1e-6 * c - on.origin()
                    }
                    _ => DVec3::ZERO,
                };
                let goes_in = wanted.normalize_or_zero().dot(normal) < -1e-6;
                let dir = if goes_in { wanted } else { ray.dir().reflect(normal) };
                (ray, from) = (Ray::new(on.origin(), dir), StartSurfaces::hits(&hits));
            }
        }
    }

    /// Rays from within, along axes and obliquely, through vertices, through edges and anywhere.
    #[test]
    fn the_tree_finds_what_a_test_of_all_triangles_finds() {
        let meshes = [
            rod(2.0, 40.0, 96, Normals::None),
            icosphere(3.0, 3, Normals::None),
            block(DVec3::new(1.0, 2.0, 3.0)),
        ];
        let mut met = 0;
        for mesh in &meshes {
            let (scene, solid) = body(mesh);
            let (inside, outside) = ([solid].into_iter().collect(), Inside::default());
            let bare = Mesh::new(mesh, &Frame::WORLD);
            let middle = mesh.positions.iter().sum::<DVec3>() / mesh.positions.len() as f64;
            for triangle in bare.triangles().step_by(3) {
                let [a, b, c] = bare.corners(triangle);
                for target in [a, 0.5 * (a + b), 0.3 * a + 0.3 * b + 0.4 * c] {
                    let away = target - middle;
                    // At a pole `away` has no component across: along x.
                    let across = DVec3::new(away.x.abs().max(1e-3), away.y, 0.0);
                    let level = DVec3::new(middle.x, middle.y, target.z);
                    for (ray, inside, toward) in [
                        (Ray::new(middle, away), &inside, Toward::Front),
                        (Ray::new(level, across), &inside, Toward::Front),
                        (Ray::new(middle + 3.0 * away, -away), &outside, Toward::Back),
                    ] {
                        let found = scene.find_next(&ray, &StartSurfaces::default(), inside);
                        let wanted = bare
                            .triangles()
                            .filter_map(|triangle| bare.crossing(triangle, &ray))
                            .filter(|crossing| crossing.toward == toward && crossing.t > -1e-9)
                            .map(|crossing| crossing.t)
                            .fold(f64::INFINITY, f64::min);
                        met += usize::from(wanted.is_finite());
                        let found = found.map_or(f64::INFINITY, |hits| hits.distance());
                        assert_eq!(found, wanted.max(0.0), "{ray:?}");
                    }
                }
            }
        }
        assert!(met > 4000, "all but rays in the ends of the rod: {met}");
    }
}
