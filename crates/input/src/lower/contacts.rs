//! Solids so close to each other that they were meant to touch, but do not.
//!
//! Faces that coincide to rounding are one interface. Single precision coordinates of a mesh, or
//! rounded ones of a drawing, leave an unintended layer between them.

use crate::lower::consistency::solid_key;
use crate::problems::Problems;
use crate::spec::SceneSpec;
use lumiduct_base::number::format_value;
use lumiduct_core::rng::{Dimension, Sampler};
use lumiduct_core::scene::shape::Toward;
use lumiduct_core::scene::{AreaPoint, FaceArea, FaceId, Owner, Ray, Scene, SolidId};
use std::collections::BTreeMap;

/// Solids closer than this, mm, were meant to touch: two wavelengths, below which ray optics does
/// not hold.
const TOUCHING_MM: f64 = 1e-3;
/// Points tried on a face.
const PROBES: u64 = 48;
/// Least cosine of the angle between adjacent faces, 1.
const PARALLEL: f64 = 0.99;

/// A gap between two solids.
#[derive(Debug, Clone, Copy)]
struct Gap {
    /// The face it was found from.
    face: FaceId,
    points: u64,
    /// The widest gap, mm.
    widest: f64,
}

/// Notes pairs of solids that almost touch, once for each pair.
pub(super) fn check_contacts(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    let mut gaps: BTreeMap<[SolidId; 2], Gap> = BTreeMap::new();
    if scene.solids.len() > 1 {
        for (index, face) in scene.faces.iter().enumerate() {
            if let Owner::Solid(solid) = face.owner {
                probe(scene, FaceId::new(index), solid, &mut gaps);
            }
        }
    }
    for ([one, other], Gap { face, points, widest }) in gaps {
        let face = &scene.faces[face.index()];
        let other = if face.owner == Owner::Solid(one) { other } else { one };
        let (face, other) = (&face.name, &scene.solids[other.index()]);
        let message = format!(
            "`{}` and `{face}` lie up to {} mm apart without touching, at {points} of {PROBES} points of that face: light meets a thin layer there",
            other.name,
            format_value(widest)
        );
        let hint = "let one of them overlap the other and give it the higher `priority`, or place it `at` the face";
        problems.warning(&solid_key(spec, other), message).hint(hint);
    }
}

/// Searches from points of a face for other solids just before or behind it.
fn probe(scene: &Scene, face: FaceId, solid: SolidId, gaps: &mut BTreeMap<[SolidId; 2], Gap>) {
    let area = FaceArea::new(scene, &[face]);
    for probe in 0..PROBES {
        let mut sampler = Sampler::for_path(face.index() as u64, u64::MAX, probe);
        let Some(AreaPoint { point, normal, .. }) =
            area.sample(sampler.pair(Dimension::EmitPosition))
        else {
            return;
        };
        let ray = Ray::new(point - TOUCHING_MM * normal, normal);
        scene.all_crossings(&ray, |prim, crossing| {
            let Owner::Solid(other) = scene.surface(prim).owner() else { return };
            let beyond = crossing.t - TOUCHING_MM;
            if other == solid || beyond.abs() > TOUCHING_MM || beyond.abs() <= scene.tolerance {
                return;
            }
            // There is a gap where the other solid begins beyond the face or ends before it; else
            // they overlap.
            let is_layer = (beyond > 0.0) == (crossing.toward == Toward::Back);
            let is_beside = scene.normal(prim, ray.at(crossing.t)).dot(normal).abs() > PARALLEL;
            if is_layer && is_beside {
                let pair = [solid.min(other), solid.max(other)];
                let gap = gaps.entry(pair).or_insert(Gap { face, points: 0, widest: 0.0 });
                if gap.face == face {
                    gap.points += 1;
                    gap.widest = gap.widest.max(beyond.abs());
                }
            }
        });
    }
}
