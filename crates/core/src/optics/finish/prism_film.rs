//! A thin film with prisms on one face.
//!
//! Every path through the film consists of smooth interfaces, so a gather path does what a photon
//! does. The same holds for the position in the period, which is drawn evenly.

use crate::optics::finish::model::FinishModel;
use crate::optics::{FilmFace, Incidence, PrismFilm, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};

/// Positions in a period at which the shares are computed; a tip may lie between two of them. 1.
const PLACES: u32 = 64;
/// The same for chances, which need not be exact.
const FEW_PLACES: u32 = 4;

/// A film as light meets it.
pub(crate) struct MetFilm<'a> {
    pub(crate) film: &'a PrismFilm,
    pub(crate) face: FilmFace,
}

impl FinishModel for MetFilm<'_> {
    fn shares(&self, incidence: &Incidence) -> Shares {
        self.film.shares(self.face, incidence, PLACES)
    }

    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.film.scatter(self.face, incidence, sampler)
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        self.scatter(incidence, sampler).map(Scattered::normalised)
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        // The light meets the face on its own side; the gather path meets it on the side it comes
        // from.
        let met = match side {
            Side::Reflected => self.face,
            Side::Transmitted => self.face.opposite(),
        };
        self.film.scatter(met, incidence, sampler).filter(|out| out.side == side)
    }

    /// From a few places, which may miss a side that little light takes.
    fn chances(&self, incidence: &Incidence) -> Shares {
        let shares = self.film.shares(self.face, incidence, FEW_PLACES);
        let sum = shares.sum();
        let reflected = if sum > 0.0 { shares.reflected / sum } else { 0.5 }.clamp(0.02, 0.98);
        Shares { reflected, transmitted: 1.0 - reflected }
    }

    /// Whatever the shares are, no side is left out.
    fn radiance_chances(&self, _incidence: &Incidence) -> Shares {
        Shares { reflected: 0.5, transmitted: 0.5 }
    }

    fn has_grain(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::finish::testing::{assert_adjoint, incidence, splitter};
    use crate::optics::{Faces, FilmMake, Finish, Grain};

    fn make() -> FilmMake {
        FilmMake {
            index: 1.59,
            prism_angle: 1.4,
            pitch: 0.3,
            base: 0.05,
            absorption: 0.4,
            rounded: 0.03,
            run: Grain::Around,
        }
    }

    #[test]
    fn films_are_the_same_film_from_both_sides() {
        let film = Box::new(PrismFilm::new(&make()));
        for face in [FilmFace::Flat, FilmFace::Prisms] {
            let own = Finish::PrismFilm { film: film.clone(), face };
            let mixed = Finish::Mixture(vec![(2.0, own.clone()), (1.0, splitter())]);
            for own in [own, mixed] {
                let behind = own.from_behind().unwrap();
                assert_adjoint(Faces { own: &own, behind: &behind });
            }
        }
    }

    #[test]
    fn chances_are_roughly_those_of_photons() {
        const PHOTONS: u32 = 4000;
        let make = FilmMake { absorption: 0.0, rounded: 0.0, ..make() };
        let film = PrismFilm::new(&make);
        for face in [FilmFace::Flat, FilmFace::Prisms] {
            let met = MetFilm { film: &film, face };
            for angle in [0.0, 0.3, 0.65, 1.0, 1.3, 1.5] {
                let light = incidence(angle, [1.0, 1.0]);
                let count = |side: Side| {
                    (0..PHOTONS)
                        .filter_map(|index| {
                            met.scatter(&light, &mut Sampler::for_path(5, 0, u64::from(index)))
                        })
                        .filter(|out| out.side == side)
                        .count()
                };
                let [reflected, transmitted] = [Side::Reflected, Side::Transmitted].map(count);
                let seen = reflected as f64 / (reflected + transmitted) as f64;
                let chances = met.chances(&light);
                assert!((chances.sum() - 1.0).abs() < 1e-12);
                assert!(
                    (chances.reflected - seen).abs() < 0.15,
                    "{face:?} at {angle}: {seen}, {chances:?}"
                );
                assert!(chances.reflected > 0.0 && chances.transmitted > 0.0);
            }
        }
    }
}
