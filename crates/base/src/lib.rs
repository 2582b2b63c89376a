//! The foundation of all Lumiduct crates: errors with their places, formatting of numbers and
//! texts, unit conversion for output, digests, the mathematics of frames, boxes and roots, and
//! triangle meshes.
//!
//! This crate knows nothing of light and of file formats.
//!
//! An illuminance, in its unit inside the program and as a report shows it:
//!
//! ```
//! use lumiduct_base::number::format_with_error;
//! use lumiduct_base::units::{FluxUnit, MM2_PER_M2};
//!
//! let (value, std_error) = (0.012_345_6, 0.000_021); // lm/mm²
//! let shown = format_with_error(value * MM2_PER_M2, std_error * MM2_PER_M2);
//! assert_eq!(format!("{shown} {}", FluxUnit::Lumen.illuminance()), "12346 ± 21 lx");
//! ```

pub mod digest;
pub mod error;
pub mod math;
pub mod mesh;
pub mod number;
pub mod text;
pub mod units;
