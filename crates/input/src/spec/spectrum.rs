//! Spectra, and properties by wavelength, as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A spectrum: radiant flux by wavelength, relative; only light from 377.5 to 782.5 nm counts. A word, or a table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpectrumSpec {
    /// CIE standard illuminant A, incandescent light.
    CieA,
    /// CIE standard illuminant D65, average daylight.
    CieD65,
    /// The same radiant flux at every wavelength.
    EqualEnergy,
    /// A black body of this temperature.
    BlackbodyK(#[schemars(range(min = 500.0, max = 100_000.0))] f64),
    /// A phase of daylight of this correlated colour temperature, by the CIE's method.
    DaylightK(#[schemars(range(min = 4000.0, max = 25_000.0))] f64),
    /// A white LED of this colour temperature on the Planckian locus: a Gaussian of its blue die at 450 nm, 20 nm wide at half maximum, and one of its phosphor, 120 nm wide, with the peak (540 to 625 nm) and height that give this colour. Ra is 68 to 75.
    PhosphorWhiteK(#[schemars(range(min = 2000.0, max = 20_000.0))] f64),
    /// A Gaussian peak, as of a coloured LED.
    Peak(PeakSpec),
    /// A spectral line. It is computed as 0.01 nm wide.
    LineNm(#[schemars(range(min = 380.0, max = 780.0))] f64),
    /// Pairs of wavelength and radiant flux per wavelength in any unit, linear in between: `[[400, 0.1], [410, 0.3], ...]`.
    ByNm(#[schemars(length(min = 2))] Vec<[f64; 2]>),
    /// A CSV file with the same in its first two columns, the first named `nm` or `um`. A relative path is relative to the scene file.
    Csv(String),
    /// Several spectra together.
    Sum(#[schemars(length(min = 1, max = 20))] Vec<SpectrumPartSpec>),
}

/// A peak of a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PeakSpec {
    /// Wavelength of the peak.
    #[schemars(range(min = 380.0, max = 780.0))]
    pub peak_nm: f64,
    /// Full width at half maximum.
    #[schemars(range(min = 3.0, max = 500.0))]
    pub fwhm_nm: f64,
}

/// Part of a spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpectrumPartSpec {
    /// Radiant flux of this part, relative to that of the others.
    #[schemars(range(min = 0.0))]
    pub share: f64,
    /// Its spectrum.
    pub spectrum: SpectrumSpec,
}

/// Refractive index: a number, or a law of dispersion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum IndexSpec {
    /// The same at every wavelength, from 1 to 4.
    Constant(#[schemars(range(min = 1.0, max = 4.0))] f64),
    /// Dispersion.
    Law(IndexLawSpec),
}

/// A law of dispersion. A table with exactly one of these keys. The index of a medium must be from 1 to 4 at all visible wavelengths.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum IndexLawSpec {
    /// A, B and C of n = A + B/λ² + C/λ⁴, λ in µm.
    Cauchy([f64; 3]),
    /// Pairs of B, 1, and C, µm², of n² = 1 + Σ B λ²/(λ² - C), λ in µm, as data sheets of glass give them.
    Sellmeier(#[schemars(length(min = 1))] Vec<[f64; 2]>),
    /// Pairs of c and whole p of n² = Σ c λ^p, λ in µm: `[[2.18, 0], [0.006, 2], [0.024, -2]]`.
    Powers(#[schemars(length(min = 1))] Vec<[f64; 2]>),
    /// Pairs of wavelength and index, linear in between and constant beyond: `[[400, 1.508], [700, 1.488]]`.
    ByNm(#[schemars(length(min = 2))] Vec<[f64; 2]>),
    /// That of a medium in the library, which `lumiduct library` lists.
    Library(String),
    /// A CSV file whose first column is the wavelength (`nm`, `wavelength_nm`, `lambda_nm`, `um` or `wavelength_um`), with a column `n`. A relative path is relative to the scene file.
    Csv(String),
}

/// Share of light: a number, or a table by wavelength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ShareSpec {
    /// The same at every wavelength, from 0 to 1.
    Constant(#[schemars(range(min = 0.0, max = 1.0))] f64),
    /// By wavelength.
    Table(ShareTableSpec),
}

impl Default for ShareSpec {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

/// Share of light by wavelength. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShareTableSpec {
    /// Pairs of wavelength and share, from 0 to 1, linear in between and constant beyond: `[[400, 0.1], [700, 0.8]]`.
    ByNm(#[schemars(length(min = 2))] Vec<[f64; 2]>),
    /// A CSV file with the same in its first two columns, the first named `nm` or `um`. A relative path is relative to the scene file.
    Csv(String),
}

/// Absorption coefficient: a number, or a table by wavelength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum AbsorptionSpec {
    /// The same at every wavelength, 0 or more.
    Constant(#[schemars(range(min = 0.0))] f64),
    /// By wavelength.
    Table(AbsorptionTableSpec),
}

impl Default for AbsorptionSpec {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

/// Absorption coefficient by wavelength. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AbsorptionTableSpec {
    /// Pairs of wavelength and coefficient, 1/mm, linear in between and constant beyond.
    ByNm(#[schemars(length(min = 2))] Vec<[f64; 2]>),
    /// A CSV file whose first column is the wavelength (`nm`, `wavelength_nm`, `lambda_nm`, `um` or `wavelength_um`), with either a column `absorption_per_mm` or the extinction coefficient `k`, from which the
    /// absorption coefficient is 4πk/λ. A relative path is relative to the scene file.
    Csv(String),
}
