//! Optimisations as a study file states them: what of a scene is to be found, and for which light.

use indexmap::IndexMap;
use lumiduct_core::plan::Request;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// A study that finds a design: a scene, what of it may change, and what is wanted of its light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Lumiduct optimisation")]
pub(crate) struct OptimisationSpec {
    /// Version of the study format.
    #[schemars(extend("const" = 1))]
    pub lumiduct_study: u32,
    /// One line that names the study in reports.
    pub title: String,
    /// What the study is for, in any number of lines.
    pub description: Option<String>,
    /// The scene to start from, relative to this file.
    pub scene: String,
    /// Keys of the scene that are set first: dotted keys in quotes and values, as after `-D`.
    #[serde(default)]
    pub set: IndexMap<String, Value>,
    /// How much is traced, and with which random numbers.
    #[serde(default)]
    pub run: OptimisationRunSpec,
    /// What is to be found.
    pub optimise: OptimiseSpec,
}

/// How much is traced. Omitted keys are as in the scene. All measurements use the same random numbers; the check at the end uses
/// others.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub(crate) struct OptimisationRunSpec {
    /// Number of paths of the last measurements and of the check. The first ones have a sixteenth of it; the number grows as the
    /// deviations fall.
    #[schemars(range(min = 1))]
    pub paths: Option<u64>,
    /// Seed of the random numbers of light.
    pub seed: Option<u64>,
    /// How flux is estimated.
    pub estimator: Option<Request>,
}

/// What is to be found. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum OptimiseSpec {
    /// Sizes or pitches of a pattern or a relief along its face, by feedback from the light of a sensor.
    PatternFeedback(Box<PatternFeedbackSpec>),
}

/// Sizes or pitches along a face that give the wanted light along it. Each row of cells of the sensor that lies across the face is a
/// zone. Zones with too little light get larger or more elements, the others smaller or fewer ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct PatternFeedbackSpec {
    /// Name of the pattern or the relief.
    pub pattern: String,
    /// What of its elements changes along the face.
    pub vary: Vary,
    /// Least and greatest value of what changes.
    pub limits: LimitsSpec,
    /// Least distance between the edges of neighbours: what remains of the wall.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub bridge_mm: f64,
    /// How it may change along the face.
    #[serde(default)]
    pub law: LawKindSpec,
    /// The sensor whose light counts: a surface with columns and rows, which it divides into zones along the face of the pattern.
    pub sensor: String,
    /// Direction of a sensor of luminance, by its number from 0. Omitted: the first.
    pub view: Option<usize>,
    /// The wanted light along the face, up to a common factor.
    #[serde(default)]
    pub target: LightTargetSpec,
    /// Smallest over largest ratio of measured to wanted light with which the target is reached.
    #[schemars(extend("exclusiveMinimum" = 0.0, "exclusiveMaximum" = 1.0))]
    pub min_over_max: f64,
    /// Name of the measure of efficiency: the share of the light that the pattern lets out. Omitted: that of the sensor.
    pub efficiency: Option<String>,
    /// Weight of the deviations of the zones, relative to the weight of the efficiency.
    #[serde(default = "one")]
    #[schemars(range(min = 0.0))]
    pub uniformity_weight: f64,
    /// Weight of the efficiency. Omitted: 0, and the openings change no more than even light needs; above 0 all openings also grow together as long as
    /// that pays.
    #[serde(default)]
    #[schemars(range(min = 0.0))]
    pub efficiency_weight: f64,
    /// Share of a correction that a step makes.
    #[serde(default = "damping")]
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 1.0))]
    pub damping: f64,
    /// Most measurements before the check.
    #[serde(default = "steps")]
    #[schemars(range(min = 1, max = 1000))]
    pub steps: u32,
    /// A second estimator for the check of the result. Omitted: `mix`, or `forward` where that is the first.
    pub check_estimator: Option<Request>,
}

/// What of an element changes along a face: a key of the element, or the pitch of the layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Vary {
    /// The diameter of circles and caps, `diameter_mm`.
    Diameter,
    /// The radius of spheres, `radius_mm`.
    Radius,
    /// The depth of grooves, dimples and pits, `depth_mm`.
    Depth,
    /// The height of ridges, bumps and pyramids, `height_mm`.
    Height,
    /// The pitch along the face, `pitch_mm`, and with it the density.
    Pitch,
}

/// Limits of a length.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct LimitsSpec {
    /// The least value.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub from_mm: f64,
    /// The greatest value.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub to_mm: f64,
}

/// How a length changes along a face.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LawKindSpec {
    /// A table: one value for each zone, straight lines in between.
    #[default]
    Table,
    /// A monotone cubic spline through a few points: smooth, and without overshoot between them.
    Spline(SplineSpec),
}

/// A monotone cubic spline (Fritsch and Butland 1984).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct SplineSpec {
    /// Number of points, evenly spaced from the first to the last element, or along the whole face where the pitch changes.
    #[schemars(range(min = 2, max = 200))]
    pub knots: u32,
}

/// The wanted light along the face.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(crate) enum LightTargetSpec {
    /// The same in all zones.
    #[default]
    Uniform,
    /// A profile along the face.
    Profile(ProfileFileSpec),
}

/// A profile of light from a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub(crate) struct ProfileFileSpec {
    /// A CSV file, relative to this file, with the columns `along_mm`, from the start of the face, and `light`, in any unit;
    /// straight lines in between. Zones with a light of 0 do not count.
    pub file: String,
}

fn one() -> f64 {
    1.0
}

fn damping() -> f64 {
    0.8
}

fn steps() -> u32 {
    20
}
