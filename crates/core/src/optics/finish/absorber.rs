//! A face that absorbs all light.

use crate::optics::finish::model::FinishModel;
use crate::optics::{Incidence, Scattered, Shares};
use crate::rng::{Numbers, Sampler};

pub(crate) struct Absorber;

impl FinishModel for Absorber {
    fn shares(&self, _incidence: &Incidence) -> Shares {
        Shares::NONE
    }

    fn scatter(
        &self,
        _incidence: &Incidence,
        _sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        None
    }
}

#[cfg(test)]
mod tests {
    use crate::optics::Finish;
    use crate::optics::finish::testing::assert_sound;

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&Finish::Absorber);
    }
}
