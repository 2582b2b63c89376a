use super::*;
use crate::optics::{
    AngleTable, Facets, FilmFace, FilmMake, Grain, HazeBase, HazeLaw, HazeSides, Microfacet,
    PrismFilm, evaluate,
};
use crate::tally::Tally;
use lumiduct_base::math::circle;
use std::f64::consts::{FRAC_PI_2, TAU};

const INDICES: [[f64; 2]; 3] = [[1.0, 1.49], [1.49, 1.0], [1.3, 1.3]];

fn sheet(sigma: f64) -> Bsdf {
    Bsdf::GaussianSheet { lobe: Gaussian::new(sigma), reflectance: 0.6, transmittance: 0.3 }
}

fn rough(sigma: f64) -> Bsdf {
    Bsdf::GaussianDielectric { lobe: Gaussian::new(sigma) }
}

fn diffuse() -> Bsdf {
    Bsdf::Lambertian { reflectance: 0.5, transmittance: 0.4 }
}

fn splitter() -> Bsdf {
    Bsdf::Specular { reflectance: 0.5, transmittance: 0.3 }
}

fn metal() -> Bsdf {
    Bsdf::Metal { n: 0.8, k: 5.9 }
}

fn tabulated() -> Bsdf {
    let table = |from, to| AngleTable::new(vec![[0.0, from], [FRAC_PI_2, to]]);
    Bsdf::Tabulated { reflectance: table(0.2, 0.6), transmittance: table(0.7, 0.1) }
}

fn coated() -> Bsdf {
    Bsdf::Coated { reflectance: AngleTable::new(vec![[0.0, 0.01], [1.0, 0.1], [FRAC_PI_2, 1.0]]) }
}

fn facets(roughness: f64) -> Bsdf {
    Bsdf::Microfacet(Microfacet::new(roughness, Facets::Interface))
}

fn rough_metal() -> Bsdf {
    Bsdf::Microfacet(Microfacet::new(0.4, Facets::Metal { n: 0.8, k: 5.9 }))
}

fn haze(base: HazeBase) -> Bsdf {
    Bsdf::Haze(Box::new(Haze::new(HazeLaw::Abg { a: 0.03, b: 0.02, g: 2.0 }, base)))
}

fn hazy_sheet() -> Bsdf {
    let scatters = HazeSides::Transmitted;
    haze(HazeBase::Sheet { reflectance: 0.2, transmittance: 0.7, scatters })
}

fn mixture() -> Bsdf {
    let smooth = Bsdf::Mixture(vec![(1.0, Bsdf::Smooth), (1.0, splitter())]);
    let parts = [smooth, rough(0.2), sheet(0.1), diffuse(), Bsdf::Absorber];
    Bsdf::Mixture(parts.map(|part| (0.5, part)).to_vec())
}

fn finishes() -> Vec<Bsdf> {
    vec![
        Bsdf::Smooth,
        splitter(),
        metal(),
        Bsdf::Absorber,
        Bsdf::Open,
        diffuse(),
        sheet(0.03),
        sheet(0.4),
        rough(0.02),
        rough(0.3),
        tabulated(),
        coated(),
        facets(0.05),
        facets(0.5),
        rough_metal(),
        hazy_sheet(),
        haze(HazeBase::Interface),
        mixture(),
    ]
}

/// Test functions of a direction away from the face: light by its height over the face and by its azimuth.
const WINDOWS: [fn(DVec3) -> f64; 4] = [
    |_| 1.0,
    |dir| dir.z * dir.z,
    |dir| (0.5 + 0.5 * dir.x).powi(2),
    |dir| (1.0 - dir.z * dir.z).powi(2) * (1.0 + dir.y),
];

/// Pairs of a window `g` for light that leaves and `h` for light that arrives.
const PAIRS: [[usize; 2]; 5] = [[0, 0], [1, 2], [2, 1], [3, 2], [2, 3]];

const PATHS: u64 = 60_000;

fn cosine(sampler: &mut Sampler) -> DVec3 {
    cosine_hemisphere(sampler.pair(Dimension::EmitDirection))
}

