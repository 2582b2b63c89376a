//! Convex solids, bounded by the surfaces they lie behind: boxes, pyramids, prisms, round rods.
//!
//! A path inside one leaves through the nearest surface ahead, and a path outside enters through
//! the last surface that it passes behind. No edge needs to be tested, and none can be missed.
//! Parallel faces are tested together, as a slab (Kay & Kajiya, SIGGRAPH 1986, section 3.1). This
//! module does not know other solids.

use crate::scene::crossing::hit::Nearest;
use crate::scene::shape::{Crossing, Cylinder, Flat, RayStart, Toward};
use crate::scene::{Owner, Patch, PrimId, Ray, SolidId, StartSurfaces};
use glam::DVec3;

/// Unit normals this close to opposite are opposite up to rounding; 1.
const OPPOSITE: f64 = 1e-15;
/// Faces whose normals differ by less may be pieces of one plane, so that the plane does not
/// identify the piece; 1.
const SAME: f64 = 1e-6;

/// A convex solid, as the intersection of slabs and at most one infinite cylinder.
#[derive(Debug, Clone)]
pub(crate) struct Convex {
    slabs: Vec<Slab>,
    round: Option<(PrimId, Cylinder)>,
    solid: SolidId,
}

/// The points between two parallel faces; if there is only one, the other is out of reach.
#[derive(Debug, Clone, Copy)]
struct Slab {
    normal: DVec3,
    /// Position of its middle along the normal, mm.
    middle: f64,
    /// Half of its thickness, mm.
    half: f64,
    /// The faces through which a ray leaves against or along the normal.
    faces: [PrimId; 2],
}

impl Slab {
    /// The distance at which a ray leaves, and through which face; NaN within a face.
    #[inline(always)]
    fn exit(&self, ray: &Ray) -> (f64, PrimId) {
        let across = ray.dir().dot(self.normal);
        let from_middle = ray.origin().dot(self.normal) - self.middle;
        let t = (self.half.copysign(across) - from_middle) / across;
        (t, self.faces[usize::from(across > 0.0)])
    }

    /// The distances at which a ray enters and leaves, and through which face it enters.
    #[inline(always)]
    fn span(&self, ray: &Ray) -> (f64, f64, PrimId) {
        let across = ray.dir().dot(self.normal);
        let from_middle = ray.origin().dot(self.normal) - self.middle;
        let half = self.half.copysign(across);
        let enter = (-half - from_middle) / across;
        (enter, (half - from_middle) / across, self.faces[usize::from(across <= 0.0)])
    }
}

/// Shared data of all solids, in a scene without meshes.
#[derive(Debug)]
pub(crate) struct ConvexSolids<'a> {
    pub(crate) patches: &'a [Patch],
    /// Diagonal of the box around everything, mm.
    pub(crate) diagonal: f64,
    /// Faces closer than this are the same, mm.
    pub(crate) tolerance: f64,
}

impl Convex {
    /// The solid of this number, if it is convex.
    pub(crate) fn of(room: &ConvexSolids<'_>, solid: SolidId) -> Option<Self> {
        let owner = Owner::Solid(solid);
        let (mut flats, mut round) = (Vec::new(), None);
        for (index, patch) in room.patches.iter().enumerate() {
            let prim = PrimId::new(index);
            if patch.owner != owner {
                continue;
            }
            if patch.trim.is_some() {
                return None;
            }
            let wall = patch.shape.as_cylinder();
            match (patch.shape.as_flat(), wall) {
                (Some(flat), _) => flats.push((prim, flat)),
                (None, Some(wall)) if round.is_none() && wall.is_whole() => {
                    round = Some((prim, wall.clone()));
                }
                (None, Some(_) | None) => return None,
            }
        }
        let mut convex = Self { slabs: Vec::new(), round, solid };
        for (prim, flat) in &flats {
            // Twice the diagonal is out of reach of any ray inside.
            convex.add_plane(*prim, flat, 2.0 * room.diagonal)?;
        }
        convex.is_bounded_by(&flats, room.tolerance).then_some(convex)
    }

