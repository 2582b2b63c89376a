//! The legs of a path as specified by the user, and possible errors in them.

use crate::scene::sweep::ProfileError;
use lumiduct_base::number::format_length;

/// A leg of a path. Lengths in mm, angles in rad. `toward` is the azimuth to which the path turns,
/// in the section as it arrives; 0 = the local +x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Leg {
    /// Straight on.
    Straight {
        /// Length, mm.
        length: f64,
        /// Size of the section at the end, relative to its size at the start of this leg.
        end_scale: f64,
    },
    /// An arc.
    Bend {
        /// Angle of the turn, up to 2π.
        angle: f64,
        /// Radius of the centre line, mm.
        radius: f64,
        /// Azimuth of the turn.
        toward: f64,
    },
    /// A sharp corner. The legs next to it end at its inner edge; the walls are extended to the
    /// plane that bisects the corner, so that in a duct of width w a right-angled corner is a
    /// square of w by w.
    Corner {
        /// Angle of the turn, below π.
        angle: f64,
        /// Azimuth of the turn.
        toward: f64,
        /// Shape of its outside.
        kind: CornerKind,
    },
}

/// The outside of a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CornerKind {
    /// The outer walls meet in an edge.
    Plain,
    /// A flat plate through the crossing of the centre lines cuts the outside off: as a mirror, it turns light running
    /// along one centre line into the other.
    Mitred,
}

/// Why a sweep cannot be built, and at which leg.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{problem}")]
pub struct SweepError {
    /// The leg, from 0; `None` when no leg is at fault.
    pub leg: Option<usize>,
    /// The problem.
    pub problem: SweepProblem,
}

/// Why a sweep cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SweepProblem {
    /// The profile itself is unusable.
    #[error(transparent)]
    Profile(#[from] ProfileError),
    /// There are no legs.
    #[error("the path has no legs, expected at least one")]
    NoLegs,
    /// A length or a factor is out of range.
    #[error("{what} is {value}, expected a positive number up to 1e9")]
    OutOfRange {
        /// Name of the quantity.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// An angle is out of range.
    #[error("{what} is {value_deg} degrees, expected {expected}")]
    Angle {
        /// Name of the quantity.
        what: &'static str,
        /// Its value, degrees.
        value_deg: f64,
        /// The range.
        expected: &'static str,
    },
    /// The section has been scaled beyond reasonable size.
    #[error("the section is scaled to {scale} of its size at the entry, expected 1e-6 to 1e6")]
    Scaled {
        /// Scale relative to the entry.
        scale: f64,
    },
    /// The bend axis passes through the profile.
    #[error(
        "the bend has a radius of {} mm but the profile reaches {} mm toward its axis",
        format_length(*.radius),
        format_length(*.reach)
    )]
    TightBend {
        /// Radius of the centre line, mm.
        radius: f64,
        /// Reach of the profile, mm.
        reach: f64,
    },
    /// A mitre plate, or the walls between two corners, need more length.
    #[error(
        "the straight part here is {} mm too short for the corners at its ends",
        format_length(*.missing)
    )]
    TooShort {
        /// The missing length, mm.
        missing: f64,
    },
    /// The path ends where it began.
    #[error("the path closes on itself: its exit lies on its entry")]
    ClosedRing,
    /// Two legs overlap.
    #[error(
        "this leg runs through leg {other} (counted from 1) near ({}, {}, {}) mm",
        format_length(*.x),
        format_length(*.y),
        format_length(*.z)
    )]
    Overlap {
        /// The other leg, from 1.
        other: usize,
        /// A common point, mm.
        x: f64,
        /// A common point, mm.
        y: f64,
        /// A common point, mm.
        z: f64,
    },
}
