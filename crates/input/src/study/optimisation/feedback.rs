//! Pattern feedback: what is to be found along a face, and for which light. Types only; the rules check and fill them.

use crate::spec::optimise::Vary;
use lumiduct_core::plan::Request;
use lumiduct_core::scene::SensorId;
use lumiduct_core::scene::pattern::TableAlong;

/// Sizes or pitches of a pattern along its face that give the wanted light along it.
#[derive(Debug, Clone, PartialEq)]
pub struct PatternFeedback {
    /// Name of the pattern or the relief.
    pub pattern: String,
    /// Dotted key of the length that changes along the face.
    pub key: String,
    /// What it is.
    pub vary: Vary,
    /// Length of the face, mm.
    pub face_length: f64,
    /// The length in the scene, mm, at positions from the start of the face.
    pub start: TableAlong,
    /// Least and greatest value, mm.
    pub limits: [f64; 2],
    /// Least distance between the edges of neighbours, mm.
    pub bridge: f64,
    /// How the length may change along the face.
    pub law: LawKind,
    /// The sensor.
    pub sensor: SensorId,
    /// Its view, if it separates directions.
    pub view: Option<usize>,
    /// Where it measures along the face, in the order of the positions: at least two.
    pub zones: Vec<FeedbackZone>,
    /// The wanted light.
    pub target: LightTarget,
    /// Smallest over largest ratio of measured to wanted light that is to be reached, 1.
    pub min_over_max: f64,
    /// Name of the measure of efficiency.
    pub efficiency: String,
    /// Weight of the deviations, 1.
    pub uniformity_weight: f64,
    /// Weight of the efficiency, 1.
    pub efficiency_weight: f64,
    /// Share of a correction that a step makes, 1.
    pub damping: f64,
    /// Most measurements before the check.
    pub steps: usize,
    /// The second estimator of the check.
    pub check_estimator: Request,
    /// Paths of the last measurements.
    pub paths: u64,
}

/// How a length changes along a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawKind {
    /// A value for each zone, straight lines in between.
    Table,
    /// A monotone cubic spline through this many points.
    Spline(usize),
}

/// Cells of a sensor at the same position along a face.
#[derive(Debug, Clone, PartialEq)]
pub struct FeedbackZone {
    /// The position, mm from the start of the face.
    pub along: f64,
    /// The cells, row by row from 0.
    pub cells: Vec<usize>,
}

/// The wanted light along a face, up to a common factor.
#[derive(Debug, Clone, PartialEq)]
pub enum LightTarget {
    /// The same everywhere.
    Uniform,
    /// Light at positions, mm.
    Profile(TableAlong),
}
