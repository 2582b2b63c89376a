//! Gaussian scatter about the mirrored and the straight direction, with shares that do not depend on
//! the angle.

use crate::optics::finish::model::FinishModel;
use crate::optics::{Gaussian, Incidence, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};
use glam::DVec3;

pub(crate) struct GaussianSheet<'a> {
    pub(crate) lobe: &'a Gaussian,
    pub(crate) shares: Shares,
}

impl FinishModel for GaussianSheet<'_> {
    fn shares(&self, _incidence: &Incidence) -> Shares {
        self.shares
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let side = self.shares.choose_side(sampler)?;
        let normal = incidence.leaving_normal(side);
        let dir = self.lobe.sample(incidence.straight(side), normal, sampler);
        Some(Scattered::diffuse(dir, self.shares.sum(), side).chosen_by(self.shares))
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let before = self.lobe.before(incidence, sampler)?;
        let side = self.shares.choose_side(sampler)?;
        let out = Scattered::specular(before.incidence.straight(side), self.shares.sum(), side);
        Some(before.continued(out.unrefracted(incidence)))
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let share = self.shares.of(side);
        let before = self.lobe.before(incidence, sampler)?;
        let out = Scattered::specular(before.incidence.straight(side), share, side);
        (share > 0.0).then(|| before.continued(out.unrefracted(incidence)))
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        let side = incidence.side_of(out);
        let normal = incidence.leaving_normal(side);
        self.shares.of(side) * self.lobe.over_cosine(incidence.straight(side), out, normal)
    }

    fn width(&self) -> Option<f64> {
        Some(self.lobe.sigma())
    }

    fn passes_straight(&self) -> bool {
        self.shares.transmitted > 0.0
    }
}

#[cfg(test)]
mod tests {
    use crate::optics::finish::testing::{
        assert_mean_factors, assert_moments, assert_sound, sheet,
    };

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&sheet(0.03));
        assert_sound(&sheet(0.4));
        assert_moments(&sheet(0.3));
        assert_mean_factors(&sheet(0.3));
    }
}
