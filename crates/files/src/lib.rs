//! Reads foreign file formats. This crate knows no scenes; it gives the triangle meshes of
//! [`lumiduct_base`].

pub mod mesh;
