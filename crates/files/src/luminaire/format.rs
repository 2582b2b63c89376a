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

impl fmt::Display for LuminaireFormat {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Ies => "IES",
            Self::Ldt => "EULUMDAT",
        })
    }
}
