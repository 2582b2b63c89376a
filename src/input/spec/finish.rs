//! Media and finishes as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A transparent medium. `air` is predefined with index 1 and no absorption.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MediumSpec {
    /// Refractive index.
    #[schemars(range(min = 1.0, max = 4.0))]
    pub index: f64,
    /// Absorption coefficient (natural): a beam falls to exp(-absorption times length).
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub absorption_per_mm: f64,
}

/// What a face does to light. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FinishSpec {
    /// A smooth interface between two media: Fresnel reflection and refraction, total internal reflection.
    Smooth(EmptySpec),
    /// A mirror with a constant reflectance, or a window with a constant transmittance.
    Specular(SpecularSpec),
    /// A smooth metal by its complex refractive index.
    Metal(MetalSpec),
    /// Absorbs everything.
    Absorber(EmptySpec),
    /// Nothing is there: light passes, unbent.
    Open(EmptySpec),
    /// Perfectly diffuse reflection or transmission.
    Lambertian(LambertianSpec),
    /// Scatter about the mirrored direction and the direction straight through.
    Gaussian(GaussianSpec),
    /// Several finishes side by side on a scale too small to see.
    Mixture(#[schemars(length(min = 1))] Vec<MixturePartSpec>),
}

/// A table without keys: `{}`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct EmptySpec {}

/// A mirror with a constant reflectance. What is neither reflected nor transmitted is absorbed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpecularSpec {
    /// Share of the flux that is mirrored, at every angle.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub reflectance: f64,
    /// Share of the flux that goes straight on, at every angle. At most 1 together with the reflectance.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub transmittance: f64,
}

/// A metal by its complex refractive index n + i k.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MetalSpec {
    /// Real part of the refractive index.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub n: f64,
    /// Imaginary part of the refractive index (extinction coefficient).
    #[schemars(range(min = 0.0))]
    pub k: f64,
}

/// Perfectly diffuse reflection and transmission. Together above 0 and at most 1; the rest is absorbed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LambertianSpec {
    /// Share of the flux that is reflected diffusely.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub reflectance: f64,
    /// Share of the flux that is transmitted diffusely.
    #[serde(default)]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub transmittance: f64,
}

/// Scatter about the mirrored direction and the direction straight through. With neither reflectance nor
/// transmittance given it is a rough interface between two media: the flux is split as at a smooth one, and scattered
/// about the mirrored and the refracted direction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GaussianSpec {
    /// Standard deviation of the scatter.
    #[schemars(range(min = 0.01, max = 60.0))]
    pub sigma_deg: f64,
    /// Share of the flux that is reflected. Together with the transmittance above 0 and at most 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub reflectance: Option<f64>,
    /// Share of the flux that is transmitted.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub transmittance: Option<f64>,
}

/// One part of a mixture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MixturePartSpec {
    /// Share of the area; the weights of a mixture need not add up to 1.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub weight: f64,
    /// Finish of this part.
    pub finish: FinishRef,
}

/// A finish: the name of one in `finishes`, a predefined one (`polished`, `black`, `open`), or a finish table in place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "FinishReference")]
pub enum FinishRef {
    /// Name of a finish.
    Name(String),
    /// The finish itself.
    Inline(Box<FinishSpec>),
}
