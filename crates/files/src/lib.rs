//! Reads and writes foreign file formats: triangle [`mesh`]es, as those of [`lumiduct_base`], the luminous
//! intensities of [`luminaire`]s, the [`rays`] of light sources, the [`scatter`] of sheets, [`measured`] maps, [`spectral`] tables, and drawings for [`cutting`]. This crate
//! knows no scenes.
//!
//! Readers never trust a file: whatever it contains, the result is data or an error, and what they assume is a remark. Each module has an
//! example; the programs in `examples/` convert luminaires, draw rays of a file, and describe the scatter of a sheet.
//!
//! A tetrahedron in centimetres, read as a closed mesh in millimetres:
//!
//! ```
//! use lumiduct_files::mesh::{LengthUnit, read};
//!
//! let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n\
//!            usemtl wall\nf 1 3 2\nf 1 2 4\nf 1 4 3\nusemtl exit\nf 2 3 4\n";
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("corner.obj");
//! std::fs::write(&path, obj)?;
//!
//! let mesh = read(&path, LengthUnit::Centimetre)?;
//! assert!(mesh.health().is_sound());
//! assert!(mesh.faces().keys().eq(&["wall", "exit"]));
//! assert_eq!(mesh.bounds().max.to_array(), [10.0, 10.0, 10.0]); // mm
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bytes;
pub mod cutting;
pub mod luminaire;
pub mod measured;
pub mod mesh;
pub mod rays;
pub mod scatter;
pub mod spectral;

/// The examples of the README, which are compiled with those of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
