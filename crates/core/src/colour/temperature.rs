//! Correlated colour temperature and the distance Duv from the Planckian locus.
//!
//! The temperature is that of the nearest point of the Planckian locus in the CIE 1960 diagram, which is the (u', 2/3 v')
//! diagram of the definition (CIE S 017:2020, 17-23-068; CIE 015:2018). The sign of Duv follows Ohno, LEUKOS 10 (2014) 47.
//! The locus is summed every nm from 360 to 830 nm, the whole range of the observer. A black body that is cut off at 380
//! and 780 nm is off the locus by up to 3e-5 in u, v: it seems 2 K colder at 6500 K, and 8 K at 10000 K.

use crate::colour::chromaticity::Chromaticity;
use crate::colour::observer::colour_matching;
use crate::colour::standard::planck;
use std::sync::LazyLock;

/// The second radiation constant, nm K, of ITS-90, which CIE 015:2018 takes for colour temperatures. That of CODATA 2018
/// is 1.6e-5 smaller, so that temperatures would be smaller by that part, 0.1 K at 6500 K.
const SECOND_RADIATION: f64 = 1.4388e7;
/// Farther from the locus a colour temperature has no meaning, 1 (CIE S 017:2020, 17-23-068).
const MAX_DUV: f64 = 5e-2;
/// The temperatures that are found, as reciprocals: 25000 to 1000 K in MK⁻¹.
const RECIPROCALS: std::ops::RangeInclusive<f64> = 40.0..=1000.0;
/// The first reciprocal temperature of [`LOCUS`], MK⁻¹; room for differences over 2 rows.
const FIRST: usize = 37;
/// The last one, MK⁻¹.
const LAST: usize = 1003;

/// The Planckian locus, u and v (CIE 1960) for every MK⁻¹.
static LOCUS: LazyLock<Vec<[f64; 2]>> = LazyLock::new(locus);

/// The colour temperature of light that is nearly white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourTemperature {
    /// The correlated colour temperature, K.
    pub kelvin: f64,
    /// The distance from the Planckian locus in the CIE 1960 diagram, 1; positive above it, where light is greenish.
    pub duv: f64,
}

/// The correlated colour temperature of a chromaticity, with an error below 0.01 K from 2000 to 10000 K; `None` where it
/// is beyond 1000 to 25000 K or farther than 0.05 from the Planckian locus.
pub fn correlated_colour_temperature(of: Chromaticity) -> Option<ColourTemperature> {
    let point = of.uv_1960();
    if !point.iter().all(|coordinate| coordinate.is_finite()) {
        return None;
    }
    let distance = |[u, v]: &[f64; 2]| (u - point[0]).powi(2) + (v - point[1]).powi(2);
    let rows = LOCUS.iter().map(distance).enumerate();
    let (nearest, _) = rows.min_by(|(_, one), (_, other)| one.total_cmp(other))?;
    let centre = nearest.clamp(2, LOCUS.len() - 3);
    let [u, v] =
        [0, 1].map(|axis| quartic(std::array::from_fn(|row| LOCUS[centre + row - 2][axis])));
    let offset = |at: f64| [point[0] - value(&u, at), point[1] - value(&v, at)];
    let tangent = |at: f64| [slope(&u, at), slope(&v, at)];

    // The nearest point is where the offset is normal to the locus, within a row of the nearest row.
    let [mut low, mut high] = [-1.0, 1.0];
    for _ in 0..48 {
        let at = 0.5 * (low + high);
        let [[du, dv], [tu, tv]] = [offset(at), tangent(at)];
        if du * tu + dv * tv > 0.0 { low = at } else { high = at }
    }
    let at = 0.5 * (low + high);
    let reciprocal = (FIRST + centre) as f64 + at;
    let [[du, dv], [tu, tv]] = [offset(at), tangent(at)];
    // u grows with the reciprocal temperature, so that above the locus is on the left.
    let duv = du.hypot(dv).copysign(tu * dv - tv * du);
    (RECIPROCALS.contains(&reciprocal) && duv.abs() <= MAX_DUV)
        .then_some(ColourTemperature { kelvin: 1e6 / reciprocal, duv })
}

