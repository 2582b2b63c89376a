//! Shared parts of the tests of finishes: light that meets a face, and samples against the
//! distribution function.

use crate::optics::incidence::leaving_normal;
use crate::optics::{Bsdf, Incidence, Lobe, Side, evaluate};
use crate::rng::Sampler;
use glam::DVec3;

/// Light that meets the face z = 0 from above at an angle, rad, between media of two indices.
pub(crate) fn incidence(angle: f64, [index_from, index_to]: [f64; 2]) -> Incidence {
    let dir = DVec3::new(angle.sin(), 0.0, -angle.cos());
    Incidence { dir, normal: DVec3::Z, index_from, index_to, grain: DVec3::ZERO }
}

/// Cells along an axis of the disk of direction cosines.
const CELLS: usize = 12;
/// Points of a cell along an axis, for its integral.
const POINTS: usize = 60;

/// `∫ f d²β` over the cells of the square about the disk of leaving direction cosines: `cos θ dω = d²β`.
fn integrals(bsdf: &Bsdf, incidence: &Incidence, side: Side) -> Vec<f64> {
    let up = leaving_normal(incidence, side).z;
    let fine = CELLS * POINTS;
    let h = 2.0 / fine as f64;
    let at = |i: usize| -1.0 + h * (i as f64 + 0.5);
    let mut cells = vec![0.0; CELLS * CELLS];
    for (i, j) in (0..fine * fine).map(|point| (point / fine, point % fine)) {
        let (x, y) = (at(i), at(j));
        let rest = 1.0 - x * x - y * y;
        if rest > 0.0 {
            let out = DVec3::new(x, y, up * rest.sqrt());
            cells[i / POINTS * CELLS + j / POINTS] += evaluate(bsdf, incidence, out) * h * h;
        }
    }
    cells
}

/// Compares light that is scattered to a side with the distribution function, by chi-square over
/// cells of direction cosines, and returns its share, 1.
pub(crate) fn assert_follows(bsdf: &Bsdf, incidence: &Incidence, side: Side) -> f64 {
    let expected = integrals(bsdf, incidence, side);
    let paths = 60_000u32;
    let (mut sums, mut squares) = (vec![0.0; expected.len()], vec![0.0; expected.len()]);
    for index in 0..paths {
        let mut sampler = Sampler::for_path(77, 0, u64::from(index));
        let out = bsdf.scatter(incidence, &mut sampler);
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
pub(crate) fn assert_reciprocal(bsdf: &Bsdf, indices: [f64; 2]) {
    for (angle, out_angle, turn) in [(0.3f64, 0.5f64, 0.4), (0.9, 0.2, 2.0), (0.6, 1.3, 3.0)] {
        let there = incidence(angle, indices);
        for (side, [index_in, index_out]) in
            [(Side::Reflected, [indices[0]; 2]), (Side::Transmitted, indices)]
        {
            let up = leaving_normal(&there, side).z;
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
                grain: DVec3::ZERO,
            };
            let one = evaluate(bsdf, &there, out) / (index_out * index_out);
            let two = evaluate(bsdf, &back, -there.dir) / (index_in * index_in);
            assert!((one - two).abs() <= 1e-12 * one.max(1e-3), "{side:?} {angle}: {one}, {two}");
        }
    }
}
