//! Luminaires and lamps from files and to files: ANSI/IES LM-63 (.ies) and EULUMDAT (.ldt); and to ANSI/IES TM-33 (.xml).
//!
//! Readers never trust a file: whatever it contains, the result is a luminaire or a [`LuminaireError`]. What they assume about
//! the light is a remark. Angles C and γ are the same in both formats, and tables of goniometer types A and B become tables over
//! them; but the length of an opening lies along C0 in the first and along C90 in the second, so [`Opening`] names its axes.
//!
//! A lamp with 100 cd in every direction, from LM-63 to EULUMDAT:
//!
//! ```
//! use lumiduct_files::luminaire::{LuminaireFormat, parse, written};
//! use std::f64::consts::PI;
//!
//! let ies = "IESNA:LM-63-2002\n[MANUFAC] A maker\nTILT=NONE\n1 -1 1 3 1 1 2 -0.1 -0.1 0\n1 1 12.5\n\
//!            0 90 180\n0\n100 100 100\n";
//! let lamp = parse(ies.as_bytes(), LuminaireFormat::Ies)?.luminaire;
//! assert_eq!(lamp.intensities.at(77.0, 15.0), 100.0); // cd
//! assert!((lamp.intensities.flux() - 400.0 * PI).abs() < 1e-9); // lm
//!
//! let ldt = written(&lamp, LuminaireFormat::Ldt).text;
//! let again = parse(ldt.as_bytes(), LuminaireFormat::Ldt)?.luminaire;
//! assert!((again.intensities.flux() / (400.0 * PI) - 1.0).abs() < 1e-7);
//! assert_eq!((again.power_w, again.text("MANUFAC")), (12.5, Some("A maker")));
//! # Ok::<(), lumiduct_files::luminaire::LuminaireError>(())
//! ```

mod asymmetry;
mod data;
mod date;
mod error;
mod fields;
mod fit;
mod format;
mod from_ies;
mod from_ldt;
mod front_table;
mod generation;
mod ies_edition;
mod ies_words;
mod intensities;
mod photometric_type;
mod text;
mod to_ies;
mod to_ldt;
mod to_tm33;
mod type_a;
mod type_b;
mod xml_text;

pub use asymmetry::asymmetry;
pub use data::{LampFlux, Luminaire, LuminaireColour, Opening, ReadLuminaire, WrittenLuminaire};
pub use error::{LuminaireError, MAX_ANGLES, MAX_LUMINAIRE_BYTES};
pub use fit::{CellMeans, FittedIntensities, Misfit, TableLayout, fit};
pub use format::LuminaireFormat;
pub use generation::FileGeneration;
pub use intensities::{Intensities, PlaneSymmetry};
pub use text::is_keyword;

use crate::bytes::read_file;
use crate::luminaire::text::decoded;
use crate::luminaire::to_ies::WrittenEdition;
use crate::luminaire::to_ldt::FIELDS_OF_LDT;
use std::path::Path;

impl LuminaireFormat {
    /// The format of a file name extension: of those with the same one, the most common.
    ///
    /// # Errors
    ///
    /// [`LuminaireError::UnknownLuminaire`] for an extension other than `ies`, `ldt` and `xml`.
    pub fn of(path: &Path) -> Result<Self, LuminaireError> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let known =
            [Self::Ies, Self::Ldt, Self::Tm33].into_iter().find(|format| format.ending() == ending);
        known.ok_or(LuminaireError::UnknownLuminaire { ending })
    }

    /// Keywords of a luminaire whose texts a file in this format leaves out, each once.
    pub fn keywords_left_out(self, luminaire: &Luminaire) -> Vec<&str> {
        match self {
            // TM-33 has comments for those without a field.
            Self::Ies | Self::Ies2019 | Self::Tm33 => Vec::new(),
            Self::Ldt => {
                let keywords = luminaire.texts.iter().map(|(keyword, _)| keyword.as_str());
                let mut others: Vec<&str> =
                    keywords.filter(|keyword| !FIELDS_OF_LDT.contains(keyword)).collect();
                others.sort_unstable();
                others.dedup();
                others
            }
        }
    }
}

/// Reads a luminaire; the file name extension gives the format.
///
/// # Errors
///
/// As [`LuminaireFormat::of`] and [`parse`]; [`LuminaireError::Unreadable`] or [`LuminaireError::TooLong`] if the file cannot be
/// read.
pub fn read(path: &Path) -> Result<ReadLuminaire, LuminaireError> {
    let format = LuminaireFormat::of(path)?;
    let bytes = read_file(path, MAX_LUMINAIRE_BYTES)?.ok_or(LuminaireError::TooLong)?;
    parse(&bytes, format)
}

/// Reads the bytes of a file.
///
/// # Errors
///
/// [`LuminaireError::Violated`] with the line if they violate the format, or with the line of the first intensity if their angles
/// or values make no distribution; [`LuminaireError::WrittenOnly`] for a format that is not read.
pub fn parse(bytes: &[u8], format: LuminaireFormat) -> Result<ReadLuminaire, LuminaireError> {
    let text = decoded(bytes);
    match format {
        LuminaireFormat::Ies | LuminaireFormat::Ies2019 => from_ies::read(&text),
        LuminaireFormat::Ldt => from_ldt::read(&text),
        LuminaireFormat::Tm33 => Err(LuminaireError::WrittenOnly { format }),
    }
}

/// A file, LM-63-2002, LM-63-2019, EULUMDAT or TM-33-18, with seven digits.
pub fn written(luminaire: &Luminaire, format: LuminaireFormat) -> WrittenLuminaire {
    match format {
        LuminaireFormat::Ies => to_ies::write(luminaire, WrittenEdition::Of2002),
        LuminaireFormat::Ies2019 => to_ies::write(luminaire, WrittenEdition::Of2019),
        LuminaireFormat::Ldt => to_ldt::write(luminaire),
        LuminaireFormat::Tm33 => to_tm33::write(luminaire),
    }
}

#[cfg(test)]
mod tests;
