//! Checks that need the built scene: solids that fill the same space, and faces that cannot be
//! open.

use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::SceneSpec;
use glam::DVec3;
use lumiduct_core::optics::{FinishModel, REFERENCE_WAVELENGTH};
use lumiduct_core::rng::{Dimension, Sampler};
use lumiduct_core::scene::{FinishId, Owner, Ray, Scene, Solid, SolidId, StartSide};

/// Points tried in the space common to the boxes of two solids.
const PROBES: u64 = 512;

/// Notes pairs of solids of equal priority that overlap: it is undefined which medium counts.
pub(super) fn check_overlaps(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    for (first, one) in scene.solids.iter().enumerate() {
        for (second, other) in scene.solids.iter().enumerate().skip(first + 1) {
            if one.priority != other.priority {
                continue;
            }
            if let Some(place) = common_point(scene, SolidId::new(first), SolidId::new(second)) {
                let [x, y, z] = (place + scene.origin).to_array();
                let message = format!(
                    "overlaps `{}` at [{x:.4}, {y:.4}, {z:.4}] mm with the same priority, {}",
                    one.name, one.priority
                );
                problems
                    .error(&solid_key(spec, other).field("priority"), message)
                    .hint("give the one whose medium counts a higher `priority`");
            }
        }
    }
}

/// A point inside both solids, if one is found.
fn common_point(scene: &Scene, first: SolidId, second: SolidId) -> Option<DVec3> {
    let [one, other] = [first, second].map(|solid| scene.solids[solid.index()].bounds);
    let (min, max) = (one.min.max(other.min), one.max.min(other.max));
    // Solids that only touch share no box.
    if !(max - min).cmpgt(DVec3::splat(scene.tolerance)).all() {
        return None;
    }
    (0..PROBES).find_map(|probe| {
        let mut sampler = Sampler::for_path(0, u64::MAX, probe);
        let [u, v] = sampler.pair(Dimension::EmitPosition);
        let w = sampler.one(Dimension::EmitPosition);
        let point = min + DVec3::new(u, v, w) * (max - min);
        // A direction not aligned with any axis.
        let inside =
            scene.inside_at(&Ray::new(point, DVec3::new(0.41, 0.57, 0.71)), StartSide::Ahead);
        (inside.contains(first) && inside.contains(second)).then_some(point)
    })
}

/// Notes open faces of solids where the index changes, as light would pass them without refraction.
pub(super) fn check_open_faces(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    // The solid, and the step of the index if the finish lets light pass straight on.
    let step = |owner: Owner, finish: FinishId| {
        let Owner::Solid(solid) = owner else { return None };
        let solid = &scene.solids[solid.index()];
        let [inside, outside] = [solid.medium, scene.surroundings]
            .map(|medium| scene.media[medium.index()].index(REFERENCE_WAVELENGTH));
        let is_open = scene.finishes[finish.index()].finish.passes_straight();
        let step =
            format!("lets light pass straight on, but the index steps from {inside} to {outside}");
        (inside != outside && is_open).then_some((solid, step))
    };
    for pattern in &scene.patterns {
        let face = &scene.faces[pattern.face.index()];
        let Some((_, step)) = step(face.owner, pattern.back) else { continue };
        let hint =
            "holes are for sheets; on a solid use dots that scatter, or leave the face polished";
        problems
            .error(
                &Key::of(&["patterns", &pattern.name, "finish"]),
                format!("{step} at `{}`", face.name),
            )
            .hint(hint);
    }
    for face in &scene.faces {
        let Some((solid, step)) = face.front.and_then(|finish| step(face.owner, finish)) else {
            continue;
        };
        let is_relief = scene.reliefs.iter().any(|relief| relief.name == face.name);
        let key = match face.name.split_once('.') {
            Some((_, relief)) if is_relief => Key::of(&["reliefs", relief, "finish"]),
            Some(_) | None => solid_key(spec, solid).field("faces"),
        };
        let hint = "such a finish is for sheets and for solids of the surrounding medium; leave the face polished";
        problems.error(&key, format!("`{}` {step} there", face.name)).hint(hint);
    }
}

pub(super) fn solid_key(spec: &SceneSpec, solid: &Solid) -> Key {
    let kind = spec.solids.get(&solid.name).map_or("", |spec| spec.kind());
    Key::of(&["solids", &solid.name, kind])
}
