//! Type A: its planes are C planes in the opposite sense, so that every value keeps its direction.

use crate::luminaire::error::LuminaireError;
use crate::luminaire::front_table::FrontTable;
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};

/// Angle behind the last plane within which light falls to 0, deg: with it the flux is right within one part in ten thousand.
const EDGE: f64 = 0.01;

/// The intensities, with a remark on how they follow. C is minus the horizontal angle, and γ is 90° plus the vertical one; between the
/// values, both tables are linear in the same angles.
pub(crate) fn over_c_planes(
    table: &FrontTable,
    remarks: &mut Vec<String>,
) -> Result<Intensities, LuminaireError> {
    let horizontal = &table.horizontal_deg;
    let (first, last) = (horizontal[0], horizontal[horizontal.len() - 1]);
    let angles_deg: Vec<f64> = table.vertical_deg.iter().map(|angle| 90.0 + angle).collect();
    let dark = || vec![0.0; angles_deg.len()];
    let mut planes: Vec<(f64, Vec<f64>)> = Vec::new();
    let symmetry = if table.is_symmetric() {
        planes.extend(horizontal.iter().map(|angle| (*angle, table.column_at(*angle))));
        planes.extend([(last + EDGE, dark()), (180.0, dark())]);
        PlaneSymmetry::AboutC0
    } else {
        // Counter-clockwise from C0: the negative angles, the dark side, the positive angles.
        planes.push((0.0, table.column_at(0.0)));
        let left = horizontal.iter().rev().filter(|angle| **angle < 0.0);
        planes.extend(left.map(|angle| (-angle, table.column_at(*angle))));
        planes.extend([(EDGE - first, dark()), (360.0 - last - EDGE, dark())]);
        let right = horizontal.iter().rev().filter(|angle| **angle > 0.0);
        planes.extend(right.map(|angle| (360.0 - angle, table.column_at(*angle))));
        PlaneSymmetry::None
    };
    let planes_deg = planes.iter().map(|(plane, _)| *plane).collect();
    let candela = planes.into_iter().flat_map(|(_, values)| values).collect();
    let intensities = Intensities::new(symmetry, planes_deg, angles_deg, candela)?;
    let how = "goniometer type A: C is minus the horizontal angle, γ is 90° plus the vertical one";
    remarks.push(format!("{how}; {}", table.dark_remark()));
    Ok(intensities)
}
