//! Remarks on valid input that is seldom intended: the light is traced as the file says, and the
//! numbers look plausible.

use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::SceneSpec;
use crate::spec::placement::PlacementSpec;
use crate::spec::sensor::{CountsSpec, SensorSide, SensorSpec};
use crate::spec::source::{BodySpec, SourceCommonSpec, SourceSpec};
use glam::DVec3;
use lumiduct_base::number::format_value;
use lumiduct_core::optics::{Finish, REFERENCE_WAVELENGTH};
use lumiduct_core::rng::{Dimension, Sampler};
use lumiduct_core::scene::{
    Emitted, FaceArea, FaceId, FinishId, Owner, Ray, Scene, Solid, SolidId, StartSide,
};

/// Points tried on a face of a sheet: a cut of a hundredth of it is missed once in ten sheets.
const PROBES: u64 = 256;

/// Remarks on sources, sheets and sensors.
pub(super) fn check_slips(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    check_cut_solids(spec, scene, problems);
    check_sources_at_exits(spec, problems);
    check_sides(spec, problems);
}

/// Notes a free source whose light all starts inside a guide. Not noted are a source with a `body`,
/// which is a component cast into the guide, and an explicit `contact`, which states the intent.
pub(super) fn check_embedded(
    scene: &Scene,
    source: &SourceSpec,
    starts: &[Emitted],
    key: &Key,
    problems: &mut Problems,
) {
    let Some(common) = source.common().filter(|common| stands_free(source, common)) else { return };
    if common.body != BodySpec::Transparent || common.contact.is_some() {
        return;
    }
    let holds_all = |solid: &SolidId| {
        is_a_guide(scene, &scene.solids[solid.index()])
            && starts.iter().all(|start| start.inside.contains(*solid))
    };
    let holding = (0..scene.solids.len()).map(SolidId::new).filter(holds_all);
    let holding = holding.map(|solid| &scene.solids[solid.index()]);
    // Of several, light starts in that of the highest priority.
    let Some(solid) = holding.max_by_key(|solid| solid.priority) else { return };
    let medium = scene.media[solid.medium.index()].name();
    let message = format!(
        "lies inside the solid `{}`: its light starts in `{medium}` and crosses no face on its way in",
        solid.name
    );
    let hint = "move it out of the solid, or write contact = \"optical\" if it is cast in";
    problems.warning(key, message).hint(hint);
}

/// Whether a source is placed by a position, not by a face or solid.
fn stands_free(source: &SourceSpec, common: &SourceCommonSpec) -> bool {
    !matches!(source, SourceSpec::Face(_) | SourceSpec::Volume(_))
        && !matches!(common.at, Some(PlacementSpec::AtFace(_)))
}

/// Whether light is meant to enter a solid by an entry: not a ball, such as the dome of a chip, nor
/// where the entry is black.
fn is_a_guide(scene: &Scene, solid: &Solid) -> bool {
    let name = format!("{}.entry", solid.name);
    let is_black = |finish: FinishId| scene.finishes[finish.index()].finish == Finish::Absorber;
    let mut faces = scene.faces.iter();
    has_an_index_step(scene, solid)
        && faces.any(|face| face.name == name && !face.back.is_some_and(is_black))
}

/// Whether the medium of a solid differs from the surroundings: if not, its faces have no effect.
fn has_an_index_step(scene: &Scene, solid: &Solid) -> bool {
    let index = |medium: lumiduct_core::scene::MediumId| {
        scene.media[medium.index()].index(REFERENCE_WAVELENGTH)
    };
    index(solid.medium) != index(scene.surroundings)
}

/// Notes sheets partly inside a guide and partly outside it. Boards and roofs do pass through
/// domes.
fn check_cut_solids(spec: &SceneSpec, scene: &Scene, problems: &mut Problems) {
    for (name, sheet) in &spec.sheets {
        let is_own = |face: &FaceId| {
            let face = &scene.faces[face.index()];
            face.owner == Owner::Sheet && face.name.split('.').next() == Some(name)
        };
        let faces: Vec<FaceId> = (0..scene.faces.len()).map(FaceId::new).filter(is_own).collect();
        for (index, solid) in scene.solids.iter().enumerate() {
            if !is_a_guide(scene, solid) {
                continue;
            }
            let Some([inside, outside]) = cut(scene, &faces, SolidId::new(index)) else { continue };
            let [inside, outside] = [inside, outside].map(|point| place(point + scene.origin));
            let message = format!(
                "cuts through the solid `{}`: it is inside at {inside} and outside at {outside}; light \
                    inside the solid also meets it",
                solid.name
            );
            let hint =
                "leave a hole for the solid, as an `annulus` has, or keep the sheet clear of it";
            problems.warning(&Key::of(&["sheets", name, sheet.kind()]), message).hint(hint);
        }
    }
}

