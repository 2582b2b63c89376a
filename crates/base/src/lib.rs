//! The foundation of all Lumiduct crates: errors with their places, formatting of numbers and
//! texts, unit conversion for output, digests, the mathematics of frames, boxes and roots, and
//! triangle meshes.
//!
//! This crate knows nothing of light and of file formats.

pub mod digest;
pub mod error;
pub mod math;
pub mod mesh;
pub mod number;
pub mod text;
pub mod units;
