//! The colour rendering indices of CIE 13.3-1995.

use crate::colour::chromaticity::Chromaticity;
use crate::colour::observer::columns;
use crate::colour::standard::{DaylightPhase, blackbody};
use crate::colour::temperature::correlated_colour_temperature;
use crate::colour::tristimulus::{sampled, tristimulus};
use std::sync::LazyLock;

/// How many test colours there are.
const TEST_COLOURS: usize = 14;
/// How many of them the general index averages, from the first.
const GENERAL: usize = 8;
/// From here on the reference illuminant is daylight, K (CIE 13.3-1995).
const DAYLIGHT_FROM: f64 = 5000.0;
/// Every 5 nm, the radiance factors of the test colours.
static FACTORS: LazyLock<Vec<[f64; TEST_COLOURS]>> =
    LazyLock::new(|| columns(include_str!("../../data/test_colours.csv")));

/// How a source renders the test colours, compared with the reference illuminant of its colour temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourRendering {
    /// The general index Ra, 1: 100 at best; negative for poor sources.
    pub general: f64,
    /// The special indices R1 to R14, 1.
    pub special: [f64; TEST_COLOURS],
}

/// The colour rendering indices of a spectrum every 5 nm from 380 to 780 nm, in any unit; `None` where its correlated
/// colour temperature is undefined. Beyond the tolerance of CIE 13.3-1995, 5.4e-3 from the reference illuminant in u, v, the
/// indices are given all the same, as other programs do.
pub fn colour_rendering(spectrum: &[f64; 81]) -> Option<ColourRendering> {
    let source = Rendition::of(spectrum)?;
    let temperature = correlated_colour_temperature(source.white)?;
    let reference = Rendition::of(&reference(temperature.kelvin)?)?;
    let adapted = |uv| adapt(uv, source.white.uv_1960(), reference.white.uv_1960());
    let special = std::array::from_fn(|index| {
        let one = uniform(adapted(source.samples[index].0), source.samples[index].1, &reference);
        let other = uniform(reference.samples[index].0, reference.samples[index].1, &reference);
        let square: f64 = one.iter().zip(other).map(|(one, other)| (one - other).powi(2)).sum();
        100.0 - 4.6 * square.sqrt()
    });
    let general = special[..GENERAL].iter().sum::<f64>() / GENERAL as f64;
    let result = ColourRendering { general, special };
    special.iter().all(|index| index.is_finite()).then_some(result)
}

/// The reference illuminant of a colour temperature in K: a Planckian radiator below 5000 K, daylight above.
fn reference(kelvin: f64) -> Option<[f64; 81]> {
    if kelvin < DAYLIGHT_FROM {
        return Some(sampled(|nm| blackbody(nm, kelvin)));
    }
    let phase = DaylightPhase::new(kelvin)?;
    Some(sampled(|nm| phase.at(nm)))
}

/// An illuminant, and the test colours under it.
struct Rendition {
    white: Chromaticity,
    /// u and v (CIE 1960), and Y in % of the illuminant's.
    samples: Vec<([f64; 2], f64)>,
}

impl Rendition {
    fn of(spectrum: &[f64; 81]) -> Option<Self> {
        let sums = |values: &[f64]| tristimulus(values);
        let white = sums(spectrum);
        let sample = |index: usize| {
            let values =
                spectrum.iter().zip(FACTORS.iter()).map(|(value, factors)| value * factors[index]);
            let own = sums(&values.collect::<Vec<_>>());
            Some((Chromaticity::from_tristimulus(own)?.uv_1960(), 100.0 * own[1] / white[1]))
        };
        let samples = (0..TEST_COLOURS).map(sample).collect::<Option<_>>()?;
        Some(Self { white: Chromaticity::from_tristimulus(white)?, samples })
    }
}

/// The coordinates u, v of a colour under the source, as seen when adapted to the reference illuminant: the von Kries
/// transformation of CIE 13.3-1995.
fn adapt(colour: [f64; 2], source: [f64; 2], reference: [f64; 2]) -> [f64; 2] {
    let c = |[u, v]: [f64; 2]| (4.0 - u - 10.0 * v) / v;
    let d = |[u, v]: [f64; 2]| (1.708 * v + 0.404 - 1.481 * u) / v;
    let c = c(reference) / c(source) * c(colour);
    let d = d(reference) / d(source) * d(colour);
    let denominator = 16.518 + 1.481 * c - d;
    [(10.872 + 0.404 * c - 4.0 * d) / denominator, 5.520 / denominator]
}

