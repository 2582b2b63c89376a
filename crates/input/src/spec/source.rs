//! Light sources as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::daylight::{SkySpec, SunSpec, enabled};
use crate::spec::finish::{EmptySpec, FinishRef};
use crate::spec::luminaire::LuminaireSpec;
use crate::spec::placement::{ContactSpec, PlacementSpec};
use crate::spec::rays::RaysSpec;
use crate::spec::solid::SphereSpec;
use crate::spec::spectrum::SpectrumSpec;
use crate::spec::sweep::RectangleSpec;

/// A light source. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SourceSpec {
    /// A point at the position.
    Point(EmitterSpec<EmptySpec>),
    /// A flat disk or ring about the position, shining along the axis.
    Disk(EmitterSpec<DiskSourceSpec>),
    /// A flat rectangle about the position, shining along the axis.
    Rectangle(EmitterSpec<RectangleSpec>),
    /// The outside of a sphere about the position.
    Sphere(EmitterSpec<SphereSpec>),
    /// A line along the axis, centred at the position.
    Line(EmitterSpec<LineSourceSpec>),
    /// The outside of the wall of a cylinder, from the position along the axis.
    Cylinder(EmitterSpec<CylinderSourceSpec>),
    /// A face of a solid or sheet.
    Face(EmitterSpec<FaceSourceSpec>),
    /// The inside of a solid, evenly filled.
    Volume(EmitterSpec<VolumeSourceSpec>),
    /// A luminaire or lamp from a file in IES LM-63 (.ies) or EULUMDAT (.ldt). Its nadir, γ = 0, is the axis; C0 is toward the local +x and C90
    /// toward the local -y, counter-clockwise as seen from behind.
    Luminaire(LuminaireSpec),
    /// Rays from a file in IES TM-25 (.tm25ray), of OpticStudio (.dat, .sdf), or in CSV (.csv). Results hold for the rays of the file; their
    /// errors do not include that the rays are only a sample of the lamp's light.
    Rays(RaysSpec),
    /// The sun.
    Sun(SunSpec),
    /// The sky.
    Sky(SkySpec),
}

impl SourceSpec {
    /// The key of the kind, such as `disk`.
    pub(crate) fn kind(&self) -> &'static str {
        self.entry().0
    }

    /// Whether its flux is given in W.
    pub(crate) fn is_radiant(&self) -> bool {
        match self {
            Self::Rays(rays) => rays.flux_w.is_some(),
            _ => self.common().is_some_and(|common| common.flux_w.is_some()),
        }
    }

    /// Its spectrum, if it has one.
    pub(crate) fn spectrum(&self) -> Option<&SpectrumSpec> {
        match self {
            Self::Luminaire(own) => own.spectrum.as_ref(),
            Self::Rays(own) => own.spectrum.as_ref(),
            Self::Sun(own) => own.common.spectrum.as_ref(),
            Self::Sky(own) => own.common.spectrum.as_ref(),
            _ => self.common()?.spectrum.as_ref(),
        }
    }

    /// The keys that all kinds but luminaires, rays, the sun and the sky have.
    pub(crate) fn common(&self) -> Option<&SourceCommonSpec> {
        self.entry().1
    }

    fn entry(&self) -> (&'static str, Option<&SourceCommonSpec>) {
        match self {
            Self::Point(source) => ("point", Some(&source.common)),
            Self::Disk(source) => ("disk", Some(&source.common)),
            Self::Rectangle(source) => ("rectangle", Some(&source.common)),
            Self::Sphere(source) => ("sphere", Some(&source.common)),
            Self::Line(source) => ("line", Some(&source.common)),
            Self::Cylinder(source) => ("cylinder", Some(&source.common)),
            Self::Face(source) => ("face", Some(&source.common)),
            Self::Volume(source) => ("volume", Some(&source.common)),
            Self::Luminaire(_) => ("luminaire", None),
            Self::Rays(_) => ("rays", None),
            Self::Sun(_) => ("sun", None),
            Self::Sky(_) => ("sky", None),
        }
    }
}

/// A shape that emits light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [
    { "required": ["flux_lm"] },
    { "required": ["flux_w"] },
    { "required": ["luminance_cd_m2"] },
    { "required": ["intensity_cd"] },
    { "required": ["intensity_mcd"] }
]))]
#[schemars(rename = "{Shape}Emitter")]
pub struct EmitterSpec<Shape> {
    /// Keys of the shape.
    #[serde(flatten)]
    pub shape: Shape,
    /// Keys of every source.
    #[serde(flatten)]
    pub common: SourceCommonSpec,
}