/// The coefficients of the quartic through 5 values at -2, -1, 0, 1 and 2.
fn quartic([a, b, c, d, e]: [f64; 5]) -> [f64; 5] {
    [
        c,
        (a - 8.0 * b + 8.0 * d - e) / 12.0,
        (16.0 * (b + d) - a - e - 30.0 * c) / 24.0,
        (e - a + 2.0 * (b - d)) / 12.0,
        (a + e - 4.0 * (b + d) + 6.0 * c) / 24.0,
    ]
}

fn value([a, b, c, d, e]: &[f64; 5], at: f64) -> f64 {
    a + at * (b + at * (c + at * (d + at * e)))
}

fn slope([_, b, c, d, e]: &[f64; 5], at: f64) -> f64 {
    b + at * (2.0 * c + at * (3.0 * d + at * 4.0 * e))
}

fn locus() -> Vec<[f64; 2]> {
    let observer = observer();
    let uv = |reciprocal: usize| radiator(&observer, 1e6 / reciprocal as f64).uv_1960();
    (FIRST..=LAST).map(uv).collect()
}

/// The chromaticity of a Planckian radiator of a temperature in K, above 900.
pub(super) fn planckian(kelvin: f64) -> Chromaticity {
    radiator(&observer(), kelvin)
}

fn radiator(observer: &[(f64, [f64; 3])], kelvin: f64) -> Chromaticity {
    let mut sums = [0.0; 3];
    for (nm, matching) in observer {
        let value = planck(*nm, kelvin, SECOND_RADIATION);
        sums.iter_mut().zip(matching).for_each(|(sum, matching)| *sum += value * matching);
    }
    Chromaticity::from_tristimulus(sums).expect("a Planckian radiator above 900 K emits light")
}

