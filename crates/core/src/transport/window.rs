//! Radius and angle within which photons count for a gather record, and how they shrink.

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

impl Window {
    /// The window of a stage, from 0: radius and angle shrink by √2 from stage to stage.
    pub(crate) fn of_stage(self, stage: u32) -> Self {
        let factor = FRAC_1_SQRT_2.powi(stage as i32);
        Self { radius: factor * self.radius, theta_max: factor * self.theta_max }
    }

    /// ΔA = π r², mm².
    pub fn area(self) -> f64 {
        PI * self.radius * self.radius
    }

    /// ΔV = 4π r³ / 3, mm³.
    pub(crate) fn volume(self) -> f64 {
        4.0 / 3.0 * PI * self.radius.powi(3)
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
    fn a_narrow_cone_has_the_area_of_a_disk() {
        let window = Window { radius: 1.0, theta_max: 1e-3 };
        assert!((window.solid_angle() - PI * 1e-6).abs() < 1e-12);
    }

    #[test]
    fn a_stage_halves_what_goes_with_the_square() {
        let window = Window { radius: 0.8, theta_max: 0.01 };
        let ratio = window.of_stage(3).area() / window.of_stage(2).area();
        assert!((ratio - 0.5).abs() < 1e-12);
        assert_eq!(window.of_stage(0), window);
    }
}
