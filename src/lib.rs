//! Photometric sensor data for light tubes and light guides.
//!
//! Light reaches the exit of a guide after tens or hundreds of specular bounces. Lumiduct follows it on exact surfaces
//! in f64 and counts it on virtual sensors: flux, efficiency, illuminance maps, uniformity, intensity and luminance,
//! each with an error bar, beside a flux balance that closes.
//!
//! The flow, top to bottom in [`pipeline`]:
//!
//! ```text
//! scene file -> Scene -> paths -> readings -> measures with uncertainty -> report
//! ```
//!
//! Inside, lengths are millimetres, angles radians, solid angles steradians, flux lumens (watts in radiometric runs),
//! wavelengths nanometres. +z of a local frame is the normal; directions are unit vectors. Units of files and reports
//! are part of the names there.

pub mod error;
pub mod formats;
pub mod input;
pub mod math;
pub mod optics;
pub mod report;
pub mod rng;
pub mod scene;
pub mod tally;
pub mod transport;
pub mod units;