/// The coordinates W*, U*, V* of the CIE 1964 uniform colour space, with the reference illuminant as white.
fn uniform([u, v]: [f64; 2], luminance: f64, reference: &Rendition) -> [f64; 3] {
    let [white_u, white_v] = reference.white.uv_1960();
    let w = 25.0 * luminance.cbrt() - 17.0;
    [w, 13.0 * w * (u - white_u), 13.0 * w * (v - white_v)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{equal_energy, gaussian, illuminant_a, illuminant_d65};

    /// Fluorescent lamps of CIE 015:2018, every 5 nm from 380 nm.
    const FL2: [f64; 81] = [
        1.18, 1.48, 1.84, 2.15, 3.44, 15.69, 3.85, 3.74, 4.19, 4.62, 5.06, 34.98, 11.81, 6.27,
        6.63, 6.93, 7.19, 7.4, 7.54, 7.62, 7.65, 7.62, 7.62, 7.45, 7.28, 7.15, 7.05, 7.04, 7.16,
        7.47, 8.04, 8.88, 10.01, 24.88, 16.64, 14.59, 16.16, 17.56, 18.62, 21.47, 22.79, 19.29,
        18.66, 17.73, 16.54, 15.21, 13.8, 12.36, 10.95, 9.65, 8.4, 7.32, 6.31, 5.43, 4.68, 4.02,
        3.45, 2.96, 2.55, 2.19, 1.89, 1.64, 1.53, 1.27, 1.1, 0.99, 0.88, 0.76, 0.68, 0.61, 0.56,
        0.54, 0.51, 0.47, 0.47, 0.43, 0.46, 0.47, 0.4, 0.33, 0.27,
    ];
    #[expect(clippy::approx_constant, reason = "3.14 is a power here")]
    const FL4: [f64; 81] = [
        0.57, 0.7, 0.87, 0.98, 2.01, 13.75, 1.95, 1.59, 1.76, 1.93, 2.1, 30.28, 8.03, 2.55, 2.7,
        2.82, 2.91, 2.99, 3.04, 3.08, 3.09, 3.09, 3.14, 3.06, 3.0, 2.98, 3.01, 3.14, 3.41, 3.9,
        4.69, 5.81, 7.32, 22.59, 15.11, 13.88, 16.33, 18.68, 20.64, 24.28, 26.26, 23.28, 22.94,
        22.14, 20.91, 19.43, 17.74, 16.0, 14.42, 12.56, 10.93, 9.52, 8.18, 7.01, 6.0, 5.11, 4.36,
        3.69, 3.13, 2.64, 2.24, 1.91, 1.7, 1.39, 1.18, 1.03, 0.88, 0.74, 0.64, 0.54, 0.49, 0.46,
        0.42, 0.37, 0.37, 0.33, 0.35, 0.36, 0.31, 0.26, 0.19,
    ];
    const FL11: [f64; 81] = [
        0.91, 0.63, 0.46, 0.37, 1.29, 12.68, 1.59, 1.79, 2.46, 3.33, 4.49, 33.94, 12.13, 6.95,
        7.19, 7.12, 6.72, 6.13, 5.46, 4.79, 5.66, 14.29, 14.96, 8.97, 4.72, 2.33, 1.47, 1.1, 0.89,
        0.83, 1.18, 4.9, 39.59, 72.84, 32.61, 7.52, 2.83, 1.96, 1.67, 4.43, 11.28, 14.76, 12.73,
        9.74, 7.33, 9.72, 55.27, 42.58, 13.18, 13.16, 12.26, 5.11, 2.07, 2.34, 3.58, 3.01, 2.48,
        2.14, 1.54, 1.33, 1.46, 1.94, 2.0, 1.2, 1.35, 4.1, 5.58, 2.51, 0.57, 0.27, 0.23, 0.21,
        0.24, 0.24, 0.2, 0.24, 0.32, 0.26, 0.16, 0.12, 0.09,
    ];

    /// Gaussian LEDs: power at the peak, peak nm, full width nm.
    fn leds<const N: usize>(leds: [(f64, f64, f64); N]) -> [f64; 81] {
        sampled(|nm| leds.iter().map(|(peak, at, width)| peak * gaussian(nm, *at, *width)).sum())
    }

    fn assert_near(name: &str, spectrum: &[f64; 81], general: f64, special: [f64; 14]) {
        let own = colour_rendering(spectrum).unwrap();
        assert!((own.general - general).abs() < 0.02, "{name}: {own:?} {general}");
        for (own, special) in own.special.iter().zip(special) {
            assert!((own - special).abs() < 0.1, "{name}: {own} {special}");
        }
    }

    #[test]
    fn fluorescent_lamps_have_their_published_indices() {
        // Ra of CIE 015:2018, whole numbers.
        for (name, spectrum, general) in
            [("FL2", FL2, 64.0), ("FL4", FL4, 51.0), ("FL11", FL11, 83.0)]
        {
            let own = colour_rendering(&spectrum).unwrap();
            assert_eq!(own.general.round(), general, "{name}: {own:?}");
        }
    }

    #[test]
    fn indices_of_lamps_agree_with_an_independent_program() {
        // colour-science 0.4.7, colour_rendering_index, which interpolates to other wavelengths first.
        #[rustfmt::skip]
        let cases = [
            ("FL2", FL2, 64.152, [55.94, 76.69, 90.29, 56.98, 58.94, 67.16, 74.08, 33.13, -83.91, 45.3, 45.86, 53.69, 60.28, 94.05]),
            ("FL4", FL4, 51.353, [42.02, 69.86, 90.44, 37.76, 40.85, 53.7, 64.88, 11.31, -111.3, 31.42, 18.28, 24.98, 46.76, 94.33]),
            ("FL11", FL11, 82.826, [98.33, 92.89, 50.4, 88.41, 87.33, 77.32, 88.49, 79.45, 25.25, 46.78, 72.3, 53.04, 96.94, 66.71]),
        ];
        for (name, spectrum, general, special) in cases {
            assert_near(name, &spectrum, general, special);
        }
    }

    #[test]
    fn indices_of_leds_agree_with_an_independent_program() {
        // colour-science 0.4.7, as above.
        let white = leds([(0.9, 450.0, 20.0), (1.0, 570.0, 120.0)]);
        #[rustfmt::skip]
        assert_near("white", &white, 66.700, [59.11, 74.32, 88.53, 63.21, 60.1, 64.62, 81.32, 42.39, -67.63, 41.38, 56.44, 30.44, 61.89, 93.52]);
        let warm = leds([(0.35, 450.0, 20.0), (1.0, 600.0, 130.0)]);
        #[rustfmt::skip]
        assert_near("warm", &warm, 73.869, [70.0, 82.1, 93.03, 69.44, 67.66, 73.55, 82.87, 52.3, -9.82, 58.33, 61.95, 44.73, 71.54, 95.61]);
        let mixed = leds([(1.0, 460.0, 25.0), (0.9, 525.0, 35.0), (1.1, 625.0, 20.0)]);
        #[rustfmt::skip]
        assert_near("mixed", &mixed, 57.324, [44.58, 84.43, 63.65, 49.63, 65.49, 78.49, 60.65, 11.67, -131.48, 71.18, 33.73, 65.87, 53.81, 75.16]);
    }

    #[test]
    fn reference_illuminants_render_perfectly() {
        let daylight = [5003.0, 5503.0, 7504.0, 12_000.0, 20_000.0];
        let daylight = daylight.map(|kelvin| {
            let phase = DaylightPhase::new(kelvin).unwrap();
            sampled(|nm| phase.at(nm))
        });
        let black = [1200.0, 2000.0, 3000.0, 4000.0, 4950.0]
            .map(|kelvin| sampled(|nm| blackbody(nm, kelvin)));
        let standard = [sampled(illuminant_a), sampled(illuminant_d65)];
        for spectrum in daylight.iter().chain(&black).chain(&standard) {
            let own = colour_rendering(spectrum).unwrap();
            assert!(own.special.iter().all(|index| (index - 100.0).abs() < 0.05), "{own:?}");
            assert!((own.general - 100.0).abs() < 0.02, "{own:?}");
        }
    }

    #[test]
    fn the_unit_of_a_spectrum_does_not_matter() {
        let scaled = FL2.map(|value| 1e-7 * value);
        let [one, other] =
            [FL2, scaled].map(|spectrum| colour_rendering(&spectrum).unwrap().general);
        assert!((one - other).abs() < 1e-9, "{one} {other}");
    }

    #[test]
    fn spectra_without_colour_temperature_have_no_indices() {
        for spectrum in [[0.0; 81], [f64::NAN; 81], [-1.0; 81], [f64::INFINITY; 81]] {
            assert_eq!(colour_rendering(&spectrum), None);
        }
        assert_eq!(colour_rendering(&leds([(1.0, 525.0, 35.0)])), None);
        assert!(colour_rendering(&sampled(equal_energy)).is_some());
    }
}
