//! Patterns of holes, dots and patches on faces, as a scene file states them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::spec::finish::FinishRef;

/// Holes, dots or patches on a face: elements whose own finish replaces that of the face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PatternSpec {
    /// The face, as `NAME.FACE`: a flat rectangle, or the wall of a straight round tube or rod.
    pub on: String,
    /// Finish of the elements, on both sides: `open` makes holes.
    pub finish: FinishRef,
    /// Shape of an element.
    pub element: ElementSpec,
    /// Where the elements are.
    pub layout: LayoutSpec,
    /// Thickness of the wall that holes go through; the face is the middle of the wall, and the sides of holes absorb.
    /// Omitted: no thickness.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub wall_mm: Option<f64>,
}

/// An element. A table with exactly one of these keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ElementSpec {
    /// A circle.
    Circle(CircleElementSpec),
    /// A rectangle.
    Rectangle(RectangleElementSpec),
}

/// A circle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "CircleElement")]
pub struct CircleElementSpec {
    /// Its diameter: a number, or one that changes along the face.
    pub diameter_mm: AlongSpec,
}

/// A rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "RectangleElement")]
pub struct RectangleElementSpec {
    /// Width across the face.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub width_mm: f64,
    /// Length along the face.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_mm: f64,
}

/// Where elements are. A table with exactly one of these keys. Places along a face are counted from its start, those across
/// from its middle line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LayoutSpec {
    /// One row along the face.
    Row(RowSpec),
    /// Rows and columns.
    Grid(GridSpec),
    /// Rows and columns, every other row shifted by half a pitch.
    Staggered(GridSpec),
    /// A hexagonal grid: each element has six neighbours at the same distance.
    Hexagonal(HexagonalSpec),
}

/// One row along a face; exactly one of `positions_mm` and `pitch_mm`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(extend("oneOf" = [{ "required": ["positions_mm"] }, { "required": ["pitch_mm"] }]))]
pub struct RowSpec {
    /// Places of the elements along the face, increasing.
    #[schemars(length(min = 1, max = 1_000_000))]
    pub positions_mm: Option<Vec<f64>>,
    /// Distance from one element to the next: a number, or one that changes along the face.
    pub pitch_mm: Option<AlongSpec>,
    /// Where the row begins and ends along the face, with `pitch_mm`. Omitted: the whole face.
    pub along_mm: Option<[f64; 2]>,
    /// Position of the row across the face, from its middle line. Omitted: the middle, which on a round face is at
    /// `around_deg` 180.
    pub across_mm: Option<f64>,
    /// Position of the row around a round tube or rod, from the local +x toward +y.
    pub around_deg: Option<f64>,
}

/// Rows and columns over a face, or a part of it, centred.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GridSpec {
    /// Distance between columns across the face. Around a round face a whole number of columns has to fit.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub across_pitch_mm: f64,
    /// Distance between rows along the face: a number, or one that changes along the face.
    pub pitch_mm: AlongSpec,
    /// Where the field begins and ends across the face. Omitted: the whole face.
    pub across_mm: Option<[f64; 2]>,
    /// Where the field begins and ends along the face. Omitted: the whole face.
    pub along_mm: Option<[f64; 2]>,
}

/// A field of elements with six neighbours each over a face, or a part of it, centred.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HexagonalSpec {
    /// Distance from an element to its neighbours.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub pitch_mm: f64,
    /// Where the field begins and ends across the face. Omitted: the whole face.
    pub across_mm: Option<[f64; 2]>,
    /// Where the field begins and ends along the face. Omitted: the whole face.
    pub along_mm: Option<[f64; 2]>,
}

/// A length that may change along a face.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(rename = "LengthAlongAFace")]
pub enum AlongSpec {
    /// The same everywhere, mm.
    Same(#[schemars(extend("exclusiveMinimum" = 0.0))] f64),
    /// Pairs of a place along the face and the length there, mm, places increasing; straight lines in between.
    Table(#[schemars(length(min = 1, max = 100_000))] Vec<[f64; 2]>),
    /// A power law from one end of the face to the other.
    Law(LawSpec),
}

/// A length that goes from one value at the start of a face to another at its end: `from + (to - from) share^power`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LawSpec {
    /// Length at the start of the face.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub from_mm: f64,
    /// Length at its end.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub to_mm: f64,
    /// Exponent; 1 is a straight line.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0.0), range(max = 100.0))]
    pub power: f64,
}

fn one() -> f64 {
    1.0
}
