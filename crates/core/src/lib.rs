//! The physics of Lumiduct, independent of any file format: light goes in, numbers with error bars
//! come out.
//!
//! ```text
//! Scene -> Run -> Findings (Readings of each estimator) -> Estimate -> Measures with errors
//! ```
//!
//! Lengths are millimetres, angles radians, solid angles steradians, flux lumens (watts in radiometric runs), wavelengths
//! nanometres. +z of a local frame is the normal; directions are unit vectors. Layers from the bottom up: [`rng`],
//! [`tally`] and [`plan`]; [`optics`]; [`scene`]; [`transport`]; [`measure`].

pub mod measure;
pub mod optics;
pub mod plan;
pub mod rng;
pub mod scene;
pub mod tally;
pub mod transport;
