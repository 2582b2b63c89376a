//! The scene that the rules are held against: what its file says, and where. Knows no rule.

use crate::keys::Places;
use crate::spec::SceneSpec;

/// A scene as a file says it, and where.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) spec: &'a SceneSpec,
    pub(super) places: &'a Places,
}
