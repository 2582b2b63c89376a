//! Haze: faint scatter with long tails about light that is otherwise mirrored, refracted or
//! transmitted.
//!
//! The lobe depends only on the distance between the arriving and the leaving direction in the
//! plane of direction cosines, as in data sheets and the theory of smooth surfaces (Harvey & Shack;
//! Stover, Optical Scattering, 3rd ed. 2012, chapter 4). Scattered light is subtracted from the
//! undisturbed light. Where the horizon cuts the lobe, less is scattered. This module knows the
//! shape of the lobe only by its law.
//!
//! A sheet has `f = S(|β_o - β_i|)`, with the sines β of angles. Between two media the distance is
//! that of `n β`, which refraction conserves, and `f = n_o² S(|n_o β_o - n_i β_i|)` on both sides:
//! then `f(i→o)/n_o²` and the undisturbed share are the same both ways, and totally reflected light
//! is also scattered out of the guide.

use crate::optics::finish::model::{FinishModel, Spread};
use crate::optics::finish::smooth::SmoothInterface;
use crate::optics::haze::horizon::{Horizon, HorizonIndices};
use crate::optics::haze::profile::LawProfile;
use crate::optics::{HazeLaw, Incidence, Lobe, Scattered, Shares, Side};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, circle};

/// A finish with haze.
#[derive(Debug, Clone, PartialEq)]
pub struct Haze {
    profile: LawProfile,
    horizon: Horizon,
    base: HazeBase,
}

/// The finish without haze.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HazeBase {
    /// The smooth interface of the two media.
    Interface,
    /// A sheet with shares that do not depend on the angle.
    Sheet {
        /// Share that is reflected, including scattered light, 0..=1.
        reflectance: f64,
        /// Share that is transmitted, including scattered light, 0..=1 with the reflectance.
        transmittance: f64,
        /// The sides to which light is scattered.
        scatters: HazeSides,
    },
}

/// The sides to which a sheet scatters; never one without a share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HazeSides {
    /// About the mirrored and about the straight direction.
    Both,
    /// About the mirrored direction only.
    Reflected,
    /// About the straight direction only.
    Transmitted,
}

/// Shares of the arriving light.
struct Parts {
    scattered: Shares,
    /// Mirrored, refracted or transmitted.
    undisturbed: Shares,
}

/// Total integrated scatter, 1: the share of light at normal incidence that is scattered to one
/// side, into a medium of this index (1 for sheets). It is smaller at every other angle.
pub fn integrated_scatter(law: HazeLaw, index: f64) -> f64 {
    LawProfile::new(law).within(index)
}

impl FinishModel for Haze {
    fn shares(&self, incidence: &Incidence) -> Shares {
        let Parts { scattered, undisturbed } = self.parts(incidence);
        scattered.plus(undisturbed)
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let Parts { scattered, undisturbed } = self.parts(incidence);
        let (reflected, transmitted) = (Side::Reflected, Side::Transmitted);
        let scattered = [reflected, transmitted].map(|side| (Lobe::Diffuse, side, scattered));
        let undisturbed = [reflected, transmitted].map(|side| (Lobe::Specular, side, undisturbed));
        self.one_of([scattered, undisturbed].as_flattened(), incidence, sampler)
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let out = self.scatter(incidence, sampler)?;
        Some(self.backwards(out.normalised(), incidence))
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let Parts { scattered, undisturbed } = self.parts(incidence);
        let lobes = [(Lobe::Diffuse, side, scattered), (Lobe::Specular, side, undisturbed)];
        let out = self.one_of(&lobes, incidence, sampler)?;
        Some(self.backwards(out, incidence))
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        let side = incidence.side_of(out);
        let [index_from, index_out] = self.indices(incidence, side);
        let along = index_out * out - index_from * incidence.dir;
        let along = along - along.dot(incidence.normal) * incidence.normal;
        if self.is_scattered(side) {
            index_out * index_out * self.profile.law.at(along.length())
        } else {
            0.0
        }
    }

    /// The tails reach over the half space; undisturbed light is separated by its lobe.
    fn spread(&self) -> Spread {
        Spread::Broad
    }

    fn passes_straight(&self) -> bool {
        match self.base {
            HazeBase::Interface => false,
            HazeBase::Sheet { transmittance, .. } => transmittance > 0.0,
        }
    }
}

