//! The smooth interface of two media: Fresnel, Snell, total reflection.
//!
//! Refraction conserves n² cos θ dω, and Fresnel's R and T are the same from both sides. So a
//! gather path does what a photon does, without a factor.

use crate::optics::coating::bare_face;
use crate::optics::finish::model::FinishModel;
use crate::optics::{FaceMueller, Incidence, Scattered, Shares, Side, fresnel};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;

pub(crate) struct SmoothInterface;

impl SmoothInterface {
    /// The photon; one draw, none under total reflection or between equal indices.
    #[inline]
    pub(crate) fn send(incidence: &Incidence, sampler: &mut Sampler<impl Numbers>) -> Scattered {
        let Incidence { dir, normal, index_from, index_to, s_share, .. } = *incidence;
        if index_from == index_to {
            return Scattered::specular(dir, 1.0, Side::Transmitted);
        }
        let cos_i = incidence.cos();
        if let Some(cos_t) = fresnel::cos_transmitted(cos_i, index_from, index_to) {
            let reflectance =
                fresnel::dielectric_refracting(cos_i, cos_t, index_from, index_to).of(s_share);
            if sampler.one(Dimension::Lobe) >= reflectance {
                let eta = index_from / index_to;
                let refracted = fresnel::refracted(dir, normal, cos_i, cos_t, eta);
                let out = Scattered::specular(refracted, 1.0, Side::Transmitted);
                return Scattered { chance: 1.0 - reflectance, ..out };
            }
            let out = Scattered::specular(fresnel::mirrored(dir, normal), 1.0, Side::Reflected);
            return Scattered { chance: reflectance, ..out };
        }
        Scattered::specular(fresnel::mirrored(dir, normal), 1.0, Side::Reflected)
    }

    /// The discrete direction to a side, a unit vector up to rounding: mirrored, or refracted
    /// (`None` under total reflection).
    pub(crate) fn direction(incidence: &Incidence, side: Side) -> Option<DVec3> {
        let Incidence { dir, normal, index_from, index_to, .. } = *incidence;
        match side {
            Side::Reflected => Some(fresnel::mirrored(dir, normal)),
            Side::Transmitted if index_from == index_to => Some(dir),
            Side::Transmitted => {
                let cos_i = incidence.cos();
                let cos_t = fresnel::cos_transmitted(cos_i, index_from, index_to)?;
                Some(fresnel::refracted(dir, normal, cos_i, cos_t, index_from / index_to))
            }
        }
    }

    /// Light to one side in its discrete direction, with this share.
    pub(crate) fn toward(side: Side, incidence: &Incidence, share: f64) -> Option<Scattered> {
        let dir = Self::direction(incidence, side)?;
        (share > 0.0).then(|| Scattered::specular(dir, share, side))
    }

    /// Shares that leave out no side, for rough interfaces: their scatter reaches directions that
    /// are themselves totally reflected, or hardly reflected.
    pub(crate) fn chances_about(incidence: &Incidence) -> Shares {
        let reflected = Self.shares(incidence).reflected.clamp(0.1, 0.9);
        Shares { reflected, transmitted: 1.0 - reflected }
    }
}

impl FinishModel for SmoothInterface {
    /// Fresnel's shares; between equal indices all light passes, even along the face.
    fn shares(&self, incidence: &Incidence) -> Shares {
        let Incidence { index_from, index_to, s_share, .. } = *incidence;
        let reflected = if index_from == index_to {
            0.0
        } else {
            fresnel::dielectric(incidence.cos(), index_from, index_to).of(s_share)
        };
        Shares { reflected, transmitted: 1.0 - reflected }
    }

    /// Under total reflection.
    fn only_mirrors(&self, incidence: &Incidence) -> bool {
        let Incidence { index_from, index_to, .. } = *incidence;
        index_from > index_to
            && fresnel::cos_transmitted(incidence.cos(), index_from, index_to).is_none()
    }

    fn mirrors_alike(&self, incidence: &Incidence) -> bool {
        self.only_mirrors(incidence)
    }

    #[inline]
    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        Some(Self::send(incidence, sampler))
    }

    #[inline]
    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.scatter(incidence, sampler)
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        _sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        Self::toward(side, incidence, self.shares(incidence).of(side))
    }

    fn mueller(&self, incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        Some(bare_face(incidence, [incidence.index_to, 0.0], side))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Finish;
    use crate::optics::finish::testing::{
        assert_sound, clear_stack, coated, diffuse, incidence, metal, splitter, tabulated,
    };

    #[test]
    fn light_mirrored_alike_is_mirrored_in_one_proportion_at_all_flatter_angles() {
        let mirror = Finish::Specular { reflectance: 0.9, transmittance: 0.0 };
        let of_one = [Finish::Smooth, mirror];
        let others =
            [splitter(), metal(), tabulated(), coated(), clear_stack(), diffuse(), Finish::Open];
        let mut alike = 0;
        for finish in of_one.into_iter().chain(others) {
            for indices in [[1.49, 1.0], [1.0, 1.49], [1.3, 1.3]] {
                let at = |step: u32| incidence(0.03 * f64::from(step), indices);
                let Some(first) = (0..52).find(|step| finish.mirrors_alike(&at(*step))) else {
                    continue;
                };
                alike += 1;
                for step in first..52 {
                    assert!(finish.only_mirrors(&at(step)), "{finish:?} at step {step}");
                    assert_eq!(finish.shares(&at(step)), finish.shares(&at(first)), "{finish:?}");
                }
            }
        }
        assert_eq!(alike, 4, "in total reflection, and at the mirror of every medium");
    }

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&Finish::Smooth);
    }

    #[test]
    fn total_reflection_draws_no_numbers() {
        let mut used = Sampler::for_path(1, 0, 0);
        let mut fresh = used.clone();
        let out = SmoothInterface::send(&incidence(1.0, [1.49, 1.0]), &mut used);
        assert_eq!((out.side, out.factor, out.chance), (Side::Reflected, 1.0, 1.0));
        assert_eq!(used.one(Dimension::Lobe), fresh.one(Dimension::Lobe));
    }
}
