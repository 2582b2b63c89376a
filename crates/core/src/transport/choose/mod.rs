//! The choice between the estimators, and sensors where gather paths find no light.

mod blind;
mod choice;
pub(crate) mod pilot;
pub(crate) mod sharing;

pub use blind::{BLIND_PATHS, blind_sensors};
pub use choice::EstimatorChoice;
