//! Reads EULUMDAT files: A. W. Stockmar, EULUMDAT, ein Leuchtendatenformat für den europäischen Beleuchtungsplaner, Licht '90
//! (1990) 641.
//!
//! A line for each field, in a fixed order. Intensities are in cd per 1000 lm of the lamps. The length of the opening lies along
//! the axis from C90 to C270.

use crate::luminaire::data::{
    LampFlux, Luminaire, LuminaireColour, Opening, ReadLuminaire, known_power, pole_remarks,
};
use crate::luminaire::error::{
    LuminaireError, MAX_ANGLES, MOST_FACTOR, MOST_LUMENS, MOST_NODES, MOST_SIZE,
};
use crate::luminaire::fields::NumberReader;
use crate::luminaire::format::LuminaireFormat;
use crate::luminaire::generation::FileGeneration;
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use crate::luminaire::text::{number, whole};
use lumiduct_base::number::shorten;

/// Most sets of lamps.
const MOST_SETS: usize = 20;
/// Difference of angles that is no more than rounding, deg.
const ROUNDING: f64 = 1e-3;
/// Relative difference of light output ratios that interpolation explains, 1.
const SAME_RATIO: f64 = 0.05;
/// Largest share that rounding explains, %.
const MOST_PERCENT: f64 = 100.5;
/// Types of luminaire: point with symmetry about the vertical axis, linear, other point; 0 if it is left out.
const LUMINAIRE_TYPES: [f64; 4] = [0.0, 1.0, 2.0, 3.0];
/// Direct ratios for ten room indices.
const DIRECT_RATIOS: usize = 10;

/// Reads the text of a file.
pub(crate) fn read(text: &str) -> Result<ReadLuminaire, LuminaireError> {
    let mut remarks = Vec::new();
    let mut fields = Fields { lines: text.lines().collect(), place: 0 };
    let mut texts = Vec::new();
    let mut keep = |keyword: &str, text: &str| {
        if !text.trim().is_empty() {
            texts.push((keyword.to_owned(), text.trim().to_owned()));
        }
    };
    keep("MANUFAC", fields.text("the company")?);
    let kind = fields.optional("the type of luminaire")?;
    if !LUMINAIRE_TYPES.contains(&kind) {
        remarks.push(format!("the type of luminaire is {kind}, expected 1 to 3; it is not used"));
    }
    let symmetry = fields.count("the symmetry", 0..=4)?;
    let planes = fields.count("the number of C planes", 1..=MAX_ANGLES)?;
    let plane_step = fields.optional("the distance of C planes")?;
    let angles = fields.count("the number of angles", 1..=MAX_ANGLES)?;
    let angle_step = fields.optional("the distance of angles")?;
    keep("TEST", fields.text("the number of the report")?);
    keep("LUMINAIRE", fields.text("the name of the luminaire")?);
    keep("LUMCAT", fields.text("the number of the luminaire")?);
    fields.text("the name of the file")?;
    keep("ISSUEDATE", fields.text("date and user")?);
    for what in ["length", "width", "height"] {
        fields.optional(&format!("the {what} of the luminaire"))?;
    }
    let opening = opening(&mut fields, &mut remarks)?;
    let downward = fields.optional("the downward flux fraction")?;
    if !(0.0..=MOST_PERCENT).contains(&downward) {
        return Err(fields
            .wrong(format!("the downward flux fraction is {downward} %, expected 0 to 100 %")));
    }
    let stated_ratio = fields.optional("the light output ratio")? / 100.0;
    let conversion = fields.positive("the conversion factor", MOST_FACTOR)?;
    if fields.optional("the tilt during measurement")? != 0.0 {
        remarks.push("the tilt during measurement is left out".to_owned());
    }
    let sets = fields.count("the number of sets of lamps", 1..=MOST_SETS)?;
    if sets > 1 {
        remarks.push(format!("of {sets} sets of lamps the first is used"));
    }
    let LampSet { count, kind, flux_lm, power_w, colour } = fields.lamp_set()?;
    (1..sets).try_for_each(|_| fields.lamp_set().map(drop))?;
    keep("LAMP", kind);
    (0..DIRECT_RATIOS).try_for_each(|_| fields.optional("a direct ratio").map(drop))?;
    let all_deg = fields.angles(planes, "a C plane")?;
    let angles_deg = fields.angles(angles, "an angle")?;
    remark_on_steps("planes", (plane_step, &all_deg), &mut remarks);
    remark_on_steps("angles", (angle_step, &angles_deg), &mut remarks);
    let power_w = known_power(power_w, &mut remarks);

    let (symmetry, planes_deg) =
        stored(symmetry, &all_deg).map_err(|problem| fields.wrong(problem))?;
    let factor = conversion * flux_lm / 1000.0;
    let mut by_plane: Vec<(f64, Vec<f64>)> = Vec::new();
    if planes * angles > MOST_NODES {
        return Err(fields.wrong(format!("{planes} times {angles} angles are too many")));
    }
    let table_line = fields.place + 1;
    for plane in planes_deg {
        let values = fields.intensities(angles)?;
        by_plane.push((plane, values.iter().map(|value| value * factor).collect()));
    }
    fields.end()?;
    by_plane.sort_by(|a, b| a.0.total_cmp(&b.0));
    let planes_deg = by_plane.iter().map(|(plane, _)| *plane).collect();
    let candela = by_plane.into_iter().flat_map(|(_, values)| values).collect();
    let intensities = Intensities::new(symmetry, planes_deg, angles_deg, candela)
        .map_err(|error| error.at_table(LuminaireFormat::Ldt, table_line))?;
    remarks.extend(pole_remarks(&intensities));
    let lamps = match whole(count) {
        Some(count) if count < 0 => LampFlux::Absolute,
        Some(count) if count > 0 => LampFlux::Relative { count: count as u32, flux_lm },
        Some(_) | None => {
            remarks.push(format!("the number of lamps is {count}; it is taken as 1"));
            LampFlux::Relative { count: 1, flux_lm }
        }
    };
    let ratio = intensities.flux() / flux_lm;
    if stated_ratio > 0.0 && (ratio / stated_ratio - 1.0).abs() > SAME_RATIO {
        let [own, stated] = [ratio, stated_ratio].map(|ratio| 100.0 * ratio);
        let what = "of the light of its lamps, the intensities give";
        remarks.push(format!("{what} {own:.1} % and the light output ratio is {stated:.1} %"));
    }
    let generation = FileGeneration::Undefined;
    let luminaire = Luminaire { texts, generation, lamps, power_w, opening, colour, intensities };
    ReadLuminaire::new(luminaire, LuminaireFormat::Ldt, table_line, remarks)
}

