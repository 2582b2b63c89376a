//! Where the light of sources starts: outside all solids, in one, or partly in one, which is
//! refused; and what lies between the starts of rays and the plane of their fit.

use crate::keys::Key;
use crate::lower::emitters::SourceExtent;
use crate::lower::slips::check_embedded;
use crate::problems::Problems;
use crate::spec::SceneSpec;
use crate::spec::placement::PlacementSpec;
use crate::spec::source::{SourceCommonSpec, SourceSpec};
use indexmap::{IndexMap, IndexSet};
use lumiduct_base::number::{format_percent, format_value};
use lumiduct_core::optics::Finish;
use lumiduct_core::rng::Sampler;
use lumiduct_core::scene::shape::Crossing;
use lumiduct_core::scene::{
    DrawnWavelength, Emitted, Emitter, FaceId, FinishId, Owner, Ray, Scene, SolidId, StartSolids,
};

/// Starts tested per source: any part that is missed is less than a hundredth of the source.
const LOOKS: u64 = 1024;

/// Sources that touch no solid start all their paths outside, without a search.
pub(super) fn settle_starts(scene: &mut Scene) {
    let boxes: Vec<_> =
        scene.solids.iter().map(|solid| solid.bounds.grown(scene.tolerance)).collect();
    for source in &mut scene.sources {
        let bounds = source.emitter.bounds();
        if !boxes.iter().any(|solid| solid.overlaps(&bounds)) {
            source.start = StartSolids::Outside;
        }
    }
}

/// Remarks on sources without a gap: glue or a thin air gap in between gives different light. A gap
/// below the tolerance of coincident faces counts as none.
pub(super) fn note_joints(
    spec: &SceneSpec,
    scene: &Scene,
    faces: &IndexMap<String, Vec<FaceId>>,
    problems: &mut Problems,
) {
    let is_of_a_solid = |face: &str| {
        let faces = faces.get(face).into_iter().flatten();
        faces.into_iter().any(|face| matches!(scene.faces[face.index()].owner, Owner::Solid(_)))
    };
    for (name, source) in &spec.sources {
        let Some(common) = source.common() else { continue };
        if let (Some(PlacementSpec::AtFace(at)), None) = (&common.at, common.contact)
            && at.gap_mm <= scene.tolerance
            && is_of_a_solid(&at.face)
        {
            let no_gap = if at.gap_mm > 0.0 {
                format!(": a gap of {} mm counts as zero", format_value(at.gap_mm))
            } else {
                String::new()
            };
            let message =
                format!("touches `{}` and is joined to it optically, as by glue{no_gap}", at.face);
            problems.warning(&Key::of(&["sources", name, source.kind()]), message).hint(
                "write contact = \"optical\" if so, contact = \"air\" for a thin layer of air, or a gap_mm",
            );
        }
    }
}

/// Notes fitted sources whose light may meet faces that the rays of the file do not meet, or may miss faces that they meet.
pub(super) fn note_fits(scene: &Scene, problems: &mut Problems) {
    for source in &scene.sources {
        let Emitter::Fitted { light, frame, .. } = &source.emitter else { continue };
        let mut between: IndexMap<&str, usize> = IndexMap::new();
        for line in light.crossings_and_starts() {
            let [place, start] = line.map(|point| frame.point_to_world(point));
            let Some(dir) = (start - place).try_normalize() else { continue };
            let mut met = IndexSet::new();
            scene.all_crossings(&Ray::new(place, dir), |prim, Crossing { t, .. }| {
                if t > scene.tolerance && t < place.distance(start) - scene.tolerance {
                    let face = scene.surface(prim).face();
                    met.insert(scene.faces[face.index()].name.as_str());
                }
            });
            met.into_iter().for_each(|face| *between.entry(face).or_default() += 1);
        }
        for (face, count) in between {
            let share = format_percent(count as f64 / light.crossings_and_starts().len() as f64);
            let message = format!(
                "for {share} of the rays, `{face}` lies between their start points in the file and the fitted plane"
            );
            let key = Key::of(&["sources", &source.name, "rays", "fitted"]);
            problems.warning(&key, message).hint(
                "light now starts at the plane, so it may meet or miss this face wrongly; choose another plane with `fitted_at_mm`",
            );
        }
    }
}

/// Notes sources whose light cannot escape from where it starts.
pub(super) fn check_starts(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    for source in &scene.sources {
        let Some(kind) = spec.sources.get(&source.name).map(SourceSpec::kind) else { continue };
        let key = Key::of(&["sources", &source.name, kind]);
        if source.start == StartSolids::Outside {
            continue;
        }
        let starts: Vec<_> = (0..LOOKS)
            .map(|look| {
                let mut sampler = Sampler::for_path(0, u64::MAX, look);
                source.emit(scene, DrawnWavelength::REFERENCE, &mut sampler)
            })
            .collect();
        let buried = |solid: SolidId| {
            starts.iter().all(|start| start.inside.contains(solid)) && is_opaque(scene, solid)
        };
        if let Some(solid) = (0..scene.solids.len()).map(SolidId::new).find(|solid| buried(*solid))
        {
            let name = &scene.solids[solid.index()].name;
            let message =
                format!("lies inside the opaque solid `{name}`: none of its light gets out");
            let hint = "move the source, or give a face of the solid another finish";
            problems.error(&key, message).hint(hint);
        } else if let Some(of) = spec.sources.get(&source.name) {
            check_embedded(scene, of, &starts, &key, problems);
        }
        if is_in_space(spec, &source.name) {
            check_covered(scene, &starts, &key, problems);
        }
    }
}

/// Whether a source is a surface in free space: one at a face may be wider than the face.
fn is_in_space(spec: &SceneSpec, name: &str) -> bool {
    spec.sources.get(name).is_some_and(|source| {
        let at_face =
            |common: &SourceCommonSpec| matches!(common.at, Some(PlacementSpec::AtFace(_)));
        SourceExtent::of(source) == Some(SourceExtent::Area)
            && !source.common().is_some_and(at_face)
    })
}

/// Notes a source that starts some of its light in a solid, such as a dome, and some outside it.
fn check_covered(scene: &Scene, starts: &[Emitted], key: &Key, problems: &mut Problems) {
    for (index, solid) in scene.solids.iter().enumerate() {
        let is_in = |start: &&Emitted| start.inside.contains(SolidId::new(index));
        let missed = starts.iter().find(|start| !is_in(start));
        if let (Some(missed), Some(_)) = (missed, starts.iter().find(is_in)) {
            let [x, y, z] = (missed.ray.origin() + scene.origin).to_array();
            let message = format!(
                "lies partly inside `{}` and partly outside, as at [{x:.4}, {y:.4}, {z:.4}] mm",
                solid.name
            );
            let hint = "move or enlarge the solid, or split the source in two";
            problems.error(key, message).hint(hint);
        }
    }
}

/// Whether every face of a solid absorbs all light.
fn is_opaque(scene: &Scene, solid: SolidId) -> bool {
    let absorbs = |finish: Option<FinishId>| {
        finish.is_some_and(|finish| scene.finishes[finish.index()].finish == Finish::Absorber)
    };
    scene
        .faces
        .iter()
        .filter(|face| face.owner == Owner::Solid(solid))
        .all(|face| absorbs(face.back))
}
