//! Connections: a vertex that scatters light is joined to a point of a sensor, or to a source, by a
//! straight way (next-event estimation).
//!
//! Photons are joined to sensors, gather paths to sources; docs/method.md has the formulas. A way
//! is void where it meets a visible interface. One path of light can be found by photons that are
//! counted, by photons that are joined, by gather paths that meet emission, by gather paths that are
//! joined, and by pairs of photons and records (`passage`); `weights` divides its light among them.
//! This module traces no paths.

pub(crate) mod passage;
pub(crate) mod sensors;
pub(crate) mod sources;
mod target;
pub(crate) mod vertex;
pub(crate) mod way;
pub(crate) mod weights;