/// Remarks where angles do not have the step that the file states; 0 states none.
fn remark_on_steps(what: &str, (step, own): (f64, &[f64]), remarks: &mut Vec<String>) {
    let is_off = |pair: &[f64]| (pair[1] - pair[0] - step).abs() > ROUNDING;
    if step != 0.0 && own.windows(2).any(is_off) {
        remarks.push(format!("the {what} are not {step}° apart, as the file says"));
    }
}

/// The luminous area: round if it has no width.
fn opening(fields: &mut Fields<'_>, remarks: &mut Vec<String>) -> Result<Opening, LuminaireError> {
    let mut sizes = [0.0; 6];
    for size in &mut sizes {
        *size = fields.optional("a size of the luminous area")?;
        if !(0.0..=MOST_SIZE).contains(size) {
            return Err(fields.wrong(format!("a size of the luminous area is {size} mm")));
        }
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

/// A set of lamps: negative numbers of them say that the photometry is absolute.
struct LampSet<'t> {
    count: f64,
    kind: &'t str,
    flux_lm: f64,
    power_w: f64,
    colour: LuminaireColour,
}

/// The lines of a file, one field after the other.
struct Fields<'t> {
    lines: Vec<&'t str>,
    place: usize,
}

impl<'t> Fields<'t> {
    fn text(&mut self, what: &str) -> Result<&'t str, LuminaireError> {
        let line = self.lines.get(self.place).copied();
        self.place += 1;
        line.ok_or_else(|| self.wrong(format!("the file ends before {what}")))
    }

    /// A number that may be left out, as 0.
    fn optional(&mut self, what: &str) -> Result<f64, LuminaireError> {
        let is_empty = self.lines.get(self.place).is_some_and(|line| line.trim().is_empty());
        self.place += usize::from(is_empty);
        if is_empty { Ok(0.0) } else { self.next(what) }
    }

    /// A set of lamps.
    fn lamp_set(&mut self) -> Result<LampSet<'t>, LuminaireError> {
        let count = self.next("the number of lamps")?;
        let kind = self.text("the type of lamps")?;
        let flux_lm = self.positive("the flux of the lamps", MOST_LUMENS)?;
        let mut words = |what: &str| self.text(what).map(|text| text.trim().to_owned());
        let temperature = words("the colour temperature")?;
        let rendering = words("the colour rendering")?;
        let power_w = self.optional("the power")?;
        let colour = LuminaireColour { temperature, rendering };
        Ok(LampSet { count, kind, flux_lm, power_w, colour })
    }

    /// Only blank lines may follow.
    fn end(&mut self) -> Result<(), LuminaireError> {
        let is_rest = |line: &str| !line.trim_matches(['\u{1a}', ' ', '\t', '\0']).is_empty();
        let rest = self.lines.get(self.place..).unwrap_or_default();
        match rest.iter().position(|line| is_rest(line)) {
            None => Ok(()),
            Some(place) => {
                self.place += place + 1;
                let found = shorten(self.lines[self.place - 1].trim(), 30);
                Err(self.wrong(format!("`{found}` follows the last intensity")))
            }
        }
    }
}

impl NumberReader for Fields<'_> {
    fn next(&mut self, what: &str) -> Result<f64, LuminaireError> {
        let text = self.text(what)?;
        let found = || format!("expected {what}, found `{}`", shorten(text.trim(), 30));
        number(text).ok_or_else(|| self.wrong(found()))
    }

    fn wrong(&self, problem: String) -> LuminaireError {
        LuminaireError::Violated {
            format: LuminaireFormat::Ldt,
            line: self.place.min(self.lines.len()).max(1),
            problem,
        }
    }
}
