//! A mirror or a window with shares by the angle of incidence; transmitted light goes straight on.

use crate::optics::finish::model::FinishModel;
use crate::optics::{AngleTable, FaceMueller, Incidence, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};

pub(crate) struct Tabulated<'a> {
    pub(crate) reflectance: &'a AngleTable,
    pub(crate) transmittance: &'a AngleTable,
}

impl FinishModel for Tabulated<'_> {
    fn shares(&self, incidence: &Incidence) -> Shares {
        Shares {
            reflected: self.reflectance.at(incidence.cos()),
            transmitted: self.transmittance.at(incidence.cos()),
        }
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let shares = self.shares(incidence);
        let side = shares.choose_side(sampler)?;
        Some(Scattered::specular(incidence.straight(side), shares.sum(), side).chosen_by(shares))
    }

    fn mueller(&self, _incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        Some(FaceMueller::ideal(side))
    }

    fn only_mirrors(&self, incidence: &Incidence) -> bool {
        self.shares(incidence).transmitted == 0.0
    }

    fn passes_straight(&self) -> bool {
        self.transmittance.greatest() > 0.0
    }
}

#[cfg(test)]
mod tests {
    use crate::optics::finish::testing::{assert_sound, tabulated};

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&tabulated());
    }
}
