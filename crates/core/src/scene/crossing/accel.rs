//! The surfaces that a ray may meet, nearest first. Only this file names obvhs.
//!
//! Boxes are f32, padded outward, and cull only: shapes intersect in f64 inside the closure. Up to a handful of shapes
//! a linear scan is faster. (obvhs's own triangle test and its 8-wide traversal are not used: the first rejects
//! u = -0.0, the second has a fixed epsilon that loses paths in other units.)

use crate::scene::Ray;
use lumiduct_base::math::Aabb;
use obvhs::aabb::Aabb as Box32;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::{Ray as Ray32, RayHit};
use obvhs::{BvhBuildParams, fast_stack};
use std::fmt;
use std::time::Duration;

/// Up to this many patches are scanned one by one.
const SCAN_LIMIT: usize = 12;
/// Boxes grow by this many f32 ulp of the largest coordinate: rounding of the box, of the ray's origin, and of the slab test.
const PADDING_ULP: f64 = 8.0;

/// A culling structure over the boxes of all surfaces.
#[derive(Debug, Clone)]
pub(crate) enum Accel {
    /// A scan over this many patches.
    Scan(usize),
    /// A tree over more, or over triangles.
    Tree(Tree),
}

/// A binary tree of boxes.
#[derive(Clone)]
pub(crate) struct Tree(Box<Bvh2>);

impl fmt::Debug for Tree {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "Tree({} nodes)", self.0.nodes.len())
    }
}

impl Accel {
    /// A structure over `boxes`: the first `patches` belong to patches, the others to triangles.
    /// Ray origins have coordinates up to `largest_coordinate`, mm.
    pub(crate) fn new(boxes: &[Aabb], patches: usize, largest_coordinate: f64) -> Self {
        if boxes.len() == patches && patches <= SCAN_LIMIT {
            return Self::Scan(patches);
        }
        let padding = PADDING_ULP * f64::from(f32::EPSILON) * largest_coordinate;
        let boxes: Vec<Box32> = boxes.iter().map(|bounds| to_f32(bounds.grown(padding))).collect();
        let params = BvhBuildParams::medium_build();
        Self::Tree(Tree(Box::new(build_bvh2(&boxes, params, &mut Duration::default()))))
    }

    /// Calls `visit` with the index of every surface whose box the ray meets before the distance
    /// that the last `visit` returned.
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

impl Tree {
    /// Like [`Accel::visit`], nearer boxes first.
    #[inline]
    pub(crate) fn visit(&self, ray: &Ray, mut visit: impl FnMut(usize) -> f64) {
        let tree = &self.0;
        let ray = Ray32::new_inf(ray.origin().as_vec3a(), ray.dir().as_vec3a());
        let mut hit = RayHit::none();
        fast_stack!(u32, (96, 192), tree.max_depth, stack, {
            tree.ray_traverse_dynamic(&mut stack, ray, &mut hit, |node, ray, _| {
                let mut limit = f64::INFINITY;
                for slot in node.first_index..node.first_index + node.prim_count {
                    limit = visit(tree.primitive_indices[slot as usize] as usize);
                }
                ray.tmax = ray.tmax.min(round_up(limit));
                true
            });
        });
    }
}

/// The next f32 above a value, so that culling never removes a hit.
#[inline]
fn round_up(value: f64) -> f32 {
    (value as f32).next_up()
}

fn to_f32(bounds: Aabb) -> Box32 {
    let (min, max) = (bounds.min.as_vec3a(), bounds.max.as_vec3a());
    Box32::new(
        glam::Vec3A::new(min.x.next_down(), min.y.next_down(), min.z.next_down()),
        glam::Vec3A::new(max.x.next_up(), max.y.next_up(), max.z.next_up()),
    )
}

#[cfg(test)]
mod tests {
    use crate::optics::Medium;
    use crate::scene::mesh::Mesh;
    use crate::scene::{Builder, Inside, Ray, Solid, StartSurfaces};
    use glam::DVec3;
    use lumiduct_base::math::{Aabb, Frame};
    use lumiduct_base::mesh::TriangleMesh;
    use lumiduct_base::units::FluxUnit;

    #[test]
    fn a_body_of_as_few_triangles_as_possible_is_met() {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let medium = builder.add_medium(Medium::new("glass", 1.5, 0.0));
        let solid = builder.add_solid(Solid {
            name: "tetrahedron".into(),
            medium,
            priority: 0,
            bounds: Aabb::EMPTY,
            volume: None,
        });
        let mesh = TriangleMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            normals: None,
            face_of: vec![0; 4],
            faces: vec!["all".into()],
        };
        builder.add_mesh("tetrahedron", solid, Mesh::new(&mesh, &Frame::WORLD), &[[None; 2]]);
        let scene = builder.build();
        let ray = Ray::new(DVec3::new(0.2, 0.3, -1.0), DVec3::Z);
        let entry = scene.find_next(&ray, &StartSurfaces::default(), &Inside::default()).unwrap();
        assert!((entry.distance() - 1.0).abs() < 1e-12);
        let within: Inside = [solid].into_iter().collect();
        let exit =
            scene.find_next(&ray.advanced(1.0), &StartSurfaces::hits(&entry), &within).unwrap();
        assert!((exit.distance() - 0.5).abs() < 1e-12);
    }
}
