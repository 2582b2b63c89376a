//! Whether patterns on one face keep clear of each other.

use crate::input::keys::Key;
use crate::input::lower::Context;
use crate::math::circle;
use crate::scene::FaceId;
use crate::scene::pattern::{Field, Outline};
use glam::DVec2;
use std::f64::consts::SQRT_2;

impl Context<'_> {
    /// Whether a field shares no place with the patterns and reliefs that lie on its face already.
    pub(in crate::input::lower) fn is_clear(
        &mut self,
        face: FaceId,
        field: &Field,
        key: &Key,
    ) -> bool {
        let scene = self.builder.scene();
        let patterns = scene.patterns.iter().filter(|other| other.face == face);
        let patterns = patterns.map(|other| ("pattern", &other.name, &other.field));
        let reliefs = scene.reliefs.iter().filter(|other| other.wall == face);
        let reliefs = reliefs.map(|other| ("relief", &other.name, &other.field));
        let met = patterns.chain(reliefs).find_map(|(what, name, other)| {
            let (few, many) =
                if field.count() <= other.count() { (field, other) } else { (other, field) };
            let shared = first_shared(few, many).or_else(|| first_shared(many, few));
            shared.map(|at| (what, name.clone(), at))
        });
        let Some((what, other, at)) = met else { return true };
        self.problems
            .error(
                key,
                format!(
                    "overlaps the {what} `{other}` at ({:.4}, {:.4}) mm of the unrolled face",
                    at.x, at.y
                ),
            )
            .hint("move one of them, or leave elements out");
        false
    }
}

/// Elements that are looked at for an overlap with another pattern, from the first on.
const PROBED: usize = 200_000;
/// Points of an outline that are looked at, beside its centre.
const RIM: u32 = 12;

/// A place that is in elements of both, if one is found: at the centres and rims of those of the first.
fn first_shared(few: &Field, many: &Field) -> Option<DVec2> {
    few.places().take(PROBED).find_map(|(place, center)| {
        let mut half = 0.5 * few.outline.size(place);
        if half.x.is_infinite() {
            // A ring is the same all around.
            half.x = 0.0;
        }
        let reach = match &few.outline {
            Outline::Circle { .. } => 1.0,
            // To the corners.
            Outline::Rectangle { .. } | Outline::Relief(_) => SQRT_2,
        };
        let rim = (0..RIM).map(|i| {
            let on_rim = reach * circle((f64::from(i) + 0.5) / f64::from(RIM));
            center + 0.999 * half * on_rim.clamp(DVec2::NEG_ONE, DVec2::ONE)
        });
        std::iter::once(center).chain(rim).find(|at| many.contains(*at))
    })
}
