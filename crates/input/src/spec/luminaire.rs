//! Luminaires as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::daylight::enabled;
use crate::spec::placement::{ContactSpec, PlacementSpec};

/// A luminaire from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LuminaireSpec {
    /// The file. A relative path is relative to the scene file.
    pub file: String,
    /// Total luminous flux. Omitted: that of the intensities in the file.
    #[schemars(range(min = 0.0))]
    pub flux_lm: Option<f64>,
    /// Where its light starts.
    #[serde(default)]
    pub extent: LuminaireExtent,
    /// How light starts where the opening touches a face: `optical` starts it beyond the face, as through glue; `air`
    /// lets it cross the face first. Omitted: `optical`.
    pub contact: Option<ContactSpec>,
    /// The light group, as of other sources.
    pub group: Option<String>,
    /// Whether it emits. A disabled source is dark, as with a flux of 0.
    #[serde(default = "enabled")]
    pub enabled: bool,
    /// Position of the middle of the opening.
    pub at: Option<PlacementSpec>,
}

/// Where the light of a luminaire starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LuminaireExtent {
    /// Evenly over the luminous opening in the file, which is taken as flat, with the same distribution everywhere.
    #[default]
    Opening,
    /// At its middle.
    Point,
}
