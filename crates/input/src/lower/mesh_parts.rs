//! Parts of one mesh that overlap: light would leave the solid at the first surface out of either.

use crate::lower::consistency::solid_key;
use crate::problems::Problems;
use crate::spec::SceneSpec;
use glam::DVec3;
use lumiduct_base::math::uniform_sphere;
use lumiduct_base::number::format_value;
use lumiduct_core::rng::{Dimension, Sampler};
use lumiduct_core::scene::shape::Toward;
use lumiduct_core::scene::{FaceArea, FaceId, Owner, PieceRange, Ray, Scene, SolidId};

/// Lines tried through points of each solid of triangles.
const LINES: u64 = 4000;

/// Notes solids of triangles whose parts overlap.
pub(super) fn check_parts(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    for (index, solid) in scene.solids.iter().enumerate() {
        let Some(point) = overlap(scene, SolidId::new(index)) else { continue };
        let [x, y, z] = (scene.origin + point).to_array().map(format_value);
        let message = format!(
            "`{}` has parts that overlap, or one inside another that is no cavity, near [{x}, {y}, {z}] mm: light would leave it at the first surface out of either",
            solid.name
        );
        problems
            .error(&solid_key(spec, solid), message)
            .hint("unite the parts in CAD, or make them solids of their own with priorities");
    }
}

/// A point where lines go into a solid of triangles twice, or out of it twice.
fn overlap(scene: &Scene, solid: SolidId) -> Option<DVec3> {
    let owner = Owner::Solid(solid);
    let faces: Vec<FaceId> = (0..scene.faces.len())
        .filter(|face| {
            let face = &scene.faces[*face];
            face.owner == owner && matches!(face.extent, PieceRange::Mesh(_))
        })
        .map(FaceId::new)
        .collect();
    let area = FaceArea::new(scene, &faces);
    (0..LINES).find_map(|line| {
        let mut sampler = Sampler::for_path(solid.index() as u64, u64::MAX, line);
        let point = area.sample(sampler.pair(Dimension::EmitPosition))?.point;
        let dir = uniform_sphere(sampler.pair(Dimension::EmitDirection));
        let ray = Ray::new(point - scene.bounds.diagonal() * dir, dir);
        let mut crossings = Vec::new();
        scene.all_crossings(&ray, |prim, crossing| {
            if scene.surface(prim).owner() == owner {
                crossings.push((crossing.t, crossing.toward));
            }
        });
        crossings.sort_by(|one, other| one.0.total_cmp(&other.0));
        Some(ray.at(repeated(&crossings, scene.tolerance)?))
    })
}

/// The first distance at which a line that is inside goes in again, or one that is outside goes out.
fn repeated(crossings: &[(f64, Toward)], tolerance: f64) -> Option<f64> {
    let mut is_inside = false;
    for met in crossings.chunk_by(|one, other| other.0 - one.0 <= tolerance) {
        let goes = |toward: Toward| met.iter().any(|(_, own)| *own == toward);
        // Both where two parts touch, and where the line touches an edge.
        if goes(Toward::Back) && goes(Toward::Front) {
            continue;
        }
        if goes(Toward::Back) == is_inside {
            return Some(met[0].0);
        }
        is_inside = !is_inside;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumiduct_base::math::{Aabb, Frame};
    use lumiduct_base::mesh::TriangleMesh;
    use lumiduct_base::mesh::bodies::{Normals, block, icosphere};
    use lumiduct_base::units::FluxUnit;
    use lumiduct_core::optics::Medium;
    use lumiduct_core::scene::mesh::Mesh;
    use lumiduct_core::scene::{Builder, Solid};

    /// Whether these parts of one solid are found to overlap.
    fn overlaps(parts: &[TriangleMesh]) -> bool {
        let mut builder = Builder::new(DVec3::ZERO, Medium::new("air", 1.0, 0.0), FluxUnit::Lumen);
        let medium = builder.add_medium(Medium::new("glass", 1.5, 0.0));
        let (name, bounds) = ("body".to_owned(), Aabb::EMPTY);
        let solid = builder.add_solid(Solid { name, medium, priority: 0, bounds, volume: None });
        for part in parts {
            let finishes = vec![[None; 2]; part.faces.len()];
            builder.add_mesh("body", solid, Mesh::new(part, &Frame::WORLD), &finishes);
        }
        overlap(&builder.build(), solid).is_some()
    }

    fn moved(mut mesh: TriangleMesh, by: DVec3) -> TriangleMesh {
        mesh.positions.iter_mut().for_each(|position| *position += by);
        mesh
    }

    #[test]
    fn parts_that_overlap_or_lie_in_each_other_are_found_and_cavities_are_none() {
        let ball = |radius: f64| icosphere(radius, 2, Normals::None);
        let cavity = |radius: f64| {
            let mut inward = ball(radius);
            inward.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
            inward
        };
        let cube = |x: f64| moved(block(DVec3::ONE), DVec3::new(x, 0.0, 0.0));
        for (parts, expected) in [
            (vec![ball(1.0)], false),
            (vec![ball(1.0), moved(ball(1.0), 2.5 * DVec3::X)], false),
            (vec![ball(1.0), moved(ball(1.0), 1.5 * DVec3::X)], true),
            (vec![ball(1.0), ball(0.3)], true),
            (vec![ball(0.3), ball(1.0)], true),
            (vec![ball(1.0), cavity(0.3)], false),
            (vec![ball(1.0), cavity(0.5), ball(0.3)], false),
            (vec![cube(0.0), cube(1.0)], false),
            (vec![cube(0.0), cube(0.9)], true),
        ] {
            assert_eq!(overlaps(&parts), expected, "{} parts", parts.len());
        }
    }
}
