//! Solid angles of a cone of directions that a horizon may cut.
//!
//! The cone has half-angle h and an axis at angle i to the normal of a plane; what counts is its
//! part above the plane, also when the axis itself lies below. Where the circle of the cone crosses
//! the horizon, the axis, the crossing and the point of the horizon below the axis form a right
//! spherical triangle: hypotenuse h, angle φ at the axis, leg ψ on the horizon, leg e (the
//! elevation of the axis, signed). All formulas use these, so that nothing cancels for cones as
//! narrow as the sun's or narrower.

use std::f64::consts::PI;

/// How the horizon cuts a cone.
enum HorizonCut {
    /// All of it is above.
    Above,
    /// None of it is.
    Below,
    /// Part of it is; the angles of the triangle, rad.
    Through {
        /// Half of the circle's arc below the horizon, seen from the axis: cos φ = cot h cot i.
        phi: f64,
        /// Half of the arc of the horizon within the cone: sin ψ = sin h sin φ.
        psi: f64,
    },
}

/// The projected solid angle ∫ cos θ dω, in sr, of the part above the horizon of a cone of directions. `cos_axis` is
/// the cosine of the axis to the normal, in -1..=1, `half_angle` is in rad, 0..=π/2.
///
/// Half the line integral of n · (r × dr) around the part (Stokes; Lambert's formula for polygons with arcs of small
/// circles): (π - φ) sin²h cos i - sin h cos h sin i sin φ + ψ. With cos h = cos ψ sin i and sin h sin φ = sin ψ the
/// last two terms are (ψ - sin ψ cos ψ) + sin ψ cos ψ cos²i.
pub fn projected_cap(cos_axis: f64, half_angle: f64) -> f64 {
    let sin_h = half_angle.sin();
    match cut(cos_axis, half_angle) {
        HorizonCut::Above => PI * sin_h * sin_h * cos_axis,
        HorizonCut::Below => 0.0,
        HorizonCut::Through { phi, psi } => {
            let arc = (PI - phi) * sin_h * sin_h * cos_axis;
            let chord = 0.5 * (2.0 * psi).sin();
            // Rounding must not make a tiny part negative.
            (arc + 0.5 * less_its_sine(2.0 * psi) + chord * cos_axis * cos_axis).max(0.0)
        }
    }
}

fn cut(cos_axis: f64, half_angle: f64) -> HorizonCut {
    let (sin_h, cos_h) = half_angle.sin_cos();
    // The elevation of the axis against the half-angle, by their sines: cosines are too coarse for
    // narrow cones.
    if cos_axis.abs() >= sin_h {
        return if cos_axis > 0.0 { HorizonCut::Above } else { HorizonCut::Below };
    }
    let cos_phi = (cos_axis * cos_h / (sin_h * sin_from_cos(cos_axis))).clamp(-1.0, 1.0);
    let sin_phi = sin_from_cos(cos_phi);
    HorizonCut::Through { phi: sin_phi.atan2(cos_phi), psi: (sin_h * sin_phi).min(1.0).asin() }
}

/// sin x for a cosine of x, x in 0..=π.
fn sin_from_cos(cos: f64) -> f64 {
    ((1.0 - cos) * (1.0 + cos)).max(0.0).sqrt()
}

