//! A measured file beside what the command line says of it: the size and the first row of a plain matrix, and errors with the name of
//! the file.

use crate::measured::computed::Comparable;
use lumiduct_base::error::Error;
use lumiduct_files::measured::{
    FirstRow, MeasuredError, MeasuredGrid, MeasuredValues, PlainMatrix, StatedFirstRow, StatedSize,
};
use std::path::Path;

/// What the command line says of a plain matrix.
#[derive(Debug, Clone, Copy, Default)]
pub struct MatrixPlace {
    /// Width along u, mm.
    pub width_mm: Option<f64>,
    /// Height along v, mm.
    pub height_mm: Option<f64>,
    /// The side of the first row.
    pub first_row: Option<FirstRow>,
}

/// Refuses a place for values that have their own.
///
/// # Errors
///
/// [`MeasuredError::NoMap`] if there is one.
pub(crate) fn expect_place(
    values: &MeasuredValues,
    place: MatrixPlace,
) -> Result<(), MeasuredError> {
    let is_given = (place.width_mm, place.height_mm, place.first_row) != (None, None, None);
    if is_given && !matches!(values, MeasuredValues::Matrix(_)) {
        return Err(MeasuredError::of_file(
            "the file gives its own places; --width-mm, --height-mm and --rows are for a plain matrix of numbers",
        ));
    }
    Ok(())
}

/// What measured values can be compared with.
pub(crate) fn comparable(values: &MeasuredValues) -> Comparable {
    match values {
        MeasuredValues::Matrix(_) | MeasuredValues::Surface(_) => Comparable::Surfaces,
        MeasuredValues::Image(_) => Comparable::Images,
        MeasuredValues::Sphere(_) | MeasuredValues::Directions(_) => Comparable::Intensities,
    }
}

/// The cells of a plain matrix around zero: the middle is that of the sensor.
///
/// # Errors
///
/// [`MeasuredError`] if its size is not known, or file and command line differ.
pub(crate) fn placed(
    matrix: PlainMatrix,
    place: MatrixPlace,
) -> Result<MeasuredGrid, MeasuredError> {
    let size = |key: &str, own: Option<StatedSize>, option: Option<f64>| {
        let flag = format!("--{}", key.replace('_', "-"));
        match (own, option) {
            (Some(StatedSize { size_mm, line }), Some(option)) if size_mm != option => {
                let why = format!("{key} is {size_mm} here, but {option} in {flag}");
                Err(MeasuredError::of_line(line, why))
            }
            (Some(StatedSize { size_mm, .. }), _) => Ok(size_mm),
            (None, Some(option)) => Ok(option),
            (None, None) => Err(MeasuredError::of_file(format!(
                "a matrix of numbers without its size; add the line `# {key} = ...`, or use {flag}"
            ))),
        }
    };
    let width = size("width_mm", matrix.width, place.width_mm)?;
    let height = size("height_mm", matrix.height, place.height_mm)?;
    let first_row = match (matrix.first_row, place.first_row) {
        (Some(StatedFirstRow { side, line }), Some(option)) if side != option => {
            return Err(MeasuredError::of_line(
                line,
                "`# rows = ...` of the file and --rows differ",
            ));
        }
        (Some(StatedFirstRow { side, .. }), _) => side,
        (None, option) => option.unwrap_or(FirstRow::Top),
    };
    Ok(matrix.centred([width, height], first_row))
}

/// An error with the file, and its line where there is one.
pub(crate) fn refused(file: &Path, error: MeasuredError) -> Error {
    let file = file.display();
    Error::Usage(match error {
        MeasuredError::WrongLine { line, problem } => format!("{file}:{line}: {problem}"),
        error @ (MeasuredError::Unreadable(_)
        | MeasuredError::TooLong
        | MeasuredError::NoMap(_)) => format!("{file}: {error}"),
    })
}
