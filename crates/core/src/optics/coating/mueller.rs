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
    // Grazing incidence.
    if s_sum.norm_squared() == 0.0 || p_sum.norm_squared() == 0.0 {
        return FaceMueller::ideal(side);
    }
    match side {
        Side::Reflected => {
            let (s, p) = (s_less * s_sum.inverse(), p_less * p_sum.inverse());
            // Amplitudes are of tangential fields; p is counted along (direction of travel) × s, which turns with the light.
            let cross = s * p.conjugate();
            FaceMueller { s: s.norm_squared(), p: p.norm_squared(), cross: [-cross.re, -cross.im] }
        }
        Side::Transmitted => {
            let s = s.shares(s_admittance, beyond.re).transmitted;
            let p = p.shares(p_admittance, to.re * to.re * beyond.re).transmitted;
            // The field in the last medium is real, so the phases are those of the inverse sums.
            let phase = s_sum.conjugate() * p_sum;
            let size = (s * p / phase.norm_squared()).sqrt();
            FaceMueller { s, p, cross: [size * phase.re, size * phase.im] }
        }
    }
}
