//! Foreign files, read and written; this layer knows no scene.

pub mod mesh;
