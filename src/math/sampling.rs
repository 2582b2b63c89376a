//! Maps from the unit square to disks and directions, in a frame whose +z is the axis.

use glam::DVec3;
use std::f64::consts::TAU;

/// A point of the unit disk, uniform over its area; z = 0.
pub fn disk(u: [f64; 2]) -> DVec3 {
    let (sin, cos) = (TAU * u[1]).sin_cos();
    let r = u[0].sqrt();
    DVec3::new(r * cos, r * sin, 0.0)
}

/// A direction of the upper half space with density cosθ/π, in 1/sr.
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let p = disk(u);
    // u[0] < 1 keeps z above zero.
    DVec3::new(p.x, p.y, (1.0 - u[0]).sqrt())
}

/// A direction of the upper half space with density (m+1) cos^m θ / 2π, in 1/sr.
pub fn cosine_power_hemisphere(power: f64, u: [f64; 2]) -> DVec3 {
    from_cosine((1.0 - u[0]).powf(1.0 / (power + 1.0)), u[1])
}

/// A direction, uniform over the sphere, density 1/4π, in 1/sr.
pub fn uniform_sphere(u: [f64; 2]) -> DVec3 {
    from_cosine(1.0 - 2.0 * u[0], u[1])
}

/// A direction, uniform in solid angle over the cone of `half_angle`, in rad, about +z.
pub fn cone_direction(half_angle: f64, u: [f64; 2]) -> DVec3 {
    // 1 - cos θ = 2 sin²(θ/2) keeps its digits for a cone as narrow as the sun's.
    let one_minus_cos = u[0] * 2.0 * (0.5 * half_angle).sin().powi(2);
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).sqrt();
    let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
    DVec3::new(sin * cos_phi, sin * sin_phi, 1.0 - one_minus_cos)
}

fn from_cosine(cos: f64, u: f64) -> DVec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (sin_phi, cos_phi) = (TAU * u).sin_cos();
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of `f` over a midpoint grid of the unit square.
    fn mean(f: impl Fn([f64; 2]) -> f64) -> f64 {
        let n = 400;
        let mid = |i: usize| (i as f64 + 0.5) / n as f64;
        (0..n * n).map(|i| f([mid(i / n), mid(i % n)])).sum::<f64>() / (n * n) as f64
    }

    #[test]
    fn moments_agree_with_the_densities() {
        // E[cos θ] = (m+1)/(m+2) for density ∝ cos^m.
        assert!((mean(|u| cosine_hemisphere(u).z) - 2.0 / 3.0).abs() < 1e-5);
        // (1-u)^(1/6) is steep at u = 1: the midpoint rule is wrong by about h^(7/6) = 9e-4 there, in one row.
        assert!((mean(|u| cosine_power_hemisphere(5.0, u).z) - 6.0 / 7.0).abs() < 9e-4);
        assert!((mean(|u| uniform_sphere(u).z.powi(2)) - 1.0 / 3.0).abs() < 1e-5);
        assert!((mean(|u| disk(u).length_squared()) - 0.5).abs() < 1e-5);
        let half_angle: f64 = 0.4;
        let expected = 0.5 * (1.0 + half_angle.cos());
        assert!((mean(|u| cone_direction(half_angle, u).z) - expected).abs() < 1e-6);
    }

    #[test]
    fn a_narrow_cone_keeps_unit_directions_inside() {
        let half_angle = 0.265f64.to_radians();
        for i in 0..100 {
            let d = cone_direction(half_angle, [f64::from(i) / 100.0, 0.3]);
            assert!((d.length() - 1.0).abs() < 1e-15);
            assert!(d.z >= half_angle.cos());
        }
    }
}
