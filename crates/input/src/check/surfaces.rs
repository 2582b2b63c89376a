//! Rules that several finishes share: reflectance and transmittance add up to no more than 1, haze
//! scatters no more light than available, and tables against the angle are complete.
//!
//! Does not know which rule applies to which finish.

use crate::check::scene::Scene;
use crate::keys::Key;
use crate::problems::Problems;
use crate::scatter;
use crate::spec::finish::{HazeSheetSpec, TabulatedSpec};
use lumiduct_base::number::format_value;
use lumiduct_core::optics::{HazeLaw, HazeSides, integrated_scatter};

/// Rounding error allowed for a sum of decimal fractions.
const SUM_TOLERANCE: f64 = 1e-12;

/// Haze as given in a file.
pub(super) struct Law<'a> {
    pub(super) key: Key,
    pub(super) law: HazeLaw,
    /// The key that scales the scattered light.
    pub(super) strength: &'a str,
}

/// The least sum of reflectance and transmittance.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Least {
    Zero,
    AboveZero,
}

pub(super) fn check_sum(
    key: &Key,
    [reflectance, transmittance]: [f64; 2],
    least: Least,
    problems: &mut Problems,
) {
    let sum = reflectance + transmittance;
    if sum > 1.0 + SUM_TOLERANCE {
        let message = format!(
            "reflectance {reflectance} and transmittance {transmittance} add up to {sum}, expected at most 1"
        );
        problems.error(key, message);
    }
    if sum == 0.0 && least == Least::AboveZero {
        let message = "reflectance and transmittance are both 0, expected a sum above 0";
        problems.error(key, message).hint("a finish that absorbs everything is `absorber = {}`");
    }
}

pub(super) fn check_haze(
    haze: &Law<'_>,
    sheet: &HazeSheetSpec,
    scene: Scene<'_>,
    problems: &mut Problems,
) {
    if sheet.reflectance.is_none() && sheet.transmittance.is_none() {
        check_interface(haze, sheet, scene, problems);
        return;
    }
    let reflectance = sheet.reflectance.unwrap_or(0.0);
    let transmittance = sheet.transmittance.unwrap_or(0.0);
    check_sum(&haze.key, [reflectance, transmittance], Least::AboveZero, problems);
    let sides = scatter::sides(sheet);
    let all = integrated_scatter(haze.law, 1.0);
    for (name, share, other) in [
        ("reflectance", reflectance, HazeSides::Transmitted),
        ("transmittance", transmittance, HazeSides::Reflected),
    ] {
        if sides != other && share > 0.0 && all > share + SUM_TOLERANCE {
            let told = format_value(all);
            let message = format!(
                "total integrated scatter is {told} at normal incidence, expected at most the {name} of {share}"
            );
            problems.error(&haze.key, message).hint(format!("lower `{}`", haze.strength));
        }
    }
}

fn check_interface(
    haze: &Law<'_>,
    sheet: &HazeSheetSpec,
    scene: Scene<'_>,
    problems: &mut Problems,
) {
    if sheet.scatters.is_some() {
        problems.error(
            &haze.key.field("scatters"),
            "an interface of two media scatters to both sides; expected a reflectance or a transmittance beside it",
        );
    }
    // Into the densest medium that may be on either side.
    let index = scene.spec.media.values().map(|medium| medium.index).fold(1.0, f64::max);
    let all = 2.0 * integrated_scatter(haze.law, index);
    if all > 1.0 {
        let told = format_value(all);
        let message = format!(
            "scatters {told} of the light at normal incidence to two sides of index {index}, expected at most 1"
        );
        problems.error(&haze.key, message).hint(format!("lower `{}`", haze.strength));
    }
}

pub(super) fn check_tabulated(key: &Key, spec: &TabulatedSpec, problems: &mut Problems) {
    let angles = &spec.angles_deg;
    check_angles(key, angles, problems);
    check_values(key, "reflectance", angles, &spec.reflectance, problems);
    let Some(transmittance) = &spec.transmittance else { return };
    check_values(key, "transmittance", angles, transmittance, problems);
    let rows = angles.iter().zip(spec.reflectance.iter().zip(transmittance));
    for (angle, (reflectance, transmittance)) in rows {
        let sum = reflectance + transmittance;
        if sum > 1.0 + SUM_TOLERANCE {
            let message = format!(
                "reflectance and transmittance at {angle} deg add up to {sum}, expected at most 1"
            );
            problems.error(key, message);
            return;
        }
    }
}

/// Angles of a table increase from 0 to 90 deg: nothing is extrapolated.
pub(super) fn check_angles(key: &Key, angles: &[f64], problems: &mut Problems) {
    let key = key.field("angles_deg");
    if let Some(place) = angles.windows(2).position(|pair| pair[1] <= pair[0]) {
        let message = format!(
            "{} comes after {}, expected angles that increase",
            angles[place + 1],
            angles[place]
        );
        problems.error(&key.index(place + 1), message);
    } else if let (Some(first), Some(last)) = (angles.first(), angles.last())
        && (*first != 0.0 || *last != 90.0)
    {
        let message = format!("go from {first} to {last}, expected 0 to 90");
        problems.error(&key, message).hint("say what holds at 0 and at 90 deg, too");
    }
}

/// There is a value for each angle.
pub(super) fn check_values(
    key: &Key,
    name: &str,
    angles: &[f64],
    values: &[f64],
    problems: &mut Problems,
) {
    if values.len() != angles.len() {
        let message = format!("{} values for {} angles", values.len(), angles.len());
        problems.error(&key.field(name), message);
    }
}
