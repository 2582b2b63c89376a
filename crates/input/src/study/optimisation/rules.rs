//! Rules of an optimisation that need its scene: the pattern, what of it varies, and the sensor.

use crate::Job;
use crate::keys::{Key, Places};
use crate::lower::patterns::layout::law_knots;
use crate::problems::{Problems, name_hint};
use crate::spec::optimise::{LawKindSpec, OptimisationSpec, PatternFeedbackSpec, SplineSpec, Vary};
use crate::spec::pattern::AlongSpec;
use crate::study::optimisation::feedback::{FeedbackZone, LawKind, LightTarget, PatternFeedback};
use crate::study::rules::check_key;
use lumiduct_core::plan::Request;
use lumiduct_core::scene::pattern::TableAlong;
use lumiduct_core::scene::{FaceId, Seeing, SensorId, SensorKind, SurfaceSensor};
use std::path::Path;

/// Layouts whose pitch can change along a face.
const LAYOUTS: [&str; 3] = ["row", "grid", "staggered"];

/// Cells closer than this share of the length of the face are one zone, 1.
const SAME_ZONE: f64 = 1e-6;
/// Most zones: the work of a step grows with their third power.
const MOST_ZONES: usize = 400;

fn at(name: &str) -> Key {
    Key::of(&["optimise", "pattern_feedback", name])
}

/// Notes what is invalid for any scene.
pub(super) fn check(spec: &OptimisationSpec, scene: &Path, problems: &mut Problems) {
    if !scene.is_file() {
        let message = format!("there is no file {}", scene.display());
        problems.error(&Key::of(&["scene"]), message);
    }
    for name in spec.set.keys() {
        let key = Key::of(&["set", name]);
        check_key(name, &key, problems);
        if ["run.paths", "run.seed", "run.estimator"].contains(&name.as_str()) {
            problems.error(&key, "is set under `run` of the study");
        }
    }
}

/// What is to be found in a scene; `None` where that is not possible, which has then been noted.
pub(super) fn feedback(
    spec: &PatternFeedbackSpec,
    base: &Job,
    target: LightTarget,
    problems: &mut Problems,
) -> Option<PatternFeedback> {
    let found = pattern(spec, base, problems);
    let sensor = sensor(spec, base, problems);
    let paths = paths(base, problems);
    let FoundPattern { table, name, face } = found?;
    let length = varied(spec, &table, &base.places, problems);
    let (id, surface) = sensor?;
    let view = view(spec, surface, problems)?;
    let zones = zones(surface, face, base, problems)?;
    let face_length = base.scene.face_length(face)?;
    let (key, along) = length?;
    let start = TableAlong::table(knots(&along, face_length))
        .expect("the scene was read, and its tables with it");
    check_bridge(spec, problems)?;
    let efficiency = spec.efficiency.clone();
    Some(PatternFeedback {
        pattern: name,
        key: key.to_string(),
        vary: spec.vary,
        face_length,
        start,
        limits: [spec.limits.from_mm, spec.limits.to_mm],
        bridge: spec.bridge_mm,
        law: match spec.law {
            LawKindSpec::Table => LawKind::Table,
            LawKindSpec::Spline(SplineSpec { knots }) => LawKind::Spline(knots as usize),
        },
        sensor: id,
        view,
        zones,
        target,
        min_over_max: spec.min_over_max,
        efficiency: efficiency.unwrap_or_else(|| format!("{}.efficiency", spec.sensor)),
        uniformity_weight: spec.uniformity_weight,
        efficiency_weight: spec.efficiency_weight,
        damping: spec.damping,
        steps: spec.steps as usize,
        check_estimator: spec.check_estimator.unwrap_or(second_estimator(base.run.estimator)),
        paths: paths?,
    })
}

/// Refuses bridges where no step keeps them; `None` if it does.
fn check_bridge(spec: &PatternFeedbackSpec, problems: &mut Problems) -> Option<()> {
    match spec.vary {
        Vary::Diameter | Vary::Pitch => Some(()),
        Vary::Radius | Vary::Depth | Vary::Height if spec.bridge_mm > 0.0 => {
            let message = "bridges are kept only where diameters or pitches vary";
            problems.error(&at("bridge_mm"), message).hint("leave it out, and set `limits`");
            None
        }
        Vary::Radius | Vary::Depth | Vary::Height => Some(()),
    }
}

/// The estimator that checks the result of another one.
fn second_estimator(first: Request) -> Request {
    match first {
        Request::Mix => Request::Forward,
        Request::Auto | Request::Forward | Request::Backward | Request::Gather | Request::Mis => {
            Request::Mix
        }
    }
}

