//! How a source spreads its flux over directions.

use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::source::measured::MeasuredEmission;
use crate::scene::source::sky::{EmitterKind, Sky};
use glam::DVec3;
use lumiduct_base::math::{
    Frame, cone_direction, cosine_hemisphere, cosine_power_hemisphere, disk, projected_cap,
    uniform_sphere,
};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A law of emission about an axis (the normal of a surface).
#[derive(Debug, Clone, PartialEq)]
pub enum Emission {
    /// The same radiance in every direction of the half space: intensity ∝ cos θ.
    Lambertian,
    /// Intensity ∝ cos^m θ.
    CosinePower(f64),
    /// The same radiance within a cone, none outside.
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
    /// The luminance of the sky. Directions in the frame of the emitter are those in which its light travels.
    Sky(Sky),
    /// A measured distribution about the axis of a point, or the normal of a surface.
    Measured(Arc<MeasuredEmission>),
}

impl Emission {
    /// A direction in the frame of the emitter, drawn in proportion to the flux.
    pub(crate) fn sample(&self, kind: EmitterKind, sampler: &mut Sampler<impl Numbers>) -> DVec3 {
        let u = sampler.pair(Dimension::EmitDirection);
        match (self, kind) {
            (Self::Sky(sky), _) => sky.sample(kind, sampler),
            (Self::Measured(table), _) => table.sample(u),
            (Self::Lambertian, _) => cosine_hemisphere(u),
            (Self::CosinePower(power), _) => cosine_power_hemisphere(*power, u),
            (Self::Collimated { axis }, _) => *axis,
            (Self::Isotropic, EmitterKind::Point | EmitterKind::Volume | EmitterKind::Far) => {
                uniform_sphere(u)
            }
            (Self::Isotropic, EmitterKind::Surface) => cosine_power_hemisphere(0.0, u),
            (
                Self::Cone { half_angle, axis },
                EmitterKind::Point | EmitterKind::Volume | EmitterKind::Far,
            ) => Frame::from_axis(DVec3::ZERO, *axis).to_world(cone_direction(*half_angle, u)),
            (Self::Cone { half_angle, axis }, EmitterKind::Surface) => {
                projected_cone(*half_angle, *axis, u, sampler)
            }
        }
    }

    /// Density, in 1/sr, with which [`Emission::sample`] draws the unit vector `dir`; 0 where it
    /// never does. `None` for a collimated beam, which has one direction and no density. For lines see
    /// [`Self::density_of_line`].
    pub(crate) fn density(&self, kind: EmitterKind, dir: DVec3) -> Option<f64> {
        let density = match (self, kind) {
            (Self::Collimated { .. }, _) => return None,
            (Self::Sky(sky), _) => sky.density(kind, dir),
            (Self::Measured(table), EmitterKind::Surface) => above(dir, table.density(dir)),
            (
                Self::Measured(table),
                EmitterKind::Point | EmitterKind::Volume | EmitterKind::Far,
            ) => table.density(dir),
            (Self::Lambertian, _) => above(dir, dir.z / PI),
            (Self::CosinePower(power), _) => above(dir, (power + 1.0) * dir.z.powf(*power) / TAU),
            (Self::Isotropic, EmitterKind::Point | EmitterKind::Volume | EmitterKind::Far) => {
                0.25 / PI
            }
            (Self::Isotropic, EmitterKind::Surface) => above(dir, 1.0 / TAU),
            (Self::Cone { half_angle, axis }, _) if !in_cone(*half_angle, *axis, dir) => 0.0,
            (
                Self::Cone { half_angle, .. },
                EmitterKind::Point | EmitterKind::Volume | EmitterKind::Far,
            ) => 1.0 / (4.0 * PI * (0.5 * half_angle).sin().powi(2)),
            (Self::Cone { half_angle, axis }, EmitterKind::Surface) => {
                above(dir, dir.z / projected_cap(axis.z, *half_angle))
            }
        };
        Some(density)
    }

    /// The same as [`Emission::sample`] for a line along z.
    pub(crate) fn sample_of_line(&self, sampler: &mut Sampler<impl Numbers>) -> DVec3 {
        match self {
            // A coordinate of a uniform point of the disk has density ∝ sqrt(1 - c²) = sin θ: Lambertian for a thin line.
            Self::Lambertian => {
                let u = sampler.pair(Dimension::EmitDirection);
                let cos = disk(u).x;
                let around = sampler.one(Dimension::EmitDirection) * TAU;
                let sin = (1.0 - cos * cos).sqrt();
                DVec3::new(sin * around.cos(), sin * around.sin(), cos)
            }
            Self::CosinePower(_)
            | Self::Cone { .. }
            | Self::Collimated { .. }
            | Self::Isotropic
            | Self::Sky(_)
            | Self::Measured(_) => self.sample(EmitterKind::Point, sampler),
        }
    }

