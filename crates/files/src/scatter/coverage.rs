//! Whether the angles of a table say enough of a distribution function: it is linear between them, and constant a little beyond.

use crate::scatter::angles::SampledScatter;
use lumiduct_base::number::format_value;

/// Farthest that polar angles may begin from 0, and end from 90 deg: within 20 deg of either lies 12 % of evenly scattered light.
const MOST_BEYOND_DEG: f64 = 20.0;
/// Largest step of polar angles over which values that change are linear, deg.
const MOST_POLAR_STEP_DEG: f64 = 45.0;
/// Largest step of azimuths over which values that change are linear, deg: a quadrant.
const MOST_AZIMUTH_STEP_DEG: f64 = 90.0;

/// Refuses a table with angles missing.
///
/// # Errors
///
/// Which column lacks which angles, and what to do.
pub(super) fn expect_covered(table: &SampledScatter) -> Result<(), String> {
    let values = &table.values;
    // A constant may be given at a single angle.
    let is_constant = values.iter().all(|value| *value == values[0]);
    expect_polar("theta_i_deg", &table.incident, is_constant)?;
    expect_polar("theta_s_deg", &table.polar, is_constant)?;
    expect_circle(table, is_constant)
}

/// Refuses polar angles that end too early, or lie too far apart.
fn expect_polar(name: &str, angles: &[f64], is_constant: bool) -> Result<(), String> {
    if let [angle] = angles {
        return single(name, *angle, is_constant);
    }
    let (first, last) = (angles[0], angles[angles.len() - 1]);
    if first > MOST_BEYOND_DEG {
        return Err(format!(
            "{name} begins at {first}, so angles are missing below it; add rows from 0, or at least from {MOST_BEYOND_DEG}"
        ));
    }
    let least_end = 90.0 - MOST_BEYOND_DEG;
    if last < least_end {
        return Err(format!(
            "{name} ends at {last}, so angles are missing beyond it; add rows up to 90, or at least up to {least_end}"
        ));
    }
    match largest_step(angles) {
        [from, to] if to - from > MOST_POLAR_STEP_DEG && !is_constant => {
            Err(gap(name, [from, to], MOST_POLAR_STEP_DEG))
        }
        _ => Ok(()),
    }
}

/// Refuses azimuths that cover neither a circle nor the half of it whose mirror image is the other half.
fn expect_circle(table: &SampledScatter, is_constant: bool) -> Result<(), String> {
    const NAME: &str = "phi_s_deg";
    let angles = &table.azimuth;
    if let [angle] = angles[..] {
        return single(NAME, angle, is_constant);
    }
    let (first, last) = (angles[0], angles[angles.len() - 1]);
    let [from, to] = largest_step(angles);
    // Around the ends of the rows, over the mirror image or over 360 deg.
    let open = if table.is_half() {
        f64::max(2.0 * first, 2.0 * (180.0 - last))
    } else {
        first + 360.0 - last
    };
    if open > f64::max(2.0 * MOST_BEYOND_DEG, to - from) {
        return Err(format!(
            "{NAME} from {first} to {last} covers neither a half circle, 0 to 180, nor a whole one, 0 to 360; add rows at the other azimuths"
        ));
    }
    if to - from > MOST_AZIMUTH_STEP_DEG && !is_constant {
        return Err(gap(NAME, [from, to], MOST_AZIMUTH_STEP_DEG));
    }
    Ok(())
}

/// A single angle says all of a constant only.
fn single(name: &str, angle: f64, is_constant: bool) -> Result<(), String> {
    if is_constant {
        return Ok(());
    }
    Err(format!(
        "{name} is {angle} in all rows, but the values change with the other angles; add rows at other {name}"
    ))
}

fn gap(name: &str, [from, to]: [f64; 2], most: f64) -> String {
    let wide = format_value(to - from);
    format!(
        "{name} has no rows between {from} and {to}, {wide} deg apart; add rows so that its steps are at most {most} deg"
    )
}

/// The neighbours farthest from each other, of two angles or more.
fn largest_step(angles: &[f64]) -> [f64; 2] {
    let steps = angles.windows(2).map(|pair| [pair[0], pair[1]]);
    steps.fold([0.0, 0.0], |most, own| if own[1] - own[0] > most[1] - most[0] { own } else { most })
}
