//! Where a thing stands.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Position and direction of an object: in space, or at the face of a solid or sheet. Omitted: at the origin, along +z.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum PlacementSpec {
    /// At the centre of a flat face.
    AtFace(FacePlacementSpec),
    /// Anywhere in space.
    InSpace(SpacePlacementSpec),
}

impl Default for PlacementSpec {
    fn default() -> Self {
        Self::InSpace(SpacePlacementSpec::default())
    }
}

/// A place at the centre of a flat face. A source or sensor looks at the face; a solid or sheet continues away from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FacePlacementSpec {
    /// The face, as `NAME.FACE`.
    pub face: String,
    /// Distance from the face along its outward normal.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub gap_mm: f64,
    /// Shift in the plane of the face, along its local x and y.
    #[serde(default)]
    pub offset_mm: [f64; 2],
    /// Turn about the axis.
    #[serde(default)]
    pub roll_deg: f64,
}

/// A place in space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpacePlacementSpec {
    /// Position of the object's origin.
    #[serde(default)]
    pub position_mm: [f64; 3],
    /// Direction of the local +z; any length but zero.
    #[serde(default = "plus_z")]
    pub axis: [f64; 3],
    /// Direction toward which the local +x is turned. Omitted: +x for an axis along +z, and a fixed choice for any other.
    pub x_axis: Option<[f64; 3]>,
    /// Turn about the axis.
    #[serde(default)]
    pub roll_deg: f64,
}

impl Default for SpacePlacementSpec {
    fn default() -> Self {
        Self { position_mm: [0.0; 3], axis: plus_z(), x_axis: None, roll_deg: 0.0 }
    }
}

fn plus_z() -> [f64; 3] {
    [0.0, 0.0, 1.0]
}

/// How light starts where a source touches a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ContactSpec {
    /// Beyond the face, in the medium ahead: a source in optical contact.
    Optical,
    /// On the near side: light crosses the face, with its reflection and refraction.
    Air,
}
