//! Polarisation of light, and what a flat face does to it: docs/theory.md, eq. (37) and (38).
//!
//! A gather path carries the Stokes parameters of what its sensor sees, and they are propagated as those of light that travels in
//! its direction. By reciprocity the Mueller matrix of the way back is the transposed one with the sign of U reversed, and for a plane face
//! that is the same matrix.

use crate::optics::{Incidence, Scattered, Side};
use glam::DVec3;

/// Stokes parameters of light over its intensity I, about an axis across it.
///
/// Q is 1 for an electric field along the axis, U for one halfway between it and (direction of travel) × (axis), V for circular
/// polarisation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stokes {
    /// Unit vector perpendicular to the light, up to rounding and interpolated normals; zero before the first face.
    axis: DVec3,
    /// Q/I, U/I and V/I, 1.
    parameters: [f64; 3],
}

impl Stokes {
    /// Light without polarisation.
    pub const UNPOLARISED: Self = Self { axis: DVec3::ZERO, parameters: [0.0; 3] };

    /// Q, U and V over I about an axis, a unit vector perpendicular to the light.
    #[cfg(test)]
    pub(crate) fn new(axis: DVec3, parameters: [f64; 3]) -> Self {
        Self { axis, parameters }
    }

    /// Q, U and V over I about an axis, a unit vector perpendicular to light of this direction: eq. (37).
    pub(crate) fn about(&self, axis: DVec3, dir: DVec3) -> [f64; 3] {
        let [q, u, v] = self.parameters;
        let (cos, sin) = (self.axis.dot(axis), dir.cross(self.axis).dot(axis));
        let square = cos * cos + sin * sin;
        if square == 0.0 {
            return [0.0, 0.0, v];
        }
        // Of twice the angle between the axes.
        let (cos, sin) = ((cos * cos - sin * sin) / square, 2.0 * sin * cos / square);
        [q * cos + u * sin, u * cos - q * sin, v]
    }

    /// Share of s in light that meets a face along a direction; the unit normal may be on either side.
    pub(crate) fn s_share(&self, dir: DVec3, normal: DVec3) -> f64 {
        let [q, ..] = self.about(self.across(dir, normal), dir);
        (0.5 + 0.5 * q).clamp(0.0, 1.0)
    }

    /// After a face, whose action is `None` where it depolarises: eq. (38).
    pub(crate) fn after(
        &self,
        face: Option<FaceMueller>,
        incidence: &Incidence,
        out: &Scattered,
    ) -> Self {
        let Some(FaceMueller { s, p, cross: [c, d] }) = face else { return Self::UNPOLARISED };
        let axis = self.across(incidence.dir, incidence.normal);
        let [q, u, v] = self.about(axis, incidence.dir);
        let (mean, half) = (0.5 * (s + p), 0.5 * (s - p));
        let intensity = mean + half * q;
        if intensity <= 0.0 {
            return Self::UNPOLARISED;
        }
        let parameters = [half + mean * q, c * u + d * v, c * v - d * u];
        // The new direction lies in the plane of incidence, but for interpolated normals of meshes.
        let axis = axis.reject_from(out.dir).normalize_or(axis);
        Self { axis, parameters: parameters.map(|one| one / intensity) }
    }

    /// The direction of s at a face; at normal incidence, the axis that it has.
    fn across(&self, dir: DVec3, normal: DVec3) -> DVec3 {
        let has_axis = self.axis != DVec3::ZERO;
        let own = if has_axis { self.axis } else { dir.any_orthonormal_vector() };
        dir.cross(normal).normalize_or(own)
    }
}

/// Mueller matrix of a plane face for one of its sides, about the plane of incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaceMueller {
    /// Share of s-polarised light that leaves, 1.
    pub s: f64,
    /// Share of p-polarised light that leaves, 1.
    pub p: f64,
    /// Real and imaginary part of (amplitude of s)(conjugate amplitude of p), both over those that arrive; p is (direction
    /// of travel) × s before and after, 1.
    pub cross: [f64; 2],
}

impl FaceMueller {
    /// Of an ideal mirror, or of no interface.
    pub(crate) const fn ideal(side: Side) -> Self {
        match side {
            // The tangential field reverses its sign; p is counted along (direction of travel) × s, which turns with the light.
            Side::Reflected => Self { s: 1.0, p: 1.0, cross: [-1.0, 0.0] },
            Side::Transmitted => Self { s: 1.0, p: 1.0, cross: [1.0, 0.0] },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::REFERENCE_WAVELENGTH;
    use std::f64::consts::FRAC_1_SQRT_2;

    const LINEAR: Stokes = Stokes { axis: DVec3::X, parameters: [0.6, 0.3, 0.2] };

    fn assert_near(found: [f64; 3], expected: [f64; 3]) {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn parameters_turn_twice_as_fast_as_their_axis() {
        let halfway = FRAC_1_SQRT_2 * (DVec3::X + DVec3::Y);
        // U is Q about the axis halfway to z × x.
        assert_near(LINEAR.about(halfway, DVec3::Z), [0.3, -0.6, 0.2]);
        assert_near(LINEAR.about(DVec3::Y, DVec3::Z), [-0.6, -0.3, 0.2]);
        assert_near(LINEAR.about(DVec3::NEG_X, DVec3::Z), [0.6, 0.3, 0.2]);
        let turned = Stokes::new(halfway, LINEAR.about(halfway, DVec3::Z));
        assert_near(turned.about(DVec3::X, DVec3::Z), LINEAR.parameters);
    }

    #[test]
    fn a_mirror_keeps_q_and_turns_the_rest_and_a_diffuser_forgets() {
        for tilt in [0.0f64, 0.5] {
            let normal = DVec3::new(0.0, tilt.sin(), -tilt.cos());
            let incidence = Incidence {
                dir: DVec3::Z,
                normal,
                index_from: 1.0,
                index_to: 1.0,
                wavelength: REFERENCE_WAVELENGTH,
                grain: DVec3::ZERO,
                s_share: Incidence::UNPOLARISED,
            };
            assert!((LINEAR.s_share(DVec3::Z, normal) - 0.8).abs() < 1e-12);
            let out =
                Scattered::specular(incidence.straight(Side::Reflected), 1.0, Side::Reflected);
            let mirror = Some(FaceMueller::ideal(Side::Reflected));
            let after = LINEAR.after(mirror, &incidence, &out);
            assert_near(after.about(DVec3::X, out.dir), [0.6, -0.3, -0.2]);
            assert_eq!(LINEAR.after(None, &incidence, &out), Stokes::UNPOLARISED);
            // A polariser.
            let face = Some(FaceMueller { s: 0.5, p: 0.0, cross: [0.0; 2] });
            let after = Stokes::UNPOLARISED.after(face, &incidence, &out);
            assert!((after.s_share(out.dir, incidence.normal) - 1.0).abs() < 1e-12);
        }
    }
}
