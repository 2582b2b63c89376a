//! A mesh as a body of the scene: in the coordinates of the scene, or one of many copies that share their triangles.
//!
//! A ray is taken to the coordinates of a copy, where all triangles see the same line, so that copies have no gaps between
//! neighbours either. Distances along it are multiplied by the scale.

use crate::scene::crossing::tree::padding;
use crate::scene::mesh::tree::Sight;
use crate::scene::mesh::{Mesh, MeshPoint, TriangleLine};
use crate::scene::shape::{Crossing, Toward};
use crate::scene::{FaceId, Ray, SolidId};
use glam::{DAffine3, DMat3, DVec3};
use lumiduct_base::math::{Aabb, Frame};
use std::sync::Arc;

/// Rotation, uniform scale and translation of a copy; never a mirror image.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshPlace {
    to_scene: DAffine3,
    from_scene: DAffine3,
    /// Mean scale, 1: a matrix in f32 distorts by 1e-7.
    scale: f64,
}

impl MeshPlace {
    /// A place in a frame; `transform` must preserve orientation, and angles to about 1e-5.
    pub fn new(transform: &DAffine3, at: &Frame) -> Self {
        let frame =
            DAffine3 { matrix3: DMat3::from_cols(at.x, at.y, at.z), translation: at.origin };
        let to_scene = frame * *transform;
        let scale = to_scene.matrix3.determinant().cbrt();
        Self { to_scene, from_scene: to_scene.inverse(), scale }
    }

    /// A ray in the coordinates of the copy, and distances in the scene over those along it, 1.
    fn ray_from_scene(&self, ray: &Ray) -> (Ray, f64) {
        let from_scene = &self.from_scene;
        let dir = from_scene.transform_vector3(ray.dir());
        (Ray::new(from_scene.transform_point3(ray.origin()), dir), dir.length().recip())
    }

    /// Largest coordinate, mm, in the copy of a point with coordinates up to `largest` in the scene.
    fn reach(&self, largest: f64) -> f64 {
        (3.0_f64.sqrt() * largest + self.to_scene.translation.length()) / self.scale
    }
}

/// A closed body of triangles.
#[derive(Debug, Clone)]
pub struct MeshBody {
    /// Its triangles, shared by all copies.
    pub(crate) mesh: Arc<Mesh>,
    /// Box around it, mm.
    bounds: Aabb,
    /// The place of a copy; `None` for a mesh in the coordinates of the scene.
    place: Option<Box<MeshPlace>>,
    /// By how much the boxes of its tree must grow for rounding; known when the scene is built.
    padding: f32,
    /// The solid that it is part of.
    pub solid: SolidId,
    /// The scene's face of each face of the mesh.
    pub faces: Arc<[FaceId]>,
    /// The plane of each flat face that has no copies.
    pub planes: Arc<[Option<Frame>]>,
    /// Number of its first triangle among all surfaces.
    pub first: usize,
}

impl MeshBody {
    /// A mesh in the coordinates of the scene.
    pub(crate) fn new(mesh: Mesh, solid: SolidId, faces: Vec<FaceId>) -> Self {
        let planes = (0..faces.len()).map(|face| mesh.chart_plane(face)).collect();
        let bounds = Aabb::of(mesh.positions.iter().copied());
        let (mesh, faces) = (Arc::new(mesh), faces.into());
        Self { mesh, bounds, place: None, padding: 0.0, solid, faces, planes, first: 0 }
    }

    /// Copies of a mesh.
    pub(crate) fn copies(
        mesh: Mesh,
        places: Vec<MeshPlace>,
        solid: SolidId,
        faces: Vec<FaceId>,
    ) -> impl Iterator<Item = Self> {
        let planes: Arc<[Option<Frame>]> = vec![None; faces.len()].into();
        let (mesh, faces): (_, Arc<[FaceId]>) = (Arc::new(mesh), faces.into());
        places.into_iter().map(move |place| Self {
            mesh: Arc::clone(&mesh),
            bounds: Aabb::of(
                mesh.positions.iter().map(|position| place.to_scene.transform_point3(*position)),
            ),
            place: Some(Box::new(place)),
            padding: 0.0,
            solid,
            faces: Arc::clone(&faces),
            planes: Arc::clone(&planes),
            first: 0,
        })
    }

