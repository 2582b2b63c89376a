//! Writes EULUMDAT.

use crate::luminaire::data::{LampFlux, Luminaire};
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use crate::luminaire::text::{one_line, seven_digits, with_digits};

/// Planes of a rotationally symmetric distribution, as most such files have.
const PLANES: u32 = 24;
/// Most letters of a text.
const TEXT: usize = 78;
/// Digits of intensities per 1000 lm: enough for seven of those in cd.
const PER_KILOLUMEN_DIGITS: i32 = 9;
/// Relative difference of steps that are taken as equal, 1.
const EQUAL_STEPS: f64 = 1e-6;

/// The text of a file. Direct ratios are written as 0, which means that they are not given.
pub(crate) fn write(luminaire: &Luminaire) -> String {
    let Luminaire { lamps, power_w, opening, intensities, .. } = luminaire;
    let text = |keyword: &str| one_line(luminaire.text(keyword).unwrap_or_default(), TEXT);
    let flux = intensities.flux();
    let (count, lamp_flux) = match *lamps {
        LampFlux::Absolute => (-1, flux),
        LampFlux::Relative { count, flux_lm } => (i64::from(count), flux_lm),
    };
    // As written, so that it belongs to the intensities.
    let lamp_flux = seven_digits(lamp_flux).parse().unwrap_or(lamp_flux);
    let circle = match intensities.symmetry() {
        PlaneSymmetry::Rotational => {
            (0..PLANES).map(|place| 360.0 * f64::from(place) / f64::from(PLANES)).collect()
        }
        _ => intensities.circle().iter().map(|(plane, _)| *plane).collect::<Vec<f64>>(),
    };
    let angles = intensities.angles_deg();
    let share = |part: f64, whole: f64| if whole > 0.0 { 100.0 * part / whole } else { 0.0 };

    let mut lines: Vec<String> =
        vec![text("MANUFAC"), kind(intensities, opening.is_round).to_string()];
    let mut add = |values: &[f64]| lines.extend(values.iter().map(|value| seven_digits(*value)));
    let symmetry = match intensities.symmetry() {
        PlaneSymmetry::None => 0.0,
        PlaneSymmetry::Rotational => 1.0,
        PlaneSymmetry::AboutC0 => 2.0,
        PlaneSymmetry::AboutC90 => 3.0,
        PlaneSymmetry::Quadrants => 4.0,
    };
    add(&[symmetry, circle.len() as f64, step(&circle), angles.len() as f64, step(angles)]);
    lines.extend(["TEST", "LUMINAIRE", "LUMCAT"].map(text));
    lines.push(String::new());
    lines.push(text("ISSUEDATE"));
    let width = if opening.is_round { 0.0 } else { opening.along_c0_mm };
    let mut add = |values: &[f64]| lines.extend(values.iter().map(|value| seven_digits(*value)));
    // The luminaire itself, then its luminous area.
    add(&[opening.along_c90_mm, width, opening.height_mm]);
    add(&[opening.along_c90_mm, width]);
    add(&[opening.height_mm; 4]);
    let shares = [share(intensities.flux_between(0.0, 90.0), flux), share(flux, lamp_flux)];
    lines.extend(shares.map(|percent| format!("{percent:.2}")));
    // Conversion factor, tilt during measurement, and one set of lamps.
    lines.extend(["1", "0", "1"].map(str::to_owned));
    lines.push(count.to_string());
    lines.push(text("LAMP"));
    lines.push(seven_digits(lamp_flux));
    lines.extend([String::new(), String::new()]);
    let mut add = |values: &[f64]| lines.extend(values.iter().map(|value| seven_digits(*value)));
    add(&[*power_w]);
    add(&[0.0; 10]);
    add(&circle);
    add(angles);
    let per_kilolumen = if lamp_flux > 0.0 { 1000.0 / lamp_flux } else { 0.0 };
    let count = intensities.planes_deg().len();
    let order: Vec<usize> = match intensities.symmetry() {
        // From C270 over C0 to C90, mirrored: from 270 down to 90.
        PlaneSymmetry::AboutC90 => (0..count).rev().collect(),
        _ => (0..count).collect(),
    };
    for place in order {
        let values = intensities.plane(place).iter().map(|value| value * per_kilolumen);
        lines.extend(values.map(|value| with_digits(value, PER_KILOLUMEN_DIGITS)));
    }
    lines.iter().map(|line| format!("{line}\r\n")).collect()
}

/// The type of luminaire: 1 a point with rotational symmetry, 2 linear, 3 any other point.
fn kind(intensities: &Intensities, is_round: bool) -> u32 {
    match intensities.symmetry() {
        PlaneSymmetry::Rotational => 1,
        _ if is_round => 3,
        _ => 2,
    }
}

/// The step between numbers; 0 where steps differ.
fn step(numbers: &[f64]) -> f64 {
    let mut steps = numbers.windows(2).map(|pair| pair[1] - pair[0]);
    let Some(first) = steps.next() else { return 0.0 };
    if steps.all(|step| (step - first).abs() <= EQUAL_STEPS * first) { first } else { 0.0 }
}
