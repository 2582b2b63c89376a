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
    /// Light carries Stokes parameters through smooth interfaces, total reflection, metals and thin layers. All sources are taken as
    /// unpolarised. Mirrors with a given reflectance act as ideal mirrors; scatter, prism film and mixtures of finishes depolarise. Not
    /// for `gather` and `mis`. Mirror tubes and rods take longer, because their bounces are traced one by one.
    #[serde(rename = "followed")]
    Followed,
}

impl Polarisation {
    /// Whether it is ignored.
    pub fn is_ignored(&self) -> bool {
        *self == Self::Ignored
    }
}
