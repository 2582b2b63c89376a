//! Finishes as a scene file states them.

use crate::spec::coating::StackSpec;
use crate::spec::spectrum::ShareSpec;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a face does to light. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FinishSpec {
    /// A smooth interface between two media: Fresnel reflection and refraction, total internal reflection. Light is
    /// unpolarised at every interface unless `run.polarisation` is `followed`. When it is followed, 0.46 % more passes the two polished ends
    /// of a round rod, and 3.6 % more a plate of index 1.49 at 75 deg.
    Smooth(EmptySpec),
    /// A mirror with the same reflectance at every angle, or a window with the same transmittance. The rest is absorbed.
    Specular(SpecularSpec),
    /// A smooth metal by its complex refractive index.
    Metal(MetalSpec),
    /// Absorbs everything.
    Absorber(EmptySpec),
    /// No surface: light passes without refraction.
    Open(EmptySpec),
    /// Perfectly diffuse reflection and transmission; together above 0 and at most 1. The rest is absorbed.
    Lambertian(LambertianSpec),
    /// Scatter about the mirrored direction and the direction straight through. With neither reflectance nor
    /// transmittance given it is a rough interface between two media: the flux is split as at a smooth one, and
    /// scattered about the mirrored and the refracted direction.
    Gaussian(GaussianSpec),
    /// A rough interface of two media, or a rough mirror, made of many small facets (GGX). Light meets one facet; light
    /// that would meet a second one is absorbed: at normal incidence on a mirror 1 % at a roughness of 0.1, 12 % at 0.3,
    /// 31 % at 0.5, 69 % at 1; on acrylic 10 % at 0.3, 24 % at 0.5, 56 % at 1.
    Ggx(GgxSpec),
    /// Haze by the `ABg` model, `A/(B + d^g)` in 1/sr: d is the distance of two directions in direction cosines. With
    /// neither reflectance nor transmittance given it is a hazy interface between two media: light is scattered to both
    /// sides, d counts in index times direction cosine, and the rest is reflected and refracted as by a smooth one.
    Abg(AbgSpec),
    /// Haze by Harvey's law with a shoulder, `b0 (1 + (d/l)²)^(s/2)` in 1/sr; otherwise as `abg`.
    Harvey(HarveySpec),
    /// A mirror or window with shares that depend on the angle of incidence, linear between the angles. The rest is
    /// absorbed.
    Tabulated(TabulatedSpec),
    /// A smooth interface with a coating, such as an antireflection coating: it reflects according to a table and
    /// refracts the rest; total internal reflection remains.
    Coated(CoatedSpec),
    /// A smooth interface, or a sheet, with thin layers that interfere: antireflection coatings, dichroic filters and mirrors,
    /// metal layers. Reflectance and transmittance follow from the layers, the media on both sides, the angle and the
    /// wavelength; total internal reflection remains, and what absorbing layers keep is absorbed. Transmitted light is
    /// refracted into the medium behind; between equal media it goes straight on.
    Stack(StackSpec),
    /// A thin film, flat on one face, with prisms side by side on the other. It acts on light from both sides.
    PrismFilm(PrismFilmSpec),
    /// Scatter of a sheet from a file, as measured or as computed by another program. It acts on light from both sides.
    ScatterFile(ScatterFileSpec),
    /// Several finishes side by side on a scale too small to see.
    Mixture(#[schemars(length(min = 1))] Vec<MixturePartSpec>),
}

/// A table without keys: `{}`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub struct EmptySpec {}

/// A mirror with a reflectance that does not depend on the angle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpecularSpec {
    /// Share of the flux that is mirrored, at every angle.
    pub reflectance: ShareSpec,
    /// Share of the flux that goes straight on, at every angle. At every wavelength at most 1 together with the reflectance.
    #[serde(default)]
    pub transmittance: ShareSpec,
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

/// Perfectly diffuse reflection and transmission.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LambertianSpec {
    /// Share of the flux that is reflected diffusely.
    #[serde(default)]
    pub reflectance: ShareSpec,
    /// Share of the flux that is transmitted diffusely.
    #[serde(default)]
    pub transmittance: ShareSpec,
}

/// Scatter about the mirrored direction and the direction straight through.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GaussianSpec {
    /// Standard deviation of the scatter.
    #[schemars(range(min = 0.01, max = 60.0))]
    pub sigma_deg: f64,
    /// Share of the flux that is reflected. Together with the transmittance above 0 and at most 1.
    pub reflectance: Option<ShareSpec>,
    /// Share of the flux that is transmitted.
    pub transmittance: Option<ShareSpec>,
}

/// Small facets with GGX slopes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GgxSpec {
    /// Roughness: about the slope of the facets.
    #[schemars(range(min = 0.001, max = 1.0))]
    pub roughness: f64,
    /// Makes the facets mirrors of this reflectance.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub reflectance: Option<f64>,
    /// Makes the facets metal.
    pub metal: Option<MetalSpec>,
}

/// Haze by the `ABg` model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AbgSpec {
    /// A, in 1/sr where g is 0.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub a: f64,
    /// B.
    #[schemars(range(min = 1e-12))]
    pub b: f64,
    /// g.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub g: f64,
    /// What is hazy.
    #[serde(flatten)]
    pub sheet: HazeSheetSpec,
}

