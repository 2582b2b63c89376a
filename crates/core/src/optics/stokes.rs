//! Polarisation of light, and what a flat face does to it: docs/theory.md, eq. (37) and (38).
//!
//! A gather path carries the Stokes parameters of what its sensor sees, and is treated as light that goes its way: a plane face
//! acts on both alike, because of reciprocity (the Mueller matrix of the way back is the transposed one with U reversed, and that
//! of a face is then the same).

use crate::optics::{Incidence, Scattered, Side};
use glam::DVec3;

/// Stokes parameters of light over its intensity I, about an axis across it.
///
/// Q is 1 for an electric field along the axis, U for one halfway between it and (direction of travel) × (axis), V for one that turns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stokes {
    /// Unit vector, as nearly across the light as its last face left it; zero before the first face.
    axis: DVec3,
    /// Q/I, U/I and V/I, 1.
    parameters: [f64; 3],
}

impl Stokes {
    /// Light without polarisation.
    pub const UNPOLARISED: Self = Self { axis: DVec3::ZERO, parameters: [0.0; 3] };

    /// Q, U and V over I about an axis, a unit vector across the light.
    pub fn new(axis: DVec3, parameters: [f64; 3]) -> Self {
        Self { axis, parameters }
    }

    /// Q, U and V over I about an axis, a unit vector across light of this direction: eq. (37).
    pub fn about(&self, axis: DVec3, dir: DVec3) -> [f64; 3] {
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
        // Across the new direction, too, which lies in the plane of incidence but for the normals of meshes.
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
            // The field along the mirror turns round; p turns with the light.
            Side::Reflected => Self { s: 1.0, p: 1.0, cross: [-1.0, 0.0] },
            Side::Transmitted => Self { s: 1.0, p: 1.0, cross: [1.0, 0.0] },
        }
    }
}
