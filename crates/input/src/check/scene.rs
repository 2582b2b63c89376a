//! The scene that the rules check: the content of its file, with places. Knows no rule.

use crate::keys::Places;
use crate::spec::SceneSpec;

/// The content of a scene file, with places.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) spec: &'a SceneSpec,
    pub(super) places: &'a Places,
}
