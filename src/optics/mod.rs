//! What interfaces and media do to light: pure physics of one place, in a frame of its own.
//!
//! This layer knows no scene, no path and no sensor. Media and finishes are asked at a wavelength, so that dispersion
//! needs no other interface.

mod bsdf;
pub mod fresnel;
mod gaussian;
mod medium;

pub use bsdf::{Bsdf, Incidence, Lobe, Scattered, Side};
pub use gaussian::Gaussian;
pub use medium::Medium;