impl Haze {
    /// Haze of this law. A sheet subtracts scattered light from its shares, so
    /// [`integrated_scatter`] must be smaller.
    pub fn new(law: HazeLaw, base: HazeBase) -> Self {
        let profile = LawProfile::new(law);
        let indices = match base {
            HazeBase::Interface => HorizonIndices::Any,
            HazeBase::Sheet { .. } => HorizonIndices::One,
        };
        Self { horizon: Horizon::new(&profile, indices), profile, base }
    }

    /// A gather path by the light that a photon would be; a sheet does not bend it.
    fn backwards(&self, out: Scattered, incidence: &Incidence) -> Scattered {
        match self.base {
            HazeBase::Interface => out.normalised(),
            HazeBase::Sheet { .. } => out.normalised().unrefracted(incidence),
        }
    }

    /// One of these lobes in proportion to its share; the factor is their sum.
    fn one_of(
        &self,
        lobes: &[(Lobe, Side, Shares)],
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let factor: f64 = lobes.iter().map(|(_, side, shares)| shares.of(*side)).sum();
        let mut left = sampler.one(Dimension::Lobe) * factor;
        let possible = lobes.iter().filter(|(_, side, shares)| shares.of(*side) > 0.0);
        let mut chosen = None;
        for (lobe, side, shares) in possible {
            chosen = Some((*lobe, *side));
            left -= shares.of(*side);
            if left < 0.0 {
                break;
            }
        }
        let (lobe, side) = chosen?;
        match lobe {
            Lobe::Diffuse => {
                let dir = self.drawn(incidence, side, sampler);
                Some(Scattered::diffuse(dir, factor, side))
            }
            Lobe::Specular => {
                let dir = self.undisturbed_direction(incidence, side)?;
                Some(Scattered::specular(dir, factor, side))
            }
        }
    }

    fn undisturbed_direction(&self, incidence: &Incidence, side: Side) -> Option<DVec3> {
        match self.base {
            HazeBase::Interface => SmoothInterface::direction(incidence, side),
            HazeBase::Sheet { .. } => Some(incidence.straight(side)),
        }
    }

    fn parts(&self, incidence: &Incidence) -> Parts {
        let scattered = Shares {
            reflected: self.scattered(incidence, Side::Reflected),
            transmitted: self.scattered(incidence, Side::Transmitted),
        };
        let undisturbed = match self.base {
            HazeBase::Interface => {
                let rest = 1.0 - scattered.reflected - scattered.transmitted;
                SmoothInterface.shares(&incidence.unpolarised()).scaled(rest)
            }
            HazeBase::Sheet { reflectance, transmittance, .. } => Shares {
                reflected: reflectance - scattered.reflected,
                transmitted: transmittance - scattered.transmitted,
            },
        };
        // Rounding, where all light is scattered.
        let undisturbed = Shares {
            reflected: undisturbed.reflected.max(0.0),
            transmitted: undisturbed.transmitted.max(0.0),
        };
        Parts { scattered, undisturbed }
    }

    fn scattered(&self, incidence: &Incidence, side: Side) -> f64 {
        if !self.is_scattered(side) {
            return 0.0;
        }
        let [index_from, index_out] = self.indices(incidence, side);
        let sin = (1.0 - incidence.cos().powi(2)).max(0.0).sqrt();
        self.profile.within(index_out) * self.horizon.share(index_from * sin, index_out)
    }

    fn is_scattered(&self, side: Side) -> bool {
        match self.base {
            HazeBase::Interface => true,
            HazeBase::Sheet { reflectance, transmittance, scatters } => {
                let share = Shares { reflected: reflectance, transmitted: transmittance }.of(side);
                let is_meant = match scatters {
                    HazeSides::Both => true,
                    HazeSides::Reflected => side == Side::Reflected,
                    HazeSides::Transmitted => side == Side::Transmitted,
                };
                is_meant && share > 0.0
            }
        }
    }

    /// The indices that multiply direction cosines: for arriving light, and for light that leaves
    /// to a side.
    fn indices(&self, incidence: &Incidence, side: Side) -> [f64; 2] {
        let Incidence { index_from, index_to, .. } = *incidence;
        match (self.base, side) {
            (HazeBase::Sheet { .. }, Side::Reflected | Side::Transmitted) => [1.0, 1.0],
            (HazeBase::Interface, Side::Reflected) => [index_from, index_from],
            (HazeBase::Interface, Side::Transmitted) => [index_from, index_to],
        }
    }

