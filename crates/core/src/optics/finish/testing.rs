//! Properties that the tests of finishes check, and samples of finishes.

use crate::optics::{
    AngleTable, Faces, FacetKind, Finish, FinishModel, Gaussian, Haze, HazeBase, HazeLaw,
    HazeSides, Incidence, IndexLaw, LayerStack, Lobe, Microfacet, REFERENCE_WAVELENGTH, Scattered,
    Side, ThinLayer, scatter_at_faces,
};
use crate::rng::{Dimension, Sampler};
use crate::tally::Tally;
use glam::DVec3;
use lumiduct_base::math::{circle, cosine_hemisphere};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

const INDICES: [[f64; 2]; 3] = [[1.0, 1.49], [1.49, 1.0], [1.3, 1.3]];

pub(crate) fn diffuse() -> Finish {
    Finish::Lambertian { reflectance: 0.5, transmittance: 0.4 }
}

pub(crate) fn splitter() -> Finish {
    Finish::Specular { reflectance: 0.5, transmittance: 0.3 }
}

pub(crate) fn metal() -> Finish {
    Finish::Metal { n: 0.8, k: 5.9 }
}

pub(crate) fn sheet(sigma: f64) -> Finish {
    Finish::GaussianSheet { lobe: Gaussian::new(sigma), reflectance: 0.6, transmittance: 0.3 }
}

pub(crate) fn rough(sigma: f64) -> Finish {
    Finish::GaussianDielectric { lobe: Gaussian::new(sigma) }
}

pub(crate) fn tabulated() -> Finish {
    let table = |from, to| AngleTable::new(vec![[0.0, from], [FRAC_PI_2, to]]);
    Finish::Tabulated { reflectance: table(0.2, 0.6), transmittance: table(0.7, 0.1) }
}

pub(crate) fn coated() -> Finish {
    Finish::Coated { reflectance: AngleTable::new(vec![[0.0, 0.01], [1.0, 0.1], [FRAC_PI_2, 1.0]]) }
}

fn stack(layers: [[f64; 3]; 2]) -> Finish {
    let layer = |[index, extinction, thickness]: [f64; 3]| ThinLayer {
        index: IndexLaw::Constant(index),
        extinction: IndexLaw::Constant(extinction),
        thickness,
    };
    Finish::Stack(Arc::new(LayerStack::new(layers.map(layer).to_vec(), None)))
}

pub(crate) fn clear_stack() -> Finish {
    stack([[2.3, 0.0, 60.0], [1.46, 0.0, 120.0]])
}

pub(crate) fn absorbing_stack() -> Finish {
    stack([[2.3, 0.0, 60.0], [0.96, 6.69, 8.0]])
}

pub(crate) fn facets(roughness: f64) -> Finish {
    Finish::Microfacet(Microfacet::new(roughness, FacetKind::Interface))
}

pub(crate) fn rough_metal() -> Finish {
    Finish::Microfacet(Microfacet::new(0.4, FacetKind::Metal { n: 0.8, k: 5.9 }))
}

pub(crate) fn haze(base: HazeBase) -> Finish {
    Finish::Haze(Box::new(Haze::new(HazeLaw::Abg { a: 0.03, b: 0.02, g: 2.0 }, base)))
}

pub(crate) fn hazy_sheet() -> Finish {
    let scatters = HazeSides::Transmitted;
    haze(HazeBase::Sheet { reflectance: 0.2, transmittance: 0.7, scatters })
}

pub(crate) fn mixture() -> Finish {
    let smooth = Finish::Mixture(vec![(1.0, Finish::Smooth), (1.0, splitter())]);
    let parts = [smooth, rough(0.2), sheet(0.1), diffuse(), Finish::Absorber];
    Finish::Mixture(parts.map(|part| (0.5, part)).to_vec())
}

/// Light that meets the face z = 0 from above at an angle, rad, between media of two indices.
pub(crate) fn incidence(angle: f64, [index_from, index_to]: [f64; 2]) -> Incidence {
    let dir = DVec3::new(angle.sin(), 0.0, -angle.cos());
    Incidence {
        dir,
        normal: DVec3::Z,
        index_from,
        index_to,
        wavelength: REFERENCE_WAVELENGTH,
        grain: DVec3::Y,
        s_share: Incidence::UNPOLARISED,
    }
}

