//! The forward estimator: photon paths from the sources, counted where they meet a sensor.

mod batch;
mod counted;
mod counter;
mod estimator;
mod sensor_table;
mod shown;
mod surprises;
#[cfg(test)]
mod tests;
mod tracks;
mod trial;

pub use counted::{CountedRay, RayCollection, counted_rays};
pub use estimator::Forward;
pub use tracks::{Track, TrackEnd, tracks};
pub(crate) use trial::{photons_for, photons_of, trial};