/// A pattern or a relief of the scene.
struct FoundPattern {
    /// Its table in the file.
    table: Key,
    /// Its name in the scene.
    name: String,
    face: FaceId,
}

/// The pattern or the relief that the study names.
fn pattern(
    spec: &PatternFeedbackSpec,
    base: &Job,
    problems: &mut Problems,
) -> Option<FoundPattern> {
    let (patterns, reliefs) = (&base.scene.patterns, &base.scene.reliefs);
    let patterns = patterns.iter().map(|own| ("patterns", &own.name, own.face));
    let reliefs = reliefs.iter().map(|own| ("reliefs", &own.name, own.wall));
    // The scene names a relief by the face that it forms: after its wall.
    let key_of = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
    let all: Vec<_> = patterns.chain(reliefs).collect();
    let found = all.iter().find(|own| key_of(own.1) == spec.pattern);
    if let Some((family, name, face)) = found {
        let table = Key::of(&[family, &spec.pattern]);
        return Some(FoundPattern { table, name: (*name).clone(), face: *face });
    }
    let names: Vec<String> = all.iter().map(|own| key_of(own.1)).collect();
    let message = format!("the scene has no pattern or relief `{}`", spec.pattern);
    let hint = name_hint(&spec.pattern, names.iter().map(String::as_str));
    problems.error(&at("pattern"), message).hint(hint);
    None
}

/// The key of the length that varies, and its value in the scene.
fn varied(
    spec: &PatternFeedbackSpec,
    table: &Key,
    places: &Places,
    problems: &mut Problems,
) -> Option<(Key, AlongSpec)> {
    let kinds = |part: &str| {
        let node = places.node(&table.field(part));
        let names = node.and_then(|node| node.table()).into_iter().flat_map(|own| own.keys());
        names.map(|name| table.field(part).field(name)).collect::<Vec<Key>>()
    };
    let [element, layout] = ["element", "layout"].map(kinds);
    let layout: Vec<Key> = layout
        .into_iter()
        .filter(|key| LAYOUTS.iter().any(|name| *key == table.field("layout").field(name)))
        .collect();
    let choices = [
        (Vary::Diameter, "diameter_mm", &element),
        (Vary::Radius, "radius_mm", &element),
        (Vary::Depth, "depth_mm", &element),
        (Vary::Height, "height_mm", &element),
        (Vary::Pitch, "pitch_mm", &layout),
    ];
    let there = choices.iter().filter_map(|(vary, name, tables)| {
        let key = tables.iter().map(|own| own.field(name)).find(|key| places.has(key))?;
        let along = serde_json::from_value(places.node(&key)?.to_json()).ok()?;
        Some((*vary, *name, key, along))
    });
    let there: Vec<(Vary, &str, Key, AlongSpec)> = there.collect();
    if let Some((_, _, key, along)) = there.iter().find(|own| own.0 == spec.vary) {
        return Some((key.clone(), along.clone()));
    }
    let names: Vec<&str> = there.iter().map(|own| own.1).collect();
    let message = format!(
        "`{}` of the scene has no such length that can change along its face",
        spec.pattern
    );
    let hint = if names.is_empty() {
        "its sizes and its pitch are fixed: give it a table of sizes, or a pitch".to_owned()
    } else {
        format!("it has {}", names.join(", "))
    };
    problems.error(&at("vary"), message).hint(hint);
    None
}

/// The sensor, if it has cells on a surface.
fn sensor<'a>(
    spec: &PatternFeedbackSpec,
    base: &'a Job,
    problems: &mut Problems,
) -> Option<(SensorId, &'a SurfaceSensor)> {
    let sensors = &base.scene.sensors;
    let Some(index) = sensors.iter().position(|own| own.name == spec.sensor) else {
        let hint = name_hint(&spec.sensor, sensors.iter().map(|own| own.name.as_str()));
        let message = format!("the scene has no sensor `{}`", spec.sensor);
        problems.error(&at("sensor"), message).hint(hint);
        return None;
    };
    match &sensors[index].kind {
        SensorKind::Surface(surface) => Some((SensorId::new(index), surface)),
        SensorKind::Goniometer(_) => {
            let message = format!("`{}` has directions, not places along a face", spec.sensor);
            let hint = "use a `plane` or a `luminance` with cells along the face";
            problems.error(&at("sensor"), message).hint(hint);
            None
        }
    }
}

