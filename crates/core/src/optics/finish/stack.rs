//! An interface, or a sheet, with a stack of thin layers: shares by the matrices of its layers between the media on both
//! sides, computed at every hit. Light is refracted into the medium behind; between equal media it goes straight on.
//!
//! A stack transmits the same both ways, and refraction conserves n² cos θ dω, so gather paths need no factor; what they
//! reflect is by the stack as seen from their side.

use crate::optics::finish::model::FinishModel;
use crate::optics::finish::smooth::SmoothInterface;
use crate::optics::{FaceMueller, Incidence, LayerStack, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};

pub(crate) struct Stacked<'a> {
    pub(crate) stack: &'a LayerStack,
}

impl FinishModel for Stacked<'_> {
    fn shares(&self, incidence: &Incidence) -> Shares {
        self.stack.shares(incidence)
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        send(self.stack.shares(incidence), incidence, sampler)
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let shares = self.stack.shares_of_leaving(incidence);
        send(shares, incidence, sampler).map(Scattered::normalised)
    }

    fn radiance_chances(&self, incidence: &Incidence) -> Shares {
        self.stack.shares_of_leaving(incidence)
    }

    fn mueller(&self, incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        Some(self.stack.mueller(incidence, side))
    }

    fn only_mirrors(&self, incidence: &Incidence) -> bool {
        self.stack.shares(incidence).transmitted == 0.0
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        _sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let share = self.stack.shares_of_leaving(incidence).of(side);
        SmoothInterface::toward(side, incidence, share)
    }
}

/// To a side in proportion to the shares; no draw where nothing is transmitted.
fn send(
    shares: Shares,
    incidence: &Incidence,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    let side = shares.choose_side(sampler)?;
    let dir = SmoothInterface::direction(incidence, side)?;
    Some(Scattered::specular(dir, shares.sum(), side).chosen_by(shares))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Faces;
    use crate::optics::finish::testing::{
        absorbing_stack, assert_adjoint, assert_sound, clear_stack, incidence,
    };

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&clear_stack());
        assert_sound(&absorbing_stack());
    }

    #[test]
    fn both_sides_of_a_stack_agree() {
        for front in [clear_stack(), absorbing_stack()] {
            let back = front.from_behind().unwrap();
            assert_adjoint(Faces { own: &front, behind: &back });
            assert_adjoint(Faces { own: &back, behind: &front });
            // Light through the stack, and back along the same way.
            let inside = (0.6f64.sin() / 1.5).asin();
            let there = front.shares(&incidence(0.6, [1.0, 1.5]));
            let again = back.shares(&incidence(inside, [1.5, 1.0]));
            assert!((there.transmitted - again.transmitted).abs() < 1e-12, "{there:?}, {again:?}");
        }
    }

    #[test]
    fn total_reflection_is_whole_before_clear_layers_only() {
        let met = incidence(1.0, [1.5, 1.0]);
        assert_eq!(clear_stack().shares(&met), Shares { reflected: 1.0, transmitted: 0.0 });
        assert!(clear_stack().only_mirrors(&met));
        let Shares { reflected, transmitted } = absorbing_stack().shares(&met);
        assert!(reflected < 0.99 && transmitted == 0.0, "{reflected}");
    }
}
