//! Stacks of thin layers as a scene file states them.

use crate::spec::spectrum::IndexLawSpec;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Thin layers on each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StackSpec {
    /// The layers, in the order in which they lie from the inside of a solid or a duct to its outside, or from the front of a
    /// sheet to its back: the first layer on a solid touches the material of the solid. Light from the other side meets the
    /// same layers in the opposite order.
    #[schemars(length(min = 1, max = 200))]
    pub layers: Vec<LayerSpec>,
    /// Wavelength at which the stack acts in a scene without spectra. Omitted: 555, as everything else there; media keep their
    /// index at 555 nm in any case. In a scene with
    /// spectra it acts at the wavelength of each path, and this key is refused.
    #[schemars(range(min = 100.0, max = 20_000.0))]
    pub wavelength_nm: Option<f64>,
}

/// A thin layer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LayerSpec {
    /// Refractive index n.
    pub index: LayerIndexSpec,
    /// Extinction coefficient k, the imaginary part of the index n + ik. Omitted: 0, a clear layer.
    #[serde(default)]
    pub extinction: ExtinctionSpec,
    /// Thickness. A quarter wave is the wavelength over 4n.
    #[schemars(range(max = 100_000.0), extend("exclusiveMinimum" = 0.0))]
    pub thickness_nm: f64,
}

/// Refractive index of a thin layer: a number, or a law of dispersion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum LayerIndexSpec {
    /// The same at every wavelength, from 0.01 to 10; below 1 only with an `extinction` above 0.
    Constant(#[schemars(range(min = 0.01, max = 10.0))] f64),
    /// Dispersion.
    Law(IndexLawSpec),
}

/// Extinction coefficient: a number, or a table by wavelength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum ExtinctionSpec {
    /// The same at every wavelength, from 0 to 20.
    Constant(#[schemars(range(min = 0.0, max = 20.0))] f64),
    /// By wavelength.
    Table(ExtinctionTableSpec),
}

impl Default for ExtinctionSpec {
    fn default() -> Self {
        Self::Constant(0.0)
    }
}

/// Extinction coefficient by wavelength. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExtinctionTableSpec {
    /// Pairs of wavelength and k, from 0 to 20, linear in between and constant beyond.
    ByNm(#[schemars(length(min = 2))] Vec<[f64; 2]>),
    /// A CSV file whose first column is the wavelength (`nm`, `wavelength_nm`, `lambda_nm`, `um` or `wavelength_um`), with a column `k`. A relative path is relative to the scene file.
    Csv(String),
}