/// Haze by Harvey's law with a shoulder.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HarveySpec {
    /// Value along the undisturbed direction, in 1/sr.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub b0: f64,
    /// Shoulder, in direction cosines.
    #[schemars(range(min = 1e-6))]
    pub l: f64,
    /// Slope beyond the shoulder in a log-log plot; -1.5 is common.
    #[schemars(range(min = -10.0, max = 0.0))]
    pub s: f64,
    /// What is hazy.
    #[serde(flatten)]
    pub sheet: HazeSheetSpec,
}

/// What is hazy.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HazeSheetSpec {
    /// Share of the flux that is reflected, scattered or not. Together with the transmittance above 0 and at most 1; at
    /// least the scattered share.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub reflectance: Option<f64>,
    /// Share of the flux that is transmitted, scattered or not.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub transmittance: Option<f64>,
    /// To which sides a sheet scatters. Omitted: `both`.
    pub scatters: Option<HazeSidesSpec>,
}

/// Sides to which light is scattered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HazeSidesSpec {
    /// About the mirrored and about the straight direction, each as the law says.
    Both,
    /// About the mirrored direction only.
    Reflected,
    /// About the straight direction only.
    Transmitted,
}

/// Shares by the angle of incidence.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TabulatedSpec {
    /// Angles of incidence, from 0 to 90.
    #[schemars(length(min = 2))]
    pub angles_deg: Vec<f64>,
    /// Share of the flux that is mirrored, for each angle.
    #[schemars(length(min = 2), extend("items" = { "type": "number", "minimum": 0.0, "maximum": 1.0 }))]
    pub reflectance: Vec<f64>,
    /// Share of the flux that goes straight on, for each angle. Omitted: none.
    #[schemars(length(min = 2), extend("items" = { "type": "number", "minimum": 0.0, "maximum": 1.0 }))]
    pub transmittance: Option<Vec<f64>>,
}

/// A coating on an interface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoatedSpec {
    /// Angles in the medium of the lower index, from 0 to 90; the coating is thus the same from both sides.
    #[schemars(length(min = 2))]
    pub angles_deg: Vec<f64>,
    /// Share of the flux that is mirrored, for each angle.
    #[schemars(length(min = 2), extend("items" = { "type": "number", "minimum": 0.0, "maximum": 1.0 }))]
    pub reflectance: Vec<f64>,
}

/// A prism film. Light is traced through one period from a random position and leaves at the point where it arrived.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PrismFilmSpec {
    /// Refractive index.
    #[schemars(range(min = 1.0, max = 4.0))]
    pub index: f64,
    /// Distance from tip to tip.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub pitch_mm: f64,
    /// Thickness between the flat face and the valleys.
    #[schemars(range(min = 0.0))]
    pub base_mm: f64,
    /// Angle between the two facets of a prism at its tip.
    #[serde(default = "right_angle")]
    #[schemars(range(min = 10.0, max = 170.0))]
    pub prism_angle_deg: f64,
    /// Absorption coefficient (natural) of the film.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub absorption_per_mm: f64,
    /// Rounded share of the facets, half at the tips and half in the valleys; light that meets it is lost and counted as
    /// absorbed.
    #[serde(default)]
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 1.0))]
    pub rounded_share: f64,
    /// Position of the prisms as seen by light that meets this finish: `behind` the flat face or `before` it. From inside
    /// a duct or a solid, `behind` is the outside.
    #[serde(default)]
    pub prisms: PrismSideSpec,
    /// Which way the prisms run: `along` the guide or `around` it. On a flat sheet these are its local y and x.
    #[serde(default)]
    pub run: GrainSpec,
}

/// Scatter of a sheet from a file. Values are constant over patches of directions, as in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ScatterFileSpec {
    /// The file, relative to the scene: .xml of Radiance genBSDF or LBNL WINDOW (Klems matrix or tensor tree, visible light),
    /// or .csv with columns `theta_i_deg`, `theta_s_deg`, `phi_s_deg`, and `brdf_per_sr` or `btdf_per_sr`.
    pub file: String,
    /// The side of the file that lies on the front of the sheet. In XML the front is the outside of a glazing.
    #[serde(default)]
    pub side: ScatterFileSideSpec,
    /// Angle from the direction along the guide, on a flat sheet its local y, to the upward direction of the file,
    /// counter-clockwise seen from the front.
    #[serde(default)]
    #[schemars(range(min = -360.0, max = 360.0))]
    pub turn_deg: f64,
}

/// A side of a scatter file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ScatterFileSideSpec {
    /// Front in the file.
    #[default]
    Front,
    /// Back in the file.
    Back,
}

/// On which face of a film its prisms are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PrismSideSpec {
    /// Light meets the flat face first.
    #[default]
    Behind,
    /// Light meets the prisms first.
    Before,
}

/// Which way something runs on a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GrainSpec {
    /// Along the guide.
    #[default]
    Along,
    /// Around it.
    Around,
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

/// A finish: the name of one in `finishes`, a predefined one (`polished`, `black`, `open`), one of those that `lumiduct library` lists, or a finish
/// table in place. A finish of the scene replaces another of the same name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "FinishReference")]
pub enum FinishRef {
    /// Name of a finish.
    Name(String),
    /// The finish itself.
    Inline(Box<FinishSpec>),
}

fn right_angle() -> f64 {
    90.0
}
