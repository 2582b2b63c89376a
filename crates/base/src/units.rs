//! Units inside the program and in its output.
//!
//! Inside, lengths are millimetres, angles radians, flux lumens (watts in radiometric runs),
//! wavelengths nanometres. Illuminance, in lm/mm², and luminance [lm/(mm² sr)] are converted to lx
//! and cd/m² here, for output.

use serde::{Deserialize, Serialize};

/// Square millimetres in a square metre.
pub const MM2_PER_M2: f64 = 1.0e6;

/// Whether fluxes are luminous (lm) or radiant (W).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Default)]
#[serde(rename_all = "snake_case")]
pub enum FluxUnit {
    /// Luminous flux, lm.
    #[default]
    Lumen,
    /// Radiant flux, W.
    Watt,
}

impl FluxUnit {
    /// Unit of flux: lm or W.
    pub fn flux(self) -> &'static str {
        match self {
            Self::Lumen => "lm",
            Self::Watt => "W",
        }
    }

    /// Unit of illuminance or irradiance: lx or W/m².
    pub fn illuminance(self) -> &'static str {
        match self {
            Self::Lumen => "lx",
            Self::Watt => "W/m²",
        }
    }

    /// Unit of luminous or radiant intensity: cd or W/sr.
    pub fn intensity(self) -> &'static str {
        match self {
            Self::Lumen => "cd",
            Self::Watt => "W/sr",
        }
    }

    /// Unit of luminance or radiance: cd/m² or W/(m² sr).
    pub fn luminance(self) -> &'static str {
        match self {
            Self::Lumen => "cd/m²",
            Self::Watt => "W/(m² sr)",
        }
    }

    /// Name of the area density of flux.
    pub fn illuminance_name(self) -> &'static str {
        match self {
            Self::Lumen => "illuminance",
            Self::Watt => "irradiance",
        }
    }

    /// Name of the flux per solid angle and projected area.
    pub fn luminance_name(self) -> &'static str {
        match self {
            Self::Lumen => "luminance",
            Self::Watt => "radiance",
        }
    }
}

/// lx to lm/mm², and cd/m² to lm/(mm² sr).
pub fn per_m2_to_per_mm2(value: f64) -> f64 {
    value / MM2_PER_M2
}