/// A point of some faces inside a solid, and one outside it, if both exist.
fn cut(scene: &Scene, faces: &[FaceId], solid: SolidId) -> Option<[DVec3; 2]> {
    let bounds = scene.solids[solid.index()].bounds;
    let near = |face: &&FaceId| {
        let mut patches = scene.face_patches(**face).iter();
        patches.any(|patch| patch.shape.bounds().overlaps(&bounds))
    };
    let mut found = [None, None];
    // Each face is tested separately, as a sheet may have several walls.
    for face in faces.iter().filter(near) {
        let area = FaceArea::new(scene, std::slice::from_ref(face));
        for probe in 0..PROBES {
            let mut sampler = Sampler::for_path(0, u64::MAX, probe);
            let Some(at) = area.sample(sampler.pair(Dimension::EmitPosition)) else { continue };
            let ray = Ray::new(at.point, at.normal);
            let [ahead, behind] = [StartSide::Ahead, StartSide::Behind]
                .map(|side| scene.inside_at(&ray, side).contains(solid));
            // They differ on a face of the solid: the sheet lies on it.
            if ahead == behind {
                found[usize::from(!ahead)].get_or_insert(at.point);
            }
            if let [Some(inside), Some(outside)] = found {
                return Some([inside, outside]);
            }
        }
    }
    None
}

fn place(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(format_value);
    format!("[{x}, {y}, {z}] mm")
}

/// Notes sources before a face where a sensor counts leaving light: their light enters there,
/// against the sensor.
fn check_sources_at_exits(spec: &SceneSpec, problems: &mut Problems) {
    for (name, source) in &spec.sources {
        let at = source.common().and_then(|common| common.at.as_ref());
        let Some(PlacementSpec::AtFace(at)) = at else { continue };
        let counts_there = |sensor: &SensorSpec| {
            sensor.on.as_ref() == Some(&at.face)
                && sensor.counts == Some(CountsSpec::Leaving)
                && sensor.side.is_none()
        };
        // A sensor on an entry counts the returning light.
        let is_entry = at.face.ends_with(".entry");
        let Some((sensor, _)) = spec.sensors.iter().find(|(_, sensor)| counts_there(sensor)) else {
            continue;
        };
        if !is_entry {
            let face = &at.face;
            let message = format!(
                "shines into `{face}`, and the sensor `{sensor}` counts light that leaves there"
            );
            let hint = "place the source at the entry, or give the sensor a `side` if it counts what comes back";
            let key = Key::of(&["sources", name, source.kind(), "at", "face"]);
            problems.warning(&key, message).hint(hint);
        }
    }
}

/// Notes a `side` that counts light opposite to its direction at the exit of a guide.
fn check_sides(spec: &SceneSpec, problems: &mut Problems) {
    for (name, sensor) in &spec.sensors {
        let Some(on) = sensor.on.as_ref().filter(|on| on.ends_with(".exit")) else { continue };
        let lit_from_outside = spec.sources.values().any(|source| {
            matches!(source.common().and_then(|common| common.at.as_ref()),
                Some(PlacementSpec::AtFace(at)) if at.face == *on)
        });
        // Two sensors on one face compare its two sides.
        let is_alone =
            spec.sensors.values().filter(|other| other.on.as_ref() == Some(on)).count() == 1;
        let (what, other) = match (sensor.counts, sensor.side) {
            (Some(CountsSpec::Leaving), Some(SensorSide::Back)) => ("leaves inward", "front"),
            (Some(CountsSpec::Incident), Some(SensorSide::Front)) => {
                ("arrives from outside", "back")
            }
            (_, Some(SensorSide::Front | SensorSide::Back | SensorSide::Both) | None) => continue,
        };
        if is_alone && !lit_from_outside {
            let message =
                format!("counts light that {what} at `{on}`, against the light of the guide");
            let hint = format!("write side = \"{other}\" for the light from the guide");
            problems.warning(&Key::of(&["sensors", name, "side"]), message).hint(hint);
        }
    }
}