/// `∫ g(o) n_o² cos θ_o L*_o dω_o / π`, with `L*_o` of the field `L*_i = h(i)`, by gather paths from the upper side.
fn gathered(faces: Faces<'_>, [above, below]: [f64; 2], side: Side) -> Vec<Tally> {
    let mut tallies = vec![Tally::default(); PAIRS.len()];
    for index in 0..PATHS {
        let mut sampler = Sampler::for_path(41, 0, index);
        let out = cosine(&mut sampler);
        let incidence = Incidence {
            dir: -out,
            normal: DVec3::Z,
            index_from: above,
            index_to: below,
            grain: DVec3::Y,
        };
        let from = scatter_radiance(faces, &incidence, &mut sampler).filter(|s| s.side == side);
        for (tally, [g, h]) in tallies.iter_mut().zip(PAIRS) {
            let field = from.map_or(0.0, |from| from.factor * WINDOWS[h](from.dir));
            tally.add(above * above * WINDOWS[g](out) * field);
        }
    }
    tallies
}

/// The same by photons that start with basic radiance h(i) on the side they come from.
fn shone(bsdf: &Bsdf, [above, below]: [f64; 2], side: Side) -> Vec<Tally> {
    let (normal, index_from, index_to) = match side {
        Side::Reflected => (DVec3::Z, above, below),
        Side::Transmitted => (DVec3::NEG_Z, below, above),
    };
    let mut tallies = vec![Tally::default(); PAIRS.len()];
    for index in 0..PATHS {
        let mut sampler = Sampler::for_path(43, 0, index);
        let from = cosine(&mut sampler) * DVec3::new(1.0, 1.0, normal.z);
        let incidence = Incidence { dir: -from, normal, index_from, index_to, grain: DVec3::Y };
        let out = bsdf.scatter(&incidence, &mut sampler).filter(|out| out.side == side);
        for (tally, [g, h]) in tallies.iter_mut().zip(PAIRS) {
            let leaving = out.map_or(0.0, |out| out.factor * WINDOWS[g](out.dir));
            tally.add(index_from * index_from * WINDOWS[h](from) * leaving);
        }
    }
    tallies
}

fn assert_adjoint(faces: Faces<'_>) {
    for indices in INDICES {
        for (side, bsdf) in [(Side::Reflected, faces.own), (Side::Transmitted, faces.behind)] {
            let pairs = gathered(faces, indices, side).into_iter().zip(shone(bsdf, indices, side));
            for ((gathered, shone), pair) in pairs.zip(PAIRS) {
                let error = gathered.std_error().hypot(shone.std_error());
                let off = (gathered.mean() - shone.mean()).abs();
                assert!(
                    off < 1e-12 || off < 4.0 * error,
                    "{side:?} of {faces:?} between {indices:?}, windows {pair:?}: {gathered:?} against {shone:?}"
                );
            }
        }
    }
}

#[test]
fn gather_paths_collect_what_photons_bring_for_every_finish() {
    for bsdf in &finishes() {
        assert_adjoint(Faces { own: bsdf, behind: bsdf });
    }
}

#[test]
fn faces_of_two_finishes_reflect_by_one_and_transmit_by_the_other() {
    let mirror = Bsdf::Specular { reflectance: 0.95, transmittance: 0.0 };
    for (own, behind) in [
        (mirror, Bsdf::Absorber),
        (diffuse(), splitter()),
        (Bsdf::Smooth, sheet(0.2)),
        (rough(0.2), diffuse()),
        (mixture(), rough(0.05)),
        (metal(), Bsdf::Open),
        (rough(0.3), Bsdf::Smooth),
        (sheet(0.3), mixture()),
        (facets(0.4), coated()),
        (haze(HazeBase::Interface), facets(0.2)),
        (tabulated(), hazy_sheet()),
        (rough_metal(), haze(HazeBase::Interface)),
    ] {
        assert_adjoint(Faces { own: &own, behind: &behind });
    }
}

#[test]
fn films_are_the_same_film_from_both_sides() {
    let make = FilmMake {
        index: 1.59,
        prism_angle: 1.4,
        pitch: 0.3,
        base: 0.05,
        absorption: 0.4,
        rounded: 0.03,
        run: Grain::Around,
    };
    let film = Box::new(PrismFilm::new(&make));
    for face in [FilmFace::Flat, FilmFace::Prisms] {
        let own = Bsdf::PrismFilm { film: film.clone(), face };
        let mixed = Bsdf::Mixture(vec![(2.0, own.clone()), (1.0, splitter())]);
        for own in [own, mixed] {
            let behind = own.from_behind().unwrap();
            assert_adjoint(Faces { own: &own, behind: &behind });
        }
    }
}

