//! Where a ray crosses surfaces: which it may meet, and what it enters and leaves there.

pub(crate) mod accel;
pub(crate) mod convex;
pub(crate) mod hit;
pub(crate) mod inside;
pub(crate) mod on;
pub(crate) mod tree;
