//! A rough dielectric: shares by Fresnel for unpolarised light, Gaussian scatter about the mirrored and the refracted direction.

use crate::optics::finish::model::FinishModel;
use crate::optics::finish::smooth::SmoothInterface;
use crate::optics::{Gaussian, Incidence, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};
use glam::DVec3;

pub(crate) struct GaussianDielectric<'a> {
    pub(crate) lobe: &'a Gaussian,
}

impl FinishModel for GaussianDielectric<'_> {
    fn shares(&self, incidence: &Incidence) -> Shares {
        SmoothInterface.shares(&incidence.unpolarised())
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let out = SmoothInterface::send(&incidence.unpolarised(), sampler);
        let normal = incidence.leaving_normal(out.side);
        let dir = self.lobe.sample(out.dir.normalize(), normal, sampler);
        Some(Scattered { chance: out.chance, ..Scattered::diffuse(dir, 1.0, out.side) })
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let before = self.lobe.before(&incidence.unpolarised(), sampler)?;
        Some(before.continued(SmoothInterface::send(&before.incidence, sampler)))
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let before = self.lobe.before(&incidence.unpolarised(), sampler)?;
        SmoothInterface
            .scatter_toward(side, &before.incidence, sampler)
            .map(|out| before.continued(out))
    }

    fn radiance_chances(&self, incidence: &Incidence) -> Shares {
        if incidence.index_from == incidence.index_to {
            self.shares(incidence)
        } else {
            SmoothInterface::chances_about(&incidence.unpolarised())
        }
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        let side = incidence.side_of(out);
        SmoothInterface::direction(incidence, side).map_or(0.0, |mean| {
            let normal = incidence.leaving_normal(side);
            self.shares(incidence).of(side) * self.lobe.over_cosine(mean.normalize(), out, normal)
        })
    }

    fn width(&self) -> Option<f64> {
        Some(self.lobe.sigma())
    }
}

#[cfg(test)]
mod tests {
    use crate::optics::finish::testing::{
        assert_mean_factors, assert_moments, assert_sound, rough,
    };
    use crate::optics::{FinishModel, Spread};

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&rough(0.02));
        assert_sound(&rough(0.3));
        assert_moments(&rough(0.15));
        assert_mean_factors(&rough(0.2));
    }

    #[test]
    fn gaussian_scatter_is_narrow_up_to_a_tenth_of_a_radian() {
        assert_eq!(rough(0.099).spread(), Spread::Narrow(0.099));
        assert_eq!((rough(0.1).spread(), rough(0.1).width()), (Spread::Broad, Some(0.1)));
    }
}
