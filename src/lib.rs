//! Photometric sensor data for light tubes and light guides.
pub mod error;
pub mod math;
pub mod report;
pub mod rng;
pub mod scene;
pub mod tally;
pub mod units;