    /// Takes the plane from a face that is not all of a face of the scene: it has no chart.
    pub(crate) fn forget_plane(&mut self, face: usize) {
        let mut planes = self.planes.to_vec();
        planes[face] = None;
        self.planes = planes.into();
    }

    /// Sets the largest coordinate, mm, at which rays may start in the scene.
    pub(crate) fn set_reach(&mut self, largest_coordinate: f64) {
        let reach = self.place.as_ref().map(|place| place.reach(largest_coordinate));
        self.padding = padding(reach.unwrap_or(largest_coordinate));
    }

    /// Calls `visit` with the crossings of a ray's line with triangles in this direction, and with their numbers, at least those before
    /// `limit` and the smallest distance that `visit` has returned, mm.
    #[inline(always)]
    pub(crate) fn visit_crossings(
        &self,
        ray: &Ray,
        toward: Toward,
        limit: f64,
        mut visit: impl FnMut(usize, Crossing) -> f64,
    ) {
        let (ray, scale) = match &self.place {
            None => (*ray, 1.0),
            Some(place) => place.ray_from_scene(ray),
        };
        let line = TriangleLine::scaled(&ray, scale);
        let sight = Sight { ray: &ray, line: &line, padding: self.padding };
        self.mesh.visit_crossings(sight, toward, limit / scale, |triangle, crossing| {
            visit(triangle, crossing) / scale
        });
    }

    /// Whether it is a copy.
    pub fn is_copy(&self) -> bool {
        self.place.is_some()
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.mesh.triangle_count()
    }

    /// Triangles have numbers below this one, but some of these numbers have no triangle.
    pub fn number_limit(&self) -> usize {
        self.mesh.number_limit()
    }

