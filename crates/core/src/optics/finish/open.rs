//! No interface: light goes straight on, whatever the indices are.

use crate::optics::finish::model::FinishModel;
use crate::optics::{FaceMueller, Incidence, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};

pub(crate) struct Open;

impl FinishModel for Open {
    fn shares(&self, _incidence: &Incidence) -> Shares {
        Shares { reflected: 0.0, transmitted: 1.0 }
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        _sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        Some(Scattered::specular(incidence.dir, 1.0, Side::Transmitted))
    }

    fn mueller(&self, _incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        Some(FaceMueller::ideal(side))
    }

    fn passes_straight(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use crate::optics::Finish;
    use crate::optics::finish::testing::assert_sound;

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&Finish::Open);
    }
}
