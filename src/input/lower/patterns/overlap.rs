//! Whether patterns on one face keep clear of each other.

use crate::input::keys::Key;
use crate::input::lower::Context;
use crate::math::circle;
use crate::scene::pattern::{Columns, Field, Outline, Pattern};
use glam::DVec2;
use std::f64::consts::SQRT_2;

impl Context<'_> {
    /// Whether a pattern shares no place with those that lie on its face already.
    pub(super) fn is_clear(&mut self, pattern: &Pattern, key: &Key) -> bool {
        let scene = self.builder.scene();
        let others = scene.faces[pattern.face.index()].patterns.iter();
        let met = others.map(|&other| &scene.patterns[other]).find_map(|other| {
            let (few, many) = if pattern.field.count() <= other.field.count() {
                (&pattern.field, &other.field)
            } else {
                (&other.field, &pattern.field)
            };
            let shared = first_shared(few, many).or_else(|| first_shared(many, few));
            shared.map(|at| (other.name.clone(), at))
        });
        let Some((other, at)) = met else { return true };
        self.problems
            .error(
                key,
                format!(
                    "overlaps the pattern `{other}` at ({:.4}, {:.4}) mm of the unrolled face",
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
    let Columns { first, pitch, count, shift } = few.columns;
    let elements =
        (0..few.rows.count()).flat_map(|row| (0..count).map(move |column| (row, column)));
    elements.take(PROBED).find_map(|(row, column)| {
        let place = few.rows.place(row);
        let from = if row % 2 == 1 { first + shift } else { first };
        let center = DVec2::new(from + column as f64 * pitch, place);
        let half = 0.5 * few.outline.size(place);
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
