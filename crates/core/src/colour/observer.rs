//! The standard colorimetric observers: CIE 1931 for fields up to 4 degrees wide, CIE 1964 for wider ones.

use std::sync::LazyLock;

/// The wavelengths of light here, nm: the bands 5 nm wide about 380, 385, ... 780 nm of sums as in CIE 015:2018, section 7.
/// Beyond them the eye sees less than 1e-4 of its best.
pub const VISIBLE: [f64; 2] = [377.5, 782.5];
/// Luminous flux per radiant flux where V(λ) is 1, lm/W. V is exactly 1 at 555 nm and 683 lm/W hold at 540 THz, 555.016 nm
/// (CIE 018:2019, section 4).
pub const MAX_EFFICACY: f64 = 683.002;
/// The first wavelength of the tables, nm.
const FIRST: f64 = 360.0;

/// Every nm from 360 to 830 nm, x, y and z.
static TABLE: LazyLock<Vec<[f64; 3]>> =
    LazyLock::new(|| columns(include_str!("../../data/observer.csv")));
/// Likewise, of the observer for wide fields.
static TABLE_10_DEG: LazyLock<Vec<[f64; 3]>> =
    LazyLock::new(|| columns(include_str!("../../data/observer_10deg.csv")));

/// The colour-matching functions x, y, z of the CIE 1931 observer at a wavelength in nm, 1; 0 beyond 360 to 830 nm (ISO/CIE
/// 11664-1:2019). The second is V(λ).
pub(crate) fn colour_matching(nm: f64) -> [f64; 3] {
    std::array::from_fn(|column| linear(&TABLE, [FIRST, 1.0], nm, |row| row[column]))
}

/// The colour-matching functions of the CIE 1964 observer, for fields of 10 degrees, likewise (ISO/CIE 11664-1:2019).
pub(crate) fn colour_matching_10_deg(nm: f64) -> [f64; 3] {
    std::array::from_fn(|column| linear(&TABLE_10_DEG, [FIRST, 1.0], nm, |row| row[column]))
}

/// The luminous efficiency V(λ) of photopic vision, 1.
pub(crate) fn luminous_efficiency(nm: f64) -> f64 {
    linear(&TABLE, [FIRST, 1.0], nm, |[_, y, _]| *y)
}

/// The value at a wavelength, nm, of a table with a first wavelength and a step, nm; 0 beyond it.
pub(super) fn linear<R>(
    rows: &[R],
    [first, step]: [f64; 2],
    nm: f64,
    value: impl Fn(&R) -> f64,
) -> f64 {
    let at = (nm - first) / step;
    if !(0.0..=(rows.len() - 1) as f64).contains(&at) {
        return 0.0;
    }
    let row = (at as usize).min(rows.len() - 2);
    let [low, high] = [value(&rows[row]), value(&rows[row + 1])];
    low + (at - row as f64) * (high - low)
}

/// The columns after the first of a table of this program.
pub(super) fn columns<const N: usize>(text: &str) -> Vec<[f64; N]> {
    let row = |line: &str| {
        let mut numbers =
            line.split(',').skip(1).map(|number| number.trim().parse().unwrap_or(0.0));
        std::array::from_fn(|_| numbers.next().unwrap_or(0.0))
    };
    text.lines().skip(1).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{Chromaticity, illuminant_a, illuminant_d65};

    #[test]
    fn a_watt_has_the_lumens_of_its_wavelength() {
        // CIE 018:2019: V is 0.038, 0.862, 1 and 0.381; by 683 lm/W.
        for (nm, lumens) in [(450.0, 25.954), (530.0, 588.746), (555.0, 683.0), (620.0, 260.223)] {
            assert!((MAX_EFFICACY * luminous_efficiency(nm) - lumens).abs() < 2.5e-3, "{nm}");
        }
        assert_eq!(luminous_efficiency(359.0), 0.0);
        assert_eq!(luminous_efficiency(f64::NAN), 0.0);
    }

    #[test]
    fn white_points_in_a_wide_field_are_those_of_the_cie() {
        // CIE 015:2018: x10 and y10 of the standard illuminants.
        type Law = fn(f64) -> f64;
        let illuminants: [(Law, [f64; 2]); 2] =
            [(illuminant_a, [0.45117, 0.40594]), (illuminant_d65, [0.31381, 0.33098])];
        for (law, [x, y]) in illuminants {
            let mut sums = [0.0; 3];
            for nm in 377..=782 {
                let own = colour_matching_10_deg(f64::from(nm));
                sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own * law(f64::from(nm)));
            }
            let white = Chromaticity::from_tristimulus(sums).unwrap();
            assert!((white.x - x).abs() < 5e-5 && (white.y - y).abs() < 5e-5, "{white:?}");
        }
    }

    #[test]
    fn equal_energy_is_white() {
        let mut sums = [0.0; 3];
        for nm in 380..=780 {
            let own = colour_matching(f64::from(nm));
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
        }
        assert!((sums[0] / sums[1] - 1.0).abs() < 1e-4, "{sums:?}");
        assert!((sums[2] / sums[1] - 1.0).abs() < 1e-4, "{sums:?}");
    }
}
