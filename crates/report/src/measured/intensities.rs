//! Measured intensities as means over the rings of a goniometer, by narrow sectors over three turns, so that any
//! rotation about the axis C is a shift.

use crate::measured::computed::ComputedCells;
use lumiduct_files::luminaire::{Intensities, LampFlux};
use lumiduct_files::measured::MeasuredGrid;
use ndarray::Array2;

/// Largest rotation that is searched, deg.
pub(crate) const MOST_ROTATION: f64 = 45.0;
/// Sectors for each of the goniometer.
const SECTORS: usize = 4;
/// Widest sector, deg.
const WIDEST_SECTOR: f64 = 1.25;
/// Parts of a ring at whose middles the file is read.
const PARTS: usize = 8;

/// The measured cells of a luminaire file from C = -360° to 720°.
pub(crate) fn measured_sphere(intensities: &Intensities, computed: &ComputedCells) -> MeasuredGrid {
    sphere_of(|c, gamma| intensities.at(c, gamma), computed)
}

/// The same of intensities by C and γ, deg; NaN where they are not measured.
pub(crate) fn sphere_of(at: impl Fn(f64, f64) -> f64, computed: &ComputedCells) -> MeasuredGrid {
    let x = sector_edges(computed);
    let gamma = computed.edges()[1];
    let ring = |row: usize, plane: f64| {
        let edge =
            |part: usize| gamma[row] + (gamma[row + 1] - gamma[row]) * part as f64 / PARTS as f64;
        let (mut sum, mut size) = (0.0, 0.0);
        for part in 0..PARTS {
            let [from, to] = [edge(part), edge(part + 1)];
            let own = from.to_radians().cos() - to.to_radians().cos();
            sum += own * at(plane, 0.5 * (from + to));
            size += own;
        }
        sum / size
    };
    let values = Array2::from_shape_fn((gamma.len() - 1, x.len() - 1), |(row, column)| {
        ring(row, 0.5 * (x[column] + x[column + 1]))
    });
    MeasuredGrid { x, y: gamma.to_vec(), values }
}

/// Edges of sectors over three turns, deg: a few in each sector of the goniometer, or more where these are wide.
pub(crate) fn sector_edges(computed: &ComputedCells) -> Vec<f64> {
    let sectors = (computed.edges()[0].len() - 1) * SECTORS;
    let sectors = sectors * (360.0 / sectors as f64 / WIDEST_SECTOR).ceil().max(1.0) as usize;
    let width = 360.0 / sectors as f64;
    (0..=3 * sectors).map(|place| width * (place as f64 - sectors as f64)).collect()
}

/// A remark on lamps whose flux is not that of the sources of the report, lm.
pub(crate) fn lamp_remark(lamps: LampFlux, sources_lm: Option<f64>) -> Option<String> {
    /// Difference of fluxes that is rounding in a file, 1.
    const SAME_FLUX: f64 = 1e-3;
    let LampFlux::Relative { flux_lm, .. } = lamps else { return None };
    let sources = sources_lm.filter(|sources| *sources > 0.0)?;
    let ratio = flux_lm / sources;
    ((ratio - 1.0).abs() > SAME_FLUX).then(|| {
        format!(
            "the photometry of the file is relative to lamps of {flux_lm} lm, but the sources of the report emit {} lm: for \
             the same luminaire the scale is {}",
            lumiduct_base::number::format_value(sources),
            lumiduct_base::number::format_value(ratio)
        )
    })
}
