//! A bare metal of complex index n + ik, by Fresnel for unpolarised light.

use crate::optics::finish::model::FinishModel;
use crate::optics::{Incidence, Scattered, Shares, Side, fresnel};
use crate::rng::{Numbers, Sampler};

pub(crate) struct Metal {
    pub(crate) n: f64,
    pub(crate) k: f64,
}

impl FinishModel for Metal {
    fn shares(&self, incidence: &Incidence) -> Shares {
        let reflected =
            fresnel::conductor(incidence.cos(), incidence.index_from, self.n, self.k).unpolarised();
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
}

#[cfg(test)]
mod tests {
    use crate::optics::finish::testing::{assert_sound, metal};

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&metal());
    }
}
