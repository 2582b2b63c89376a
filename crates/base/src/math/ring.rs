//! Integrals over rings of the sphere.

/// Half-width below which the difference of nearly equal terms is a series, rad.
const NARROW: f64 = 1e-2;

/// ∫ f(γ) sin γ dγ between two angles in rad, where f is linear between its values at the ends. With the middle m and the half-width h
/// it is 2 sin m sin h times the mean, and the slope times 2 cos m (sin h - h cos h): no digits are lost in narrow rings.
pub fn linear_over_ring([from, to]: [f64; 2], [first, last]: [f64; 2]) -> f64 {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (sin, cos) = half.sin_cos();
    let odd = if half < NARROW {
        // sin h - h cos h = h³/3 - h⁵/30 + h⁷/840 - ...
        half.powi(3) * (1.0 / 3.0 - half * half * (1.0 / 30.0 - half * half / 840.0))
    } else {
        sin - half * cos
    };
    let slope = if half > 0.0 { (last - first) / (2.0 * half) } else { 0.0 };
    (first + last) * middle.sin() * sin + slope * 2.0 * middle.cos() * odd
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_ring_is_the_sum_of_its_parts_and_the_sphere_is_whole() {
        assert!((linear_over_ring([0.0, PI], [1.0, 1.0]) - 2.0).abs() < 1e-15);
        let at = |angle: f64| 3.0 - 2.0 * angle;
        let of = |from: f64, to: f64| linear_over_ring([from, to], [at(from), at(to)]);
        let parts: f64 =
            (0..1000).map(|n| f64::from(n) * 1e-3).map(|from| of(from, from + 1e-3)).sum();
        assert!((parts / of(0.0, 1.0) - 1.0).abs() < 1e-13, "{parts}");
        // ∫ (3 - 2γ) sin γ dγ = -(3 - 2γ) cos γ - 2 sin γ.
        let exact = 3.0 - 1.0f64.cos() - 2.0 * 1.0f64.sin();
        assert!((of(0.0, 1.0) / exact - 1.0).abs() < 1e-14);
    }

    #[test]
    fn narrow_rings_lose_no_digits() {
        // From 1 at the pole to 0 at h: h²/6 as h → 0.
        for width in [1e-1, 1e-3, 1e-5, 1e-8] {
            let ring = linear_over_ring([0.0, width], [1.0, 0.0]);
            let expected = width * width / 6.0 * (1.0 - 0.05 * width * width);
            assert!((ring / expected - 1.0).abs() < 1e-6, "{width}: {ring} {expected}");
        }
        assert_eq!(linear_over_ring([0.5, 0.5], [1.0, 2.0]), 0.0);
    }
}