/// The wavelengths from 360 to 830 nm, and the CIE 1931 colour-matching functions there.
fn observer() -> Vec<(f64, [f64; 3])> {
    let whole = (360..=830).map(f64::from);
    whole.map(|nm| (nm, colour_matching(nm))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{blackbody, illuminant_d65, sampled, tristimulus};

    fn temperature(x: f64, y: f64) -> ColourTemperature {
        correlated_colour_temperature(Chromaticity { x, y }).unwrap()
    }

    #[test]
    fn a_planckian_radiator_has_its_own_temperature() {
        let observer = observer();
        assert_eq!(observer.len(), 471);
        assert_eq!(observer[470].0, 830.0);
        for step in 0..400 {
            let kelvin = 1001.0 * (24_990.0_f64 / 1001.0).powf(f64::from(step) / 399.0);
            let own = correlated_colour_temperature(radiator(&observer, kelvin)).unwrap();
            assert!((own.kelvin / kelvin - 1.0).abs() < 1e-7, "{kelvin} {own:?}");
            assert!(own.duv.abs() < 1e-9, "{kelvin} {own:?}");
        }
    }

    #[test]
    fn a_black_body_cut_off_at_the_ends_of_the_visible_has_nearly_its_temperature() {
        for kelvin in [1500.0, 2856.0, 4000.0, 6500.0, 10_000.0] {
            let values: [f64; 401] = sampled(|nm| blackbody(nm, kelvin));
            let sums = tristimulus(&values);
            let own = Chromaticity::from_tristimulus(sums).unwrap();
            let own = correlated_colour_temperature(own).unwrap();
            assert!((own.kelvin / kelvin - 1.0).abs() < 1e-3, "{kelvin} {own:?}");
            assert!(own.duv.abs() < 5e-5, "{kelvin} {own:?}");
        }
    }

    #[test]
    fn temperatures_agree_with_an_independent_program() {
        // colour-science 0.4.7, uv_to_CCT_Ohno2013 with a spacing of 1.0002, whose locus ends at 780 nm.
        let cases = [
            (0.3127, 0.3290, 6504.312, 0.0032069),
            (0.44757, 0.40745, 2855.642, 0.0000039),
            (0.31, 0.33, 6643.223, 0.0050854),
            (0.45, 0.42, 2916.816, 0.0044920),
            (0.38, 0.36, 3878.915, -0.0079267),
            (0.28, 0.29, 9972.382, 0.0013012),
            (0.5, 0.4, 2151.546, -0.0049173),
            (0.57, 0.39, 1570.983, -0.0026985),
        ];
        for (x, y, kelvin, duv) in cases {
            let own = temperature(x, y);
            assert!((own.kelvin - kelvin).abs() < 0.1, "{x} {y}: {own:?} {kelvin}");
            assert!((own.duv - duv).abs() < 1e-6, "{x} {y}: {own:?} {duv}");
        }
    }

    #[test]
    fn temperatures_agree_with_a_golden_section_search() {
        // The observer of colour-science 0.4.7 with Planck's law from 360 to 830 nm.
        let cases = [
            (0.44757, 0.40745, 2855.68153, 0.0000044771),
            (0.3127, 0.3290, 6504.34482, 0.0032072028),
            (0.57, 0.39, 1571.05620, -0.0026978428),
            (0.5, 0.4, 2151.59503, -0.0049165881),
            (0.45, 0.42, 2916.85477, 0.0044926057),
            (0.38, 0.36, 3878.94672, -0.0079261587),
            (0.28, 0.29, 9972.42033, 0.0013013992),
            (0.36, 0.45, 4858.72764, 0.0370891597),
        ];
        for (x, y, kelvin, duv) in cases {
            let own = temperature(x, y);
            assert!((own.kelvin - kelvin).abs() < 1e-3, "{x} {y}: {own:?} {kelvin}");
            assert!((own.duv - duv).abs() < 1e-9, "{x} {y}: {own:?} {duv}");
        }
    }

    #[test]
    fn d65_has_its_published_temperature() {
        let values: [f64; 81] = sampled(illuminant_d65);
        let sums = tristimulus(&values);
        let own = Chromaticity::from_tristimulus(sums).unwrap();
        let own = correlated_colour_temperature(own).unwrap();
        assert!((own.kelvin - 6504.0).abs() < 2.0 && (own.duv - 0.0032).abs() < 5e-5, "{own:?}");
    }

    #[test]
    fn points_normal_to_the_locus_have_the_temperature_of_its_foot() {
        let observer = observer();
        for kelvin in [1500.0, 3000.0, 5000.0, 9000.0, 20_000.0] {
            let [[u, v], [later_u, later_v], [earlier_u, earlier_v]] =
                [kelvin, kelvin * 0.9999, kelvin * 1.0001]
                    .map(|kelvin| radiator(&observer, kelvin).uv_1960());
            let [tu, tv] = [later_u - earlier_u, later_v - earlier_v];
            let length = tu.hypot(tv);
            for duv in [-0.045, -0.02, 0.02, 0.045] {
                let [u, v] = [u - duv * tv / length, v + duv * tu / length];
                let denominator = 2.0 * u - 8.0 * v + 4.0;
                let own = temperature(3.0 * u / denominator, 2.0 * v / denominator);
                assert!((own.kelvin / kelvin - 1.0).abs() < 1e-5, "{kelvin} {duv}: {own:?}");
                assert!((own.duv - duv).abs() < 1e-6, "{kelvin} {duv}: {own:?}");
            }
        }
    }

    #[test]
    fn colours_far_from_white_have_no_temperature() {
        for (x, y) in [
            (0.2, 0.6),
            (0.15, 0.06),
            (0.25, 0.25),
            (0.7, 0.3),
            (f64::NAN, 0.3),
            (0.3, f64::INFINITY),
        ] {
            assert_eq!(correlated_colour_temperature(Chromaticity { x, y }), None, "{x} {y}");
        }
        assert_eq!(correlated_colour_temperature(Chromaticity { x: 1.5, y: 0.0 }), None);
    }
}
