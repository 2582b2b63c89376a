//! Writes ANSI/IESNA LM-63-2002 and ANSI/IES LM-63-2019, which differ in the first line and in the number after the ballast factor.

use crate::luminaire::data::{LampFlux, Luminaire, LuminaireColour, WrittenLuminaire};
use crate::luminaire::intensities::PlaneSymmetry;
use crate::luminaire::text::{KEYWORD, beyond_ascii, one_line, seven_digits};
use std::fmt::Write;

/// Keywords that every file must have (LM-63-2002, 5.3).
const REQUIRED: [&str; 4] = ["TEST", "TESTLAB", "ISSUEDATE", "MANUFAC"];
/// Most letters of a line.
const LINE: usize = 120;
/// Most letters of the text after a keyword: a line has up to 256 (LM-63-2002, 5.1).
const TEXT: usize = 220;

/// An edition that is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WrittenEdition {
    /// LM-63-2002.
    Of2002,
    /// LM-63-2019.
    Of2019,
}

/// The file.
pub(crate) fn write(luminaire: &Luminaire, edition: WrittenEdition) -> WrittenLuminaire {
    let Luminaire { generation, lamps, power_w, opening, intensities, .. } = luminaire;
    let (head, second) = match edition {
        WrittenEdition::Of2002 => ("IESNA:LM-63-2002", "1".to_owned()),
        WrittenEdition::Of2019 => ("IES:LM-63-2019", generation.number()),
    };
    let mut out = format!("{head}\r\n{}TILT=NONE\r\n", keywords(luminaire));
    let (count, flux) = match *lamps {
        LampFlux::Absolute => (1, "-1".to_owned()),
        LampFlux::Relative { count, flux_lm } => {
            let count = count.max(1);
            (count, seven_digits(flux_lm / f64::from(count)))
        }
    };
    let mut planes: Vec<usize> = (0..intensities.planes_deg().len()).collect();
    let mut planes_deg = intensities.planes_deg().to_vec();
    if intensities.symmetry() == PlaneSymmetry::None {
        planes.push(0);
        planes_deg.push(360.0);
    }
    // Negative sizes are diameters (LM-63-2002, table 1).
    let sign = if opening.is_round { -1.0 } else { 1.0 };
    let [width, length] =
        [opening.along_c90_mm, opening.along_c0_mm].map(|size| sign * size / 1000.0);
    let sizes = [width, length, opening.height_mm / 1000.0].map(seven_digits).join(" ");
    let (angles, numbers) = (intensities.angles_deg().len(), planes.len());
    _ = write!(out, "{count} {flux} 1 {angles} {numbers} 1 2 {sizes}\r\n");
    _ = write!(out, "1 {second} {}\r\n", seven_digits(*power_w));
    let mut list = |values: &[f64]| {
        let mut line = String::new();
        for word in values.iter().map(|value| seven_digits(*value)) {
            if !line.is_empty() && line.len() + 1 + word.len() > LINE {
                _ = write!(out, "{line}\r\n");
                line.clear();
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line += &word;
        }
        _ = write!(out, "{line}\r\n");
    };
    list(intensities.angles_deg());
    list(&planes_deg);
    planes.iter().for_each(|place| list(intensities.plane(*place)));
    let remarks = beyond_ascii(&out, "LM-63 knows ASCII only").into_iter().collect();
    WrittenLuminaire { text: out, remarks }
}

/// The lines of keywords.
fn keywords(luminaire: &Luminaire) -> String {
    let mut out = String::new();
    // A keyword without a text says that it is not known.
    for keyword in REQUIRED.iter().filter(|keyword| luminaire.text(keyword).is_none()) {
        _ = write!(out, "[{keyword}]\r\n");
    }
    let LuminaireColour { temperature, rendering } = &luminaire.colour;
    let colour = [("colour temperature", temperature), ("colour rendering", rendering)];
    let colour = colour.into_iter().filter(|(_, words)| !words.is_empty());
    let colour = colour.map(|(what, words)| ("OTHER".to_owned(), format!("{what}: {words}")));
    for (keyword, text) in luminaire.texts.iter().cloned().chain(colour) {
        let mut keyword = one_line(&keyword, KEYWORD);
        for part in text.split('\n').flat_map(parts) {
            _ = write!(out, "[{keyword}] {}\r\n", one_line(&part, TEXT));
            keyword = "MORE".to_owned();
        }
    }
    out
}

/// A text in parts that fit into a line; one part for an empty text.
fn parts(text: &str) -> Vec<String> {
    let letters: Vec<char> = text.chars().collect();
    let parts = letters.chunks(TEXT).map(|part| part.iter().collect());
    if letters.is_empty() { vec![String::new()] } else { parts.collect() }
}
