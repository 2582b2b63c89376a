//! Where paths start: photons on their sources, gather paths on their sensors.

pub(crate) mod area;
pub(crate) mod arrivals;
pub(crate) mod emit;
mod spectral;
pub(crate) mod strata;