/// x - sin x, which cancels for small x: there by the series x³/3! - x⁵/5! + ...
fn less_its_sine(x: f64) -> f64 {
    if x.abs() > 0.5 {
        return x - x.sin();
    }
    // The first term left out is below 1e-18 of the sum.
    let x2 = x * x;
    let rest = [156.0, 110.0, 72.0, 42.0, 20.0].iter().fold(1.0, |sum, n| 1.0 - x2 / n * sum);
    x * x2 / 6.0 * rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Projected solid angle by the midpoint rule over rings about the axis: of the ring
    /// at angle θ the azimuths |φ| < w are above, with cos = sin e cos θ + cos e sin θ cos φ.
    fn by_rings(cos_axis: f64, half_angle: f64) -> f64 {
        let sin_axis = sin_from_cos(cos_axis);
        let elevation = cos_axis.asin();
        let integrate = |from: f64, to: f64| {
            let n = 4000;
            let mut sum = 0.0;
            for k in 0..n {
                // Points crowded at the ends resolve the square roots there.
                let s = (f64::from(k) + 0.5) / f64::from(n);
                let theta = from + (to - from) * s * s * (3.0 - 2.0 * s);
                let d_theta = (to - from) * 6.0 * s * (1.0 - s) / f64::from(n);
                let (along, across) = (cos_axis * theta.cos(), sin_axis * theta.sin());
                let w = if across <= along.abs() {
                    if along > 0.0 { PI } else { 0.0 }
                } else {
                    (-along / across).acos()
                };
                sum += 2.0 * (along * w + across * w.sin()) * theta.sin() * d_theta;
            }
            sum
        };
        // The horizon begins to cut at θ = |e| and ends to at π - |e|.
        let kink = elevation.abs().min(half_angle);
        integrate(0.0, kink) + integrate(kink, half_angle)
    }

    #[test]
    fn it_agrees_with_quadrature_for_narrow_and_wide_cones_at_every_elevation() {
        for half_angle in [1e-4f64, 4.6e-3, 0.1, 0.7, 1.2, 1.5, 1.57] {
            for share in [-0.99, -0.9, -0.5, -1e-3, 0.0, 1e-6, 0.3, 0.7, 0.999, 1.0, 1.2, 3.0] {
                let elevation = share * half_angle;
                if elevation.abs() > 1.5 {
                    continue;
                }
                let cos_axis = elevation.sin();
                let projected = by_rings(cos_axis, half_angle);
                let what = format!("h {half_angle}, elevation {share} h");
                let error = projected_cap(cos_axis, half_angle) / projected - 1.0;
                assert!(error.abs() < 1e-6, "projected, {what}: {error}");
            }
        }
    }

    #[test]
    fn known_values_come_out_to_rounding() {
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} against {b}");
        // The half space, from an upright axis to a level one, where a quarter sphere remains.
        close(projected_cap(1.0, 0.5 * PI), PI);
        close(projected_cap(0.0, 0.5 * PI), 0.5 * PI);
        // Two half spaces at 60 degrees overlap in a lune: π/2 (1 + cos i).
        close(projected_cap(0.5, 0.5 * PI), 0.75 * PI);
        // Half of a narrow cone: 2/3 h³ to leading order.
        let h = 1e-6;
        close(projected_cap(0.0, h), 2.0 / 3.0 * h * h * h);
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(21), ..ProptestConfig::default() })]
        #[test]
        fn the_signed_parts_above_and_below_make_the_projection_of_the_axis(cos_axis in -1.0..=1.0f64, log_h in -8.0..0.0f64) {
            let half_angle = 0.5 * PI * 10f64.powf(log_h);
            let projected = projected_cap(cos_axis, half_angle) - projected_cap(-cos_axis, half_angle);
            let expected = PI * half_angle.sin().powi(2) * cos_axis;
            prop_assert!((projected - expected).abs() < 1e-12 * expected.abs().max(half_angle.powi(3)));
        }

        #[test]
        fn nothing_is_negative_or_undefined(share in -1.0..=1.0f64, log_h in -300.0..0.0f64) {
            let half_angle = 0.5 * PI * 10f64.powf(log_h);
            for cos_axis in [share, half_angle.sin() * share, -half_angle.sin(), half_angle.sin(), -1.0, 0.0, 1.0] {
                let value = projected_cap(cos_axis, half_angle);
                prop_assert!(value.is_finite() && value >= 0.0, "{cos_axis}, {half_angle}: {value}");
            }
            prop_assert_eq!(projected_cap(share, 0.0), 0.0);
        }
    }
}
