//! Sensors as a scene file states them.

use lumiduct_core::plan::Estimator;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::luminaire::LuminaireExportSpec;
use crate::spec::placement::PlacementSpec;
use crate::spec::rays::RayExportSpec;
use crate::spec::sweep::AreaSpec;

/// A sensor; exactly one of `plane`, `goniometer`, `luminance` and `image`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [
    { "required": ["plane"] },
    { "required": ["goniometer"] },
    { "required": ["luminance"] },
    { "required": ["image"] }
]))]
pub struct SensorSpec {
    /// A sensor file whose keys are included; keys given here take precedence. Relative to the scene file.
    pub file: Option<String>,
    /// A map of illuminance over a flat area or a face.
    pub plane: Option<PlaneSpec>,
    /// A sphere of directions: intensity in type C angles.
    pub goniometer: Option<GoniometerSpec>,
    /// A map of luminance seen from one or more directions.
    pub luminance: Option<LuminanceSpec>,
    /// A luminance image, as an imaging luminance meter takes it.
    pub image: Option<ImageSpec>,
    /// The face that is the sensor, as `NAME.FACE`. For `plane` and `luminance`; not together with `at`.
    pub on: Option<String>,
    /// Whether light is counted as it leaves the face or as it arrives at it. Needed with `on`.
    pub counts: Option<CountsSpec>,
    /// The side that counts. Omitted: `front`, and `both` with `counts = "incident"`.
    pub side: Option<SensorSide>,
    /// Position of the sensor.
    pub at: Option<PlacementSpec>,
    /// Faces through which a remote sensor is lit, as `NAME.FACE`; the rest of its light is reported separately.
    #[schemars(length(min = 1))]
    pub aim: Option<Vec<String>>,
    /// Whether the sensor absorbs what it counts. Only for a `plane` that is not `on` a face.
    #[serde(default)]
    pub absorbing: bool,
    /// How its flux is estimated; takes precedence over `run.estimator` and `--estimator`. Omitted: as these say.
    pub estimator: Option<Estimator>,
    /// Which passages count for light that passes the sensor more than once: `every`, or only the `first`; applies to the
    /// port `entering`, too. Only for a `plane` without `aim`; supported by `forward`, `backward` and `mix`.
    #[serde(default)]
    pub passage: PassageSpec,
    /// The port, as `NAME.FACE`, whose entering flux is the reference for `transmission`.
    pub entering: Option<String>,
    /// Luminaire files to write from what the sensor measures. Only for a `goniometer`.
    pub luminaire: Option<LuminaireExportSpec>,
    /// Ray files to write of the light that the sensor counts. Only for a `plane` or a `goniometer`.
    pub rays: Option<RayExportSpec>,
}

/// The kind of a sensor, with its keys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SensorKindSpec<'a> {
    /// Illuminance over an area.
    Plane(&'a PlaneSpec),
    /// Intensity over directions.
    Goniometer(&'a GoniometerSpec),
    /// Luminance over an area and directions.
    Luminance(&'a LuminanceSpec),
    /// Luminance over the pixels of an image.
    Image(&'a ImageSpec),
}

impl SensorKindSpec<'_> {
    /// The key of the kind.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Plane(_) => "plane",
            Self::Goniometer(_) => "goniometer",
            Self::Luminance(_) => "luminance",
            Self::Image(_) => "image",
        }
    }
}

impl SensorSpec {
    /// The kind; `None` in a spec that was never validated.
    pub(crate) fn kind(&self) -> Option<SensorKindSpec<'_>> {
        let plane = self.plane.as_ref().map(SensorKindSpec::Plane);
        let goniometer = self.goniometer.as_ref().map(SensorKindSpec::Goniometer);
        let luminance = self.luminance.as_ref().map(SensorKindSpec::Luminance);
        let image = self.image.as_ref().map(SensorKindSpec::Image);
        plane.or(goniometer).or(luminance).or(image)
    }
}

/// A grid of cells over a flat area or a face: `cells`, or `rings` and `sectors`; one cell without them. A `rectangle` or
/// a `disk` gives the area; a sensor `on` a face has the area of the face.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlaneSpec {
    /// The area of its own.
    #[serde(flatten)]
    pub area: AreaSpec,
    /// Cells along the local x and y, over the bounding rectangle of the area.
    #[schemars(inner(range(min = 1, max = 100_000_000)))]
    pub cells: Option<[u32; 2]>,
    /// Rings of equal width about the centre, for a round area.
    #[schemars(range(min = 1, max = 100_000_000))]
    pub rings: Option<u32>,
    /// Sectors of equal angle in each ring; the first begins at the local +x. Omitted: rings are whole.
    #[schemars(range(min = 1, max = 100_000_000))]
    pub sectors: Option<u32>,
}

/// A sphere of directions about the position, with the polar axis along the axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GoniometerSpec {
    /// Step of the C planes; divides 360.
    #[serde(default = "c_step")]
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 360.0))]
    pub c_step_deg: f64,
    /// Step of the angle from the axis; divides 180.
    #[serde(default = "gamma_step")]
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 180.0))]
    pub gamma_step_deg: f64,
    /// Radius of a sphere at a finite distance. Omitted: the far field.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub radius_mm: Option<f64>,
}

/// A grid of cells over a flat area or a face, seen from one or more directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LuminanceSpec {
    /// The area of its own.
    #[serde(flatten)]
    pub area: AreaSpec,
    /// Cells along the local x and y, over the bounding rectangle of the area.
    #[schemars(inner(range(min = 1, max = 100_000_000)))]
    pub cells: [u32; 2],
    /// Directions of view.
    #[schemars(length(min = 1))]
    pub directions: Vec<DirectionSpec>,
    /// Half-angle of the cone about each direction over which luminance is averaged.
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 90.0))]
    pub acceptance_half_angle_deg: f64,
}

/// A luminance image: an aperture, a `rectangle` or a `disk`, that looks along the axis, and pixels that are directions.
/// The image is that of a lens without distortion: its pixels are squares of equal size in a plane perpendicular to the
/// axis, so straight lines stay straight. It is as the eye sees it, with the local +y up; columns are counted from the
/// left, rows from below. There is no focus: choose an aperture that is small compared with the details to resolve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ImageSpec {
    /// The area of its own.
    #[serde(flatten)]
    pub area: AreaSpec,
    /// Columns and rows.
    #[schemars(inner(range(min = 1, max = 100_000_000)))]
    pub pixels: [u32; 2],
    /// Angle that a pixel in the middle of the image spans; those further out span less.
    #[schemars(range(min = 0.001, max = 90.0))]
    pub pixel_deg: f64,
}

/// A direction in the local frame of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DirectionSpec {
    /// Angle from the normal.
    #[schemars(range(min = 0.0), extend("exclusiveMaximum" = 90.0))]
    pub theta_deg: f64,
    /// Azimuth about the normal: 0 is toward the local +x.
    pub phi_deg: f64,
}

/// What a sensor on a face counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CountsSpec {
    /// Light that leaves the face, after it was reflected, refracted or scattered there.
    Leaving,
    /// Light that arrives at the face, whatever happens to it there.
    Incident,
}

/// Which passages of light through a sensor count.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PassageSpec {
    /// Every passage: the sensor reads the illuminance at its position.
    #[default]
    Every,
    /// The first passage of each path: light that returns is not counted again.
    First,
}

/// Which side of a sensor counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SensorSide {
    /// The side that the axis or outward normal points to.
    Front,
    /// The other side.
    Back,
    /// Both sides, added up.
    Both,
}

fn c_step() -> f64 {
    15.0
}

fn gamma_step() -> f64 {
    2.0
}
