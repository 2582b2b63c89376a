//! A bare metal of complex index n + ik, by Fresnel.

use crate::optics::coating::bare_face;
use crate::optics::finish::model::FinishModel;
use crate::optics::{FaceMueller, Incidence, Scattered, Shares, Side, fresnel};
use crate::rng::{Numbers, Sampler};

pub(crate) struct Metal {
    pub(crate) n: f64,
    pub(crate) k: f64,
}

impl FinishModel for Metal {
    fn shares(&self, incidence: &Incidence) -> Shares {
        let Incidence { index_from, s_share, .. } = *incidence;
        let reflected = fresnel::conductor(incidence.cos(), index_from, self.n, self.k).of(s_share);
        Shares { reflected, transmitted: 0.0 }
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        _sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let side = Side::Reflected;
        let factor = self.shares(incidence).reflected;
        Some(Scattered::specular(incidence.straight(side), factor, side))
    }

    fn only_mirrors(&self, _incidence: &Incidence) -> bool {
        true
    }

    fn mueller(&self, incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        Some(bare_face(incidence, [self.n, self.k], side))
    }
}

#[cfg(test)]
mod tests {
    use crate::optics::finish::testing::{assert_sound, metal};

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&metal());
    }
}
