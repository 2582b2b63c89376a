//! Reads EULUMDAT files: A. W. Stockmar, EULUMDAT, ein Leuchtendatenformat für den europäischen Beleuchtungsplaner, Licht '90
//! (1990) 641.
//!
//! A line for each field, in a fixed order. Intensities are in cd per 1000 lm of the lamps. The length of the opening lies along
//! the axis from C90 to C270.

use crate::luminaire::data::{LampFlux, Luminaire, Opening, ReadLuminaire};
use crate::luminaire::error::{LuminaireError, MAX_ANGLES};
use crate::luminaire::format::LuminaireFormat;
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use crate::luminaire::text::{number, whole};
use lumiduct_base::number::shorten;

/// Most sets of lamps.
const MOST_SETS: usize = 20;
/// Direct ratios for ten room indices.
const DIRECT_RATIOS: usize = 10;

/// Reads the text of a file.
pub(crate) fn read(text: &str) -> Result<ReadLuminaire, LuminaireError> {
    let mut remarks = Vec::new();
    let mut fields = Fields { lines: text.lines().collect(), next: 0 };
    let mut texts = Vec::new();
    let mut keep = |keyword: &str, text: &str| {
        if !text.trim().is_empty() {
            texts.push((keyword.to_owned(), text.trim().to_owned()));
        }
    };
    keep("MANUFAC", fields.text("the company")?);
    fields.number("the type of luminaire")?;
    let symmetry = fields.count("the symmetry", 0..=4)?;
    let planes = fields.count("the number of C planes", 1..=MAX_ANGLES)?;
    fields.number("the distance of C planes")?;
    let angles = fields.count("the number of angles", 1..=MAX_ANGLES)?;
    fields.number("the distance of angles")?;
    keep("TEST", fields.text("the number of the report")?);
    keep("LUMINAIRE", fields.text("the name of the luminaire")?);
    keep("LUMCAT", fields.text("the number of the luminaire")?);
    fields.text("the name of the file")?;
    keep("ISSUEDATE", fields.text("date and user")?);
    for what in ["length", "width", "height"] {
        fields.number(&format!("the {what} of the luminaire"))?;
    }
    let opening = opening(&mut fields, &mut remarks)?;
    fields.number("the downward flux fraction")?;
    fields.number("the light output ratio")?;
    let conversion = fields.number("the conversion factor")?;
    if fields.number("the tilt during measurement")? != 0.0 {
        remarks.push("the tilt during measurement is left out".to_owned());
    }
    let sets = fields.count("the number of sets of lamps", 1..=MOST_SETS)?;
    if sets > 1 {
        remarks.push(format!("of {sets} sets of lamps the first is used"));
    }
    let (lamps, flux_lm, power_w) = (0..sets)
        .try_fold(None, |first, _| {
            let count = fields.number("the number of lamps")?;
            keep(
                "LAMP",
                fields
                    .text("the type of lamps")
                    .map(|text| if first.is_none() { text } else { "" })?,
            );
            let flux = fields.number("the flux of the lamps")?;
            fields.text("the colour temperature")?;
            fields.text("the colour rendering")?;
            let power = fields.number("the power")?;
            Ok::<_, LuminaireError>(first.or(Some((count, flux, power))))
        })?
        .expect("there is a set");
    (0..DIRECT_RATIOS).try_for_each(|_| fields.number("a direct ratio").map(drop))?;
    let all_deg = fields.list(planes, "a C plane")?;
    let angles_deg = fields.list(angles, "an angle")?;

    let (symmetry, planes_deg) =
        stored(symmetry, &all_deg).map_err(|problem| fields.wrong(problem))?;
    let factor = conversion * flux_lm / 1000.0;
    let mut by_plane: Vec<(f64, Vec<f64>)> = Vec::new();
    for plane in planes_deg {
        let values = fields.list(angles, "an intensity")?;
        by_plane.push((plane, values.iter().map(|value| value * factor).collect()));
    }
    fields.end()?;
    by_plane.sort_by(|a, b| a.0.total_cmp(&b.0));
    let planes_deg = by_plane.iter().map(|(plane, _)| *plane).collect();
    let candela = by_plane.into_iter().flat_map(|(_, values)| values).collect();
    let intensities = Intensities::new(symmetry, planes_deg, angles_deg, candela)?;
    let lamps = match whole(lamps) {
        Some(count) if count < 0 => LampFlux::Absolute,
        Some(count) if count > 0 && flux_lm > 0.0 => {
            LampFlux::Relative { count: count as u32, flux_lm }
        }
        _ => {
            remarks.push(format!(
                "{lamps} lamps of {flux_lm} lm; the photometry is taken as absolute"
            ));
            LampFlux::Absolute
        }
    };
    Ok(ReadLuminaire::new(Luminaire { texts, lamps, power_w, opening, intensities }, remarks))
}

