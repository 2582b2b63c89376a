//! The backward estimator: gather paths from the sensors to the sources, alone or weighed with photons.

pub(crate) mod estimator;
pub(crate) mod mix;
