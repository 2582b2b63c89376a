use super::*;
use crate::optics::{AngleTable, Facets, Gaussian, Haze, HazeBase, HazeLaw, Microfacet};
use crate::tally::Tally;

fn incidence(angle_deg: f64, index_from: f64, index_to: f64) -> Incidence {
    let angle = angle_deg.to_radians();
    Incidence {
        dir: DVec3::new(angle.sin(), 0.0, -angle.cos()),
        normal: DVec3::Z,
        index_from,
        index_to,
        grain: DVec3::ZERO,
    }
}

fn finishes() -> Vec<Bsdf> {
    let lobe = Gaussian::new(0.2);
    vec![
        Bsdf::Smooth,
        Bsdf::Specular { reflectance: 0.5, transmittance: 0.3 },
        Bsdf::Metal { n: 0.8, k: 5.9 },
        Bsdf::Absorber,
        Bsdf::Open,
        Bsdf::Lambertian { reflectance: 0.6, transmittance: 0.4 },
        Bsdf::GaussianSheet { lobe: lobe.clone(), reflectance: 0.9, transmittance: 0.05 },
        Bsdf::GaussianDielectric { lobe },
        Bsdf::Tabulated {
            reflectance: AngleTable::constant(0.4),
            transmittance: AngleTable::constant(0.6),
        },
        Bsdf::Coated { reflectance: AngleTable::constant(0.1) },
        Bsdf::Microfacet(Microfacet::new(0.5, Facets::Interface)),
        Bsdf::Microfacet(Microfacet::new(0.2, Facets::Metal { n: 0.8, k: 5.9 })),
        Bsdf::Haze(Box::new(Haze::new(
            HazeLaw::Abg { a: 0.05, b: 0.1, g: 2.0 },
            HazeBase::Interface,
        ))),
        Bsdf::Mixture(vec![
            (0.3, Bsdf::Absorber),
            (0.7, Bsdf::Specular { reflectance: 1.0, transmittance: 0.0 }),
        ]),
    ]
}

#[test]
fn no_finish_creates_light_and_each_leaves_on_the_side_it_says() {
    for bsdf in finishes() {
        for angle in [0.0, 30.0, 60.0, 85.0, 89.99] {
            let incidence = incidence(angle, 1.49, 1.0);
            for index in 0..200 {
                let mut sampler = Sampler::for_path(1, 0, index);
                let Some(out) = bsdf.scatter(&incidence, &mut sampler) else { continue };
                assert!((0.0..=1.0).contains(&out.factor), "{bsdf:?}");
                match out.side {
                    Side::Reflected => assert!(out.dir.z >= 0.0, "{bsdf:?} at {angle}"),
                    Side::Transmitted => assert!(out.dir.z <= 0.0, "{bsdf:?} at {angle}"),
                }
            }
        }
    }
}

#[test]
fn mirrors_and_total_reflection_draw_no_numbers() {
    let mirror = Bsdf::Specular { reflectance: 0.9, transmittance: 0.0 };
    for (bsdf, incidence) in
        [(mirror, incidence(20.0, 1.0, 1.0)), (Bsdf::Smooth, incidence(60.0, 1.49, 1.0))]
    {
        let mut used = Sampler::for_path(1, 0, 0);
        let mut fresh = used.clone();
        assert!(bsdf.scatter(&incidence, &mut used).is_some());
        assert_eq!(used.one(Dimension::Lobe), fresh.one(Dimension::Lobe));
    }
}

#[test]
fn shares_of_a_mixture_follow_the_weights() {
    let bsdf = finishes().pop().unwrap();
    let survived = Tally::of((0..20_000).map(|index| {
        let mut sampler = Sampler::for_path(9, 0, index);
        bsdf.scatter(&incidence(10.0, 1.0, 1.0), &mut sampler).map_or(0.0, |out| out.factor)
    }));
    assert!(survived.sigmas_from(0.7).abs() < 4.0, "{survived:?}");
}

#[test]
fn a_smooth_interface_reflects_the_share_that_fresnel_says() {
    let incidence = incidence(40.0, 1.49, 1.0);
    let expected = fresnel::dielectric(incidence.cos(), 1.49, 1.0).unpolarised();
    let reflected = Tally::of((0..50_000).map(|index| {
        let mut sampler = Sampler::for_path(2, 0, index);
        let out = Bsdf::Smooth.scatter(&incidence, &mut sampler).unwrap();
        if out.side == Side::Reflected { 1.0 } else { 0.0 }
    }));
    assert!(reflected.sigmas_from(expected).abs() < 4.0, "{reflected:?}, expected {expected}");
}
