//! What a bare face and a stack of thin films do to polarised light: docs/theory.md eq. (38), with the amplitudes of the
//! matrices of `matrix`.

use crate::optics::coating::complex::Complex;
use crate::optics::coating::matrix::{Film, StackFields, fields};
use crate::optics::{FaceMueller, Incidence, Side};

/// The action of an interface without films; the medium behind has the index n + ik.
pub(crate) fn bare_face(incidence: &Incidence, [n, k]: [f64; 2], side: Side) -> FaceMueller {
    let to = Complex::new(n, -k);
    mueller(std::iter::empty(), incidence.cos(), (incidence.index_from, to), side)
}

/// The action of films on light that leaves to a side; the medium behind may absorb, where light is reflected.
pub(super) fn mueller(
    films: impl DoubleEndedIterator<Item = Film>,
    cos: f64,
    (from, to): (f64, Complex),
    side: Side,
) -> FaceMueller {
    let StackFields { s, p, beyond } = fields(films, cos, (from, to));
    let normal = from * cos;
    let (s_admittance, p_admittance) = ([normal, 1.0], [from * from, normal]);
    let [[s_less, s_sum], [p_less, p_sum]] =
        [s.differences(s_admittance), p.differences(p_admittance)];
    // Along the face.
    if s_sum.norm_squared() == 0.0 || p_sum.norm_squared() == 0.0 {
        return FaceMueller::ideal(side);
    }
    match side {
        Side::Reflected => {
            let (s, p) = (s_less * s_sum.inverse(), p_less * p_sum.inverse());
            // Along the face the fields of s and p turn alike; p is counted across the light, which turns back.
            let cross = s * p.conjugate();
            FaceMueller { s: s.norm_squared(), p: p.norm_squared(), cross: [-cross.re, -cross.im] }
        }
        Side::Transmitted => {
            let s = s.shares(s_admittance, beyond.re).transmitted;
            let p = p.shares(p_admittance, to.re * to.re * beyond.re).transmitted;
            // The last fields are real.
            let phase = s_sum.conjugate() * p_sum;
            let size = (s * p / phase.norm_squared()).sqrt();
            FaceMueller { s, p, cross: [size * phase.re, size * phase.im] }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::finish::testing::{absorbing_stack, clear_stack, incidence};
    use crate::optics::{Finish, FinishModel, Scattered, Stokes};
    use glam::DVec3;

    /// Light at 45° to the plane of incidence, after it was reflected at faces in turn.
    fn after_reflections(faces: &[(Finish, Incidence)]) -> [f64; 3] {
        let mut stokes = Stokes::new(DVec3::Y, [0.0, 1.0, 0.0]);
        for (finish, incidence) in faces {
            let dir = incidence.straight(Side::Reflected);
            let out = Scattered::specular(dir, 1.0, Side::Reflected);
            stokes = stokes.after(finish.mueller(incidence, Side::Reflected), incidence, &out);
        }
        stokes.about(DVec3::Y, faces[faces.len() - 1].1.straight(Side::Reflected))
    }

    #[test]
    fn the_rhomb_of_fresnel_makes_circular_light() {
        // Born & Wolf, 7th ed., 1.5.4: in glass of index 1.51 two total reflections at 48°37' or 54°37' delay s and p by a
        // quarter of a wave against each other.
        for degrees in [48.0f64 + 37.0 / 60.0, 54.0 + 37.0 / 60.0] {
            let first = incidence(degrees.to_radians(), [1.51, 1.0]);
            let dir = first.straight(Side::Reflected);
            let second = Incidence { dir, normal: -first.normal, ..first };
            let [q, u, v] = after_reflections(&[(Finish::Smooth, first), (Finish::Smooth, second)]);
            assert!(v.abs() > 0.9999 && q.abs() < 1e-9 && u.abs() < 0.01, "{q} {u} {v}");
        }
    }

    #[test]
    fn a_mirror_of_a_perfect_conductor_is_the_ideal_one() {
        let metal = Finish::Metal { n: 1e-9, k: 1e9 };
        let mirror = Finish::Specular { reflectance: 1.0, transmittance: 0.0 };
        for angle in [0.0, 0.4, 1.2] {
            let [found, ideal] = [&metal, &mirror]
                .map(|finish| after_reflections(&[(finish.clone(), incidence(angle, [1.0, 1.0]))]));
            for (found, ideal) in found.iter().zip(ideal) {
                assert!((found - ideal).abs() < 1e-6, "{angle}: {found} {ideal}");
            }
        }
    }

    #[test]
    fn shares_of_both_polarisations_are_those_that_finishes_draw_from() {
        let metal = Finish::Metal { n: 0.96, k: 6.69 };
        for finish in [Finish::Smooth, metal, clear_stack(), absorbing_stack()] {
            for (angle, indices) in
                [(0.0, [1.0, 1.5]), (0.7, [1.0, 1.5]), (1.5, [1.0, 1.5]), (0.5, [1.5, 1.0])]
            {
                for s_share in [0.0, 0.3, 1.0] {
                    let met = Incidence { s_share, ..incidence(angle, indices) };
                    let shares = finish.shares(&met);
                    for side in [Side::Reflected, Side::Transmitted] {
                        if shares.of(side) == 0.0 {
                            continue;
                        }
                        let FaceMueller { s, p, cross: [re, im] } =
                            finish.mueller(&met, side).unwrap();
                        let mean = s_share * s + (1.0 - s_share) * p;
                        assert!((mean - shares.of(side)).abs() < 1e-9, "{finish:?} {angle} {mean}");
                        // A plane face leaves fully polarised light so.
                        assert!((re * re + im * im - s * p).abs() < 1e-12, "{finish:?} {angle}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_stack_passes_polarised_light_alike_both_ways() {
        let inside = (0.6f64.sin() / 1.5).asin();
        for front in [clear_stack(), absorbing_stack()] {
            let back = front.from_behind().unwrap();
            let side = Side::Transmitted;
            let there = front.mueller(&incidence(0.6, [1.0, 1.5]), side).unwrap();
            let again = back.mueller(&incidence(inside, [1.5, 1.0]), side).unwrap();
            let parts = |face: FaceMueller| [face.s, face.p, face.cross[0], face.cross[1]];
            for (there, again) in parts(there).into_iter().zip(parts(again)) {
                assert!((there - again).abs() < 1e-12, "{there} {again}");
            }
        }
    }
}
