//! Directions of placements.

use glam::DVec3;

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::Problems;
use crate::spec::placement::{PlacementSpec, SpacePlacementSpec};
use lumiduct_base::math::Frame;

pub(crate) fn check(scene: Scene<'_>, problems: &mut Problems) {
    for (key, at) in placements(scene) {
        match at {
            PlacementSpec::InSpace(space) => check_axes(&key, space, problems),
            PlacementSpec::AtFace(_) => {}
        }
    }
}

fn placements(scene: Scene<'_>) -> impl Iterator<Item = (Key, &PlacementSpec)> {
    let spec = scene.spec;
    let solids = spec
        .solids
        .iter()
        .map(|(n, s)| (Key::of(&["solids", n, s.kind()]), s.common().at.as_ref()));
    let sheets =
        spec.sheets.iter().map(|(n, s)| (Key::of(&["sheets", n, s.kind()]), s.common().at()));
    let sources = spec.sources.iter().map(|(n, s)| {
        (Key::of(&["sources", n, s.kind()]), s.common().and_then(|common| common.at.as_ref()))
    });
    let sensors = spec.sensors.iter().map(|(n, s)| (Key::of(&["sensors", n]), s.at.as_ref()));
    let all = solids.chain(sheets).chain(sources).chain(sensors);
    all.filter_map(|(key, at)| Some((key.field("at"), at?)))
}

fn check_axes(key: &Key, space: &SpacePlacementSpec, problems: &mut Problems) {
    let axis = scaled(space.axis);
    if axis == DVec3::ZERO {
        problems.error(&key.field("axis"), "has no direction: all three numbers are 0");
        return;
    }
    let Some(x_axis) = space.x_axis.map(scaled) else { return };
    if x_axis == DVec3::ZERO {
        problems.error(&key.field("x_axis"), "has no direction: all three numbers are 0");
    } else if Frame::from_axis_and_x(DVec3::ZERO, axis, x_axis).is_none() {
        problems.error(&key.field("x_axis"), "points along the axis, expected another direction");
    }
}

/// A direction scaled so that squaring it neither overflows nor vanishes.
fn scaled(direction: [f64; 3]) -> DVec3 {
    let direction = DVec3::from(direction);
    let largest = direction.abs().max_element();
    if largest == 0.0 { DVec3::ZERO } else { direction / largest }
}