#[test]
fn from_each_direction_the_mean_factor_is_the_integral_of_the_distribution_function() {
    let rows = 600;
    for bsdf in [diffuse(), sheet(0.3), rough(0.2), facets(0.7), haze(HazeBase::Interface)] {
        for [above, below] in INDICES {
            for angle in [0.0f64, 0.7, 0.9, 1.3] {
                let dir = DVec3::new(angle.sin(), 0.0, -angle.cos());
                let incidence = Incidence {
                    dir,
                    normal: DVec3::Z,
                    index_from: above,
                    index_to: below,
                    grain: DVec3::Y,
                };
                for (side, index_from, index_to, z) in
                    [(Side::Reflected, above, below, 1.0), (Side::Transmitted, below, above, -1.0)]
                {
                    // ∫ (n_i²/n_o²) f(i→o) cos θ_i h(i) dω_i, h = (1 + x)/2
                    let mut expected = 0.0;
                    for cell in 0..rows * rows {
                        let cos = (f64::from(cell / rows) + 0.5) / f64::from(rows);
                        let around = circle((f64::from(cell % rows) + 0.5) / f64::from(rows));
                        let from = ((1.0 - cos * cos).sqrt() * around).extend(cos * z);
                        let photon = Incidence {
                            dir: -from,
                            normal: DVec3::Z * z,
                            index_from,
                            index_to,
                            grain: DVec3::Y,
                        };
                        expected += evaluate(&bsdf, &photon, -dir) * cos * (0.5 + 0.5 * from.x);
                    }
                    expected *=
                        TAU / f64::from(rows * rows) * index_from * index_from / (above * above);
                    let seen = Tally::of((0..40_000).map(|index| {
                        let mut sampler = Sampler::for_path(47, 0, index);
                        let faces = Faces { own: &bsdf, behind: &bsdf };
                        scatter_radiance(faces, &incidence, &mut sampler)
                            .filter(|from| from.side == side && from.lobe == Lobe::Diffuse)
                            .map_or(0.0, |from| from.factor * (0.5 + 0.5 * from.dir.x))
                    }));
                    let met =
                        (seen.mean() - expected).abs() <= 4.0 * seen.std_error() + 1e-3 * expected;
                    assert!(
                        met,
                        "{side:?} of {bsdf:?}, {above} over {below}, at {angle}: {seen:?}, expected {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_uniform_field_of_basic_radiance_is_seen_unchanged_through_a_smooth_face() {
    for [index_from, index_to] in INDICES {
        for index in 0..1000 {
            let mut sampler = Sampler::for_path(3, 0, index);
            let incidence = Incidence {
                dir: -cosine(&mut sampler),
                normal: DVec3::Z,
                index_from,
                index_to,
                grain: DVec3::Y,
            };
            let faces = Faces { own: &Bsdf::Smooth, behind: &Bsdf::Smooth };
            assert_eq!(scatter_radiance(faces, &incidence, &mut sampler).unwrap().factor, 1.0);
        }
    }
}

#[test]
fn a_mirror_with_a_black_back_loses_no_path() {
    let mirror = Bsdf::Specular { reflectance: 0.95, transmittance: 0.0 };
    let faces = Faces { own: &mirror, behind: &Bsdf::Absorber };
    for index in 0..100 {
        let mut sampler = Sampler::for_path(3, 0, index);
        let dir = -cosine(&mut sampler);
        let incidence =
            Incidence { dir, normal: DVec3::Z, index_from: 1.0, index_to: 1.0, grain: DVec3::Y };
        let out = scatter_radiance(faces, &incidence, &mut sampler).unwrap();
        assert_eq!((out.factor, out.side, out.lobe), (0.95, Side::Reflected, Lobe::Specular));
    }
}

#[test]
fn every_path_stays_finite_and_on_the_side_it_says() {
    for bsdf in &finishes() {
        for [index_from, index_to] in INDICES {
            for cos in [0.0, 1e-300, 1e-9, 1e-3, 0.5, 1.0f64] {
                let dir = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos);
                let incidence =
                    Incidence { dir, normal: DVec3::Z, index_from, index_to, grain: DVec3::Y };
                for index in 0..200 {
                    let mut sampler = Sampler::for_path(9, 0, index);
                    let faces = Faces { own: bsdf, behind: bsdf };
                    let Some(out) = scatter_radiance(faces, &incidence, &mut sampler) else {
                        continue;
                    };
                    assert!(out.factor.is_finite() && out.factor >= 0.0, "{bsdf:?} at {cos}");
                    assert!((out.dir.length() - 1.0).abs() < 1e-12, "{bsdf:?} at {cos}");
                    match out.side {
                        Side::Reflected => assert!(out.dir.z >= 0.0, "{bsdf:?} at {cos}"),
                        Side::Transmitted => assert!(out.dir.z <= 0.0, "{bsdf:?} at {cos}"),
                    }
                }
            }
        }
    }
}
