use super::*;
use crate::optics::testing::{assert_follows, assert_reciprocal, incidence};
use crate::optics::{Bsdf, fresnel, shares};
use std::f64::consts::PI;

const ABG: HazeLaw = HazeLaw::Abg { a: 0.02, b: 0.01, g: 2.0 };
const HARVEY: HazeLaw = HazeLaw::Harvey { b0: 1.0, shoulder: 0.1, slope: -1.5 };
const SHEET: HazeBase =
    HazeBase::Sheet { reflectance: 0.45, transmittance: 0.5, scatters: HazeSides::Both };

fn all() -> Vec<Bsdf> {
    let through =
        HazeBase::Sheet { reflectance: 0.05, transmittance: 0.9, scatters: HazeSides::Transmitted };
    [(ABG, SHEET), (HARVEY, through), (ABG, HazeBase::Interface), (HARVEY, HazeBase::Interface)]
        .map(|(law, base)| Bsdf::Haze(Box::new(Haze::new(law, base))))
        .to_vec()
}

#[test]
fn scattered_light_follows_the_distribution_function_and_its_share_is_told() {
    for bsdf in all() {
        let Bsdf::Haze(haze) = &bsdf else { unreachable!() };
        for indices in [[1.0, 1.49], [1.49, 1.0], [1.3, 1.3]] {
            for angle in [0.0, 0.6, 1.2] {
                let incidence = incidence(angle, indices);
                for side in [Side::Reflected, Side::Transmitted] {
                    let integral = assert_follows(&bsdf, &incidence, side);
                    let told = haze.parts(&incidence).scattered.of(side);
                    let off = (integral - told).abs();
                    assert!(off <= 3e-3 * told, "{side:?} at {angle}: {integral}, {told}");
                }
            }
        }
    }
}

#[test]
fn haze_creates_and_absorbs_nothing_at_any_angle() {
    for bsdf in all() {
        for indices in [[1.0, 1.49], [1.49, 1.0], [1.3, 1.3], [4.0, 1.0]] {
            for angle in [0.0, 0.3, 0.8, 1.3, 1.57] {
                let shares = shares(&bsdf, &incidence(angle, indices));
                let sum = shares.reflected + shares.transmitted;
                assert!([1.0, 0.95].iter().any(|all| (sum - all).abs() < 1e-12), "{sum}");
            }
        }
    }
}

#[test]
fn the_distribution_function_is_reciprocal_between_media() {
    for law in [ABG, HARVEY] {
        let bsdf = Bsdf::Haze(Box::new(Haze::new(law, HazeBase::Interface)));
        for indices in [[1.0, 1.49], [1.49, 1.0]] {
            assert_reciprocal(&bsdf, indices);
        }
        assert_reciprocal(&Bsdf::Haze(Box::new(Haze::new(law, SHEET))), [1.0, 1.0]);
    }
}

#[test]
fn light_that_goes_on_undisturbed_does_so_in_the_same_share_both_ways() {
    for law in [ABG, HARVEY] {
        let haze = Haze::new(law, HazeBase::Interface);
        for angle in [0.0f64, 0.4, 1.0, 1.4] {
            let cos = fresnel::cos_transmitted(angle.cos(), 1.0, 1.49).unwrap();
            let there = haze.parts(&incidence(angle, [1.0, 1.49])).undisturbed.transmitted;
            let back = haze.parts(&incidence(cos.acos(), [1.49, 1.0])).undisturbed.transmitted;
            assert!((there - back).abs() < 1e-12, "{angle}: {there}, {back}");
        }
    }
}

#[test]
fn the_integrated_scatter_is_that_of_closed_forms() {
    // ABg with g = 2: π A ln(1 + 1/B), Stover eq. (4.26) with the exponent of 2.
    let abg = integrated_scatter(ABG, 1.0);
    assert!((abg / (PI * 0.02 * 101f64.ln()) - 1.0).abs() < 1e-3, "{abg}");
    let harvey = integrated_scatter(HARVEY, 1.0);
    let expected = 2.0 * PI * 0.01 / 0.5 * (101f64.powf(0.25) - 1.0);
    assert!((harvey / expected - 1.0).abs() < 1e-3, "{harvey}, {expected}");
}

#[test]
fn totally_reflected_light_is_scattered_out() {
    let haze = Haze::new(ABG, HazeBase::Interface);
    let shares = haze.shares(&incidence(0.8, [1.49, 1.0]));
    assert!(shares.transmitted > 0.01 && shares.transmitted < 0.2, "{shares:?}");
}
