//! The share of arriving light that a finish sends to each side.

use crate::optics::incidence::{Incidence, Shares};
use crate::optics::smooth::smooth;
use crate::optics::{AngleTable, Bsdf, fresnel};

/// Probabilities with which [`Bsdf::scatter`] sends light that it does not absorb to the two sides, 1; both are 0 where
/// it always absorbs. The parts of a mixture count by their weights.
pub fn chances(bsdf: &Bsdf, incidence: &Incidence) -> Shares {
    match bsdf {
        Bsdf::Smooth
        | Bsdf::GaussianDielectric { .. }
        | Bsdf::Specular { .. }
        | Bsdf::Lambertian { .. }
        | Bsdf::GaussianSheet { .. }
        | Bsdf::Metal { .. }
        | Bsdf::Absorber
        | Bsdf::Open
        | Bsdf::Tabulated { .. }
        | Bsdf::Coated { .. }
        | Bsdf::Haze(_)
        | Bsdf::PrismFilm { .. } => {
            let Shares { reflected, transmitted } = shares(bsdf, incidence);
            let sum = reflected + transmitted;
            let over_sum = if sum > 0.0 { 1.0 / sum } else { 0.0 };
            Shares { reflected: over_sum * reflected, transmitted: over_sum * transmitted }
        }
        Bsdf::Microfacet(rough) => rough.sides(incidence).1,
        Bsdf::Mixture(parts) => mean(parts, |part| chances(part, incidence)),
    }
}

/// Positions in a period at which the shares of a film are computed; a tip may lie between two of
/// them. 1.
const PLACES_OF_A_FILM: u32 = 64;

/// The shares of a finish for light that arrives with `incidence`.
pub fn shares(bsdf: &Bsdf, incidence: &Incidence) -> Shares {
    match bsdf {
        Bsdf::Smooth | Bsdf::GaussianDielectric { .. } => smooth(incidence),
        Bsdf::Specular { reflectance, transmittance }
        | Bsdf::Lambertian { reflectance, transmittance }
        | Bsdf::GaussianSheet { reflectance, transmittance, .. } => {
            Shares { reflected: *reflectance, transmitted: *transmittance }
        }
        Bsdf::Metal { n, k } => Shares {
            reflected: fresnel::conductor(incidence.cos(), incidence.index_from, *n, *k)
                .unpolarised(),
            transmitted: 0.0,
        },
        Bsdf::PrismFilm { film, face } => film.shares(*face, incidence, PLACES_OF_A_FILM),
        Bsdf::Tabulated { reflectance, transmittance } => Shares {
            reflected: reflectance.at(incidence.cos()),
            transmitted: transmittance.at(incidence.cos()),
        },
        Bsdf::Coated { reflectance } => coated(reflectance, incidence),
        Bsdf::Microfacet(rough) => rough.sides(incidence).0,
        Bsdf::Haze(haze) => haze.shares(incidence),
        Bsdf::Absorber => Shares { reflected: 0.0, transmitted: 0.0 },
        Bsdf::Open => Shares { reflected: 0.0, transmitted: 1.0 },
        Bsdf::Mixture(parts) => mean(parts, |part| shares(part, incidence)),
    }
}

/// The mean over the parts of a mixture.
fn mean(parts: &[(f64, Bsdf)], of: impl Fn(&Bsdf) -> Shares) -> Shares {
    let mut mean = Shares { reflected: 0.0, transmitted: 0.0 };
    let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
    for (weight, part) in parts {
        let of_part = of(part);
        mean.reflected += weight / total * of_part.reflected;
        mean.transmitted += weight / total * of_part.transmitted;
    }
    mean
}

