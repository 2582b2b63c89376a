//! Reliefs on walls of solids, as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::finish::FinishRef;
use crate::spec::pattern::{AlongSpec, LayoutSpec};

/// Dimples, bumps, grooves, ridges or pyramids on a wall of a solid, as parts of its boundary with exact surfaces. They
/// form a separate face, named after the solid and the relief, such as `plate.grooves`, with its own line in the flux
/// balance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReliefSpec {
    /// The wall, as `NAME.FACE`: a flat rectangle, or the wall of a straight round rod.
    pub on: String,
    /// Finish of the elements. Omitted: the smooth interface of the media.
    pub finish: Option<FinishRef>,
    /// Shape of an element.
    pub element: ReliefElementSpec,
    /// Where the elements are: positions are those of the middle of each element's footprint on the wall.
    pub layout: LayoutSpec,
}

/// An element with relief. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "ReliefElement")]
#[serde(rename_all = "snake_case")]
pub enum ReliefElementSpec {
    /// A spherical cap, at most a hemisphere, sunk into the wall.
    Dimple(CapSpec<DepthSpec>),
    /// A spherical cap, at most a hemisphere, raised from the wall.
    Bump(CapSpec<HeightSpec>),
    /// A V-groove across the guide.
    Groove(WedgeSpec<DepthSpec>),
    /// A ridge with two flanks across the guide, a prism. On a round wall only as a `ring`.
    Ridge(WedgeSpec<HeightSpec>),
    /// A pyramid raised from a flat wall.
    Pyramid(PyramidSpec<HeightSpec>),
    /// A pyramid sunk into a flat wall.
    Pit(PyramidSpec<DepthSpec>),
}

/// Depth of an element in its wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Sunk")]
pub struct DepthSpec {
    /// Depth below the wall: a number, or one that changes along the guide.
    pub depth_mm: AlongSpec,
}

/// Height of an element above its wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Raised")]
pub struct HeightSpec {
    /// Height over the wall: a number, or one that changes along the guide.
    pub height_mm: AlongSpec,
}

/// A spherical cap; exactly one of `radius_mm` and `diameter_mm`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "{Extent}Cap", extend("oneOf" = [{ "required": ["radius_mm"] }, { "required": ["diameter_mm"] }]))]
pub struct CapSpec<Extent> {
    /// Radius of the sphere: a number, or one that changes along the guide.
    pub radius_mm: Option<AlongSpec>,
    /// Diameter of the opening or the foot; on a round wall the diameter along the guide.
    pub diameter_mm: Option<AlongSpec>,
    /// How deep or high it is.
    #[serde(flatten)]
    pub extent: Extent,
}

/// Two flanks; exactly one of `angle_deg` and `flank_angles_deg`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "{Extent}Wedge", extend("oneOf" = [{ "required": ["angle_deg"] }, { "required": ["flank_angles_deg"] }]))]
pub struct WedgeSpec<Extent> {
    /// How deep or high it is.
    #[serde(flatten)]
    pub extent: Extent,
    /// Angle between the two equal flanks.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 180.0))]
    pub angle_deg: Option<f64>,
    /// Angles between the wall and the two flanks, first the flank toward the start of the guide; 90 is upright.
    pub flank_angles_deg: Option<[f64; 2]>,
    /// Length across the guide, on a flat wall. Omitted: the whole width.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_mm: Option<f64>,
    /// Its course on a round wall.
    #[serde(default)]
    pub course: CourseSpec,
}

/// A pyramid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "{Extent}Pyramid")]
pub struct PyramidSpec<Extent> {
    /// Width across the guide.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub width_mm: f64,
    /// Length along the guide.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_mm: f64,
    /// How deep or high it is.
    #[serde(flatten)]
    pub extent: Extent,
}

/// Course of a groove or a ridge over a wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Course")]
pub enum CourseSpec {
    /// Straight across the guide; on a round wall as a saw would cut it.
    #[default]
    Straight,
    /// All around a round wall.
    Ring,
}
