//! Formats of luminaire files.

use crate::luminaire::error::LuminaireError;
use std::fmt;
use std::path::Path;

/// File formats of luminaires.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LuminaireFormat {
    /// ANSI/IES LM-63.
    Ies,
    /// EULUMDAT.
    Ldt,
}

impl LuminaireFormat {
    /// The format of a file name extension.
    ///
    /// # Errors
    ///
    /// [`LuminaireError::UnknownLuminaire`] for an extension that is neither `ies` nor `ldt`.
    pub fn of(path: &Path) -> Result<Self, LuminaireError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "ies" => Ok(Self::Ies),
            "ldt" => Ok(Self::Ldt),
            _ => Err(LuminaireError::UnknownLuminaire { ending }),
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
