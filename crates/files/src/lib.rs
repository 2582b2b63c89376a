//! Foreign files, read and written. This crate knows no scene and stands alone: it gives the triangle meshes of
//! [`lumiduct_base`].

pub mod mesh;
