//! The choice between the estimators, and sensors where gather paths find no light.

mod blind;
mod choice;
pub(crate) mod pilot;

pub use blind::{BLIND_PATHS, blind_sensors};
pub use choice::EstimatorChoice;
