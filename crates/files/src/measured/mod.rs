//! Measured maps and intensities from CSV: columns of places and values, the tables and matrices of reports, or a plain matrix of
//! numbers.
//!
//! A reader never trusts a file: whatever it contains, the result is a [`MeasuredMap`] or a [`MeasuredError`] with the line where there is
//! one. Values are not below 0, and NaN where nothing was measured. What they are compared with is not known here.
//!
//! ```
//! use lumiduct_files::measured::{FirstRow, MeasuredValues, parse};
//!
//! let csv = "# width_mm = 4\n# height_mm = 3\n# unit = lx\n812 835 841 829\n790 818 822 807\n771 796 803 788\n";
//! let map = parse(csv.as_bytes())?;
//! assert_eq!(map.unit.map(|own| own.unit).as_deref(), Some("lx"));
//! let MeasuredValues::Matrix(matrix) = map.values else { panic!("numbers alone") };
//! let grid = matrix.centred([4.0, 3.0], FirstRow::Top);
//! assert_eq!(grid.x, [-2.0, -1.0, 0.0, 1.0, 2.0]); // mm
//! assert_eq!(grid.values[[0, 0]], 771.0); // the bottom row
//! # Ok::<(), lumiduct_files::measured::MeasuredError>(())
//! ```

mod cells;
mod data;
mod directions;
mod error;
mod forms;
mod points;
mod table;
mod unit;

pub use data::{
    FirstRow, MeasuredGrid, MeasuredMap, MeasuredValues, PlainMatrix, StatedFirstRow, StatedSize,
    StatedUnit,
};
pub use directions::MeasuredDirections;
pub use error::{MAX_MEASURED_BYTES, MeasuredError};

use crate::bytes::read_file;
use crate::measured::table::TextTable;
use std::path::Path;

/// Reads a file.
///
/// # Errors
///
/// As [`parse`], and [`MeasuredError::Unreadable`] or [`MeasuredError::TooLong`] if the file cannot be read.
pub fn read(path: &Path) -> Result<MeasuredMap, MeasuredError> {
    let bytes = read_file(path, MAX_MEASURED_BYTES)?.ok_or(MeasuredError::TooLong)?;
    parse(&bytes)
}

/// Reads the bytes of a file.
///
/// # Errors
///
/// [`MeasuredError::WrongLine`] if they are no map.
pub fn parse(bytes: &[u8]) -> Result<MeasuredMap, MeasuredError> {
    let text = table::text(bytes)?;
    forms::measured_map(&TextTable::new(text)?)
}

#[cfg(test)]
mod tests;
