//! Diffuse reflection and transmission by Lambert's law.
//!
//! A diffuser mixes radiance, not basic radiance, so the factor `n_i²/n_o²` of a gather path remains.

use crate::optics::finish::model::{FinishModel, Spread};
use crate::optics::{Incidence, Scattered, Shares, Side};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, cosine_hemisphere};
use std::f64::consts::PI;

pub(crate) struct Lambertian {
    pub(crate) shares: Shares,
}

impl FinishModel for Lambertian {
    fn shares(&self, _incidence: &Incidence) -> Shares {
        self.shares
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let side = self.shares.choose_side(sampler)?;
        let dir = draw(incidence, side, sampler);
        Some(Scattered::diffuse(dir, self.shares.sum(), side).chosen_by(self.shares))
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let share = self.shares.of(side);
        let out = Scattered::diffuse(draw(incidence, side, sampler), share, side);
        (share > 0.0).then(|| out.unrefracted(incidence))
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        self.shares.of(incidence.side_of(out)) / PI
    }

    fn spread(&self) -> Spread {
        Spread::Broad
    }
}

/// A direction by Lambert's law.
fn draw(incidence: &Incidence, side: Side, sampler: &mut Sampler<impl Numbers>) -> DVec3 {
    let local = cosine_hemisphere(sampler.pair(Dimension::Scatter));
    Frame::from_axis(DVec3::ZERO, incidence.leaving_normal(side)).to_world(local)
}

#[cfg(test)]
mod tests {
    use crate::optics::finish::testing::{
        assert_mean_factors, assert_moments, assert_sound, diffuse,
    };

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&diffuse());
        assert_moments(&diffuse());
        assert_mean_factors(&diffuse());
    }
}
