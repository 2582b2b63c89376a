//! Type B: its axis is horizontal, so that intensities are interpolated in its angles at the directions of C planes.

use crate::luminaire::error::LuminaireError;
use crate::luminaire::front_table::FrontTable;
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use lumiduct_base::number::{format_exact, format_percent};

/// Finest step of the table, deg: finer than goniometers for floodlights, and still a file that programs read.
const FINEST_STEP: f64 = 0.5;
/// Sine below which a direction lies on the axis, 1.
const ON_AXIS: f64 = 1e-12;

/// The intensities, with half the smallest step of the file, and a remark on how much they differ between their values.
pub(crate) fn over_c_planes(
    table: &FrontTable,
    remarks: &mut Vec<String>,
) -> Result<Intensities, LuminaireError> {
    let steps = |angles: &[f64]| {
        angles.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min)
    };
    let smallest = steps(&table.horizontal_deg).min(steps(&table.vertical_deg));
    let segments = (90.0 / (0.5 * smallest).max(FINEST_STEP)).ceil() as usize;
    let step = 90.0 / segments as f64;
    let angles_deg: Vec<f64> = (0..=segments).map(|place| step * place as f64).collect();
    let (symmetry, planes) = match table.is_symmetric() {
        true => (PlaneSymmetry::AboutC0, 2 * segments + 1),
        false => (PlaneSymmetry::None, 4 * segments),
    };
    let planes_deg: Vec<f64> = (0..planes).map(|place| step * place as f64).collect();
    let at = |plane: f64, angle: f64| {
        let [horizontal, vertical] = angles_of(plane, angle);
        table.at(horizontal, vertical)
    };
    let candela =
        planes_deg.iter().flat_map(|plane| angles_deg.iter().map(|angle| at(*plane, *angle)));
    let candela = candela.collect();
    let intensities = Intensities::new(symmetry, planes_deg, angles_deg, candela)?;
    let difference = largest_difference(table, &intensities, step);
    let share = format_percent(if difference > 0.0 { difference / table.peak() } else { 0.0 });
    let step = format_exact((step * 1e4).round() / 1e4);
    remarks.push(format!(
        "goniometer type B: interpolated at planes and angles every {step}°, between which intensities differ from those of the \
            file by up to {share} of the peak; {}",
        table.dark_remark()
    ));
    Ok(intensities)
}

/// Horizontal and vertical angle of a direction in a C plane at an angle γ of up to 90°, all in deg. With the unit vector
/// (sin γ cos C, sin γ sin C, cos γ) toward C0, C90 and the nadir, H is the angle from the plane through C0 toward C270 (clockwise
/// as seen from above), and V turns about the axis along C90, from the nadir toward C0: sin H = -sin γ sin C, tan V = tan γ cos C.
pub(crate) fn angles_of(plane_deg: f64, angle_deg: f64) -> [f64; 2] {
    let (sin_plane, cos_plane) = plane_deg.to_radians().sin_cos();
    let (sin, down) = angle_deg.to_radians().sin_cos();
    let (ahead, right) = (sin * cos_plane, -sin * sin_plane);
    let is_on_axis = ahead.abs() < ON_AXIS && down.abs() < ON_AXIS;
    let vertical = if is_on_axis { 0.0 } else { ahead.atan2(down) };
    [right.clamp(-1.0, 1.0).asin(), vertical].map(f64::to_degrees)
}

/// The C plane and the angle γ of a horizontal and a vertical angle, deg: the inverse of [`angles_of`].
pub(crate) fn direction_of(horizontal_deg: f64, vertical_deg: f64) -> [f64; 2] {
    let (right, forward) = horizontal_deg.to_radians().sin_cos();
    let (sin, cos) = vertical_deg.to_radians().sin_cos();
    let (ahead, down) = (forward * sin, forward * cos);
    let plane = (-right).atan2(ahead).to_degrees().rem_euclid(360.0);
    [plane, ahead.hypot(right).atan2(down).to_degrees()]
}

/// The largest difference between the two tables, cd: at the directions of the file, and in the middle of the cells of the new table.
fn largest_difference(table: &FrontTable, intensities: &Intensities, step: f64) -> f64 {
    let own = table.horizontal_deg.iter().enumerate().flat_map(|(column, horizontal)| {
        let values = table.vertical_deg.iter().zip(table.column(column));
        values.map(move |(vertical, value)| (direction_of(*horizontal, *vertical), *value))
    });
    let planes = intensities.planes_deg();
    let angles = intensities.angles_deg();
    let middles = planes.iter().flat_map(|plane| {
        let below = angles[..angles.len() - 1].iter();
        below.map(move |angle| [plane + 0.5 * step, angle + 0.5 * step])
    });
    let of_middle = |[plane, angle]: [f64; 2]| {
        let [horizontal, vertical] = angles_of(plane, angle);
        ([plane, angle], table.at(horizontal, vertical))
    };
    let difference = |([plane, angle], value): ([f64; 2], f64)| {
        (intensities.at(plane, angle.min(90.0)) - value).abs()
    };
    own.chain(middles.map(of_middle)).map(difference).fold(0.0, f64::max)
}
