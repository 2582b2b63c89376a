//! Whether patterns on one face overlap.

use crate::keys::Key;
use crate::lower::context::Context;
use lumiduct_core::scene::FaceId;
use lumiduct_core::scene::pattern::ElementField;

impl Context<'_> {
    /// Whether a field does not overlap the patterns and reliefs already on its face.
    pub(in crate::lower) fn is_clear(
        &mut self,
        face: FaceId,
        field: &ElementField,
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
            few.first_met(many).map(|at| (what, name.clone(), at))
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
