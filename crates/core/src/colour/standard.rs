//! Relative spectra of illuminants and model sources as functions of wavelength. Those of the CIE are scaled to 1 at 560 nm.

use crate::colour::observer::{columns, linear};
use std::sync::LazyLock;

/// The second radiation constant hc/k, nm K (CODATA 2018, exact to all digits given).
const SECOND_RADIATION: f64 = 1.438776877e7;
/// The second radiation constant in the definition of illuminant A, nm K (ISO/CIE 11664-2:2022).
const SECOND_RADIATION_A: f64 = 1.435e7;
/// The temperature of illuminant A with that constant, K.
const TEMPERATURE_A: f64 = 2848.0;
/// The wavelength where spectra are 1, nm.
const UNITY: f64 = 560.0;
/// The temperatures of daylight phases, K (CIE 015:2018).
const DAYLIGHT: std::ops::RangeInclusive<f64> = 4000.0..=25_000.0;

/// First wavelength and step of the tables, nm.
const FIVE_NM: [f64; 2] = [375.0, 5.0];

/// S0, S1 and S2.
static COMPONENTS: LazyLock<Vec<[f64; 3]>> =
    LazyLock::new(|| columns(include_str!("../../data/daylight.csv")));
/// 100 at 560 nm.
static D65: LazyLock<Vec<[f64; 1]>> = LazyLock::new(|| columns(include_str!("../../data/d65.csv")));

/// The spectrum of CIE standard illuminant A, 1 at 560 nm (ISO/CIE 11664-2:2022).
pub fn illuminant_a(nm: f64) -> f64 {
    planck(nm, TEMPERATURE_A, SECOND_RADIATION_A)
}

/// The spectrum of CIE standard illuminant D65, 1 at 560 nm: the table of ISO/CIE 11664-2:2022, which defines it, every
/// 5 nm and linear between; 0 beyond 375 to 785 nm. [`DaylightPhase`] at 6503.6 K differs by up to 7e-4.
pub fn illuminant_d65(nm: f64) -> f64 {
    linear(&D65, FIVE_NM, nm, |[value]| *value) / 100.0
}

/// The spectrum of a black body by Planck's law in vacuum, 1 at 560 nm; 0 where the temperature in K or the wavelength is
/// not positive.
pub fn blackbody(nm: f64, kelvin: f64) -> f64 {
    planck(nm, kelvin, SECOND_RADIATION)
}

/// The equal-energy spectrum E, 1 at all wavelengths.
pub fn equal_energy(_nm: f64) -> f64 {
    1.0
}

/// A model of a coloured LED: a Gaussian in wavelength, 1 at its peak, with a full width at half maximum, all in nm; 0
/// where the width is not positive.
pub fn gaussian(nm: f64, peak: f64, full_width: f64) -> f64 {
    let widths = (nm - peak) / full_width;
    let value = (-4.0 * std::f64::consts::LN_2 * widths * widths).exp();
    if full_width > 0.0 && value.is_finite() { value } else { 0.0 }
}

/// A phase of daylight, CIE illuminant D of any correlated colour temperature (CIE 015:2018).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DaylightPhase {
    m1: f64,
    m2: f64,
}

impl DaylightPhase {
    /// The phase of a correlated colour temperature from 4000 to 25000 K; `None` beyond. Its factors M1 and M2 are not
    /// rounded to 3 decimals as for the tables of the CIE, so that it changes steadily with temperature.
    pub fn new(kelvin: f64) -> Option<Self> {
        if !DAYLIGHT.contains(&kelvin) {
            return None;
        }
        let [t1, t2, t3] = [1e3 / kelvin, 1e6 / kelvin.powi(2), 1e9 / kelvin.powi(3)];
        let x = if kelvin <= 7000.0 {
            0.244063 + 0.09911 * t1 + 2.9678 * t2 - 4.6070 * t3
        } else {
            0.237040 + 0.24748 * t1 + 1.9018 * t2 - 2.0064 * t3
        };
        let y = -3.000 * x * x + 2.870 * x - 0.275;
        let denominator = 0.0241 + 0.2562 * x - 0.7341 * y;
        let m1 = (-1.3515 - 1.7703 * x + 5.9114 * y) / denominator;
        let m2 = (0.0300 - 31.4424 * x + 30.0717 * y) / denominator;
        Some(Self { m1, m2 })
    }

    /// The spectrum at a wavelength in nm, 1 at 560 nm; 0 beyond 375 to 785 nm.
    pub fn at(self, nm: f64) -> f64 {
        linear(&COMPONENTS, FIVE_NM, nm, |[s0, s1, s2]| s0 + self.m1 * s1 + self.m2 * s2) / 100.0
    }
}