/// Light by which finishes are compared: at angles with, near and without total reflection, and
/// between equal indices.
fn light() -> [Incidence; 4] {
    [(0.9, [1.0, 1.49]), (0.65, [1.49, 1.0]), (1.0, [1.49, 1.0]), (1.3, [1.2, 1.2])]
        .map(|(angle, indices)| incidence(angle, indices))
}

/// Checks what holds for every finish that is the same from both sides.
pub(crate) fn assert_sound(finish: &Finish) {
    assert_paths_are_sound(finish);
    assert_follows_shares(finish);
    assert_adjoint(Faces { own: finish, behind: finish });
}

/// No photon gains flux, and photons and gather paths stay finite and leave on the side they say.
fn assert_paths_are_sound(finish: &Finish) {
    let faces = Faces { own: finish, behind: finish };
    for indices in INDICES {
        for cos in [0.0, 1e-300, 1e-9, 1e-3, 0.1, 0.5, 0.9, 1.0f64] {
            let dir = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos);
            let incidence = Incidence { dir, ..incidence(0.0, indices) };
            for index in 0..200 {
                let mut sampler = Sampler::for_path(9, 0, index);
                let photon = finish.scatter(&incidence, &mut sampler);
                assert!(photon.is_none_or(|out| out.factor <= 1.0), "{finish:?} at {cos}");
                let gathered = scatter_at_faces(faces, &incidence, &mut sampler);
                for out in [photon, gathered].into_iter().flatten() {
                    assert!(out.factor.is_finite() && out.factor >= 0.0, "{finish:?} at {cos}");
                    assert!((out.dir.length() - 1.0).abs() < 1e-12, "{finish:?} at {cos}");
                    match out.side {
                        Side::Reflected => assert!(out.dir.z >= 0.0, "{finish:?} at {cos}"),
                        Side::Transmitted => assert!(out.dir.z <= 0.0, "{finish:?} at {cos}"),
                    }
                }
            }
        }
    }
}

/// Photons go to each side in the shares and with the chances that the finish gives, and that they state.
fn assert_follows_shares(finish: &Finish) {
    const ROUNDING: f64 = 1e-9;
    // Chances of rough facets are those of a level one.
    let room = if matches!(finish, Finish::Microfacet(_)) { 0.4 } else { ROUNDING };
    for incidence in light() {
        for side in [Side::Reflected, Side::Transmitted] {
            let sent = |worth: fn(&Scattered, bool) -> f64| {
                Tally::of((0..10_000).map(|index| {
                    let mut sampler = Sampler::for_path(5, 0, index);
                    let out = finish.scatter(&incidence, &mut sampler);
                    out.map_or(0.0, |out| worth(&out, out.side == side))
                }))
            };
            let flux = sent(|out, is_there| if is_there { out.factor } else { 0.0 });
            let number = sent(|_, is_there| f64::from(u8::from(is_there)));
            let surprise =
                sent(|out, is_there| if is_there { 1.0 - out.chance } else { out.chance - 1.0 });
            let [shares, chances] = [finish.shares(&incidence), finish.chances(&incidence)];
            assert!(number.mean() == 0.0 || chances.of(side) > 0.0, "{finish:?}, {side:?}");
            let expected = [
                (flux, shares.of(side), ROUNDING),
                (number, chances.of(side), room),
                (surprise, 0.0, ROUNDING),
            ];
            for (seen, expected, room) in expected {
                let met =
                    (seen.mean() - expected).abs() < room || seen.sigmas_from(expected).abs() < 4.0;
                assert!(met, "{finish:?}, {incidence:?}, {side:?}: {seen:?}, expected {expected}");
            }
        }
    }
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
        let incidence = Incidence { dir: -out, ..incidence(0.0, [above, below]) };
        let from = scatter_at_faces(faces, &incidence, &mut sampler).filter(|s| s.side == side);
        for (tally, [g, h]) in tallies.iter_mut().zip(PAIRS) {
            let field = from.map_or(0.0, |from| from.factor * WINDOWS[h](from.dir));
            tally.add(above * above * WINDOWS[g](out) * field);
        }
    }
    tallies
}

