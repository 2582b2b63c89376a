//! Rays of light sources from files and to files: IES TM-25 (.tm25ray), source files of OpticStudio (.dat, .sdf) and CSV.
//!
//! Files are streamed: one longer than the memory can be [read](RayReader), [sampled](sample) and [written](write()). Readers never trust
//! a file: every ray is checked, and whatever a file contains, the result is rays or a [`RayFileError`] that names the place.
//!
//! ```
//! use lumiduct_base::units::FluxUnit;
//! use lumiduct_files::rays::{FileRay, RayFormat, RayReader, RaySetInfo, write};
//!
//! let ray = FileRay { position_mm: [1.0, 0.0, 0.5], direction: [0.0, 0.6, 0.8], flux: 2.5 };
//! let info = RaySetInfo { count: 2, unit: FluxUnit::Lumen, flux: 5.0, luminous_flux_lm: None, is_measured: false, texts: Vec::new() };
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("led.tm25ray");
//! write(&mut std::fs::File::create(&path)?, RayFormat::of(&path)?, &info, [Ok(ray), Ok(ray)])?;
//!
//! let reader = RayReader::open(&path)?;
//! assert_eq!(reader.info().flux, 5.0); // lm
//! for found in reader {
//!     assert_eq!(found?, ray);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod data;
mod error;
mod format;
mod lines;
mod reader;
mod records;
mod sampling;
mod source;
mod table;
mod tm25;
mod writer;
mod zemax;
mod zemax_text;

pub use data::{FileRay, RaySetInfo, RayText};
pub use error::RayFileError;
pub use format::RayFormat;
pub use reader::RayReader;
pub use sampling::{RaySample, sample};
pub use writer::write;

use std::path::Path;

impl RayFormat {
    /// The format of a file name extension.
    ///
    /// # Errors
    ///
    /// [`RayFileError::UnknownRays`] for an extension that is none of `tm25ray`, `dat`, `sdf` and `csv`.
    pub fn of(path: &Path) -> Result<Self, RayFileError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "tm25ray" => Ok(Self::Tm25),
            "dat" | "sdf" => Ok(Self::Zemax),
            "csv" => Ok(Self::Csv),
            _ => Err(RayFileError::UnknownRays { ending }),
        }
    }
}

#[cfg(test)]
mod tests;
