//! Frames, boxes, roots of polynomials and maps from the unit square: the mathematics that the physics stands on.

mod aabb;
mod frame;
pub mod planar;
mod roots;
mod sampling;

pub use aabb::Aabb;
pub use frame::Frame;
pub use roots::{Roots, bracketed_root, convex_roots, cubic, quadratic, quartic};
pub use sampling::{
    cone_direction, cosine_hemisphere, cosine_power_hemisphere, disk, uniform_sphere,
};
