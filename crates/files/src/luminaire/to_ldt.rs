//! Writes EULUMDAT.

use crate::luminaire::data::{LampFlux, Luminaire, LuminaireColour, Opening, WrittenLuminaire};
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use crate::luminaire::text::{beyond_ascii, one_line, seven_digits, with_digits};

/// Keywords of LM-63 for whose texts EULUMDAT has a field.
pub(crate) const FIELDS_OF_LDT: [&str; 6] =
    ["MANUFAC", "TEST", "LUMINAIRE", "LUMCAT", "ISSUEDATE", "LAMP"];
/// Planes of a rotationally symmetric distribution, as most such files have.
const PLANES: u32 = 24;
/// Most letters of a text, and of the type of lamps, in EULUMDAT.
const TEXT: usize = 78;
const LAMP: usize = 24;
/// Digits of intensities per 1000 lm: enough for seven of those in cd.
const PER_KILOLUMEN_DIGITS: i32 = 9;
/// Relative difference of steps that are taken as equal, 1.
const EQUAL_STEPS: f64 = 1e-6;

/// The file. Direct ratios are written as 0, which means that they are not given.
pub(crate) fn write(luminaire: &Luminaire) -> WrittenLuminaire {
    let Luminaire { lamps, power_w, opening, colour, intensities, .. } = luminaire;
    let mut remarks: Vec<String> =
        FIELDS_OF_LDT.into_iter().filter_map(|keyword| remark_on_cut(luminaire, keyword)).collect();
    let text = |keyword: &str| {
        one_line(luminaire.text(keyword).unwrap_or_default(), most_letters(keyword))
    };
    let flux = intensities.flux();
    let (count, lamp_flux) = match *lamps {
        LampFlux::Absolute => (-1, flux),
        LampFlux::Relative { count, flux_lm } => (i64::from(count), flux_lm),
    };
    // As written, so that it belongs to the intensities; any flux does for a dark luminaire.
    let lamp_flux = seven_digits(lamp_flux).parse().ok().filter(|flux| *flux > 0.0);
    let lamp_flux = lamp_flux.unwrap_or(1000.0);
    let (symmetry, circle, stored) = layout(intensities);
    let angles = intensities.angles_deg();
    let percent = |part: f64, whole: f64| {
        format!("{:.2}", if whole > 0.0 { 100.0 * part / whole } else { 0.0 })
    };
    // A round opening has a diameter and no width.
    let [length, width] = match opening.is_round {
        true => [(opening.along_c90_mm * opening.along_c0_mm).sqrt(), 0.0],
        false => [opening.along_c90_mm, opening.along_c0_mm],
    };
    if opening.is_round && opening.along_c0_mm != opening.along_c90_mm {
        remarks.push("the opening is an ellipse; it is written as a circle of its area".to_owned());
    }
    let numbers = |values: &[f64]| -> Vec<String> {
        values.iter().map(|value| seven_digits(*value)).collect()
    };

    let kind = kind(intensities, opening);
    let mut lines = vec![text("MANUFAC"), kind.to_string(), symmetry.to_string()];
    let [planes_count, angles_count] = [circle.len(), angles.len()].map(|count| count as f64);
    lines.extend(numbers(&[planes_count, step(&circle), angles_count, step(angles)]));
    lines.extend(["TEST", "LUMINAIRE", "LUMCAT"].map(text));
    lines.extend([String::new(), text("ISSUEDATE")]);
    // The luminaire itself, then its luminous area.
    lines.extend(numbers(&[length, width, opening.height_mm, length, width]));
    lines.extend(numbers(&[opening.height_mm; 4]));
    lines.extend([percent(intensities.flux_between(0.0, 90.0), flux), percent(flux, lamp_flux)]);
    // Conversion factor, tilt during measurement, and one set of lamps.
    lines.extend(["1", "0", "1"].map(str::to_owned));
    lines.extend([count.to_string(), text("LAMP"), seven_digits(lamp_flux)]);
    let LuminaireColour { temperature, rendering } = colour;
    lines.extend([temperature, rendering].map(|words| one_line(words, TEXT)));
    lines.push(seven_digits(*power_w));
    lines.extend(numbers(&[0.0; 10]));
    lines.extend(numbers(&circle));
    lines.extend(numbers(angles));
    for plane in stored {
        let values = angles.iter().map(|angle| intensities.at(plane, *angle) * 1000.0 / lamp_flux);
        lines.extend(values.map(|value| with_digits(value, PER_KILOLUMEN_DIGITS)));
    }
    let text: String = lines.iter().map(|line| format!("{line}\r\n")).collect();
    remarks.extend(beyond_ascii(&text, "some readers of EULUMDAT expect Windows-1252"));
    WrittenLuminaire { text, remarks }
}

/// Most letters of the field for the text of a keyword.
fn most_letters(keyword: &str) -> usize {
    if keyword == "LAMP" { LAMP } else { TEXT }
}

/// A remark if a text is too long for its field.
fn remark_on_cut(luminaire: &Luminaire, keyword: &str) -> Option<String> {
    let longest = most_letters(keyword);
    let length = one_line(luminaire.text(keyword)?, usize::MAX).chars().count();
    let remark =
        format!("of the {length} letters of {keyword} it has room for the first {longest}");
    (length > longest).then_some(remark)
}

/// The symmetry, all planes and the planes whose intensities are written, deg.
fn layout(intensities: &Intensities) -> (u32, Vec<f64>, Vec<f64>) {
    let circle = intensities.circle();
    let quarter = circle.len() / 4;
    match intensities.symmetry() {
        PlaneSymmetry::None => (0, circle.clone(), circle),
        PlaneSymmetry::Rotational => {
            let planes = (0..PLANES).map(|place| 360.0 * f64::from(place) / f64::from(PLANES));
            (1, planes.collect(), circle)
        }
        PlaneSymmetry::AboutC0 => (2, circle.clone(), circle[..=circle.len() / 2].to_vec()),
        PlaneSymmetry::AboutC90 => {
            // From C270 over C0 to C90, if they lie where a reader looks for them.
            let is_even = circle.len() == 4 * quarter
                && [circle[quarter], circle[3 * quarter]] == [90.0, 270.0];
            let half = || [&circle[3 * quarter..], &circle[..=quarter]].concat();
            if is_even { (3, circle.clone(), half()) } else { (0, circle.clone(), circle) }
        }
        PlaneSymmetry::Quadrants => (4, circle.clone(), circle[..=quarter].to_vec()),
    }
}

/// The type of luminaire: 1 a point with rotational symmetry, 2 linear, 3 any other point.
fn kind(intensities: &Intensities, opening: &Opening) -> u32 {
    let has_length = opening.along_c0_mm > 0.0 || opening.along_c90_mm > 0.0;
    match intensities.symmetry() {
        PlaneSymmetry::Rotational => 1,
        PlaneSymmetry::Quadrants
        | PlaneSymmetry::AboutC0
        | PlaneSymmetry::AboutC90
        | PlaneSymmetry::None => {
            if has_length && !opening.is_round {
                2
            } else {
                3
            }
        }
    }
}

/// The step between numbers; 0 where steps differ.
fn step(numbers: &[f64]) -> f64 {
    let mut steps = numbers.windows(2).map(|pair| pair[1] - pair[0]);
    let Some(first) = steps.next() else { return 0.0 };
    if steps.all(|step| (step - first).abs() <= EQUAL_STEPS * first) { first } else { 0.0 }
}
