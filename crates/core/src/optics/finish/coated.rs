//! A coated interface of two media: it reflects as a table says and refracts the rest. A gather
//! path does what a photon does, as at a smooth interface.

use crate::optics::finish::model::FinishModel;
use crate::optics::finish::smooth::SmoothInterface;
use crate::optics::{AngleTable, FaceMueller, Incidence, Scattered, Shares, Side, fresnel};
use crate::rng::{Numbers, Sampler};

pub(crate) struct Coated<'a> {
    pub(crate) reflectance: &'a AngleTable,
}

impl FinishModel for Coated<'_> {
    /// The table's shares at the angle in the medium of the lower index, so that they are the same from both sides.
    fn shares(&self, incidence: &Incidence) -> Shares {
        let Incidence { index_from, index_to, .. } = *incidence;
        let outside = if index_from > index_to {
            fresnel::cos_transmitted(incidence.cos(), index_from, index_to)
        } else {
            Some(incidence.cos())
        };
        let reflected = outside.map_or(1.0, |cos| self.reflectance.at(cos));
        Shares { reflected, transmitted: 1.0 - reflected }
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let shares = self.shares(incidence);
        let side = shares.choose_side(sampler)?;
        let dir = SmoothInterface::direction(incidence, side)?;
        Some(Scattered::specular(dir, 1.0, side).chosen_by(shares))
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.scatter(incidence, sampler).map(Scattered::normalised)
    }

    /// Total reflection is that of the bare face.
    fn mueller(&self, incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        if SmoothInterface.only_mirrors(incidence) {
            return SmoothInterface.mueller(incidence, side);
        }
        Some(FaceMueller::ideal(side))
    }

    fn only_mirrors(&self, incidence: &Incidence) -> bool {
        self.shares(incidence).transmitted == 0.0
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        _sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        SmoothInterface::toward(side, incidence, self.shares(incidence).of(side))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Finish;
    use crate::optics::finish::testing::{assert_sound, coated, incidence};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&coated());
    }

    #[test]
    fn a_coating_reflects_the_same_from_both_sides_and_keeps_total_reflection() {
        let coated = Finish::Coated {
            reflectance: AngleTable::new(vec![[0.0, 0.005], [1.0, 0.06], [FRAC_PI_2, 1.0]]),
        };
        let shares_at = |angle, indices| coated.shares(&incidence(angle, indices));
        for angle in [0.0f64, 0.5, 1.0, 1.3] {
            let inside = (angle.sin() / 1.52).asin();
            let (there, back) = (shares_at(angle, [1.0, 1.52]), shares_at(inside, [1.52, 1.0]));
            assert!(
                (there.reflected - back.reflected).abs() < 1e-12,
                "{angle}: {there:?}, {back:?}"
            );
        }
        assert!((shares_at(0.5, [1.0, 1.52]).reflected - 0.0325).abs() < 1e-12);
        assert_eq!(shares_at(0.8, [1.52, 1.0]), Shares { reflected: 1.0, transmitted: 0.0 });
    }
}
