use super::*;
use crate::optics::testing::{assert_follows, assert_reciprocal, incidence};
use crate::optics::{Bsdf, shares};

const INDICES: [[f64; 2]; 2] = [[1.0, 1.49], [1.49, 1.0]];

fn rough(roughness: f64, facets: Facets) -> Bsdf {
    Bsdf::Microfacet(Microfacet::new(roughness, facets))
}

fn all(roughness: f64) -> [Bsdf; 3] {
    [Facets::Interface, Facets::Mirror { reflectance: 0.9 }, Facets::Metal { n: 0.8, k: 5.9 }]
        .map(|facets| rough(roughness, facets))
}

#[test]
fn scattered_light_follows_the_distribution_function_and_its_share_is_told() {
    for bsdf in all(0.4).into_iter().chain([rough(0.15, Facets::Interface)]) {
        for indices in INDICES {
            for angle in [0.0, 0.6, 1.2] {
                let incidence = incidence(angle, indices);
                for side in [Side::Reflected, Side::Transmitted] {
                    let integral = assert_follows(&bsdf, &incidence, side);
                    let told = shares(&bsdf, &incidence).of(side);
                    assert!((integral - told).abs() < 4e-3, "{side:?} {angle}: {integral}, {told}");
                }
            }
        }
    }
}

#[test]
fn the_distribution_function_is_reciprocal() {
    for bsdf in all(0.3) {
        for indices in INDICES {
            assert_reciprocal(&bsdf, indices);
        }
    }
}

#[test]
fn rougher_facets_catch_more_of_the_light_and_none_creates_any() {
    for (roughness, most) in [(0.01, 5e-4), (0.1, 0.03), (0.3, 0.2), (1.0, 0.75)] {
        let mirror = rough(roughness, Facets::Mirror { reflectance: 1.0 });
        for angle in [0.0, 0.5, 1.0] {
            let lost = 1.0 - shares(&mirror, &incidence(angle, [1.0, 1.0])).reflected;
            assert!((-1e-12..most).contains(&lost), "{roughness} at {angle}: {lost}");
        }
    }
}

#[test]
fn fine_facets_share_light_as_a_smooth_interface() {
    let bsdf = rough(1e-3, Facets::Interface);
    for indices in INDICES {
        for angle in [0.0, 0.4, 0.6, 0.9, 1.2] {
            let incidence = incidence(angle, indices);
            let (fine, smooth) = (shares(&bsdf, &incidence), shares(&Bsdf::Smooth, &incidence));
            assert!((fine.reflected - smooth.reflected).abs() < 1e-3, "{fine:?}, {smooth:?}");
            assert!((fine.transmitted - smooth.transmitted).abs() < 1e-3, "{fine:?}, {smooth:?}");
        }
    }
}

#[test]
fn areas_of_facets_add_up_to_the_area_of_the_surface() {
    // ∫ D cos θ dω = 1 (WMLT eq. 4).
    for roughness in [0.05, 0.5, 1.0] {
        let surface = Microfacet::new(roughness, Facets::Interface);
        let steps = 20_000;
        let sum: f64 = (0..steps)
            .map(|i| {
                let cos = 1.0 - ((f64::from(i) + 0.5) / f64::from(steps)).powi(3);
                let width =
                    3.0 * ((f64::from(i) + 0.5) / f64::from(steps)).powi(2) / f64::from(steps);
                2.0 * PI * surface.density(cos) * cos * width
            })
            .sum();
        assert!((sum - 1.0).abs() < 1e-5, "{roughness}: {sum}");
    }
}

#[test]
fn between_equal_indices_small_facets_do_nothing() {
    let bsdf = rough(0.4, Facets::Interface);
    let incidence = incidence(0.7, [1.3, 1.3]);
    let mut sampler = Sampler::for_path(1, 0, 0);
    let out = bsdf.scatter(&incidence, &mut sampler).unwrap();
    assert_eq!((out.dir, out.factor, out.side), (incidence.dir, 1.0, Side::Transmitted));
}