    /// The same as [`Emission::density`] for a line along z: Lambertian light is proportional to the sine of the angle to the line.
    pub(crate) fn density_of_line(&self, dir: DVec3) -> Option<f64> {
        match self {
            Self::Lambertian => Some(dir.truncate().length() / (PI * PI)),
            Self::CosinePower(_)
            | Self::Cone { .. }
            | Self::Collimated { .. }
            | Self::Isotropic
            | Self::Sky(_)
            | Self::Measured(_) => self.density(EmitterKind::Point, dir),
        }
    }

    /// The one direction of a collimated beam, in the frame of the emitter, unit vector.
    pub(crate) fn beam(&self) -> Option<DVec3> {
        match self {
            Self::Collimated { axis } => Some(*axis),
            Self::Lambertian
            | Self::CosinePower(_)
            | Self::Cone { .. }
            | Self::Isotropic
            | Self::Sky(_)
            | Self::Measured(_) => None,
        }
    }

    /// Half-angle of the cone that has all of its light, rad; `None` where it may go everywhere.
    pub(crate) fn half_angle(&self) -> Option<f64> {
        match self {
            Self::Cone { half_angle, .. } => Some(*half_angle),
            Self::Collimated { .. } => Some(0.0),
            Self::Lambertian
            | Self::CosinePower(_)
            | Self::Isotropic
            | Self::Sky(_)
            | Self::Measured(_) => None,
        }
    }

    /// The largest angle to the axis of a measured distribution at which there may be light, rad; π for all other laws.
    pub(crate) fn widest(&self) -> f64 {
        match self {
            Self::Measured(own) => own.widest(),
            Self::Lambertian
            | Self::CosinePower(_)
            | Self::Cone { .. }
            | Self::Collimated { .. }
            | Self::Isotropic
            | Self::Sky(_) => PI,
        }
    }

