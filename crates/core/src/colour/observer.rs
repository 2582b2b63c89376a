//! The CIE 1931 standard colorimetric observer, for fields up to 4 degrees wide.

use std::sync::LazyLock;

/// The wavelengths of light here, nm: the bands 5 nm wide about 380, 385, ... 780 nm of sums as in CIE 015:2018, section 7.
/// Beyond them the eye sees less than 1e-4 of its best.
pub const VISIBLE: [f64; 2] = [377.5, 782.5];
/// Luminous flux per radiant flux where V(λ) is 1, lm/W. V is exactly 1 at 555 nm and 683 lm/W hold at 540 THz, 555.016 nm
/// (CIE 018:2019, section 4).
pub const MAX_EFFICACY: f64 = 683.002;
/// The first wavelength of the table, nm.
const FIRST: f64 = 360.0;

/// Every nm from 360 to 830 nm, x, y and z.
static TABLE: LazyLock<Vec<[f64; 3]>> =
    LazyLock::new(|| columns(include_str!("../../data/observer.csv")));

/// The colour-matching functions x, y, z of the CIE 1931 observer at a wavelength in nm, 1; 0 beyond 360 to 830 nm (ISO/CIE
/// 11664-1:2019). The second is V(λ).
pub(crate) fn colour_matching(nm: f64) -> [f64; 3] {
    std::array::from_fn(|column| linear(&TABLE, [FIRST, 1.0], nm, |row| row[column]))
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
