//! Media as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::spectrum::{AbsorptionSpec, IndexSpec, SpectrumSpec};

/// A medium in which light travels. `air` is predefined with index 1 and no absorption, and so are the media that `lumiduct library` lists, without
/// absorption except `pure_water`; a table of the same name replaces them. What an interface of two media
/// transmits follows from their indices: see the finish `smooth`. Index and absorption may depend on the
/// wavelength; where sources have no spectrum, light has 555 nm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MediumSpec {
    /// Refractive index.
    pub index: IndexSpec,
    /// Absorption coefficient (natural): a beam decreases to exp(-absorption times length).
    #[serde(default)]
    pub absorption_per_mm: AbsorptionSpec,
    /// Particles that scatter light, evenly spread, as in diffuser rods; none in a clear medium.
    pub scattering: Option<ScatteringSpec>,
    /// Phosphors or dyes that absorb light and emit it at other wavelengths; sources need a `spectrum`.
    pub fluorescence: Option<FluorescenceSpec>,
}

/// Scattering within a medium.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScatteringSpec {
    /// Scattering coefficient: the inverse of the mean free path between scatterings.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub per_mm: f64,
    /// Mean cosine of the scattering angle, for the Henyey-Greenstein phase function: 0 is isotropic, near 1 mostly
    /// forward (particles larger than a wavelength), below 0 mostly backward.
    #[serde(default)]
    #[schemars(range(min = -0.999, max = 0.999))]
    pub anisotropy: f64,
}

/// Fluorescence of a medium, evenly spread. What is absorbed is emitted in all directions alike, unpolarised. Computed by `forward`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FluorescenceSpec {
    /// Absorption coefficient (natural) of the phosphor or dye, beside that of the medium itself: a table that ends in 0 where
    /// light is no longer absorbed, toward long wavelengths.
    pub absorption_per_mm: AbsorptionSpec,
    /// Spectrum of what it emits.
    pub emission: SpectrumSpec,
    /// Quantum yield: photons of the emission for each photon absorbed. The rest, and the difference in energy of the photons, becomes heat.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub quantum_yield: f64,
}
