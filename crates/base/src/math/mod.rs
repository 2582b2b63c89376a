//! Frames, boxes, roots of polynomials and maps from the unit square: the mathematics behind the
//! physics.

mod aabb;
mod cap;
mod frame;
mod least_squares;
mod patches;
pub mod planar;
mod polynomial;
mod ring;
mod roots;
mod sampling;

pub use aabb::Aabb;
pub use cap::projected_cap;
pub use frame::Frame;
pub use least_squares::{least_squares, solve_rows};
pub use patches::{
    DirectionPatches, PatchPairs, RingPatches, common_directions, square_of_disk, turns,
};
pub use polynomial::{Root, SignChange, cubic, quartic};
pub use ring::linear_over_ring;
pub use roots::{bracketed_root, convex_roots, quadratic};
pub use sampling::{
    circle, cone_direction, cosine_hemisphere, cosine_power_hemisphere, disk, from_cosine,
    uniform_sphere,
};

use glam::DVec3;

/// The unit vector along `v`; fast where `v` has unit length up to rounding.
#[inline]
pub fn unit(v: DVec3) -> DVec3 {
    let excess = v.length_squared() - 1.0;
    // 1/sqrt(1 + e) = 1 - e/2 + 3/8 e² - ...
    if excess.abs() < 1e-8 { (1.0 - 0.5 * excess) * v } else { v.normalize() }
}
