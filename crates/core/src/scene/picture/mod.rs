//! What pictures show of a scene: its faces as triangles, cuts through it, and the guides in it.

pub(crate) mod facets;
pub(crate) mod guide;
pub(crate) mod section;