    /// A direction drawn from the lobe, above the horizon.
    fn drawn(
        &self,
        incidence: &Incidence,
        side: Side,
        sampler: &mut Sampler<impl Numbers>,
    ) -> DVec3 {
        let [index_from, index_out] = self.indices(incidence, side);
        let normal = incidence.normal;
        let center = index_from * (incidence.dir - incidence.dir.dot(normal) * normal);
        let away = center.length();
        let toward_middle = if away > 0.0 { -center } else { normal };
        let frame = Frame::from_axis_and_x(DVec3::ZERO, normal, toward_middle)
            .unwrap_or_else(|| Frame::from_axis(DVec3::ZERO, normal));
        let range = [(away - index_out).max(0.0), away + index_out];
        // Angles about the direction to the middle of the disk at which part of it lies.
        let widest =
            if away > index_out { (index_out / away).asin() / std::f64::consts::TAU } else { 0.5 };
        loop {
            let distance = self.profile.sample(range, sampler);
            let turns = widest * (2.0 * sampler.one(Dimension::Scatter) - 1.0);
            let around = circle(turns.rem_euclid(1.0));
            let place = (center + distance * frame.to_world(around.extend(0.0))) / index_out;
            let above = 1.0 - place.length_squared();
            if above > 0.0 {
                return place + above.sqrt() * incidence.leaving_normal(side);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::finish::testing::{
        assert_follows, assert_mean_factors, assert_reciprocal, assert_sound, haze, hazy_sheet,
        incidence,
    };
    use crate::optics::{Finish, fresnel};
    use std::f64::consts::PI;

    const ABG: HazeLaw = HazeLaw::Abg { a: 0.02, b: 0.01, g: 2.0 };
    const HARVEY: HazeLaw = HazeLaw::Harvey { b0: 1.0, shoulder: 0.1, slope: -1.5 };
    const SHEET: HazeBase =
        HazeBase::Sheet { reflectance: 0.45, transmittance: 0.5, scatters: HazeSides::Both };

    fn all() -> Vec<Finish> {
        let through = HazeBase::Sheet {
            reflectance: 0.05,
            transmittance: 0.9,
            scatters: HazeSides::Transmitted,
        };
        [(ABG, SHEET), (HARVEY, through), (ABG, HazeBase::Interface), (HARVEY, HazeBase::Interface)]
            .map(|(law, base)| Finish::Haze(Box::new(Haze::new(law, base))))
            .to_vec()
    }

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&hazy_sheet());
        assert_sound(&haze(HazeBase::Interface));
        assert_mean_factors(&haze(HazeBase::Interface));
    }

    #[test]
    fn scattered_light_follows_the_distribution_function_and_its_share_is_told() {
        for finish in all() {
            let Finish::Haze(haze) = &finish else { unreachable!() };
            for indices in [[1.0, 1.49], [1.49, 1.0], [1.3, 1.3]] {
                for angle in [0.0, 0.6, 1.2] {
                    let incidence = incidence(angle, indices);
                    for side in [Side::Reflected, Side::Transmitted] {
                        let integral = assert_follows(&finish, &incidence, side);
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
        for finish in all() {
            for indices in [[1.0, 1.49], [1.49, 1.0], [1.3, 1.3], [4.0, 1.0]] {
                for angle in [0.0, 0.3, 0.8, 1.3, 1.57] {
                    let shares = finish.shares(&incidence(angle, indices));
                    let sum = shares.reflected + shares.transmitted;
                    assert!([1.0, 0.95].iter().any(|all| (sum - all).abs() < 1e-12), "{sum}");
                }
            }
        }
    }

    #[test]
    fn the_distribution_function_is_reciprocal_between_media() {
        for law in [ABG, HARVEY] {
            let finish = Finish::Haze(Box::new(Haze::new(law, HazeBase::Interface)));
            for indices in [[1.0, 1.49], [1.49, 1.0]] {
                assert_reciprocal(&finish, indices);
            }
            assert_reciprocal(&Finish::Haze(Box::new(Haze::new(law, SHEET))), [1.0, 1.0]);
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
}
