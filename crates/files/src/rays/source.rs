//! Where rays are read from, and what is found before them.

use crate::rays::data::RaySetInfo;
use std::fmt::Debug;
use std::io::{Read, Seek};

/// A file, or bytes in memory.
pub(crate) trait RaySource: Read + Seek + Debug {}

impl<T: Read + Seek + Debug> RaySource for T {}

/// What a format finds before its rays, and the rays.
pub(crate) struct Opened<Rays> {
    pub(crate) info: RaySetInfo,
    pub(crate) remarks: Vec<String>,
    pub(crate) rays: Rays,
}