/// What every source has; exactly one of `flux_lm`, `flux_w`, `luminance_cd_m2`, `intensity_cd` and `intensity_mcd`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SourceCommonSpec {
    /// Total luminous flux.
    #[schemars(range(min = 0.0))]
    pub flux_lm: Option<f64>,
    /// Total radiant flux; with a `spectrum`, from 377.5 to 782.5 nm. Without spectra a scene has sources in lm or in W, not both.
    #[schemars(range(min = 0.0))]
    pub flux_w: Option<f64>,
    /// Luminance along the axis or normal, for sources with an area.
    #[schemars(range(min = 0.0))]
    pub luminance_cd_m2: Option<f64>,
    /// Peak intensity, for `point` only.
    #[schemars(range(min = 0.0))]
    pub intensity_cd: Option<f64>,
    /// Peak intensity in millicandela, as data sheets of LEDs give it, for `point` only.
    #[schemars(range(min = 0.0))]
    pub intensity_mcd: Option<f64>,
    /// Distribution of the light over directions. Omitted: `isotropic` for a `volume`, `lambertian` for all others.
    pub emission: Option<EmissionRef>,
    /// Angle between the axis and the direction of a cone or a collimated beam.
    #[serde(default)]
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 90.0))]
    pub tilt_deg: f64,
    /// Azimuth of a tilted direction about the axis: 0 is toward the local +x.
    #[serde(default)]
    pub azimuth_deg: f64,
    /// How light starts where the source touches a face: `optical` starts it beyond the face, as through glue; `air`
    /// lets it cross the face first. Omitted: `optical`.
    pub contact: Option<ContactSpec>,
    /// Spectrum of its light. If one source has a spectrum, all must have one; the run then also measures colour.
    pub spectrum: Option<SpectrumSpec>,
    /// What happens to light that meets the emitter.
    #[serde(default)]
    pub body: BodySpec,
    /// The light group: flux, efficiency, transmission, maps, uniformity and intensity are also measured for all sources of a group together.
    pub group: Option<String>,
    /// Whether the source emits. A disabled source is dark, as with a flux of 0; its body still blocks light.
    #[serde(default = "enabled")]
    pub enabled: bool,
    /// Position of the source. A `face` or `volume` is where its solid is.
    pub at: Option<PlacementSpec>,
}

/// A flat disk, or a ring if it has an inner radius.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiskSourceSpec {
    /// Radius of the rim.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: f64,
    /// Radius of the dark middle; smaller than that of the rim.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub inner_radius_mm: f64,
}

/// A line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LineSourceSpec {
    /// Length along the axis.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_mm: f64,
}

/// The wall of a cylinder.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CylinderSourceSpec {
    /// Radius.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: f64,
    /// Length along the axis.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_mm: f64,
}

/// A face that emits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FaceSourceSpec {
    /// The face, as `NAME.FACE`.
    pub of: String,
    /// Side to which it emits: `front` is out of the solid, `back` into it.
    #[serde(default)]
    pub side: FaceSide,
}

/// A solid that emits from within.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VolumeSourceSpec {
    /// Name of the solid.
    pub of: String,
}

/// One side of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FaceSide {
    /// The outside of a solid, the side of the normal of a sheet.
    #[default]
    Front,
    /// The other side.
    Back,
}

/// Distribution of light over directions: one of the kinds of emission, the name of one in `emissions`, or of one that `lumiduct library` lists. An
/// emission of the scene replaces one of the library of the same name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "EmissionReference")]
pub enum EmissionRef {
    /// The emission itself.
    Inline(EmissionSpec),
    /// Name of an emission, such as `smd_0603_120deg`.
    Name(String),
}

/// Distribution of light over directions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EmissionSpec {
    /// The same luminance in every direction.
    Lambertian,
    /// The same intensity in every direction.
    Isotropic,
    /// A parallel beam.
    Collimated,
    /// Intensity proportional to this power of the cosine of the angle from the axis or normal; 1 is Lambertian.
    CosinePower(#[schemars(range(min = 0.0))] f64),
    /// The viewing angle of an LED, the full angle between directions of half of the peak intensity: intensity proportional to a power of the
    /// cosine. 120 is Lambertian.
    ViewingAngleDeg(
        #[schemars(extend("exclusiveMinimum" = 1.0), extend("exclusiveMaximum" = 180.0))] f64,
    ),
    /// The same luminance within a cone of this half-angle, none outside.
    ConeHalfAngleDeg(#[schemars(extend("exclusiveMinimum" = 0.0), range(max = 90.0))] f64),
}

/// Kinds of emission that are words.
pub(crate) const EMISSION_WORDS: [&str; 3] = ["lambertian", "isotropic", "collimated"];

/// Keys of the kinds of emission that are tables.
pub(crate) const EMISSION_TABLES: [&str; 3] =
    ["cosine_power", "viewing_angle_deg", "cone_half_angle_deg"];

/// What happens to light that meets an emitter: `transparent` lets it pass, `absorbing` absorbs it; or a finish.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BodySpec {
    /// Light passes as if the emitter were not there.
    #[default]
    Transparent,
    /// Light is absorbed, and counted as such.
    Absorbing,
    /// Light meets a finish.
    #[serde(untagged)]
    Finish(FinishRef),
}
