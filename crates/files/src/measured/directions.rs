//! Measured intensities from a row for each direction, linear in between as those of a luminaire file.

use crate::luminaire::{Intensities, PlaneSymmetry};
use crate::measured::error::MeasuredError;
use crate::measured::points::GridPoints;
use crate::measured::table::{TextRow, TextTable, expect_gamma, number};

/// Share of measured directions in a value that is all but rounding, 1.
const WHOLE: f64 = 1.0 - 1e-9;
/// Angles closer than this are the same, deg.
const SAME_ANGLE: f64 = 1e-6;
/// Gap between the last plane and the first, in the largest step of the others, that closes a circle.
const CLOSED: f64 = 1.5;

/// Intensities at planes C and angles γ.
#[derive(Debug)]
pub struct MeasuredDirections {
    /// The intensities; 0 where nothing was measured.
    values: Intensities,
    /// 1 where a value was measured, 0 elsewhere.
    known: Intensities,
    /// The plane C at which both begin, deg.
    first_deg: f64,
}

impl MeasuredDirections {
    /// The columns `c_deg`, `gamma_deg` and an intensity.
    ///
    /// # Errors
    ///
    /// [`MeasuredError`] if the directions are no planes around the axis.
    pub(super) fn read(table: &TextTable<'_>) -> Result<Self, MeasuredError> {
        for TextRow { line, cells } in &table.rows[1..] {
            if let Some(gamma) = cells.get(1) {
                expect_gamma(*line, [number(*line, gamma)?])?;
            }
        }
        let GridPoints { x: mut planes, y: mut angles, mut values } =
            GridPoints::read(table, [1, 2])?;
        let last = planes.len() - 1;
        let turn = planes[last] - planes[0];
        if turn > 360.0 + SAME_ANGLE {
            let (from, to) = (planes[0], planes[last]);
            let why = format!(
                "planes C from {from} to {to} deg are more than a circle; give each plane once"
            );
            return Err(MeasuredError::of_line(line_of_plane(table, to), why));
        }
        // The first plane again.
        if turn > 360.0 - SAME_ANGLE {
            planes.pop();
        }
        // A pole is one direction, so it may have a row in one plane only.
        for (mut row, gamma) in values.rows_mut().into_iter().zip(&angles) {
            if *gamma == 0.0 || *gamma == 180.0 {
                let known: Vec<f64> = row.iter().copied().filter(|own| !own.is_nan()).collect();
                let mean = known.iter().sum::<f64>() / known.len() as f64;
                row.mapv_inplace(|own| if own.is_nan() { mean } else { own });
            }
        }
        let mut rows: Vec<usize> = (0..angles.len()).collect();
        let steps = [angles[1] - angles[0], angles[rows.len() - 1] - angles[rows.len() - 2]];
        // Angles in the middles of rings reach to the poles.
        if angles[0] > 0.0 && angles[0] <= 0.5 * steps[0] + SAME_ANGLE {
            angles.insert(0, 0.0);
            rows.insert(0, 0);
        }
        let end = angles[angles.len() - 1];
        if end < 180.0 && 180.0 - end <= 0.5 * steps[1] + SAME_ANGLE {
            angles.push(180.0);
            let last = rows[rows.len() - 1];
            rows.push(last);
        }
        let symmetry = symmetry(&planes).map_err(|why| {
            MeasuredError::of_line(line_of_plane(table, planes[planes.len() - 1]), why)
        })?;
        let first_deg = match symmetry {
            PlaneSymmetry::Rotational | PlaneSymmetry::None => planes[0],
            PlaneSymmetry::Quadrants | PlaneSymmetry::AboutC0 | PlaneSymmetry::AboutC90 => 0.0,
        };
        planes.iter_mut().for_each(|plane| *plane -= first_deg);
        let distribution = |of: fn(f64) -> f64| {
            let (rows, values) = (&rows, &values);
            let plane = move |column: usize| rows.iter().map(move |row| of(values[[*row, column]]));
            let candela = (0..planes.len()).flat_map(plane).collect();
            let own = Intensities::new(symmetry, planes.clone(), angles.clone(), candela);
            own.map_err(|error| MeasuredError::of_line(table.line(1), error.to_string()))
        };
        Ok(Self {
            values: distribution(|own| if own.is_nan() { 0.0 } else { own })?,
            known: distribution(|own| if own.is_nan() { 0.0 } else { 1.0 })?,
            first_deg,
        })
    }

    /// The largest intensity, cd or W/sr.
    pub fn peak(&self) -> f64 {
        self.values.peak()
    }

    /// The intensity in a direction, cd or W/sr; angles are in degrees. NaN where it is not measured.
    pub fn at(&self, c_deg: f64, gamma_deg: f64) -> f64 {
        let plane = c_deg - self.first_deg;
        let is_known = self.known.at(plane, gamma_deg) >= WHOLE;
        if is_known { self.values.at(plane, gamma_deg) } else { f64::NAN }
    }

    /// A remark on planes that are taken as equal.
    pub(super) fn remark(&self) -> Option<String> {
        let symmetry = self.values.symmetry();
        (symmetry != PlaneSymmetry::None).then(|| {
            format!(
                "the measured file has planes C of a part of the circle; the others follow from their symmetry: {}",
                symmetry.name()
            )
        })
    }
}

/// The symmetry whose planes these are, in ascending order.
fn symmetry(planes: &[f64]) -> Result<PlaneSymmetry, String> {
    let [first, last] = [planes[0], planes[planes.len() - 1]];
    let step = planes.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    if planes.len() == 1 {
        return Ok(PlaneSymmetry::Rotational);
    }
    if first + 360.0 - last <= CLOSED * step {
        return Ok(PlaneSymmetry::None);
    }
    let parts = [
        (PlaneSymmetry::Quadrants, [0.0, 90.0]),
        (PlaneSymmetry::AboutC0, [0.0, 180.0]),
        (PlaneSymmetry::AboutC90, [90.0, 270.0]),
    ];
    let found = parts.into_iter().find(|(_, ends)| *ends == [first, last]);
    found.map(|(symmetry, _)| symmetry).ok_or_else(|| {
        format!(
            "planes C from {first} to {last} deg are no circle; give all planes, or those of a symmetry: one, or from 0 to 90, \
             0 to 180 or 90 to 270 deg"
        )
    })
}

/// The first line of a plane C, deg.
fn line_of_plane(table: &TextTable<'_>, plane: f64) -> usize {
    let distance = |row: &TextRow<'_>| {
        let c = row.cells.first().and_then(|cell| cell.parse::<f64>().ok());
        c.map_or(f64::INFINITY, |c| (c - plane).abs())
    };
    let nearest = table.rows[1..].iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.map_or(table.line(1), |row| row.line)
}