/// The table's shares at the angle in the medium of the lower index, so that they are the same from both sides.
fn coated(table: &AngleTable, incidence: &Incidence) -> Shares {
    let Incidence { index_from, index_to, .. } = *incidence;
    let outside = if index_from > index_to {
        fresnel::cos_transmitted(incidence.cos(), index_from, index_to)
    } else {
        Some(incidence.cos())
    };
    let reflected = outside.map_or(1.0, |cos| table.at(cos));
    Shares { reflected, transmitted: 1.0 - reflected }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Side;
    use crate::optics::testing::incidence;
    use crate::optics::{Facets, Gaussian, Haze, HazeBase, HazeLaw, Microfacet};
    use crate::rng::Sampler;
    use crate::tally::Tally;
    use glam::DVec3;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn a_coating_reflects_the_same_from_both_sides_and_keeps_total_reflection() {
        let coated = Bsdf::Coated {
            reflectance: AngleTable::new(vec![[0.0, 0.005], [1.0, 0.06], [FRAC_PI_2, 1.0]]),
        };
        let shares_at = |angle, indices| shares(&coated, &incidence(angle, indices));
        for angle in [0.0f64, 0.5, 1.0, 1.3] {
            let inside = (angle.sin() / 1.52).asin();
            let (there, back) = (shares_at(angle, [1.0, 1.52]), shares_at(inside, [1.52, 1.0]));
            assert!(
                (there.reflected - back.reflected).abs() < 1e-12,
                "{angle}: {there:?}, {back:?}"
            );
        }
        assert!((shares_at(0.5, [1.0, 1.52]).reflected - 0.0325).abs() < 1e-12);
        assert_eq!(shares_at(0.8, [1.52, 1.0]), Shares { reflected: 1.0, transmitted: 0.0 });
    }

    #[test]
    fn photons_go_to_each_side_in_the_shares_and_with_the_chances_that_are_told() {
        let sheet = Bsdf::Specular { reflectance: 0.5, transmittance: 0.3 };
        let finishes = [
            Bsdf::Smooth,
            sheet.clone(),
            Bsdf::Metal { n: 0.8, k: 5.9 },
            Bsdf::Absorber,
            Bsdf::Open,
            Bsdf::Lambertian { reflectance: 0.2, transmittance: 0.4 },
            Bsdf::GaussianDielectric { lobe: Gaussian::new(0.2) },
            Bsdf::Tabulated {
                reflectance: AngleTable::new(vec![[0.0, 0.1], [1.0, 0.5], [FRAC_PI_2, 0.9]]),
                transmittance: AngleTable::new(vec![[0.0, 0.8], [FRAC_PI_2, 0.1]]),
            },
            Bsdf::Coated { reflectance: AngleTable::new(vec![[0.0, 0.01], [FRAC_PI_2, 1.0]]) },
            Bsdf::Microfacet(Microfacet::new(0.3, Facets::Interface)),
            Bsdf::Haze(Box::new(Haze::new(
                HazeLaw::Abg { a: 0.02, b: 0.01, g: 2.0 },
                HazeBase::Interface,
            ))),
            Bsdf::Mixture(vec![(1.0, sheet), (2.0, Bsdf::Smooth), (1.0, Bsdf::Absorber)]),
        ];
        for bsdf in &finishes {
            for (angle, index_from, index_to) in
                [(0.9f64, 1.0, 1.49), (0.65, 1.49, 1.0), (1.0, 1.49, 1.0), (0.3, 1.2, 1.2)]
            {
                let dir = DVec3::new(angle.sin(), 0.0, -angle.cos());
                let incidence =
                    Incidence { dir, normal: DVec3::Z, index_from, index_to, grain: DVec3::ZERO };
                for side in [Side::Reflected, Side::Transmitted] {
                    let sent = |worth: fn(f64) -> f64| {
                        Tally::of((0..10_000).map(|index| {
                            let mut sampler = Sampler::for_path(5, 0, index);
                            bsdf.scatter(&incidence, &mut sampler)
                                .filter(|out| out.side == side)
                                .map_or(0.0, |out| worth(out.factor))
                        }))
                    };
                    let flux = (sent(|factor| factor), shares(bsdf, &incidence).of(side));
                    let number = (sent(|_| 1.0), chances(bsdf, &incidence).of(side));
                    for (seen, told) in [flux, number] {
                        // A constant share is exact up to rounding.
                        let met =
                            (seen.mean() - told).abs() < 1e-9 || seen.sigmas_from(told).abs() < 4.0;
                        assert!(met, "{bsdf:?} at {angle}, {side:?}: {seen:?}, told {told}");
                    }
                }
            }
        }
    }
}
