//! How much the planes that a symmetry treats as equal differ.

use crate::luminaire::fit::CellMeans;
use crate::luminaire::fit::nodes::ring_edges;
use crate::luminaire::intensities::PlaneSymmetry;
use lumiduct_base::math::linear_over_ring;
use std::collections::BTreeMap;

/// Standard deviations of its noise by which a difference must exceed what noise explains.
const CLEARLY: f64 = 4.0;

/// Sums over the sectors of a ring that a symmetry takes as equal.
#[derive(Default)]
struct EqualSectors {
    count: f64,
    values: f64,
    squares: f64,
    variances: f64,
}

/// Root mean square over all directions of the difference from the mean of the planes that are taken as equal, as a share of the
/// root mean square of the intensities, 1. What the standard errors explain is not in it, and it is 0 where that may be all.
pub fn asymmetry(means: &CellMeans<'_>, symmetry: PlaneSymmetry) -> f64 {
    let (rings, sectors) = means.candela.dim();
    // Middles of sectors are odd multiples of half a step, also when folded.
    let folded = |sector: usize| {
        let middle = 360.0 * (sector as f64 + 0.5) / sectors as f64;
        (symmetry.folded(middle) * sectors as f64 / 180.0).round() as i64
    };
    let (mut excess, mut noise, mut whole) = (0.0, 0.0, 0.0);
    for ring in 0..rings {
        let weight = linear_over_ring(ring_edges(ring, rings), [1.0; 2]);
        let mut equals = BTreeMap::<i64, EqualSectors>::new();
        for sector in 0..sectors {
            let (value, error) = (means.candela[[ring, sector]], means.std_errors[[ring, sector]]);
            let sums = equals.entry(folded(sector)).or_default();
            sums.count += 1.0;
            sums.values += value;
            sums.squares += value * value;
            sums.variances += error * error;
        }
        for EqualSectors { count, values, squares, variances } in equals.into_values() {
            let expected = variances * (1.0 - 1.0 / count);
            excess += weight * (squares - values * values / count - expected);
            // Of a sum of count - 1 squares of normal deviates.
            noise += 2.0 * (weight * variances / count).powi(2) * (count - 1.0);
            whole += weight * squares;
        }
    }
    if excess > CLEARLY * noise.sqrt() { (excess / whole).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ndarray::Array2;
    use std::f64::consts::TAU;

    /// Cells of 1 + slope cos C, with errors, and noise of `spread`.
    fn found(slope: f64, error: f64, spread: f64, symmetry: PlaneSymmetry) -> f64 {
        let value = |(ring, sector): (usize, usize)| {
            let noise =
                spread * f64::from((ring as u32 * 7919 + sector as u32 * 104_729) % 17) / 17.0;
            1.0 + slope * (TAU * (sector as f64 + 0.5) / 24.0).cos() + noise
        };
        let candela = Array2::from_shape_fn((18, 24), value);
        let std_errors = Array2::from_elem((18, 24), error);
        let means = CellMeans { candela: candela.view(), std_errors: std_errors.view() };
        asymmetry(&means, symmetry)
    }

    #[test]
    fn planes_that_differ_are_found_and_others_are_not() {
        // 1 + s cos C has a mean square of 1 + s²/2; about C0 it is symmetric.
        let whole = 1.0 + 0.5 * 0.2 * 0.2;
        for symmetry in
            [PlaneSymmetry::Rotational, PlaneSymmetry::Quadrants, PlaneSymmetry::AboutC90]
        {
            let own = found(0.2, 1e-3, 0.0, symmetry);
            assert!((own - (0.02_f64 / whole).sqrt()).abs() < 1e-4, "{symmetry:?} {own}");
        }
        for symmetry in [PlaneSymmetry::AboutC0, PlaneSymmetry::None] {
            assert_eq!(found(0.2, 1e-3, 0.0, symmetry), 0.0, "{symmetry:?}");
        }
    }

    #[test]
    fn noise_is_no_asymmetry() {
        // Evenly spread values have a standard deviation of 0.29 of their range.
        assert_eq!(found(0.0, 0.29, 1.0, PlaneSymmetry::Rotational), 0.0);
        assert!(found(0.0, 0.03, 1.0, PlaneSymmetry::Rotational) > 0.1);
    }
}
