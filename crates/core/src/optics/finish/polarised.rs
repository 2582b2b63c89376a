//! What finishes do to polarised light.

use crate::optics::finish::testing::{
    absorbing_stack, clear_stack, coated, diffuse, facets, haze, incidence, metal, mixture, rough,
    rough_metal, sheet, splitter, tabulated,
};
use crate::optics::{
    FaceMueller, Finish, FinishModel, HazeBase, Incidence, Scattered, Side, Stokes,
};
use glam::DVec3;

/// Light at 45° to the plane of incidence, after it was reflected at faces in turn.
fn after_reflections(faces: &[(Finish, Incidence)]) -> [f64; 3] {
    let mut stokes = Stokes::new(DVec3::Y, [0.0, 1.0, 0.0]);
    for (finish, incidence) in faces {
        let dir = incidence.straight(Side::Reflected);
        let out = Scattered::specular(dir, 1.0, Side::Reflected);
        stokes = stokes.after(finish.mueller(incidence, Side::Reflected), incidence, &out);
    }
    stokes.about(DVec3::Y, faces[faces.len() - 1].1.straight(Side::Reflected))
}

#[test]
fn the_rhomb_of_fresnel_makes_circular_light() {
    // Born & Wolf, 7th ed., 1.5.4: in glass of index 1.51 two total reflections at 48°37' or 54°37' delay s and p by a
    // quarter of a wave against each other.
    for degrees in [48.0f64 + 37.0 / 60.0, 54.0 + 37.0 / 60.0] {
        let first = incidence(degrees.to_radians(), [1.51, 1.0]);
        let dir = first.straight(Side::Reflected);
        let second = Incidence { dir, normal: -first.normal, ..first };
        let [q, u, v] = after_reflections(&[(Finish::Smooth, first), (Finish::Smooth, second)]);
        assert!(v.abs() > 0.9999 && q.abs() < 1e-9 && u.abs() < 0.01, "{q} {u} {v}");
    }
}

#[test]
fn a_mirror_of_a_perfect_conductor_is_the_ideal_one() {
    let metal = Finish::Metal { n: 1e-9, k: 1e9 };
    let mirror = Finish::Specular { reflectance: 1.0, transmittance: 0.0 };
    for angle in [0.0, 0.4, 1.2] {
        let [found, ideal] = [&metal, &mirror]
            .map(|finish| after_reflections(&[(finish.clone(), incidence(angle, [1.0, 1.0]))]));
        for (found, ideal) in found.iter().zip(ideal) {
            assert!((found - ideal).abs() < 1e-6, "{angle}: {found} {ideal}");
        }
    }
}

#[test]
fn shares_of_both_polarisations_are_those_that_finishes_draw_from() {
    let keeping = [
        Finish::Smooth,
        metal(),
        clear_stack(),
        absorbing_stack(),
        splitter(),
        tabulated(),
        coated(),
    ];
    for finish in keeping {
        for (angle, indices) in
            [(0.0, [1.0, 1.5]), (0.7, [1.0, 1.5]), (1.5, [1.0, 1.5]), (0.5, [1.5, 1.0])]
        {
            let shares =
                |s_share| finish.shares(&Incidence { s_share, ..incidence(angle, indices) });
            for side in [Side::Reflected, Side::Transmitted] {
                if shares(0.5).of(side) == 0.0 {
                    continue;
                }
                let FaceMueller { s, p, cross: [re, im] } =
                    finish.mueller(&incidence(angle, indices), side).unwrap();
                let whole = shares(0.5).of(side) / (0.5 * (s + p));
                for s_share in [0.0, 0.3, 1.0] {
                    let mean = whole * (s_share * s + (1.0 - s_share) * p);
                    assert!((mean - shares(s_share).of(side)).abs() < 1e-9, "{finish:?} {angle}");
                }
                // A plane face leaves fully polarised light so.
                assert!((re * re + im * im - s * p).abs() < 1e-12, "{finish:?} {angle}");
            }
        }
    }
}

#[test]
fn what_depolarises_acts_on_all_light_alike() {
    let out = DVec3::new(0.2, 0.1, 0.9).normalize();
    for finish in [
        diffuse(),
        sheet(0.2),
        rough(0.2),
        facets(0.3),
        rough_metal(),
        haze(HazeBase::Interface),
        mixture(),
        Finish::Mixture(vec![(1.0, Finish::Smooth), (1.0, metal())]),
    ] {
        for indices in [[1.0, 1.5], [1.5, 1.0]] {
            let [s, p] = [1.0, 0.0].map(|s_share| Incidence { s_share, ..incidence(0.6, indices) });
            for side in [Side::Reflected, Side::Transmitted] {
                assert_eq!(finish.mueller(&s, side), None, "{finish:?}");
            }
            assert_eq!(finish.shares(&s), finish.shares(&p), "{finish:?}");
            assert_eq!(finish.radiance_chances(&s), finish.radiance_chances(&p), "{finish:?}");
            assert_eq!(finish.evaluate(&s, out), finish.evaluate(&p, out), "{finish:?}");
        }
    }
}

#[test]
fn a_stack_passes_polarised_light_alike_both_ways() {
    let inside = (0.6f64.sin() / 1.5).asin();
    for front in [clear_stack(), absorbing_stack()] {
        let back = front.from_behind().unwrap();
        let side = Side::Transmitted;
        let there = front.mueller(&incidence(0.6, [1.0, 1.5]), side).unwrap();
        let again = back.mueller(&incidence(inside, [1.5, 1.0]), side).unwrap();
        let parts = |face: FaceMueller| [face.s, face.p, face.cross[0], face.cross[1]];
        for (there, again) in parts(there).into_iter().zip(parts(again)) {
            assert!((there - again).abs() < 1e-12, "{there} {again}");
        }
    }
}
