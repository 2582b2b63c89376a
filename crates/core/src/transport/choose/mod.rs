//! The choice between the estimators, and sensors that gather paths leave dark.

mod blind;
mod choice;
pub(crate) mod pilot;
mod trials;

pub use blind::{BLIND_PATHS, blind_sensors};
pub use choice::{Choice, Objection, Trial};
