//! What a ray meets next: the nearest surfaces, and the one interface that they make.

pub(crate) mod interface;
pub(crate) mod intersect;
pub(crate) mod pieces;
