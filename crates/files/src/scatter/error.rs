//! Formats and errors of scatter files.

use std::fmt;
use std::path::Path;

/// Longest file that is read, bytes.
pub const MAX_SCATTER_BYTES: u64 = 256 << 20;

/// A format of scatter files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScatterFormat {
    /// XML of Radiance genBSDF and LBNL WINDOW.
    Xml,
    /// CSV by polar angles and azimuth.
    Csv,
}

impl ScatterFormat {
    /// The format of a file name extension.
    ///
    /// # Errors
    ///
    /// [`ScatterError::UnknownScatter`] for an extension that is neither `xml` nor `csv`.
    pub fn of(path: &Path) -> Result<Self, ScatterError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "xml" => Ok(Self::Xml),
            "csv" => Ok(Self::Csv),
            _ => Err(ScatterError::UnknownScatter { ending }),
        }
    }
}

impl fmt::Display for ScatterFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Xml => "BSDF XML",
            Self::Csv => "scatter CSV",
        })
    }
}

/// Why a scatter file could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ScatterError {
    /// The operating system refuses the file.
    #[error("the file cannot be read: {0}; check the name and the permissions")]
    Unreadable(#[from] std::io::Error),
    /// The file name extension is not one of a scatter format.
    #[error("`.{ending}` is not the ending of a known scatter format; use .xml or .csv")]
    UnknownScatter {
        /// The extension, without its dot.
        ending: String,
    },
    /// The file is longer than [`MAX_SCATTER_BYTES`].
    #[error("the file has more than {} MiB", MAX_SCATTER_BYTES >> 20)]
    TooLong,
    /// The file violates its format.
    #[error("not a usable {format} file: line {line}: {problem}")]
    Violated {
        /// The format.
        format: ScatterFormat,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
}

/// What is wrong with a text.
#[derive(Debug)]
pub(super) struct Violation {
    /// The line, from 1.
    pub(super) line: usize,
    pub(super) problem: String,
}

impl Violation {
    pub(super) fn new(line: usize, problem: impl Into<String>) -> Self {
        Self { line, problem: problem.into() }
    }
}

/// A value of a distribution function.
pub(super) fn value(word: &str, line: usize) -> Result<f64, Violation> {
    /// Far more than any sheet has: all light within 1e-12 sr.
    const MOST: f64 = 1e12;
    match word.parse::<f64>() {
        Ok(value) if value < 0.0 => Err(Violation::new(line, format!("{word} is negative"))),
        Ok(value) if value <= MOST => Ok(value),
        Ok(_) => Err(Violation::new(line, format!("{word} is not a usable value in 1/sr"))),
        Err(_) => Err(Violation::new(line, format!("`{word}` is not a number"))),
    }
}
