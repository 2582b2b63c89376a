//! Scatter of sheets from files: the XML of Radiance and WINDOW, over Klems patches or as a tensor tree, and CSV by angles.
//!
//! Readers never trust a file: whatever it contains, the result is a [`ScatterFile`] or a [`ScatterError`]. What they assume is a
//! remark. Values are distribution functions, 1/sr, that are constant over pairs of patches ([`PatchPairs`]): the share of flux that
//! leaves into a patch is the value times the projected solid angle of the patch. Whether they conserve energy is not checked here.
//!
//! A diffuser that transmits 0.2/sr in every direction, which is the share 0.2 π of the light:
//!
//! ```
//! use lumiduct_files::scatter::{ScatterFormat, parse};
//! use std::f64::consts::PI;
//!
//! let csv = "theta_i_deg,theta_s_deg,phi_s_deg,btdf_per_sr\n0,0,0,0.2\n";
//! let sheet = parse(csv.as_bytes(), ScatterFormat::Csv)?;
//! let matrix = sheet.front.transmission.ok_or("no transmission")?;
//! let [_, leaving] = matrix.pairs.counts();
//! // Light of the first patch of arriving light.
//! let values = matrix.values[..leaving].iter().zip(0..);
//! let share: f64 = values.map(|(value, to)| value * matrix.pairs.leaving_projected(to)).sum();
//! assert!((share - 0.2 * PI).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`PatchPairs`]: lumiduct_base::math::PatchPairs

mod angles;
mod basis;
mod coverage;
mod csv;
mod data;
mod error;
mod tree;
mod xml;
mod xml_shape;

pub use data::{BsdfMatrix, ScatterFile, ScatterSide};
pub use error::{MAX_SCATTER_BYTES, ScatterError, ScatterFormat};

use crate::bytes::{NOT_UTF8, read_file, utf8};
use crate::scatter::error::Violation;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;

/// Length of the head of a CSV file in which its columns are looked for, bytes.
const HEAD_BYTES: u64 = 1 << 16;

/// Whether a CSV file begins as one of scatter does: in the first line that is neither empty nor a comment, a column has an angle of
/// incidence.
pub fn is_scatter_table(path: &Path) -> bool {
    // A pipe may never end.
    if !path.is_file() {
        return false;
    }
    let mut start = Vec::new();
    let read = File::open(path).map(|file| file.take(HEAD_BYTES).read_to_end(&mut start));
    read.is_ok() && csv::has_angles(&String::from_utf8_lossy(&start))
}

/// Reads a file; its name extension gives the format.
///
/// # Errors
///
/// [`ScatterError::UnknownScatter`] for an extension that is neither `xml` nor `csv`; otherwise as [`parse`], and
/// [`ScatterError::Unreadable`] or [`ScatterError::TooLong`] if the file cannot be read.
pub fn read(path: &Path) -> Result<ScatterFile, ScatterError> {
    let format = ScatterFormat::of(path)?;
    let bytes = read_file(path, MAX_SCATTER_BYTES)?.ok_or(ScatterError::TooLong)?;
    parse(&bytes, format)
}

/// Reads the bytes of a file.
///
/// # Errors
///
/// [`ScatterError::Violated`] with the line if they violate the format.
pub fn parse(bytes: &[u8], format: ScatterFormat) -> Result<ScatterFile, ScatterError> {
    let wrong = |line, problem: String| ScatterError::Violated { format, line, problem };
    let text = utf8(bytes).map_err(|line| wrong(line, NOT_UTF8.to_owned()))?;
    let read = match format {
        ScatterFormat::Xml => xml::read(text),
        ScatterFormat::Csv => csv::read(text),
    };
    read.map_err(|Violation { line, problem }| wrong(line, problem))
}

#[cfg(test)]
mod tests;
