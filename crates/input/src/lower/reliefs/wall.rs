//! The walls of solids that reliefs can lie on.

use crate::keys::Key;
use crate::lower::context::Context;
use crate::lower::patterns::ground::PatternGround;
use lumiduct_core::scene::{Owner, relief};

/// The wall of a relief, unrolled and in space.
#[derive(Debug, Clone, Copy)]
pub(super) struct UnrolledReliefWall {
    pub(super) unrolled: PatternGround,
    pub(super) ground: relief::ReliefWall,
}

impl Context<'_> {
    /// The wall of a solid that a relief can lie on.
    pub(super) fn wall(&mut self, on: &str, key: &Key) -> Option<UnrolledReliefWall> {
        let unrolled = self.ground(on, key)?;
        let scene = self.builder.scene();
        let is_solid = matches!(scene.owner(unrolled.face), Owner::Solid(_));
        let ground = match scene.face_patches(unrolled.face) {
            [patch] => relief::ReliefWall::of(patch),
            [] | [_, _, ..] => None,
        };
        let (true, Some(ground)) = (is_solid, ground) else {
            let message = format!(
                "`{on}` is neither one flat wall nor the outer wall of a straight round rod, of a solid"
            );
            let hint = "a relief is a part of the boundary of a solid; sheets have patterns";
            return self.refuse(key, message, hint);
        };
        Some(UnrolledReliefWall { unrolled, ground })
    }
}