/// The view of the sensor that counts: `Some(None)` for one that does not separate directions.
fn view(
    spec: &PatternFeedbackSpec,
    sensor: &SurfaceSensor,
    problems: &mut Problems,
) -> Option<Option<usize>> {
    match (&sensor.seeing, spec.view) {
        (Seeing::All, None) => Some(None),
        (Seeing::All, Some(_)) => {
            let message = format!("`{}` does not separate directions", spec.sensor);
            problems.error(&at("view"), message).hint("leave `view` out");
            None
        }
        (Seeing::Views(views), view) => {
            let (view, count) = (view.unwrap_or(0), views.directions.len());
            if view >= count {
                let message = format!("{view} is out of range: the sensor has {count} directions");
                problems.error(&at("view"), message).hint("they are numbered from 0");
                return None;
            }
            Some(Some(view))
        }
        (Seeing::Pixels(_), _) => {
            let message = format!("`{}` is an image, whose pixels have no places", spec.sensor);
            problems.error(&at("sensor"), message).hint("use a `luminance` with cells");
            None
        }
    }
}

/// The zones of a sensor along the face; refused where it has none, or too many.
fn zones(
    sensor: &SurfaceSensor,
    face: FaceId,
    base: &Job,
    problems: &mut Problems,
) -> Option<Vec<FeedbackZone>> {
    let (places, length) = (base.scene.cell_places(sensor, face), base.scene.face_length(face));
    let Some((places, length)) = places.zip(length) else {
        let message = "its cells are no columns and rows of a flat or round surface";
        problems.error(&at("sensor"), message).hint("give it `cells = [columns, rows]`");
        return None;
    };
    let [low, high] = places
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(*at), high.max(*at)]);
    if low < 0.0 || high > length {
        let message = format!(
            "its cells lie at {low:.4} to {high:.4} mm along the face, which is {length:.4} mm long"
        );
        problems.error(&at("sensor"), message).hint("place it over the face, or make it shorter");
        return None;
    }
    let zones = grouped(&places, SAME_ZONE * length);
    let count = zones.len();
    if count < 2 {
        let message = "all of its cells lie at one place along the face of the pattern";
        problems.error(&at("sensor"), message).hint("divide it along the face");
        return None;
    }
    if count > MOST_ZONES {
        let message = format!(
            "its cells make {count} zones along the face, and at most {MOST_ZONES} are possible"
        );
        let hint = "give it fewer rows, or turn it parallel to the face";
        problems.error(&at("sensor"), message).hint(hint);
        return None;
    }
    Some(zones)
}

/// Cells by their positions along a face, mm; those within `same` of the first one of a zone belong to it.
fn grouped(places: &[f64], same: f64) -> Vec<FeedbackZone> {
    let mut order: Vec<usize> = (0..places.len()).collect();
    order.sort_by(|one, other| places[*one].total_cmp(&places[*other]));
    let mut zones: Vec<FeedbackZone> = Vec::new();
    for cell in order {
        let along = places[cell];
        match zones.last_mut() {
            Some(zone) if along - zone.along <= same => zone.cells.push(cell),
            _ => zones.push(FeedbackZone { along, cells: vec![cell] }),
        }
    }
    zones
}

/// The number of paths, without which no measurement repeats.
fn paths(base: &Job, problems: &mut Problems) -> Option<u64> {
    let stop = &base.run.stop;
    match (stop.paths, &stop.target, stop.time, stop.batches) {
        (Some(paths), None, None, None) => Some(paths),
        (Some(_), None, None, Some(_)) => {
            let message = "an optimisation has batches of its own";
            let hint = "remove `batches` from [run] of the scene";
            problems.error(&Key::of(&["run"]), message).hint(hint);
            None
        }
        (_, _, _, _) => {
            let message = "an optimisation ends its measurements by a number of paths alone";
            problems.error(&Key::of(&["run"]), message).hint("give the study `paths` under [run]");
            None
        }
    }
}

/// Positions and values of a length along a face, mm.
fn knots(along: &AlongSpec, length: f64) -> Vec<[f64; 2]> {
    match along {
        AlongSpec::Same(value) => vec![[0.0, *value]],
        AlongSpec::Table(knots) => knots.clone(),
        AlongSpec::Law(law) => law_knots(law, length),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_near_the_first_of_a_zone_belong_to_it() {
        // Neighbours within the distance would chain into one zone without end.
        let zones = grouped(&[3.0, 1.0, 1.6, 2.2, 1.0], 1.0);
        let found: Vec<(f64, &[usize])> =
            zones.iter().map(|zone| (zone.along, zone.cells.as_slice())).collect();
        assert_eq!(found, [(1.0, &[1, 4, 2][..]), (2.2, &[3, 0])]);
    }
}
