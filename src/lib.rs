//! Photometric sensor data for light tubes and light guides.
pub mod error;
pub mod formats;
pub mod math;
pub mod optics;
pub mod rng;
pub mod scene;
pub mod tally;
pub mod transport;
pub mod units;
