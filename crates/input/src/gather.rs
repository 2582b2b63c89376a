//! Requested settings of the gather estimator: the command line overrides the file, and both are
//! checked against the scene.
//!
//! The range of a single value is checked by the schema of the file and by the command-line parser.

use crate::keys::Key;
use crate::problems::Problems;
use lumiduct_base::math::Aabb;
use lumiduct_base::number::format_value;
use lumiduct_core::plan::{GatherPlan, Request};
use lumiduct_core::scene::{Owner, Scene};
use std::collections::BTreeMap;

/// Usual first radius, as a share of half the width of a guide.
const USUAL_RADIUS: f64 = 0.3;

/// Notes settings of the file and the command line that the estimator does not use.
pub(crate) fn check_use(
    request: Request,
    file: &GatherPlan,
    settings: &GatherPlan,
    problems: &mut Problems,
) {
    if request.may_gather() {
        return;
    }
    let mut warn = |key: &Key, names: &[&str], hint: &str| {
        let names = names.join(", ");
        let message = format!("without effect with the estimator \"{}\": {names}", request.name());
        problems.warning(key, message).hint(hint);
    };
    let flags: Vec<String> = settings.given().into_iter().map(flag).collect();
    let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
    let keys = file.given();
    if !keys.is_empty() {
        warn(&gather_key(), &keys, "they are for the estimators \"auto\", \"gather\" and \"mis\"");
    }
    if let Some(first) = flags.first() {
        warn(&Key::of(&[first]), &flags, "add --estimator gather");
    }
}

/// Notes a radius too large for any guide of the scene. `plan` contains the final settings.
pub(crate) fn check_radius(
    plan: &GatherPlan,
    settings: &GatherPlan,
    scene: &Scene,
    problems: &mut Problems,
) {
    let (Some(radius), Some((name, half))) = (plan.radius_mm, widest(scene)) else { return };
    if radius <= half {
        return;
    }
    let key = match settings.radius_mm {
        Some(_) => Key::of(&["--radius-mm"]),
        None => gather_key().field("radius_mm"),
    };
    let message = format!(
        "{radius} mm is larger than every solid and sheet: the widest, `{name}`, measures {} mm from its \
            middle to its side",
        format_value(half)
    );
    problems
        .warning(&key, message)
        .hint(format!("a usual radius is {} mm", format_value(USUAL_RADIUS * half)));
}

fn gather_key() -> Key {
    Key::of(&["run", "gather"])
}

/// The flag of a setting.
fn flag(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}

/// The solid or sheet whose box has the greatest narrowest side, and half that width, mm. Flat
/// things, which have no width, are left out.
fn widest(scene: &Scene) -> Option<(&str, f64)> {
    let mut boxes: BTreeMap<&str, Aabb> =
        scene.solids.iter().map(|solid| (solid.name.as_str(), solid.bounds)).collect();
    for patch in scene.patches.iter().filter(|patch| patch.owner == Owner::Sheet) {
        let face = &scene.faces[patch.face.index()].name;
        let name = face.split('.').next().unwrap_or(face);
        let bounds = boxes.entry(name).or_insert(Aabb::EMPTY);
        *bounds = bounds.union(patch.shape.bounds());
    }
    boxes
        .into_iter()
        .map(|(name, bounds)| (name, 0.5 * (bounds.max - bounds.min).min_element()))
        .filter(|(_, half)| *half > scene.tolerance)
        .max_by(|(_, one), (_, other)| one.total_cmp(other))
}
