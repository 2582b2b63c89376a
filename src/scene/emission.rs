//! How a source spreads its flux over directions.

use crate::math::{
    Frame, cone_direction, cosine_hemisphere, cosine_power_hemisphere, uniform_sphere,
};
use crate::rng::{Dimension, Sampler};
use glam::DVec3;
use std::f64::consts::PI;

/// A law of emission about an axis (the normal of a surface).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Emission {
    /// The same radiance in every direction of the half space: intensity ∝ cos θ.
    Lambertian,
    /// Intensity ∝ cos^m θ.
    CosinePower(f64),
    /// The same radiance within a cone, none outside; `tilt` is the cone's axis in the emitter's frame.
    Cone {
        /// Half-angle of the cone, rad.
        half_angle: f64,
        /// Axis of the cone in the frame of the emitter, unit vector.
        axis: DVec3,
    },
    /// One direction, in the frame of the emitter.
    Collimated {
        /// Unit vector in the frame of the emitter.
        axis: DVec3,
    },
    /// The same intensity in every direction (of the half space in front of a surface).
    Isotropic,
}

/// What kind of thing emits: it decides the measure in which a law is uniform.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EmitterKind {
    /// A point: laws are intensities.
    Point,
    /// A surface: laws are radiances, flux goes with the cosine to the normal.
    Surface,
    /// A volume: laws are intensities.
    Volume,
}

impl Emission {
    /// A direction in the frame of the emitter, drawn in proportion to the flux.
    pub fn sample(&self, kind: EmitterKind, sampler: &mut Sampler) -> DVec3 {
        let u = sampler.pair(Dimension::EmitDirection);
        match (self, kind) {
            (Self::Lambertian, _) => cosine_hemisphere(u),
            (Self::CosinePower(power), _) => cosine_power_hemisphere(*power, u),
            (Self::Collimated { axis }, _) => *axis,
            (Self::Isotropic, EmitterKind::Point | EmitterKind::Volume) => uniform_sphere(u),
            (Self::Isotropic, EmitterKind::Surface) => cosine_power_hemisphere(0.0, u),
            (Self::Cone { half_angle, axis }, EmitterKind::Point | EmitterKind::Volume) => {
                Frame::from_axis(DVec3::ZERO, *axis).to_world(cone_direction(*half_angle, u))
            }
            (Self::Cone { half_angle, axis }, EmitterKind::Surface) => {
                projected_cone(*half_angle, *axis, u, sampler)
            }
        }
    }

    /// Flux per luminance and area of a surface, sr: the projected solid angle ∫ cos θ dω of the law.
    /// `None` where luminance is not the same in all its directions.
    pub fn projected_solid_angle(&self) -> Option<f64> {
        match self {
            Self::Lambertian => Some(PI),
            // A cone of half-angle h that is wholly above the surface, its axis tilted: π sin²h cos(tilt).
            Self::Cone { half_angle, axis } => Some(PI * half_angle.sin().powi(2) * axis.z),
            Self::CosinePower(_) | Self::Collimated { .. } | Self::Isotropic => None,
        }
    }

    /// Flux per peak intensity of a point, sr. `None` for a collimated beam.
    pub fn flux_per_peak_intensity(&self) -> Option<f64> {
        match self {
            Self::Lambertian => Some(PI),
            Self::CosinePower(power) => Some(2.0 * PI / (power + 1.0)),
            // 2π(1 - cos h) without cancellation.
            Self::Cone { half_angle, .. } => Some(4.0 * PI * (0.5 * half_angle).sin().powi(2)),
            Self::Isotropic => Some(4.0 * PI),
            Self::Collimated { .. } => None,
        }
    }
}

/// Uniform radiance over a cone in front of a surface: density ∝ cos θ to the normal, by rejection from the cone.
fn projected_cone(half_angle: f64, axis: DVec3, u: [f64; 2], sampler: &mut Sampler) -> DVec3 {
    let frame = Frame::from_axis(DVec3::ZERO, axis);
    // The largest cosine to the normal within the cone.
    let tilt = axis.z.clamp(-1.0, 1.0).acos();
    let bound = (tilt - half_angle).max(0.0).cos();
    let mut dir = frame.to_world(cone_direction(half_angle, u));
    while dir.z <= sampler.one(Dimension::EmitDirection) * bound {
        dir = frame.to_world(cone_direction(half_angle, sampler.pair(Dimension::EmitDirection)));
    }
    dir
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tally::Tally;

    #[test]
    fn a_wide_tilted_cone_of_a_surface_has_uniform_radiance() {
        // E[1/cos θ] over the flux-weighted density is Ω / projected Ω.
        let (half_angle, tilt) = (0.5f64, 0.6f64);
        let law = Emission::Cone { half_angle, axis: DVec3::new(tilt.sin(), 0.0, tilt.cos()) };
        let mean = Tally::of((0..40_000).map(|index| {
            1.0 / law.sample(EmitterKind::Surface, &mut Sampler::for_path(4, 0, index)).z
        }));
        let solid_angle = 2.0 * PI * (1.0 - half_angle.cos());
        let expected = solid_angle / law.projected_solid_angle().unwrap();
        assert!(mean.sigmas_from(expected).abs() < 4.0, "{mean:?}, expected {expected}");
    }

    #[test]
    fn intensity_of_a_point_cone_is_uniform() {
        let law = Emission::Cone { half_angle: 0.5, axis: DVec3::Z };
        let mean = Tally::of(
            (0..20_000).map(|i| law.sample(EmitterKind::Point, &mut Sampler::for_path(4, 0, i)).z),
        );
        assert!(mean.sigmas_from(0.5 * (1.0 + 0.5f64.cos())).abs() < 4.0);
    }
}