    /// Adds the plane of a face; `None` for a second face in the same one.
    fn add_plane(&mut self, prim: PrimId, flat: &Flat, far: f64) -> Option<()> {
        let (normal, origin) = (flat.frame().z, flat.frame().origin);
        for slab in &mut self.slabs {
            let [against, along] = slab.faces;
            let opposite = slab.normal.distance(-normal);
            if slab.normal.distance(normal) < SAME || (opposite < SAME && against != along) {
                return None;
            }
            if opposite < OPPOSITE {
                let (low, high) = (origin.dot(slab.normal), slab.middle + slab.half);
                slab.middle = 0.5 * (low + high);
                slab.half = 0.5 * (high - low);
                slab.faces = [prim, along];
                return Some(());
            }
        }
        let middle = origin.dot(normal) - far;
        self.slabs.push(Slab { normal, middle, half: far, faces: [prim; 2] });
        Some(())
    }

    /// Whether all faces lie within all slabs and the cylinder. Then the solid is their
    /// intersection: its boundary is a closed surface on the boundary of the intersection, and so
    /// is all of it.
    fn is_bounded_by(&self, flats: &[(PrimId, &Flat)], tolerance: f64) -> bool {
        let round = self.round.as_ref().map(|(_, round)| round);
        let behind = |normal: DVec3, offset: f64| {
            flats.iter().all(|(_, flat)| flat.reach(normal) <= offset + tolerance)
                && round.is_none_or(|round| round.reach(normal) <= offset + tolerance)
        };
        !flats.is_empty()
            && self.slabs.iter().all(|slab| {
                behind(slab.normal, slab.half + slab.middle)
                    && behind(-slab.normal, slab.half - slab.middle)
            })
            && round
                .is_none_or(|round| flats.iter().all(|(_, flat)| round.encloses(flat, tolerance)))
    }

    /// The number of the solid.
    #[inline(always)]
    pub(crate) fn solid(&self) -> SolidId {
        self.solid
    }

