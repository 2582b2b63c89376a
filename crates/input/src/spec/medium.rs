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
    /// A phosphor or dye that absorbs light and emits it at other wavelengths; sources need a `spectrum`.
    pub fluorescence: Option<FluorescenceSpec>,
}

/// Scattering within a medium.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScatteringSpec {
    /// Scattering coefficient: the inverse of the mean free path between scatterings.
    pub per_mm: ScatteringCoefficientSpec,
    /// Mean cosine of the scattering angle, for the Henyey-Greenstein phase function: 0 is isotropic, near 1 mostly
    /// forward (particles larger than a wavelength), below 0 mostly backward.
    #[serde(default)]
    #[schemars(range(min = -0.999, max = 0.999))]
    pub anisotropy: f64,
}

/// Scattering coefficient: a number, or a table by wavelength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ScatteringCoefficientSpec {
    /// The same at every wavelength; 0 in a clear medium.
    Constant(#[schemars(range(min = 0.0))] f64),
    /// By wavelength.
    Table(ScatteringTableSpec),
}

/// Scattering coefficient by wavelength. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ScatteringTableSpec {
    /// Pairs of wavelength and coefficient, 1/mm, linear in between and constant beyond; 0 where the medium is clear.
    ByNm(#[schemars(length(min = 2))] Vec<[f64; 2]>),
    /// A CSV file whose first column is the wavelength (`nm`, `wavelength_nm`, `lambda_nm`, `um` or `wavelength_um`), with a column `scattering_per_mm`. A relative path is relative to the scene file.
    Csv(String),
}

/// A phosphor or dye, evenly distributed in a medium. What it absorbs is emitted equally in all directions, unpolarised. Only `forward` can
/// compute it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FluorescenceSpec {
    /// Absorption coefficient (natural) of the phosphor or dye, in addition to that of the medium: a table that ends in 0 where
    /// light is no longer absorbed, toward long wavelengths. Emission that overlaps with it is absorbed again. Of the light of no source may more
    /// power be emitted than absorbed.
    pub absorption_per_mm: AbsorptionSpec,
    /// Emission spectrum, radiant flux per wavelength; only the part from 377.5 to 782.5 nm is computed.
    pub emission: SpectrumSpec,
    /// Quantum yield: photons emitted, in the visible range, for each photon absorbed. Photons that are not, and the energy that the others lose
    /// (Stokes shift), become heat.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub quantum_yield: f64,
}