/// Planck's law with a given second radiation constant in nm K, 1 at 560 nm.
pub(super) fn planck(nm: f64, kelvin: f64, second_radiation: f64) -> f64 {
    let [own, unity] = [nm, UNITY].map(|nm| second_radiation / (nm * kelvin));
    // (e^unity - 1) / (e^own - 1), which does not overflow where both are large.
    let ratio = (unity - own).exp() * (-unity).exp_m1() / (-own).exp_m1();
    let value = (UNITY / nm).powi(5) * ratio;
    if nm > 0.0 && kelvin > 0.0 && value.is_finite() { value } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{Chromaticity, sampled, tristimulus};

    /// By sums every 5 nm.
    fn chromaticity(spectrum: impl Fn(f64) -> f64) -> Chromaticity {
        let values: [f64; 81] = sampled(spectrum);
        let sums = tristimulus(&values);
        Chromaticity::from_tristimulus(sums).unwrap()
    }

    #[test]
    fn white_points_agree_with_the_reference_values() {
        // Case CO-02 of the reference values; CIE 015:2018: A (0.44758, 0.40745), D65 (0.31272, 0.32903).
        let cases = [
            (chromaticity(illuminant_a), 0.4475750179, 0.4074457172),
            (chromaticity(illuminant_d65), 0.3127205252, 0.329030685),
            (chromaticity(|nm| blackbody(nm, 2856.0)), 0.4475367125, 0.4074345809),
        ];
        for (own, x, y) in cases {
            assert!((own.x - x).abs() < 2e-6 && (own.y - y).abs() < 2e-6, "{own:?} {x} {y}");
        }
        let own = chromaticity(equal_energy);
        assert!((own.x - 1.0 / 3.0).abs() < 2e-5 && (own.y - 1.0 / 3.0).abs() < 2e-5, "{own:?}");
    }

    #[test]
    fn a_black_body_of_2856_k_has_the_reference_efficacy() {
        let values: [f64; 81] = sampled(|nm| blackbody(nm, 2856.0));
        let [_, y, _] = tristimulus(&values);
        let efficacy = 683.002 * y / (5.0 * values.iter().sum::<f64>()); // lm/W inside 380 to 780 nm
        assert!((efficacy - 154.1664118).abs() < 0.05, "{efficacy}");
    }

    #[test]
    fn daylight_agrees_with_published_white_points() {
        // x, y of D50, D55 and D75, CIE 015:2018.
        for (nominal, x, y) in
            [(5000.0, 0.34567, 0.35851), (5500.0, 0.33243, 0.34744), (7500.0, 0.29903, 0.31488)]
        {
            let phase = DaylightPhase::new(nominal * 1.4388 / 1.4380).unwrap();
            let own = chromaticity(|nm| phase.at(nm));
            assert!((own.x - x).abs() < 5e-5 && (own.y - y).abs() < 5e-5, "{own:?} {x} {y}");
        }
    }

    #[test]
    fn daylight_agrees_with_an_independent_program() {
        // colour-science 0.4.7, sd_CIE_illuminant_D_series without rounding: at 400, 450, 500, 600 and 700 nm.
        let cases = [
            (4000.0, [26.391499, 63.388245, 84.485836, 108.271447, 121.445510]),
            (5003.0, [49.327945, 87.264918, 95.731821, 97.683150, 91.591356]),
            (10_000.0, [138.722401, 162.666177, 129.896827, 83.504077, 57.423253]),
        ];
        for (kelvin, values) in cases {
            let phase = DaylightPhase::new(kelvin).unwrap();
            for (nm, value) in [400.0, 450.0, 500.0, 600.0, 700.0].into_iter().zip(values) {
                assert!((100.0 * phase.at(nm) - value).abs() < 1e-5, "{kelvin} K, {nm} nm");
            }
        }
        let phase = DaylightPhase::new(6500.0 * 1.4388 / 1.4380).unwrap();
        for nm in (380..=780).step_by(5).map(f64::from) {
            assert!((phase.at(nm) - illuminant_d65(nm)).abs() < 7e-4, "{nm}");
        }
    }

    #[test]
    fn spectra_are_1_at_560_nm() {
        for value in [
            illuminant_a(560.0),
            illuminant_d65(560.0),
            blackbody(560.0, 1234.0),
            equal_energy(560.0),
            gaussian(560.0, 560.0, 20.0),
            DaylightPhase::new(9000.0).unwrap().at(560.0),
        ] {
            assert!((value - 1.0).abs() < 1e-12, "{value}");
        }
        assert!((gaussian(550.0, 560.0, 20.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn senseless_numbers_have_no_light() {
        for bad in [0.0, -1.0, f64::NAN] {
            assert_eq!(blackbody(500.0, bad), 0.0);
            assert_eq!(blackbody(bad, 3000.0), 0.0);
            assert_eq!(gaussian(500.0, 500.0, bad), 0.0);
            assert_eq!(DaylightPhase::new(bad), None);
            assert_eq!(illuminant_d65(bad), 0.0);
        }
        assert_eq!(DaylightPhase::new(25_001.0), None);
        for nm in [380.0, 560.0, 780.0] {
            assert!(blackbody(nm, 1e-3).is_finite() && blackbody(nm, 1e9).is_finite());
        }
    }
}
