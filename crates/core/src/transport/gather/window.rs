//! Radius and angle within which photons count for a gather record, and how they shrink.

pub(crate) use crate::transport::connect::weights::COUNTED;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// A disk of positions and a cone of directions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Radius of the disk, mm.
    pub radius: f64,
    /// Half-angle of the cone, rad.
    pub theta_max: f64,
}

/// Nested windows that count the same photons.
pub(crate) const NESTED: usize = 3;
/// Their size relative to the widest: the bias of a smooth field scales with the square, 1 : 1/2 :
/// 1/4.
const SIZES: [f64; NESTED] = [1.0, FRAC_1_SQRT_2, 0.5];

/// Indices of radius and angle among the nested sizes, for each window in which pairs are counted: the nested ones, one
/// smaller only in position, and one only in angle.
pub(crate) const RADIUS_OF: [usize; COUNTED] = [0, 1, 2, 1, 0];
pub(crate) const ANGLE_OF: [usize; COUNTED] = [0, 1, 2, 0, 1];
/// Estimates from these windows: E1, E2 and E3 within the nested ones, and E0.
pub(crate) const ESTIMATES: usize = 4;

/// The estimates from the counts of each window. E0 = 2 E(r/√2, θ) + 2 E(r, θ/√2) - 3 E1 is free of
/// a bias that scales with the squares of radius and angle: docs/method.md, eq. (23).
#[inline]
pub(crate) fn estimates(counted: [f64; COUNTED]) -> [f64; ESTIMATES] {
    let [wide, middle, narrow, smaller, sharper] = counted;
    [wide, middle, narrow, 2.0 * (smaller + sharper) - 3.0 * wide]
}

impl Window {
    /// The window shrunk by a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { radius: factor * self.radius, theta_max: factor * self.theta_max }
    }

    /// The three nested windows, the widest first.
    pub fn nested(self) -> [Self; NESTED] {
        SIZES.map(|size| self.scaled(size))
    }

    /// The windows in which pairs are counted.
    pub(crate) fn counted(self) -> [Self; COUNTED] {
        let nested = self.nested();
        std::array::from_fn(|place| Self {
            radius: nested[RADIUS_OF[place]].radius,
            theta_max: nested[ANGLE_OF[place]].theta_max,
        })
    }

    /// The window of a stage, from 0: radius and angle shrink by √2 from stage to stage (the bias halves).
    pub(crate) fn of_stage(self, stage: u32) -> Self {
        self.scaled(FRAC_1_SQRT_2.powi(stage as i32))
    }

    /// The window of pass `pass`, from 0, when it shrinks from pass to pass: `r_i, θ_i ∝ i^-1/8`, the best of the
    /// exponents below 1/4 for which four shrinking dimensions stay consistent.
    pub(crate) fn of_pass(self, pass: u64) -> Self {
        self.scaled(((pass + 1) as f64).powf(-0.125))
    }

    /// ΔA = π r², mm².
    pub fn area(self) -> f64 {
        PI * self.radius * self.radius
    }

    /// ΔΩ = 2π (1 - cos θ), sr, without cancellation.
    pub(crate) fn solid_angle(self) -> f64 {
        4.0 * PI * (0.5 * self.theta_max).sin().powi(2)
    }

    /// Distance between unit vectors at the rim of the cone, 1.
    pub(crate) fn chord(self) -> f64 {
        2.0 * (0.5 * self.theta_max).sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_windows_halve_area_and_solid_angle() {
        let window = Window { radius: 1.0, theta_max: 1e-3 };
        let [wide, middle, narrow] = window.nested();
        assert!((wide.area() / middle.area() - 2.0).abs() < 1e-12);
        assert!((middle.area() / narrow.area() - 2.0).abs() < 1e-12);
        assert!((wide.solid_angle() / narrow.solid_angle() - 4.0).abs() < 1e-5);
        assert!((wide.solid_angle() - PI * 1e-6).abs() < 1e-12);
    }

    /// Each window is its share of the mean plus a bias by the squares of radius and angle.
    #[test]
    fn e0_is_free_of_a_bias_by_the_squares_of_radius_and_angle() {
        let window = Window { radius: 1.0, theta_max: 0.1 };
        for (by_radius, by_angle) in [(0.3, 0.0), (0.0, 20.0), (-0.2, 7.0)] {
            let biased = window.counted().map(|window| {
                5.0 + by_radius * window.radius.powi(2) + by_angle * window.theta_max.powi(2)
            });
            let [wide, middle, narrow, free] = estimates(biased);
            assert!((free - 5.0).abs() < 1e-12, "{free}");
            assert!(((wide - middle) / (middle - narrow) - 2.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_stage_halves_what_goes_with_the_square() {
        let window = Window { radius: 0.8, theta_max: 0.01 };
        let ratio = window.of_stage(3).area() / window.of_stage(2).area();
        assert!((ratio - 0.5).abs() < 1e-12);
        assert_eq!(window.of_stage(0), window);
        assert_eq!(window.of_pass(0), window);
        assert!((window.of_pass(255).radius / window.radius - 0.5).abs() < 1e-12);
    }
}