    /// Projected solid angle of all directions to which a surface may emit, sr, whatever the distribution over them.
    pub fn projected_extent(&self) -> f64 {
        match self {
            Self::Collimated { .. } => 0.0,
            Self::Measured(own) => PI * own.widest().min(0.5 * PI).sin().powi(2),
            Self::CosinePower(_) | Self::Isotropic => PI,
            Self::Lambertian | Self::Cone { .. } | Self::Sky(_) => {
                self.projected_solid_angle().unwrap_or(PI)
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
            Self::Sky(sky) => Some(sky.projected_solid_angle(EmitterKind::Surface)),
            Self::CosinePower(_)
            | Self::Collimated { .. }
            | Self::Isotropic
            | Self::Measured(_) => None,
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
            Self::Measured(table) => Some(1.0 / table.peak()),
            Self::Collimated { .. } | Self::Sky(_) => None,
        }
    }
}

/// A density that is 0 in the lower half space.
fn above(dir: DVec3, density: f64) -> f64 {
    if dir.z > 0.0 { density } else { 0.0 }
}

fn in_cone(half_angle: f64, axis: DVec3, dir: DVec3) -> bool {
    // |a - b| = 2 sin(θ/2) keeps the digits of narrow cones.
    dir.distance(axis) <= 2.0 * (0.5 * half_angle).sin()
}

/// Uniform radiance over a cone in front of a surface: density ∝ cos θ to the normal, by rejection from the cone.
fn projected_cone(
    half_angle: f64,
    axis: DVec3,
    u: [f64; 2],
    sampler: &mut Sampler<impl Numbers>,
) -> DVec3 {
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
    fn the_density_of_a_line_integrates_to_one() {
        const STEPS: usize = 1000;
        for law in [Emission::Lambertian, Emission::Isotropic, Emission::CosinePower(2.0)] {
            // Over the cosine z by midpoints; the laws are symmetric about the line.
            let density = |step: usize| {
                let z = 2.0 * (step as f64 + 0.5) / STEPS as f64 - 1.0;
                law.density_of_line(DVec3::new((1.0 - z * z).sqrt(), 0.0, z)).unwrap()
            };
            let sum = (0..STEPS).map(density).sum::<f64>() * TAU * 2.0 / STEPS as f64;
            assert!((sum - 1.0).abs() < 1e-4, "{law:?}: {sum}");
        }
    }

    #[test]
    fn intensity_of_a_point_cone_is_uniform() {
        let law = Emission::Cone { half_angle: 0.5, axis: DVec3::Z };
        let mean = Tally::of(
            (0..20_000).map(|i| law.sample(EmitterKind::Point, &mut Sampler::for_path(4, 0, i)).z),
        );
        assert!(mean.sigmas_from(0.5 * (1.0 + 0.5f64.cos())).abs() < 4.0);
    }

    /// Direction at angles to `axis`: 1 - cos θ, so that equal steps are equal solid angles, and the azimuth in turns.
    fn direction(axis: DVec3, one_minus_cos: f64, turns: f64) -> DVec3 {
        let sin = (one_minus_cos * (2.0 - one_minus_cos)).sqrt();
        let local = (sin * lumiduct_base::math::circle(turns)).extend(1.0 - one_minus_cos);
        Frame::from_axis(DVec3::ZERO, axis).to_world(local)
    }

    const RINGS: usize = 10;
    const SECTORS: usize = 8;
    const CELLS: usize = RINGS * SECTORS;

    /// Chi-square of samples against the density over cells that fill the cone of `half_angle` about `axis`.
    fn samples_against_density(law: Emission, kind: EmitterKind, axis: DVec3, half_angle: f64) {
        let what = format!("{law:?} of a {kind:?}");
        let extent = 2.0 * (0.5 * half_angle).sin().powi(2);
        let sub = 100;
        let (rows, columns) = (RINGS * sub, SECTORS * sub);
        let mut expected = [0.0; CELLS];
        for row in 0..rows {
            for column in 0..columns {
                let ring = (row as f64 + 0.5) / rows as f64;
                let dir = direction(axis, extent * ring, (column as f64 + 0.5) / columns as f64);
                let mass = law.density(kind, dir).unwrap() * TAU * extent / (rows * columns) as f64;
                expected[row / sub * SECTORS + column / sub] += mass;
            }
        }
        let total: f64 = expected.iter().sum();
        assert!((total - 1.0).abs() < 1e-3, "{what}: the density integrates to {total}");
        let n = 50_000;
        let mut seen = [0.0; CELLS];
        let frame = Frame::from_axis(DVec3::ZERO, axis);
        for index in 0..n {
            let dir = law.sample(kind, &mut Sampler::for_path(31, 0, index));
            assert!(law.density(kind, dir).unwrap() > 0.0, "{what}: draws {dir} of density 0");
            let ring = 0.5 * dir.distance_squared(axis) / extent * RINGS as f64;
            let local = frame.to_local(dir);
            let sector = (local.y.atan2(local.x).rem_euclid(TAU) / TAU * SECTORS as f64) as usize;
            seen[(ring as usize).min(RINGS - 1) * SECTORS + sector.min(SECTORS - 1)] += 1.0;
        }
        let (mut chi2, mut freedom) = (0.0, 0.0);
        for (share, count) in expected.iter().zip(seen) {
            let mean = share * n as f64;
            if mean > 10.0 {
                chi2 += (count - mean).powi(2) / mean;
                freedom += 1.0;
            } else {
                assert!(count < 40.0, "{what}: {count} where {mean} were expected");
            }
        }
        assert!(freedom > 10.0, "{what}: {freedom} cells");
        assert!(chi2 < freedom + 4.0 * f64::sqrt(2.0 * freedom), "{what}: {chi2} of {freedom}");
    }

    #[test]
    fn samples_of_every_law_follow_its_density() {
        for kind in [EmitterKind::Point, EmitterKind::Surface, EmitterKind::Volume] {
            for law in [
                Emission::Lambertian,
                Emission::CosinePower(0.5),
                Emission::CosinePower(12.0),
                Emission::Isotropic,
            ] {
                samples_against_density(law, kind, DVec3::Z, PI);
            }
            // Half-angle and tilt: straight, wholly above, cut by the surface, the axis below it.
            for (half_angle, tilt) in [
                (0.0047, 0.0f64),
                (0.0047, 0.5),
                (0.5, 0.6),
                (0.5, 1.3),
                (0.5, 1.8),
                (1.5, 1.0),
                (0.0047, 1.57),
            ] {
                let axis = DVec3::new(tilt.sin(), 0.0, tilt.cos());
                let law = Emission::Cone { half_angle, axis };
                samples_against_density(law, kind, axis, half_angle);
            }
        }
    }

    #[test]
    fn a_beam_of_one_direction_has_no_density() {
        let beam = Emission::Collimated { axis: DVec3::Z };
        assert_eq!(beam.density(EmitterKind::Surface, DVec3::Z), None);
    }
}
