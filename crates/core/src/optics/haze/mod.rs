//! Parts of the lobe of haze: its fall-off, and what of it lies above the horizon.

pub(crate) mod horizon;
pub(crate) mod profile;
