//! What all crates of Lumiduct stand on: errors with their places, numbers and texts as people read them, units at the
//! border, digests, the mathematics of frames, boxes and roots, and triangle meshes.
//!
//! This crate knows no light and no file format.

pub mod digest;
pub mod error;
pub mod math;
pub mod mesh;
pub mod number;
pub mod text;
pub mod units;
