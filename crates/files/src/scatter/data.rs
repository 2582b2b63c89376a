//! What a file says of a sheet.

use lumiduct_base::math::PatchPairs;

/// What a file says of a sheet.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ScatterFile {
    /// For light that meets the front.
    pub front: ScatterSide,
    /// For light that meets the back.
    pub back: ScatterSide,
    /// What was assumed or left out.
    pub remarks: Vec<String>,
}

/// What a sheet does to light that meets one side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ScatterSide {
    /// Reflected light.
    pub reflection: Option<BsdfMatrix>,
    /// Transmitted light.
    pub transmission: Option<BsdfMatrix>,
}

/// A distribution function over pairs of patches. Directions are those of travel, in axes of the sheet: y points up, and x to the
/// right as seen by an observer who faces the back.
#[derive(Debug, Clone, PartialEq)]
pub struct BsdfMatrix {
    /// The patches.
    pub pairs: PatchPairs,
    /// Values, 1/sr: for each patch of arriving light one for each patch of leaving light.
    pub values: Vec<f64>,
    /// Line of the first value in the file, from 1.
    pub line: usize,
}
