//! Each photon meets one of several finishes, chosen by weight. It is depolarised, since which of them sent it on is not known.
//!
//! This module does not know which finishes there are: it asks the parts what it is asked.

use crate::optics::finish::model::{FinishModel, Spread};
use crate::optics::{Incidence, Scattered, Shares, Side};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;

/// Finishes with their weights, at least one.
pub(crate) struct Mixture<'a, F> {
    pub(crate) parts: &'a [(f64, F)],
}

impl<'a, F> Mixture<'a, F> {
    fn total(&self) -> f64 {
        self.parts.iter().map(|(weight, _)| weight).sum()
    }

    fn finishes(&self) -> impl Iterator<Item = &'a F> {
        self.parts.iter().map(|(_, part)| part)
    }

    /// One of the parts, by its weight.
    fn pick(&self, sampler: &mut Sampler<impl Numbers>) -> &'a F {
        let mut left = sampler.one(Dimension::Lobe) * self.total();
        for (weight, part) in &self.parts[..self.parts.len() - 1] {
            left -= weight;
            if left < 0.0 {
                return part;
            }
        }
        &self.parts[self.parts.len() - 1].1
    }

    /// The mean over the parts.
    fn mean(&self, of: impl Fn(&F) -> Shares) -> Shares {
        let total = self.total();
        self.parts
            .iter()
            .fold(Shares::NONE, |mean, (weight, part)| mean.plus(of(part).scaled(weight / total)))
    }
}

impl<F: FinishModel> FinishModel for Mixture<'_, F> {
    fn shares(&self, incidence: &Incidence) -> Shares {
        let incidence = &incidence.unpolarised();
        self.mean(|part| part.shares(incidence))
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.pick(sampler).scatter(&incidence.unpolarised(), sampler)
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.pick(sampler).scatter_radiance(&incidence.unpolarised(), sampler)
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.pick(sampler).scatter_toward(side, &incidence.unpolarised(), sampler)
    }

    fn albedo_about(&self, incidence: &Incidence) -> f64 {
        let of = |(weight, part): &(f64, F)| weight * part.albedo_about(&incidence.unpolarised());
        self.parts.iter().map(of).sum::<f64>() / self.total()
    }

    fn chances(&self, incidence: &Incidence) -> Shares {
        let incidence = &incidence.unpolarised();
        self.mean(|part| part.chances(incidence))
    }

    fn radiance_chances(&self, incidence: &Incidence) -> Shares {
        let incidence = &incidence.unpolarised();
        let sum = self.parts.iter().fold(Shares::NONE, |sum, (weight, part)| {
            sum.plus(part.radiance_chances(incidence).scaled(*weight))
        });
        let total = self.total();
        Shares { reflected: sum.reflected / total, transmitted: sum.transmitted / total }
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        let value = |(weight, part): &(f64, F)| weight * part.evaluate(incidence, out);
        self.parts.iter().map(value).sum::<f64>() / self.total()
    }

    fn width(&self) -> Option<f64> {
        self.finishes().filter_map(F::width).reduce(f64::min)
    }

    fn spread(&self) -> Spread {
        self.finishes().map(F::spread).fold(Spread::Discrete, Spread::broader)
    }

    fn passes_straight(&self) -> bool {
        self.finishes().any(F::passes_straight)
    }

    fn has_grain(&self) -> bool {
        self.finishes().any(F::has_grain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::Finish;
    use crate::optics::finish::testing::{
        assert_moments, assert_sound, diffuse, mixture, rough, sheet,
    };

    #[test]
    fn photons_and_gather_paths_follow_it() {
        assert_sound(&mixture());
        let parts = [diffuse(), sheet(0.3), rough(0.15), Finish::Absorber];
        assert_moments(&Finish::Mixture(parts.map(|part| (1.0, part)).to_vec()));
    }

    #[test]
    fn a_mixture_is_as_broad_as_its_broadest_part_and_resolved_by_its_narrowest() {
        let diffuse = Finish::Lambertian { reflectance: 0.5, transmittance: 0.0 };
        let two =
            Finish::Mixture(vec![(1.0, rough(0.05)), (1.0, Finish::Smooth), (1.0, rough(0.02))]);
        assert_eq!((two.spread(), two.width()), (Spread::Narrow(0.05), Some(0.02)));
        let all = Finish::Mixture(vec![(1.0, diffuse), (1.0, two)]);
        assert_eq!((all.spread(), all.width()), (Spread::Broad, Some(0.02)));
        let none = Finish::Mixture(vec![(1.0, Finish::Smooth), (1.0, Finish::Absorber)]);
        assert_eq!((none.spread(), none.width()), (Spread::Discrete, None));
    }
}