    /// All its faces.
    pub(crate) fn faces(&self) -> impl Iterator<Item = PrimId> + '_ {
        let flats = self.slabs.iter().flat_map(|slab| match slab.faces {
            [against, along] if against == along => [Some(along), None],
            faces => faces.map(Some),
        });
        flats.flatten().chain(self.round.iter().map(|(prim, _)| *prim))
    }

    /// Where a ray inside leaves; `None` where rounding has put it beyond a face, or where it
    /// starts on the face that it leaves through: then edges must be tested.
    #[inline(always)]
    pub(crate) fn exit(&self, ray: &Ray, from: &StartSurfaces, tolerance: f64) -> Option<Nearest> {
        let mut nearest = Nearest::NONE;
        for slab in &self.slabs {
            let (t, prim) = slab.exit(ray);
            nearest.choose(prim, Crossing { t, toward: Toward::Front });
        }
        if from.contains(nearest.prim) || nearest.crossing.t < -tolerance {
            return None;
        }
        if let Some((prim, round)) = &self.round {
            let start = if from.contains(*prim) { RayStart::On } else { RayStart::Elsewhere };
            let t = round.exit(ray, start);
            nearest.consider(*prim, Crossing { t, toward: Toward::Front });
        }
        (nearest.crossing.t >= -tolerance).then_some(nearest)
    }

    /// Where a ray outside enters. A ray that starts on a face has left the solid and does not
    /// return.
    #[inline(always)]
    pub(crate) fn entry(
        &self,
        ray: &Ray,
        from: &StartSurfaces,
        tolerance: f64,
    ) -> Option<(PrimId, Crossing)> {
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut face = None;
        if let Some((prim, round)) = &self.round {
            [enter, leave] = round.span(ray)?;
            face = Some(*prim);
        }
        for slab in &self.slabs {
            let (t, out, prim) = slab.span(ray);
            leave = if out < leave { out } else { leave };
            if t > enter {
                (enter, face) = (t, Some(prim));
            }
        }
        let enters =
            enter <= leave && enter >= -tolerance && !self.faces().any(|own| from.contains(own));
        let crossing = Crossing { t: enter, toward: Toward::Back };
        face.filter(|_| enters).map(|face| (face, crossing))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Medium;
    use crate::rng::{Dimension, Sampler};
    use crate::scene::Scene;
    use crate::scene::shape::{Region, Shape};
    use crate::scene::{Builder, FacePiece, FaceSpec, Inside, Solid};
    use lumiduct_base::math::{Aabb, Frame, circle, uniform_sphere};
    use lumiduct_base::units::FluxUnit;

    const LENGTH: f64 = 3.0;
    const RADIUS: f64 = 1.0;

    fn frame() -> Frame {
        Frame::from_axis(DVec3::new(0.3, -0.2, 0.5), DVec3::new(0.4, -0.3, 0.8))
    }

    fn solid_of(shapes: Vec<Shape>) -> Scene {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let medium = builder.add_medium(Medium::new("glass", 1.5, 0.0));
        let solid = builder.add_solid(Solid {
            name: "body".into(),
            medium,
            priority: 0,
            bounds: Aabb::EMPTY,
            volume: None,
        });
        builder.add_face(FaceSpec {
            name: "body.all".into(),
            owner: Owner::Solid(solid),
            front: None,
            back: None,
            pieces: shapes.into_iter().map(FacePiece::whole).collect(),
        });
        builder.build()
    }

    /// The two ends of a body along z of the frame.
    fn ends(region: &Region) -> Vec<Shape> {
        let f = frame();
        let back = Frame { x: f.x, y: -f.y, z: -f.z, origin: f.origin };
        let ahead = f.shifted(LENGTH * f.z);
        [back, ahead].map(|frame| Shape::Flat(Flat::new(frame, region.clone()))).into()
    }

    fn rod() -> Vec<Shape> {
        let mut shapes = ends(&Region::Annulus { inner: 0.0, outer: RADIUS });
        shapes.push(Shape::Cylinder(Cylinder::new(frame(), RADIUS, LENGTH)));
        shapes
    }

    /// A prism over a regular polygon whose walls touch the circle of [`RADIUS`].
    fn prism(sides: u32) -> Vec<Shape> {
        let f = frame();
        let share = |side: f64| side / f64::from(sides);
        let apothem = RADIUS;
        let half_side = apothem * (std::f64::consts::PI / f64::from(sides)).tan();
        let corner =
            |side: u32| apothem.hypot(half_side) * circle((share(f64::from(side) + 0.5)).fract());
        let outline: Vec<_> = (0..sides).map(corner).collect();
        let mirrored = outline.iter().rev().map(|p| glam::DVec2::new(p.x, -p.y)).collect();
        let mut shapes = ends(&Region::polygon(outline));
        let Shape::Flat(back) = &shapes[0] else { unreachable!() };
        shapes[0] = Shape::Flat(Flat::new(*back.frame(), Region::polygon(mirrored)));
        shapes.extend((0..sides).map(|side| {
            let outward = f.to_world(circle(share(f64::from(side))).extend(0.0));
            let middle = f.origin + apothem * outward + 0.5 * LENGTH * f.z;
            let wall = Frame::from_axis_and_x(middle, outward, f.z).unwrap();
            let region = Region::Rectangle { half_x: 0.5 * LENGTH, half_y: half_side };
            Shape::Flat(Flat::new(wall, region))
        }));
        shapes
    }

    #[test]
    fn rays_leave_convex_solids_where_the_edges_of_their_faces_say() {
        for scene in [rod(), prism(3), prism(4), prism(5), prism(6)].map(solid_of) {
            let mut by_edges = scene.clone();
            by_edges.convex.clear();
            by_edges.loose = (0..scene.patches.len()).map(PrimId::new).collect();
            assert_eq!((scene.convex.len(), scene.loose.len()), (1, 0));
            let inside: Inside = [SolidId::new(0)].into_iter().collect();
            for index in 0..4000 {
                let mut sampler = Sampler::for_path(5, 0, index);
                let mut pair = || sampler.pair(Dimension::EmitPosition);
                let (across, along) =
                    (0.99 * lumiduct_base::math::disk(pair()), pair()[0] * LENGTH);
                let start = frame().point_to_world(across + along * DVec3::Z);
                let mut ray = Ray::new(start, uniform_sphere(pair()));
                let mut on = StartSurfaces::default();
                // From inside, and from the face that was met, back into the solid.
                for _ in 0..3 {
                    let found = scene.find_next(&ray, &on, &inside).unwrap();
                    let expected = by_edges.find_next(&ray, &on, &inside).unwrap();
                    assert_eq!(found.nearest(), expected.nearest());
                    let point = ray.at(found.distance());
                    let normal = scene.normal(found.nearest().prim, point);
                    // Rounding moves the face, and a grazing ray meets it elsewhere.
                    let apart = found.distance() - expected.distance();
                    assert!((apart * ray.dir().dot(normal)).abs() < 1e-14, "{apart}");
                    let into = uniform_sphere(pair());
                    on = StartSurfaces::hits(&found);
                    ray = Ray::new(point, if into.dot(normal) < 0.0 { into } else { -into });
                }
            }
        }
    }

    #[test]
    fn rays_enter_convex_solids_where_the_edges_of_their_faces_say() {
        for scene in [rod(), prism(3), prism(4), prism(5), prism(6)].map(solid_of) {
            let mut by_edges = scene.clone();
            by_edges.convex.clear();
            by_edges.loose = (0..scene.patches.len()).map(PrimId::new).collect();
            let (mut met, axis) = (0, frame().z);
            for index in 0..8000 {
                let mut sampler = Sampler::for_path(6, 0, index);
                let mut pair = || sampler.pair(Dimension::EmitPosition);
                let start = frame().point_to_world(4.0 * LENGTH * uniform_sphere(pair()));
                let across = frame().to_world(1.5 * RADIUS * lumiduct_base::math::disk(pair()));
                let target = frame().origin + across + pair()[0] * LENGTH * axis;
                // Includes rays along the axis, which meet no wall.
                let ray = if index % 4 == 0 {
                    Ray::new(target - 2.0 * LENGTH * axis, axis)
                } else {
                    Ray::new(start, target - start)
                };
                let find = |scene: &Scene| {
                    scene.find_next(&ray, &StartSurfaces::default(), &Inside::default())
                };
                let (found, expected) = (find(&scene), find(&by_edges));
                assert_eq!(found.is_some(), expected.is_some());
                if let (Some(found), Some(expected)) = (found, expected) {
                    met += 1;
                    assert_eq!(found.nearest(), expected.nearest());
                    let normal = scene.normal(found.nearest().prim, ray.at(found.distance()));
                    let apart = found.distance() - expected.distance();
                    assert!((apart * ray.dir().dot(normal)).abs() < 1e-13, "{apart}");
                }
            }
            assert!((2000..8000).contains(&met), "{met}");
        }
    }

    #[test]
    fn a_ray_into_an_edge_leaves_through_both_faces_or_one_but_never_slips_through() {
        let scene = solid_of(prism(4));
        let inside: Inside = [SolidId::new(0)].into_iter().collect();
        let f = frame();
        let middle = f.point_to_world(DVec3::new(0.0, 0.0, 0.4 * LENGTH));
        for index in 0..2000 {
            let height = f64::from(index) / 2000.0 * LENGTH;
            let edge = f.point_to_world(DVec3::new(RADIUS, RADIUS, height));
            let hits = scene.find_next(
                &Ray::new(middle, edge - middle),
                &StartSurfaces::default(),
                &inside,
            );
            assert!((hits.unwrap().distance() - middle.distance(edge)).abs() < 1e-12);
        }
    }

    #[test]
    fn solids_with_holes_inward_corners_or_split_faces_are_not_convex() {
        let convex = |shapes| {
            let scene = solid_of(shapes);
            let room = ConvexSolids {
                patches: &scene.patches,
                diagonal: scene.bounds.diagonal(),
                tolerance: scene.tolerance,
            };
            Convex::of(&room, SolidId::new(0)).is_some()
        };
        assert!(convex(rod()) && convex(prism(6)));
        let mut pipe = rod();
        pipe.push(Shape::Cylinder(Cylinder::new(frame(), 0.5 * RADIUS, LENGTH).inward()));
        assert!(!convex(pipe));
        let mut split = prism(4);
        split.push(split[3].clone());
        assert!(!convex(split));
        // A wall closer to the axis than the rim of the ends.
        let mut waisted = prism(6);
        let Shape::Flat(wall) = &waisted[4] else { unreachable!() };
        let moved = wall.frame().shifted(-0.1 * wall.frame().z);
        waisted[4] = Shape::Flat(Flat::new(moved, wall.region().clone()));
        assert!(!convex(waisted));
    }
}
