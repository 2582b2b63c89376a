//! Light groups: sources whose light is also measured together.

use crate::scene::SourceId;

/// Sources that are measured together, in addition to each one separately.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LightGroup {
    /// Name, which no source has.
    pub name: String,
    /// Its sources, ascending.
    pub sources: Vec<SourceId>,
}

/// The light groups of a scene, and the weathers that its daylight belongs to.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LightGroups {
    /// Those of the scene file, then those of different weathers.
    pub groups: Vec<LightGroup>,
    /// Names of the weathers that shine; no two of them shine at the same time.
    pub weathers: Vec<String>,
}
