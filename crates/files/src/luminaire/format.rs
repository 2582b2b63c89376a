//! Formats of luminaire files.

use std::fmt;

/// File formats of luminaires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LuminaireFormat {
    /// ANSI/IES LM-63.
    Ies,
    /// EULUMDAT.
    Ldt,
}

impl LuminaireFormat {
    /// The extension of its file names, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Ies => "ies",
            Self::Ldt => "ldt",
        }
    }
}

impl fmt::Display for LuminaireFormat {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Ies => "IES",
            Self::Ldt => "EULUMDAT",
        })
    }
}
