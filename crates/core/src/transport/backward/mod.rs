//! The backward estimator: gather paths from the sensors to the sources, alone or weighted with
//! photons.

pub(crate) mod estimator;
pub(crate) mod mix;
