//! The value of a finish's distribution function, for estimates that join two given directions.
//!
//! Photons that arrive with flux `Φ_p` on an area ΔA give the radiance `L(o) = Σ f(i_p→o) Φ_p / ΔA`
//! (Jensen, Realistic Image Synthesis Using Photon Mapping, 2001, chapter 7). Discrete directions
//! have no finite value and count as 0 here. This module does not know a face's two finishes:
//! evaluate the one that the photons meet.

use crate::optics::incidence::{leaving_normal, straight};
use crate::optics::smooth::smooth_direction;
use crate::optics::{Bsdf, Gaussian, Incidence, Side, shares};
use glam::DVec3;
use std::f64::consts::PI;

/// The bidirectional distribution function f(i→o), in 1/sr, of a finish for a photon that arrives
/// with `incidence` and leaves along the unit vector `out`: reflected on the side of the normal,
/// otherwise transmitted. Its discrete part is left out: 0 for specular finishes. `f cos θ_o dω_o`
/// is the share of the photon's flux that leaves into `dω_o`.
pub fn evaluate(bsdf: &Bsdf, incidence: &Incidence, out: DVec3) -> f64 {
    let cos = out.dot(incidence.normal);
    let side = if cos > 0.0 { Side::Reflected } else { Side::Transmitted };
    match bsdf {
        Bsdf::Smooth
        | Bsdf::Specular { .. }
        | Bsdf::Metal { .. }
        | Bsdf::Absorber
        | Bsdf::Open
        | Bsdf::Tabulated { .. }
        | Bsdf::Coated { .. }
        | Bsdf::PrismFilm { .. } => 0.0,
        Bsdf::Microfacet(rough) => rough.evaluate(incidence, out),
        Bsdf::Haze(haze) => haze.evaluate(incidence, out, side),
        Bsdf::Lambertian { .. } => shares(bsdf, incidence).of(side) / PI,
        Bsdf::GaussianSheet { lobe, .. } => {
            shares(bsdf, incidence).of(side)
                * about(lobe, straight(incidence, side), leaving_normal(incidence, side), out)
        }
        Bsdf::GaussianDielectric { lobe } => {
            smooth_direction(incidence, side).map_or(0.0, |mean| {
                let normal = leaving_normal(incidence, side);
                shares(bsdf, incidence).of(side) * about(lobe, mean.normalize(), normal, out)
            })
        }
        Bsdf::Mixture(parts) => {
            let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
            parts.iter().map(|(weight, part)| weight * evaluate(part, incidence, out)).sum::<f64>()
                / total
        }
    }
}

/// `p(o|mean) / cos θ_o` of a lobe, 1/sr; 0 along the horizon, where it has no value.
fn about(lobe: &Gaussian, mean: DVec3, normal: DVec3, out: DVec3) -> f64 {
    let cos = out.dot(normal);
    if cos > 0.0 { lobe.pdf(mean, out, normal) / cos } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Bsdf;
    use crate::rng::Sampler;
    use crate::tally::Tally;
    use lumiduct_base::math::circle;

    fn finishes() -> Vec<Bsdf> {
        let diffuse = Bsdf::Lambertian { reflectance: 0.5, transmittance: 0.3 };
        let sheet =
            Bsdf::GaussianSheet { lobe: Gaussian::new(0.3), reflectance: 0.6, transmittance: 0.3 };
        let rough = Bsdf::GaussianDielectric { lobe: Gaussian::new(0.15) };
        let mixture = Bsdf::Mixture(vec![
            (1.0, diffuse.clone()),
            (2.0, sheet.clone()),
            (1.0, rough.clone()),
            (1.0, Bsdf::Absorber),
        ]);
        vec![diffuse, sheet, rough, mixture]
    }

    /// Moments 1, x and z of the light that leaves to a side, per flux that arrives: by quadrature of `f cos θ_o`.
    fn moments(bsdf: &Bsdf, incidence: &Incidence, side: Side) -> [f64; 3] {
        let toward = leaving_normal(incidence, side).z;
        let (rows, columns) = (1000, 400);
        let mut sums = [0.0; 3];
        for row in 0..rows {
            let cos = (f64::from(row) + 0.5) / f64::from(rows);
            for column in 0..columns {
                let around = circle((f64::from(column) + 0.5) / f64::from(columns));
                let out = ((1.0 - cos * cos).sqrt() * around).extend(cos * toward);
                let share = evaluate(bsdf, incidence, out) * cos;
                for (sum, moment) in sums.iter_mut().zip([1.0, out.x, out.z]) {
                    *sum += share * moment;
                }
            }
        }
        sums.map(|sum| sum * std::f64::consts::TAU / f64::from(rows * columns))
    }

    #[test]
    fn it_integrates_to_the_shares_and_has_the_moments_of_scattered_photons() {
        for bsdf in finishes() {
            for (angle, index_from, index_to) in
                [(0.9f64, 1.0, 1.49), (0.65, 1.49, 1.0), (1.0, 1.49, 1.0), (1.4, 1.0, 1.0)]
            {
                let dir = DVec3::new(angle.sin(), 0.0, -angle.cos());
                let incidence =
                    Incidence { dir, normal: DVec3::Z, index_from, index_to, grain: DVec3::ZERO };
                for side in [Side::Reflected, Side::Transmitted] {
                    let what = format!("{bsdf:?} at {angle}, {side:?}");
                    let expected = moments(&bsdf, &incidence, side);
                    let share = shares(&bsdf, &incidence).of(side);
                    assert!((expected[0] - share).abs() < 2e-4, "{what}: {expected:?}, {share}");
                    let mut seen = [Tally::default(); 3];
                    for index in 0..40_000 {
                        let mut sampler = Sampler::for_path(6, 0, index);
                        let out = bsdf.scatter(&incidence, &mut sampler);
                        let out = out.filter(|out| out.side == side);
                        let [dir, factor] =
                            out.map_or([DVec3::ZERO; 2], |out| [out.dir, DVec3::splat(out.factor)]);
                        for (tally, moment) in seen.iter_mut().zip([1.0, dir.x, dir.z]) {
                            tally.add(factor.x * moment);
                        }
                    }
                    for (tally, value) in seen.iter().zip(expected) {
                        let met = (tally.mean() - value).abs() < 2e-4
                            || tally.sigmas_from(value).abs() < 4.0;
                        assert!(met, "{what}: {tally:?}, expected {value}");
                    }
                }
            }
        }
    }

    #[test]
    fn discrete_directions_have_no_value() {
        let incidence = Incidence {
            dir: DVec3::NEG_Z,
            normal: DVec3::Z,
            index_from: 1.0,
            index_to: 1.49,
            grain: DVec3::ZERO,
        };
        for bsdf in [Bsdf::Smooth, Bsdf::Open, Bsdf::Metal { n: 0.8, k: 5.9 }] {
            assert_eq!(evaluate(&bsdf, &incidence, DVec3::Z), 0.0);
        }
    }
}
