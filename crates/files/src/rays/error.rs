//! Errors of ray files.

use crate::rays::format::RayFormat;
use std::io;

/// Why a ray file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum RayFileError {
    /// The operating system refuses the file.
    #[error("the file cannot be read or written: {0}; check the name and the permissions")]
    Unreadable(#[from] io::Error),
    /// The file name extension is not one of a ray file.
    #[error("`.{ending}` is not the ending of a known ray file; use .tm25ray, .dat, .sdf or .csv")]
    UnknownRays {
        /// The extension, without its dot.
        ending: String,
    },
    /// The file violates its format.
    #[error("not a usable {format} file: {place}: {problem}")]
    Violated {
        /// The format.
        format: RayFormat,
        /// A line, a byte or a ray.
        place: String,
        /// What is wrong.
        problem: String,
    },
    /// All rays together have no flux.
    #[error("its rays have no flux")]
    NoLight,
    /// The format cannot hold the rays.
    #[error("a file of the format {format} cannot hold this: {problem}")]
    NotWritten {
        /// The format.
        format: RayFormat,
        /// What is too much for it.
        problem: String,
    },
}

impl RayFileError {
    /// A violation at a byte.
    pub(crate) fn at_byte(format: RayFormat, byte: u64, problem: impl Into<String>) -> Self {
        Self::Violated { format, place: format!("byte {byte}"), problem: problem.into() }
    }
}