    /// The three vertices of a triangle, mm.
    pub(crate) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.mesh.corners(triangle).map(|corner| self.point_to_scene(corner))
    }

    /// Box around it, mm.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Box around one of its faces, mm; around all of a copy.
    pub(crate) fn face_bounds(&self, face: usize) -> Aabb {
        if self.is_copy() {
            return self.bounds;
        }
        let corners = self.mesh.face_triangles(face).iter();
        Aabb::of(corners.flat_map(|triangle| self.corners(*triangle as usize)))
    }

    /// Unit normal of a triangle's plane, outward.
    #[inline]
    pub(crate) fn facet_normal(&self, triangle: usize) -> DVec3 {
        self.normal_to_scene(self.mesh.facet_normal(triangle))
    }

    /// Unit normal of the surface that the mesh approximates at a point of a triangle, outward.
    #[inline]
    pub(crate) fn shading_normal(&self, triangle: usize, point: DVec3) -> DVec3 {
        let own = match &self.place {
            None => point,
            Some(place) => place.from_scene.transform_point3(point),
        };
        self.normal_to_scene(self.mesh.shading_normal(triangle, own))
    }

    /// Area of a face, mm².
    pub(crate) fn face_area(&self, face: usize) -> f64 {
        let scale = self.place.as_ref().map_or(1.0, |place| place.scale);
        scale * scale * self.mesh.face_area(face)
    }

    /// A point of a face, uniform over its area for uniform `u`; `None` for a face without area.
    pub(crate) fn sample(&self, face: usize, u: [f64; 2]) -> Option<MeshPoint> {
        let MeshPoint { triangle, point } = self.mesh.sample(face, u)?;
        Some(MeshPoint { triangle, point: self.point_to_scene(point) })
    }

    #[inline]
    fn point_to_scene(&self, point: DVec3) -> DVec3 {
        match &self.place {
            None => point,
            Some(place) => place.to_scene.transform_point3(point),
        }
    }

    #[inline]
    fn normal_to_scene(&self, normal: DVec3) -> DVec3 {
        match &self.place {
            None => normal,
            Some(place) => (place.from_scene.matrix3.transpose() * normal).normalize(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Medium;
    use crate::rng::{Dimension, Sampler};
    use crate::scene::start::area::FaceArea;
    use crate::scene::{Builder, Hits, Inside, Scene, Solid, SolidId, StartSurfaces};
    use glam::DQuat;
    use lumiduct_base::math::uniform_sphere;
    use lumiduct_base::mesh::TriangleMesh;
    use lumiduct_base::mesh::bodies::{Normals, icosphere, rod};
    use lumiduct_base::units::FluxUnit;

    /// Turned, scaled and moved, far from the origin and from each other; the last is slightly distorted, as by rounding.
    fn places() -> Vec<DAffine3> {
        let place = |index: u32| {
            let own = f64::from(index);
            let turn = DQuat::from_euler(glam::EulerRot::XYZ, own, 0.3 + 2.0 * own, -own);
            let at = DVec3::new(120.0 + 30.0 * own, -30.0 + own * own, 7.0 * own);
            let scale = DVec3::new(1.0, 1.0 + if index == 4 { 5e-6 } else { 0.0 }, 1.0);
            DAffine3::from_scale_rotation_translation((0.3 + 0.4 * own) * scale, turn, at)
        };
        (0..5).map(place).collect()
    }

    fn frame() -> Frame {
        Frame::from_axis(DVec3::new(3.0, -2.0, 1.0), DVec3::new(0.2, 0.5, -0.8))
    }

    /// A solid of glass in air to which meshes are added.
    fn scene(add: impl FnOnce(&mut Builder, SolidId)) -> Scene {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let medium = builder.add_medium(Medium::new("glass", 1.5, 0.0));
        let (name, bounds) = ("body".to_owned(), Aabb::EMPTY);
        let solid = builder.add_solid(Solid { name, medium, priority: 0, bounds, volume: None });
        add(&mut builder, solid);
        builder.build()
    }

    /// Copies of a mesh beside one in the coordinates of the scene, and all of them as meshes of their own.
    fn both(mesh: &TriangleMesh) -> [Scene; 2] {
        let finishes = vec![[None; 2]; mesh.faces.len()];
        let own = Mesh::new(mesh, &frame());
        let copied = scene(|builder, solid| {
            let places = places().iter().map(|place| MeshPlace::new(place, &frame())).collect();
            builder.add_mesh("body", solid, own.clone(), &finishes);
            let shared = Mesh::new(mesh, &Frame::WORLD);
            builder.add_mesh_copies("body", solid, (shared, places), &finishes);
        });
        let single = scene(|builder, solid| {
            builder.add_mesh("body", solid, own.clone(), &finishes);
            for place in places() {
                let mut moved = mesh.clone();
                moved.positions.iter_mut().for_each(|p| *p = place.transform_point3(*p));
                for normal in moved.normals.iter_mut().flatten().flatten() {
                    *normal = (place.matrix3.inverse().transpose() * *normal).normalize();
                }
                builder.add_mesh("body", solid, Mesh::new(&moved, &frame()), &finishes);
            }
        });
        [copied, single]
    }

    /// Where a line meets what, all along, and whether it is outside of everything in the end.
    fn followed(scene: &Scene, ray: &Ray) -> (Vec<(f64, DVec3, String)>, bool) {
        let (mut ray, mut from, mut inside) = (*ray, StartSurfaces::default(), Inside::default());
        let (mut met, mut way) = (Vec::new(), 0.0);
        // A line that touches a vertex may go in and out there again and again.
        while let Some(hits) = scene.find_next(&ray, &from, &inside).filter(|_| met.len() < 100) {
            way += hits.distance();
            ray = ray.advanced(hits.distance());
            let Hits { nearest, .. } = &hits;
            let face = scene.faces[nearest.face.index()].name.clone();
            met.push((way, scene.normal(nearest.prim, ray.origin()), face));
            hits.cross(&mut inside);
            from = StartSurfaces::hits(&hits);
        }
        (met, inside.is_empty())
    }

    #[test]
    fn copies_are_met_like_meshes_of_their_own() {
        for mesh in [icosphere(3.0, 2, Normals::Smooth), rod(2.0, 9.0, 24, Normals::None)] {
            let [copied, single] = both(&mesh);
            let [ours, wanted] = [&copied, &single].map(|scene| scene.bounds.diagonal());
            assert!((ours - wanted).abs() < 1e-12 * wanted);
            let (mut crossings, mut touching) = (0, 0);
            for index in 0..4000 {
                let mut sampler = Sampler::for_path(51, 0, index);
                let body = &single.meshes[index as usize % single.meshes.len()];
                let triangles: Vec<usize> = body.mesh.triangles().collect();
                let [a, b, c] = body.corners(triangles[index as usize % triangles.len()]);
                // Every third aims at a vertex, every third at an edge.
                let target = match index % 3 {
                    0 => a,
                    1 => 0.5 * (a + b),
                    _ => 0.2 * a + 0.3 * b + 0.5 * c,
                };
                let away = uniform_sphere(sampler.pair(Dimension::EmitDirection));
                let ray = Ray::new(target + 300.0 * away, -away);
                let [ours, wanted] = [&copied, &single].map(|scene| followed(scene, &ray));
                // A line that touches a vertex or an edge of the silhouette may meet it on the way in alone, or in one scene alone.
                let touches = |(met, is_outside): &(Vec<(f64, DVec3, String)>, bool)| {
                    !is_outside || met.windows(2).any(|pair| pair[1].0 - pair[0].0 < 1e-3)
                };
                let meets = |(met, _): &(Vec<(f64, DVec3, String)>, bool)| {
                    met.iter().any(|(way, ..)| (way - 300.0).abs() < 1e-6)
                };
                if touches(&ours)
                    || touches(&wanted)
                    || index % 3 != 2 && meets(&ours) != meets(&wanted)
                {
                    touching += 1;
                    continue;
                }
                let ((ours, _), (wanted, _)) = (ours, wanted);
                assert_eq!(ours.len(), wanted.len(), "{ray:?}");
                crossings += ours.len();
                for (one, other) in ours.iter().zip(&wanted) {
                    assert!((one.0 - other.0).abs() < 1e-9, "{one:?} {other:?}");
                    // At a vertex or an edge either of its triangles may come first.
                    assert!(
                        index % 3 != 2 || (one.1.distance(other.1) < 1e-9 && one.2 == other.2),
                        "{one:?} {other:?}"
                    );
                }
            }
            assert!(crossings > 7000 && touching < 400, "{crossings} {touching}");
        }
    }

    #[test]
    fn faces_of_copies_have_their_area_their_points_and_no_chart() {
        let [copied, single] = both(&rod(2.0, 9.0, 24, Normals::Smooth));
        let exit = copied.face_named("body.exit").unwrap();
        let exits: Vec<FaceId> = (0..single.faces.len())
            .filter(|face| single.faces[*face].name == "body.exit")
            .map(FaceId::new)
            .collect();
        let one_by_one = FaceArea::new(&single, &exits);
        // Areas take the scale to be even.
        assert!((copied.face_area(exit) / one_by_one.area() - 1.0).abs() < 1e-5);
        assert!(copied.face_rect(exit).is_none() && copied.face_plane(exit).is_none());
        // Not even that of the mesh that is no copy: a point would be found for some of the light alone.
        assert!(copied.meshes[0].planes[2].is_none() && single.meshes[0].planes[2].is_some());
        let area = FaceArea::new(&copied, &[exit]);
        for index in 0..200 {
            let u = Sampler::for_path(52, 0, index).pair(Dimension::EmitPosition);
            let found = area.sample(u).unwrap();
            let normal = found.normal;
            let ray = Ray::new(found.point + normal, -normal);
            let density = area.density_across(&ray);
            let wanted = one_by_one.density_across(&ray) * one_by_one.area();
            assert!((density * area.area() / wanted - 1.0).abs() < 1e-9, "{density} {wanted}");
            let back = copied.normal(found.prim.unwrap(), found.point);
            assert!(back.distance(normal) < 1e-12);
        }
    }

    #[test]
    fn shading_normals_turn_with_the_copy() {
        let [copied, single] = both(&icosphere(3.0, 2, Normals::Smooth));
        for (index, (copy, mesh)) in copied.copies.iter().zip(&single.meshes[1..]).enumerate() {
            // A distortion bends interpolated normals otherwise than those of the corners.
            let most = if index == 4 { 1e-5 } else { 1e-12 };
            let pairs = copy.mesh.triangles().zip(mesh.mesh.triangles());
            for (triangle, same) in pairs.step_by(7) {
                let [a, b, c] = mesh.corners(same);
                let point = 0.2 * a + 0.3 * b + 0.5 * c;
                let ours = copy.shading_normal(triangle, point);
                let wanted = mesh.shading_normal(same, point);
                assert!(ours.distance(wanted) < most);
            }
        }
    }
}
