//! The formats of ray files.

use std::fmt;

/// A format of ray files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayFormat {
    /// IES TM-25.
    Tm25,
    /// Source file of OpticStudio, binary or text.
    Zemax,
    /// A table with one ray a line.
    Csv,
}

impl RayFormat {
    /// The usual extension of its file names, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Tm25 => "tm25ray",
            Self::Zemax => "sdf",
            Self::Csv => "csv",
        }
    }
}

impl fmt::Display for RayFormat {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Tm25 => "IES TM-25",
            Self::Zemax => "OpticStudio source",
            Self::Csv => "CSV ray",
        })
    }
}
