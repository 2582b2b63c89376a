//! Where paths start: photons on their sources, gather paths on their sensors.

pub(crate) mod area;
mod around;
pub(crate) mod arrivals;
mod directions;
pub(crate) mod emit;
pub(crate) mod polar;
mod spectral;
pub(crate) mod strata;
