//! A mirror, or a beam splitter, with the same shares at every angle; transmitted light goes straight on.

use crate::optics::finish::model::FinishModel;
use crate::optics::{FaceMueller, Incidence, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};

pub(crate) struct Specular {
    pub(crate) shares: Shares,
}

impl FinishModel for Specular {
    fn shares(&self, _incidence: &Incidence) -> Shares {
        self.shares
    }

    #[inline]
    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let side = self.shares.choose_side(sampler)?;
        let out = Scattered::specular(incidence.straight(side), self.shares.sum(), side);
        Some(out.chosen_by(self.shares))
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.scatter(incidence, sampler).map(|out| out.unrefracted(incidence))
    }

    fn mueller(&self, _incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        Some(FaceMueller::ideal(side))
    }

    fn only_mirrors(&self, incidence: &Incidence) -> bool {
        self.shares(incidence).transmitted == 0.0
    }

    fn mirrors_alike(&self, incidence: &Incidence) -> bool {
        self.only_mirrors(incidence)
    }

    fn passes_straight(&self) -> bool {
        self.shares.transmitted > 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::finish::testing::{assert_sound, incidence, splitter};
    use crate::rng::Dimension;

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&splitter());
    }

    #[test]
    fn a_mirror_draws_no_numbers() {
        let mirror = Specular { shares: Shares { reflected: 0.9, transmitted: 0.0 } };
        let mut used = Sampler::for_path(1, 0, 0);
        let mut fresh = used.clone();
        assert!(mirror.scatter(&incidence(0.3, [1.0, 1.0]), &mut used).is_some());
        assert_eq!(used.one(Dimension::Lobe), fresh.one(Dimension::Lobe));
    }
}
