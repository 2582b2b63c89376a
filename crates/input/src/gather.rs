//! Requested settings of the gather estimator: the command line overrides the file, and both are
//! checked against the scene.
//!
//! The range of a single value is checked by the schema of the file and by the command-line parser.

use crate::keys::Key;
use crate::problems::Problems;
use lumiduct_base::math::Aabb;
use lumiduct_base::number::format_value;
use lumiduct_core::plan::{GatherPlan, Request, Schedule};
use lumiduct_core::scene::{Owner, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Usual first radius, as a share of half the width of a guide.
const USUAL_RADIUS: f64 = 0.2;

/// Gather settings of the command line; omitted ones stay as in the scene file.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct GatherSettings {
    /// Depth at which gather paths end at the latest.
    pub depth: Option<u32>,
    /// Radius of the window of the first pass, mm; above 0.
    pub radius_mm: Option<f64>,
    /// Half-angle of the window of the first pass, degrees; above 0, below 90.
    pub angle_deg: Option<f64>,
    /// Gather paths of a pass; 1 at least.
    pub records: Option<u64>,
    /// Photons of a pass; 1 at least.
    pub photons: Option<u64>,
    /// How the window shrinks.
    pub schedule: Option<Schedule>,
}

impl GatherSettings {
    /// The plan with these settings applied.
    pub(crate) fn over(&self, plan: &GatherPlan) -> GatherPlan {
        GatherPlan {
            depth: self.depth.or(plan.depth),
            radius: self.radius_mm.or(plan.radius),
            theta_max: self.angle_deg.map(f64::to_radians).or(plan.theta_max),
            records: self.records.or(plan.records),
            photons: self.photons.or(plan.photons),
            schedule: self.schedule.unwrap_or(plan.schedule),
        }
    }

    /// The flags that are given.
    fn flags(&self) -> Vec<&'static str> {
        let all = [
            ("--depth", self.depth.is_some()),
            ("--radius-mm", self.radius_mm.is_some()),
            ("--angle-deg", self.angle_deg.is_some()),
            ("--records", self.records.is_some()),
            ("--photons", self.photons.is_some()),
            ("--schedule", self.schedule.is_some()),
        ];
        given(&all)
    }
}

/// Notes settings of the file and the command line that the estimator does not use.
pub(crate) fn check_use(
    request: Request,
    file: &GatherPlan,
    settings: &GatherSettings,
    problems: &mut Problems,
) {
    if request.may_gather() {
        return;
    }
    let keys = [
        ("depth", file.depth.is_some()),
        ("radius_mm", file.radius.is_some()),
        ("angle_deg", file.theta_max.is_some()),
        ("records", file.records.is_some()),
        ("photons", file.photons.is_some()),
        ("schedule", file.schedule != Schedule::default()),
    ];
    let mut warn = |key: &Key, names: &[&str], hint: &str| {
        let names = names.join(", ");
        let message = format!("without effect with the estimator \"{}\": {names}", request.name());
        problems.warning(key, message).hint(hint);
    };
    let (keys, flags) = (given(&keys), settings.flags());
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
    settings: &GatherSettings,
    scene: &Scene,
    problems: &mut Problems,
) {
    let (Some(radius), Some((name, half))) = (plan.radius, widest(scene)) else { return };
    if radius <= half {
        return;
    }
    let key = match settings.radius_mm {
        Some(_) => Key::of(&["--radius-mm"]),
        None => gather_key().field("radius_mm"),
    };
    let message = format!(
        "{radius} mm is larger than every solid and sheet: the widest, `{name}`, has {} mm from its middle to its side",
        format_value(half)
    );
    problems
        .warning(&key, message)
        .hint(format!("a usual radius is {} mm", format_value(USUAL_RADIUS * half)));
}

fn gather_key() -> Key {
    Key::of(&["run", "gather"])
}

/// The names of the given settings.
fn given(all: &[(&'static str, bool)]) -> Vec<&'static str> {
    all.iter().filter(|(_, is_given)| *is_given).map(|(name, _)| *name).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_wins_wish_by_wish() {
        let file = GatherPlan {
            depth: Some(3),
            radius: Some(0.5),
            schedule: Schedule::PerPass,
            ..GatherPlan::default()
        };
        assert_eq!(GatherSettings::default().over(&file), file);
        let settings = GatherSettings {
            radius_mm: Some(1.0),
            angle_deg: Some(180.0),
            schedule: Some(Schedule::Stages),
            ..GatherSettings::default()
        };
        let expected = GatherPlan {
            depth: Some(3),
            radius: Some(1.0),
            theta_max: Some(std::f64::consts::PI),
            records: None,
            photons: None,
            schedule: Schedule::Stages,
        };
        assert_eq!(settings.over(&file), expected);
    }
}
