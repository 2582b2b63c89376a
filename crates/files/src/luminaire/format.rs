//! Formats of luminaire files.

use std::fmt;

/// File formats of luminaires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LuminaireFormat {
    /// ANSI/IESNA LM-63-2002; when reading, any edition.
    Ies,
    /// ANSI/IES LM-63-2019; when reading, any edition.
    Ies2019,
    /// EULUMDAT.
    Ldt,
    /// ANSI/IES TM-33-18, which is written and not read.
    Tm33,
}

impl LuminaireFormat {
    /// The extension of its file names, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Ies | Self::Ies2019 => "ies",
            Self::Ldt => "ldt",
            Self::Tm33 => "xml",
        }
    }
}

impl fmt::Display for LuminaireFormat {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Ies => "IES",
            Self::Ies2019 => "IES LM-63-2019",
            Self::Ldt => "EULUMDAT",
            Self::Tm33 => "TM-33",
        })
    }
}
