//! Photometric sensor data for light tubes and light guides.
pub mod error;
pub mod input;
pub mod math;
pub mod rng;
pub mod scene;
pub mod tally;
pub mod units;
