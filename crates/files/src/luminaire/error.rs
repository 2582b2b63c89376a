//! Errors of luminaire files, and limits of their size.

use crate::luminaire::format::LuminaireFormat;

/// Longest file that is read, bytes.
pub const MAX_LUMINAIRE_BYTES: u64 = 16 << 20;
/// Most planes, and most angles in a plane, of a file.
pub const MAX_ANGLES: usize = 4096;
/// Most intensities of a file.
pub(crate) const MOST_NODES: usize = 1 << 20;
/// Largest intensity, cd: far beyond any lamp.
pub(crate) const MOST_CANDELA: f64 = 1e15;
/// Largest flux of lamps, lm: no less than what intensities may make.
pub(crate) const MOST_LUMENS: f64 = 1e17;
/// Most lamps.
pub(crate) const MOST_LAMPS: usize = 10_000;
/// Largest factor of intensities, 1.
pub(crate) const MOST_FACTOR: f64 = 1e12;
/// Largest size of an opening, mm.
pub(crate) const MOST_SIZE: f64 = 1e7;

/// Why a luminaire file could not be read, or a luminaire not be written.
#[derive(Debug, thiserror::Error)]
pub enum LuminaireError {
    /// The operating system refuses the file.
    #[error("the file cannot be read: {0}; check the name and the permissions")]
    Unreadable(#[from] std::io::Error),
    /// The file name extension is not one of a luminaire format.
    #[error(
        "`.{ending}` is not the ending of a known luminaire format; use .ies or .ldt, or, to write TM-33, .xml"
    )]
    UnknownLuminaire {
        /// The extension, without its dot.
        ending: String,
    },
    /// The format is written only.
    #[error("{format} files are only written; luminaires are read from .ies and .ldt")]
    WrittenOnly {
        /// The format.
        format: LuminaireFormat,
    },
    /// The file is longer than [`MAX_LUMINAIRE_BYTES`].
    #[error("the file has more than {} MiB, which no luminaire needs", MAX_LUMINAIRE_BYTES >> 20)]
    TooLong,
    /// The file violates its format.
    #[error("not a usable {format} file: line {line}: {problem}")]
    Violated {
        /// The format.
        format: LuminaireFormat,
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// The angles or values make no distribution.
    #[error("no usable distribution: {0}")]
    NoDistribution(String),
}

impl LuminaireError {
    /// The same with the line where the table of the file begins, from 1, if it has none.
    pub(crate) fn at_table(self, format: LuminaireFormat, line: usize) -> Self {
        if let Self::NoDistribution(_) = self {
            Self::Violated { format, line, problem: self.to_string() }
        } else {
            self
        }
    }
}
