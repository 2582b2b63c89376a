//! Records of an optimisation: what it is, every measurement, and how it ended.

use crate::page::Standing;
use lumiduct_core::plan::Request;
use serde::{Deserialize, Serialize};

/// Version of the layout of these records.
pub const OPTIMISATION_FORMAT: u32 = 1;

/// What identifies an optimisation in its folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct OptimisationIdentity {
    /// Version of the layout.
    pub lumiduct_optimisation: u32,
    /// Name of the study.
    pub name: String,
    /// Digest of everything that determines the results.
    pub hash: String,
}

/// A value with its standard error, in a unit given elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Uncertain {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

/// What a measurement is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Purpose {
    /// To find the next step.
    Search,
    /// To check the scene as it was.
    CheckBefore,
    /// To check the result.
    CheckAfter,
}

/// A measured design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeasuredStep {
    /// Version of the layout.
    pub lumiduct_step: u32,
    /// Digest of the optimisation.
    pub hash: String,
    /// Its number, from 1.
    pub step: usize,
    /// What it is for.
    pub purpose: Purpose,
    /// Seed of its random numbers.
    pub seed: u64,
    /// How flux was estimated.
    pub estimator: Request,
    /// Paths asked for.
    pub paths_asked: u64,
    /// Whether the scene was measured as it is, before any change.
    pub is_start: bool,
    /// The lengths at the points of the law, mm.
    pub values: Vec<f64>,
    /// Light of the zones, in the unit of the sensor.
    pub zones: Vec<Uncertain>,
    /// The efficiency, 1.
    pub efficiency: Uncertain,
    /// Paths traced.
    pub paths: u64,
}

/// How well the light of a design is as wanted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LightMisfit {
    /// Root mean square of the relative deviations of the zones beyond noise, 1.
    pub deviation: Uncertain,
    /// Smallest over largest ratio of measured to wanted light, 1.
    pub min_over_max: Uncertain,
    /// What is made small: the weighted sum of deviation and light lost, 1.
    pub objective: Uncertain,
}

/// Why an optimisation ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind", content = "reason")]
pub enum Ending {
    /// The target is reached.
    Reached,
    /// Limits keep zones from getting the light that they lack.
    Unreachable(String),
    /// No size meets all limits.
    ContradictingLimits(String),
    /// Nothing is wanted: all weights are zero.
    ZeroWeight(String),
    /// All deviations lie within their errors.
    HiddenByNoise(String),
    /// Steps improve nothing beyond the error.
    NoProgress(String),
    /// The number of steps was not enough.
    OutOfSteps(String),
    /// The scene refuses the sizes.
    Refused(String),
    /// The search reached the target, but the check did not confirm it.
    NotConfirmed(String),
    /// The user stopped it.
    Interrupted,
}

impl Ending {
    /// The ending as a verdict.
    pub fn standing(&self) -> Standing {
        match self {
            Self::Reached => Standing::Good,
            Self::Interrupted => Standing::Open,
            Self::Unreachable(_)
            | Self::ContradictingLimits(_)
            | Self::ZeroWeight(_)
            | Self::HiddenByNoise(_)
            | Self::NoProgress(_)
            | Self::OutOfSteps(_)
            | Self::Refused(_)
            | Self::NotConfirmed(_) => Standing::Bad,
        }
    }

    /// In words.
    pub fn words(&self) -> &str {
        match self {
            Self::Reached => "the target is reached",
            Self::Unreachable(reason)
            | Self::ContradictingLimits(reason)
            | Self::ZeroWeight(reason)
            | Self::HiddenByNoise(reason)
            | Self::NoProgress(reason)
            | Self::OutOfSteps(reason)
            | Self::Refused(reason)
            | Self::NotConfirmed(reason) => reason,
            Self::Interrupted => "stopped; --resume continues",
        }
    }
}

/// A step of the search with its judgement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedStep {
    /// The measurement.
    #[serde(flatten)]
    pub measured: MeasuredStep,
    /// Its judgement.
    pub misfit: LightMisfit,
}

/// A zone of the sensor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ZonePlace {
    /// Position along the face, mm.
    pub along_mm: f64,
    /// Wanted light, relative to the mean; 0 where the zone does not count.
    pub wanted: f64,
}

/// An element of the pattern that was found.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FoundElement {
    /// Position of its middle across the face, mm from the left edge of the unrolled face.
    pub across_mm: f64,
    /// Position along the face, mm from its start.
    pub along_mm: f64,
    /// Extent across the face, mm.
    pub width_mm: f64,
    /// Extent along the face, mm.
    pub length_mm: f64,
    /// Depth or height of a relief, mm; 0 without one.
    pub height_mm: f64,
}

/// The form of the elements, for drawings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ElementShape {
    /// Circles.
    Circle,
    /// Rectangles.
    Rectangle,
    /// Parts of a relief, which no flat drawing shows.
    Relief,
}

/// Everything that the report of an optimisation shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptimisationReport {
    /// What it is.
    #[serde(flatten)]
    pub identity: OptimisationIdentity,
    /// Version of the program.
    pub version: String,
    /// Title.
    pub title: String,
    /// Its purpose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub description: Option<String>,
    /// Name of the scene.
    pub scene: String,
    /// Overrides of the scene before any step.
    pub overrides: Vec<String>,
    /// The pattern.
    pub pattern: String,
    /// The key that was varied.
    pub key: String,
    /// Name of the length: `diameter`.
    pub length: String,
    /// Settings, in words.
    pub settings: Vec<String>,
    /// The sensor.
    pub sensor: String,
    /// Its quantity, such as `illuminance`.
    pub quantity: String,
    /// The unit of the quantity.
    pub unit: String,
    /// Target for the smallest over the largest ratio, 1.
    pub goal: f64,
    /// Zones along the face.
    pub zones: Vec<ZonePlace>,
    /// Points of the law, mm along the face.
    pub points_mm: Vec<f64>,
    /// Steps of the search.
    pub steps: Vec<JudgedStep>,
    /// The best one: its place among the steps.
    pub best: usize,
    /// Checks with fresh random numbers: before and after, by each estimator.
    pub checks: Vec<JudgedStep>,
    /// Limits that hold, in words.
    pub active_limits: Vec<String>,
    /// How it ended.
    pub ending: Ending,
    /// The form of the elements.
    pub shape: ElementShape,
    /// Width and length of the face, mm.
    pub face_mm: [f64; 2],
    /// Whether the face goes once around, so that its left and its right edge are one line: the seam.
    #[serde(skip)]
    pub is_round: bool,
    /// The elements of the best design.
    #[serde(skip)]
    pub elements: Vec<FoundElement>,
}

impl OptimisationReport {
    /// The step whose design is the result.
    pub fn best_step(&self) -> Option<&JudgedStep> {
        self.steps.get(self.best)
    }

    /// The checks of a purpose.
    pub(crate) fn checks_of(&self, purpose: Purpose) -> impl Iterator<Item = &JudgedStep> {
        self.checks.iter().filter(move |own| own.measured.purpose == purpose)
    }
}
