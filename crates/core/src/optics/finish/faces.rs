//! A face as a gather path meets it: with a finish that acts on reflected light, and one that acts
//! on transmitted light.

use crate::optics::{Finish, FinishModel, Incidence, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};

/// The finishes that a gather path meets at a face.
#[derive(Debug, Clone, Copy)]
pub struct Faces<'a> {
    /// Acts on light that arrives from the gather path's side: on reflected light.
    pub own: &'a Finish,
    /// Acts on light that arrives from the other side: on transmitted light.
    pub behind: &'a Finish,
}

/// Sends a gather path on toward the origin of its light, or ends it where there is none (`None`):
/// [`FinishModel::scatter_radiance`] for both finishes of a face.
#[inline]
pub(crate) fn scatter_at_faces(
    faces: Faces<'_>,
    incidence: &Incidence,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    match (faces.own, faces.behind) {
        (Finish::Smooth, Finish::Smooth) => Finish::Smooth.scatter(incidence, sampler),
        // Behind a film is the same film.
        (own @ Finish::PrismFilm { .. }, _) => own.scatter(incidence, sampler),
        (own, behind) if std::ptr::eq(own, behind) => own.scatter_radiance(incidence, sampler),
        (own, behind) => by_two_finishes(own, behind, incidence, sampler),
    }
}

/// Reflection by one finish, transmission by the other, chosen in proportion to their chances.
fn by_two_finishes(
    own: &Finish,
    behind: &Finish,
    incidence: &Incidence,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    let chances = Shares {
        reflected: own.radiance_chances(incidence).reflected,
        transmitted: behind.radiance_chances(incidence).transmitted,
    };
    let side = chances.choose_side(sampler)?;
    let finish = match side {
        Side::Reflected => own,
        Side::Transmitted => behind,
    };
    let out = finish.scatter_toward(side, incidence, sampler)?;
    Some(Scattered { factor: out.factor * (chances.sum() / chances.of(side)), ..out })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::finish::testing::{
        assert_adjoint, coated, diffuse, facets, haze, hazy_sheet, incidence, metal, mixture,
        rough, rough_metal, sheet, splitter, tabulated,
    };
    use crate::optics::{HazeBase, Lobe};

    #[test]
    fn faces_of_two_finishes_reflect_by_one_and_transmit_by_the_other() {
        let mirror = Finish::Specular { reflectance: 0.95, transmittance: 0.0 };
        for (own, behind) in [
            (mirror, Finish::Absorber),
            (diffuse(), splitter()),
            (Finish::Smooth, sheet(0.2)),
            (rough(0.2), diffuse()),
            (mixture(), rough(0.05)),
            (metal(), Finish::Open),
            (rough(0.3), Finish::Smooth),
            (sheet(0.3), mixture()),
            (facets(0.4), coated()),
            (haze(HazeBase::Interface), facets(0.2)),
            (tabulated(), hazy_sheet()),
            (rough_metal(), haze(HazeBase::Interface)),
        ] {
            assert_adjoint(Faces { own: &own, behind: &behind });
        }
    }

    #[test]
    fn a_mirror_with_a_black_back_loses_no_path() {
        let mirror = Finish::Specular { reflectance: 0.95, transmittance: 0.0 };
        let faces = Faces { own: &mirror, behind: &Finish::Absorber };
        for index in 0..1500 {
            let mut sampler = Sampler::for_path(3, 0, index);
            let incidence = incidence(1e-3 * index as f64, [1.0, 1.0]);
            let out = scatter_at_faces(faces, &incidence, &mut sampler).unwrap();
            assert_eq!((out.factor, out.side, out.lobe), (0.95, Side::Reflected, Lobe::Specular));
        }
    }
}
