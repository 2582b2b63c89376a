//! Whether the polarisation of light is followed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What becomes of the polarisation of light on its way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Polarisation {
    /// Light is unpolarised wherever it meets an interface.
    #[default]
    #[serde(rename = "ignored")]
    Ignored,
    /// Stokes parameters are followed from the sources, whose light is unpolarised, through Fresnel reflection and refraction, total
    /// reflection, metals and layers; what scatters depolarises. With `forward` and `backward` only.
    #[serde(rename = "followed")]
    Followed,
}

impl Polarisation {
    /// Whether it is ignored.
    pub fn is_ignored(&self) -> bool {
        *self == Self::Ignored
    }
}
