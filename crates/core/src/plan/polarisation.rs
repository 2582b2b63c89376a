//! Whether the polarisation of light is followed.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Whether the polarisation of light is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Polarisation {
    /// Light is unpolarised wherever it meets an interface.
    #[default]
    #[serde(rename = "ignored")]
    Ignored,
    /// Stokes parameters are followed from the sources, all of which count as unpolarised, through smooth interfaces, total reflection,
    /// metals and thin layers. Mirrors with a given reflectance act as ideal mirrors. Whatever scatters, prism film and mixtures of finishes
    /// depolarise. For all estimators but `gather` and `mis`. Slower in mirror tubes and rods, where rows of bounces are traced one by one.
    #[serde(rename = "followed")]
    Followed,
}

impl Polarisation {
    /// Whether it is ignored.
    pub fn is_ignored(&self) -> bool {
        *self == Self::Ignored
    }
}