/// The same by photons that start with basic radiance h(i) on the side they come from.
fn shone(finish: &Finish, [above, below]: [f64; 2], side: Side) -> Vec<Tally> {
    let (normal, index_from, index_to) = match side {
        Side::Reflected => (DVec3::Z, above, below),
        Side::Transmitted => (DVec3::NEG_Z, below, above),
    };
    let mut tallies = vec![Tally::default(); PAIRS.len()];
    for index in 0..PATHS {
        let mut sampler = Sampler::for_path(43, 0, index);
        let from = cosine(&mut sampler) * DVec3::new(1.0, 1.0, normal.z);
        let incidence = Incidence { dir: -from, normal, ..incidence(0.0, [index_from, index_to]) };
        let out = finish.scatter(&incidence, &mut sampler).filter(|out| out.side == side);
        for (tally, [g, h]) in tallies.iter_mut().zip(PAIRS) {
            let leaving = out.map_or(0.0, |out| out.factor * WINDOWS[g](out.dir));
            tally.add(index_from * index_from * WINDOWS[h](from) * leaving);
        }
    }
    tallies
}

/// Gather paths collect what photons bring.
pub(crate) fn assert_adjoint(faces: Faces<'_>) {
    for indices in INDICES {
        for (side, finish) in [(Side::Reflected, faces.own), (Side::Transmitted, faces.behind)] {
            let pairs =
                gathered(faces, indices, side).into_iter().zip(shone(finish, indices, side));
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

/// From each direction the mean factor of gather paths is the integral of the distribution function.
pub(crate) fn assert_mean_factors(finish: &Finish) {
    for [above, below] in INDICES {
        for angle in [0.0f64, 0.7, 0.9, 1.3] {
            let met = incidence(angle, [above, below]);
            for (side, index_from, index_to, z) in
                [(Side::Reflected, above, below, 1.0), (Side::Transmitted, below, above, -1.0)]
            {
                // ∫ (n_i²/n_o²) f(i→o) cos θ_i h(i) dω_i, h = (1 + x)/2
                let mut expected = 0.0;
                for (from, weight) in hemisphere(600, 600, z) {
                    let normal = DVec3::Z * z;
                    let photon = Incidence { dir: -from, normal, index_from, index_to, ..met };
                    expected += finish.evaluate(&photon, -met.dir) * weight * (0.5 + 0.5 * from.x);
                }
                expected *= index_from * index_from / (above * above);
                let seen = Tally::of((0..40_000).map(|index| {
                    let mut sampler = Sampler::for_path(47, 0, index);
                    scatter_at_faces(Faces { own: finish, behind: finish }, &met, &mut sampler)
                        .filter(|from| from.side == side && from.lobe == Lobe::Diffuse)
                        .map_or(0.0, |from| from.factor * (0.5 + 0.5 * from.dir.x))
                }));
                assert!(
                    (seen.mean() - expected).abs() <= 4.0 * seen.std_error() + 1e-3 * expected,
                    "{side:?} of {finish:?}, {above} over {below}, at {angle}: {seen:?}, {expected}"
                );
            }
        }
    }
}

/// Directions over a half space with their cos θ dω.
fn hemisphere(rows: u32, columns: u32, up: f64) -> impl Iterator<Item = (DVec3, f64)> {
    let weight = TAU / f64::from(rows * columns);
    (0..rows * columns).map(move |cell| {
        let cos = (f64::from(cell / columns) + 0.5) / f64::from(rows);
        let around = circle((f64::from(cell % columns) + 0.5) / f64::from(columns));
        (((1.0 - cos * cos).sqrt() * around).extend(cos * up), cos * weight)
    })
}

/// The distribution function integrates to the shares and has the moments of scattered photons.
pub(crate) fn assert_moments(finish: &Finish) {
    for incidence in light() {
        for side in [Side::Reflected, Side::Transmitted] {
            let what = format!("{finish:?}, {incidence:?}, {side:?}");
            // Moments 1, x and z of the light that leaves to the side, per flux that arrives.
            let mut expected = [0.0; 3];
            for (out, weight) in hemisphere(1000, 400, incidence.leaving_normal(side).z) {
                let share = finish.evaluate(&incidence, out) * weight;
                for (sum, moment) in expected.iter_mut().zip([1.0, out.x, out.z]) {
                    *sum += share * moment;
                }
            }
            let share = finish.shares(&incidence).of(side);
            assert!((expected[0] - share).abs() < 2e-4, "{what}: {expected:?}, {share}");
            let mut seen = [Tally::default(); 3];
            for index in 0..40_000 {
                let mut sampler = Sampler::for_path(6, 0, index);
                let out = finish.scatter(&incidence, &mut sampler).filter(|out| out.side == side);
                let (dir, factor) = out.map_or((DVec3::ZERO, 0.0), |out| (out.dir, out.factor));
                for (tally, moment) in seen.iter_mut().zip([1.0, dir.x, dir.z]) {
                    tally.add(factor * moment);
                }
            }
            for (tally, value) in seen.iter().zip(expected) {
                let met =
                    (tally.mean() - value).abs() < 2e-4 || tally.sigmas_from(value).abs() < 4.0;
                assert!(met, "{what}: {tally:?}, expected {value}");
            }
        }
    }
}

/// Cells along an axis of the disk of direction cosines.
const CELLS: usize = 12;
/// Points of a cell along an axis, for its integral.
const POINTS: usize = 60;

/// `∫ f d²β` over the cells of the square about the disk of leaving direction cosines: `cos θ dω = d²β`.
fn integrals(finish: &Finish, incidence: &Incidence, side: Side) -> Vec<f64> {
    let up = incidence.leaving_normal(side).z;
    let fine = CELLS * POINTS;
    let h = 2.0 / fine as f64;
    let at = |i: usize| -1.0 + h * (i as f64 + 0.5);
    let mut cells = vec![0.0; CELLS * CELLS];
    for (i, j) in (0..fine * fine).map(|point| (point / fine, point % fine)) {
        let (x, y) = (at(i), at(j));
        let rest = 1.0 - x * x - y * y;
        if rest > 0.0 {
            let out = DVec3::new(x, y, up * rest.sqrt());
            cells[i / POINTS * CELLS + j / POINTS] += finish.evaluate(incidence, out) * h * h;
        }
    }
    cells
}

/// Compares light that is scattered to a side with the distribution function, by chi-square over
/// cells of direction cosines, and returns its share, 1.
pub(crate) fn assert_follows(finish: &Finish, incidence: &Incidence, side: Side) -> f64 {
    let expected = integrals(finish, incidence, side);
    let paths = 60_000u32;
    let (mut sums, mut squares) = (vec![0.0; expected.len()], vec![0.0; expected.len()]);
    for index in 0..paths {
        let mut sampler = Sampler::for_path(77, 0, u64::from(index));
        let out = finish.scatter(incidence, &mut sampler);
        let Some(out) = out.filter(|out| out.side == side && out.lobe == Lobe::Diffuse) else {
            continue;
        };
        let cell = |x: f64| ((0.5 * (x + 1.0) * CELLS as f64) as usize).min(CELLS - 1);
        let cell = cell(out.dir.x) * CELLS + cell(out.dir.y);
        sums[cell] += out.factor;
        squares[cell] += out.factor * out.factor;
    }
    let (mut chi2, mut freedom) = (0.0, 0.0);
    let paths = f64::from(paths);
    for ((&share, &sum), &square) in expected.iter().zip(&sums).zip(&squares) {
        if share * paths > 20.0 {
            let variance = square - sum * sum / paths;
            chi2 += (sum - share * paths).powi(2) / variance.max(1.0);
            freedom += 1.0;
        }
    }
    let limit = freedom + 4.0 * f64::sqrt(2.0 * freedom);
    assert!(chi2 <= limit, "{side:?} of {incidence:?}: chi-square {chi2} of {freedom}");
    expected.iter().sum()
}

/// Compares `f(i→o)/n_o²` with the value for the same path backwards.
pub(crate) fn assert_reciprocal(finish: &Finish, indices: [f64; 2]) {
    for (angle, out_angle, turn) in [(0.3f64, 0.5f64, 0.4), (0.9, 0.2, 2.0), (0.6, 1.3, 3.0)] {
        let there = incidence(angle, indices);
        for (side, [index_in, index_out]) in
            [(Side::Reflected, [indices[0]; 2]), (Side::Transmitted, indices)]
        {
            let up = there.leaving_normal(side).z;
            let out = DVec3::new(
                out_angle.sin() * f64::cos(turn),
                out_angle.sin() * f64::sin(turn),
                up * out_angle.cos(),
            );
            let other = if side == Side::Reflected { indices[1] } else { index_in };
            let back = Incidence {
                dir: -out,
                normal: DVec3::Z * up,
                index_from: index_out,
                index_to: other,
                wavelength: REFERENCE_WAVELENGTH,
                grain: DVec3::ZERO,
                s_share: Incidence::UNPOLARISED,
            };
            let one = finish.evaluate(&there, out) / (index_out * index_out);
            let two = finish.evaluate(&back, -there.dir) / (index_in * index_in);
            assert!((one - two).abs() <= 1e-12 * one.max(1e-3), "{side:?} {angle}: {one}, {two}");
        }
    }
}
