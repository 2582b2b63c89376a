//! Luminance of a lamp on a plane, fitted to its rays.
//!
//! Position and direction are a point of a unit cube of four dimensions in which volume is proportional to etendue: x and y over a rectangle,
//! the square of the sine of the angle to the normal, and the azimuth. Density of flux in the cube is proportional to luminance. It is the mean of several
//! trees, each constant in its leaves, which smooths their borders (bagging: L. Breiman, Machine Learning 24 (1996) 123). Directions within 0.1°
//! of the normal are not distinguished.

mod fit;
mod light;
mod split;
mod tree;
mod waist;

pub use fit::NoFit;
pub use light::{FitQuality, FittedLight};

#[cfg(test)]
mod tests;
