//! Tristimulus values of a spectrum.

use crate::colour::observer::colour_matching;

/// First and last wavelength of sums, nm.
const SUMMED: [f64; 2] = [380.0, 780.0];

/// The values of a spectrum at `N` wavelengths, evenly spaced from 380 to 780 nm: 81 for every 5 nm, 401 for every nm.
pub fn sampled<const N: usize>(spectrum: impl Fn(f64) -> f64) -> [f64; N] {
    std::array::from_fn(|index| spectrum(wavelength(index, N)))
}

/// The tristimulus values X, Y, Z of a spectrum given at evenly spaced wavelengths from 380 to 780 nm, in the unit of the
/// spectrum times nm: sums as in CIE 015:2018, section 7, with k = 1. 683.002 lm/W times Y is a luminous flux if the
/// spectrum is in W/nm.
pub fn tristimulus(values: &[f64]) -> [f64; 3] {
    let [first, last] = SUMMED;
    let step = (last - first) / values.len().saturating_sub(1).max(1) as f64; // nm
    let mut sums = [0.0; 3];
    for (index, value) in values.iter().enumerate() {
        let matching = colour_matching(wavelength(index, values.len()));
        sums.iter_mut().zip(matching).for_each(|(sum, matching)| *sum += value * matching * step);
    }
    sums
}

/// The wavelength of one of `count` evenly spaced values, nm.
fn wavelength(index: usize, count: usize) -> f64 {
    let [first, last] = SUMMED;
    first + (last - first) * index as f64 / count.saturating_sub(1).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{Chromaticity, gaussian, observer::MAX_EFFICACY};

    #[test]
    fn gaussian_leds_have_the_colours_and_lumens_of_sums_over_5_nm() {
        // Peak nm, full width nm, x, y, lm/W: case CO-04 of the reference values.
        let leds = [
            (460.0, 25.0, 0.1429585913, 0.0349165588, 44.78715396),
            (525.0, 35.0, 0.1512205754, 0.7587022512, 507.4818061),
            (625.0, 20.0, 0.6944555092, 0.3054208274, 223.1782932),
        ];
        for (peak, width, x, y, efficacy) in leds {
            let values: [f64; 81] = sampled(|nm| gaussian(nm, peak, width));
            let sums = tristimulus(&values);
            let own = Chromaticity::from_tristimulus(sums).unwrap();
            assert!((own.x - x).abs() < 1e-6 && (own.y - y).abs() < 1e-6, "{peak}: {own:?}");
            let radiant = values.iter().sum::<f64>() * 5.0;
            assert!((MAX_EFFICACY * sums[1] / radiant - efficacy).abs() < 2e-3, "{peak}: {sums:?}");
        }
    }

    #[test]
    fn few_values_have_sums_too() {
        assert_eq!(tristimulus(&[]), [0.0; 3]);
        let one = tristimulus(&[1.0]);
        assert!(one[0] > 0.0 && one[0].is_finite(), "{one:?}");
        assert_eq!(sampled::<1>(|nm| nm), [380.0]);
    }
}
