//! The backward estimator: gather paths from the sensors to the sources, alone or weighted with
//! photons.

pub(crate) mod counter;
pub(crate) mod estimator;
pub(crate) mod learning;
pub(crate) mod mix;
pub(crate) mod paths;