/// The luminous area: round if it has no width.
fn opening(fields: &mut Fields<'_>, remarks: &mut Vec<String>) -> Result<Opening, LuminaireError> {
    let mut sizes = [0.0; 6];
    for size in &mut sizes {
        *size = fields.number("a size of the luminous area")?;
    }
    let [length, width, heights @ ..] = sizes;
    let height = heights.iter().copied().fold(0.0, f64::max);
    if heights.iter().any(|own| *own != height) {
        remarks.push("the heights of the luminous area differ; the largest is used".to_owned());
    }
    let is_round = width == 0.0 && length > 0.0;
    let across = if is_round { length } else { width };
    Ok(Opening { is_round, along_c0_mm: across, along_c90_mm: length, height_mm: height })
}

/// The symmetry, and the planes whose intensities follow, deg, in the order of the file.
fn stored(symmetry: usize, all: &[f64]) -> Result<(PlaneSymmetry, Vec<f64>), String> {
    let count = all.len();
    let part = |parts: usize| -> Result<usize, String> {
        if count.is_multiple_of(parts) {
            Ok(count / parts)
        } else {
            Err(format!("{count} C planes cannot have symmetry {symmetry}"))
        }
    };
    Ok(match symmetry {
        0 => (PlaneSymmetry::None, all.to_vec()),
        1 => (PlaneSymmetry::Rotational, vec![0.0]),
        2 => (PlaneSymmetry::AboutC0, half(all, 0, part(2)?)),
        // From C270 over C0 to C90: mirrored about the plane, from 270 down to 90.
        3 => {
            let planes = half(all, 3 * part(4)?, part(2)?);
            (
                PlaneSymmetry::AboutC90,
                planes.iter().map(|plane| (180.0 - plane).rem_euclid(360.0)).collect(),
            )
        }
        _ => (PlaneSymmetry::Quadrants, half(all, 0, part(4)?)),
    })
}

/// `steps` planes and one more from a place on, around the circle.
fn half(all: &[f64], first: usize, steps: usize) -> Vec<f64> {
    (first..=first + steps).map(|place| all[place % all.len()]).collect()
}

/// The lines of a file, one field after the other.
struct Fields<'t> {
    lines: Vec<&'t str>,
    next: usize,
}

impl<'t> Fields<'t> {
    fn text(&mut self, what: &str) -> Result<&'t str, LuminaireError> {
        let line = self.lines.get(self.next).copied();
        self.next += 1;
        line.ok_or_else(|| self.wrong(format!("the file ends before {what}")))
    }

    fn number(&mut self, what: &str) -> Result<f64, LuminaireError> {
        let text = self.text(what)?;
        number(text).ok_or_else(|| {
            self.wrong(format!("expected {what}, found `{}`", shorten(text.trim(), 30)))
        })
    }

    fn count(
        &mut self,
        what: &str,
        range: std::ops::RangeInclusive<usize>,
    ) -> Result<usize, LuminaireError> {
        let value = self.number(what)?;
        let count = whole(value).and_then(|count| usize::try_from(count).ok());
        let [least, most] = [range.start(), range.end()];
        let wrong = || self.wrong(format!("{what} is {value}, expected {least} to {most}"));
        count.filter(|count| range.contains(count)).ok_or_else(wrong)
    }

    fn list(&mut self, count: usize, what: &str) -> Result<Vec<f64>, LuminaireError> {
        (0..count).map(|_| self.number(what)).collect()
    }

    /// Only blank lines may follow.
    fn end(&mut self) -> Result<(), LuminaireError> {
        let is_rest = |line: &str| !line.trim_matches(['\u{1a}', ' ', '\t', '\0']).is_empty();
        let rest = self.lines.get(self.next..).unwrap_or_default();
        match rest.iter().position(|line| is_rest(line)) {
            None => Ok(()),
            Some(place) => {
                self.next += place + 1;
                Err(self.wrong("something follows the last intensity".to_owned()))
            }
        }
    }

    fn wrong(&self, problem: String) -> LuminaireError {
        LuminaireError::Violated {
            format: LuminaireFormat::Ldt,
            line: self.next.min(self.lines.len()).max(1),
            problem,
        }
    }
}
