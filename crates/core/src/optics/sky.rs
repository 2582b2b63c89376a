//! Luminance of the sky: the standard skies of the CIE, relative to the zenith.
//!
//! Directions point toward the sky, in a frame with x east, y north and z up. This module does not
//! know absolute amounts, the sun's disk, or what the light falls on.
//!
//! CIE S 011/E:2003, ISO 15469:2004: luminance is the product of a gradation in the angle Z from
//! the zenith and an indicatrix in the angle χ from the sun. Numbers as printed by Darula &
//! Kittler, Proc. eSim 2002, 11, tables 1 and 2.

use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// The number of standard skies.
pub(crate) const CIE_TYPES: usize = 15;

/// Gradations of the six groups: a and b of φ = 1 + a exp(b / cos Z).
const GRADATIONS: [[f64; 2]; 6] =
    [[4.0, -0.70], [1.1, -0.80], [0.0, -1.0], [-1.0, -0.55], [-1.0, -0.32], [-1.0, -0.15]];

/// Indicatrices of the six groups: c, d and e of f = 1 + c (exp(d χ) - exp(d π/2)) + e cos²χ.
const INDICATRICES: [[f64; 3]; 6] = [
    [0.0, -1.0, 0.0],
    [2.0, -1.5, 0.15],
    [5.0, -2.5, 0.30],
    [10.0, -3.0, 0.45],
    [16.0, -3.0, 0.30],
    [24.0, -2.8, 0.15],
];

/// Groups of gradation and indicatrix of the types 1 to 15, from 1.
const GROUPS: [[usize; 2]; CIE_TYPES] = [
    [1, 1],
    [1, 2],
    [2, 1],
    [2, 2],
    [3, 1],
    [3, 2],
    [3, 3],
    [3, 4],
    [4, 2],
    [4, 3],
    [4, 4],
    [5, 4],
    [5, 5],
    [6, 5],
    [6, 6],
];

/// Variation of luminance with the angle from the zenith.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Gradation {
    /// 1 + a exp(b / cos Z).
    Standard([f64; 2]),
    /// (1 + 2 cos Z) / 3: Moon & Spencer, Illum. Eng. 37 (1942) 707; type 16 of the standard.
    Overcast,
}

/// Relative luminance of a sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkyModel {
    gradation: Gradation,
    indicatrix: [f64; 3],
    /// Unit vector toward the sun.
    sun: DVec3,
    /// Factor that makes the zenith 1.
    scale: f64,
}

impl SkyModel {
    /// One luminance everywhere; the same as type 5.
    pub fn uniform() -> Self {
        Self::new(Gradation::Standard(GRADATIONS[2]), INDICATRICES[0], DVec3::Z)
    }

    /// The traditional overcast sky, a third as bright at the horizon as at the zenith.
    pub fn overcast() -> Self {
        Self::new(Gradation::Overcast, INDICATRICES[0], DVec3::Z)
    }

    /// A type of the standard, 1 to 15, with a unit vector toward the sun above the horizon. `None` for other numbers.
    pub fn of_type(number: usize, sun: DVec3) -> Option<Self> {
        let [gradation, indicatrix] = *GROUPS.get(number.checked_sub(1)?)?;
        Some(Self::new(
            Gradation::Standard(GRADATIONS[gradation - 1]),
            INDICATRICES[indicatrix - 1],
            sun,
        ))
    }

    fn new(gradation: Gradation, indicatrix: [f64; 3], sun: DVec3) -> Self {
        let unscaled = Self { gradation, indicatrix, sun, scale: 1.0 };
        Self { scale: 1.0 / unscaled.luminance(DVec3::Z), ..unscaled }
    }

    /// Luminance over that of the zenith, 1, along a unit vector toward the sky; 0 at and below the horizon.
    pub(crate) fn luminance(&self, toward: DVec3) -> f64 {
        if toward.z <= 0.0 {
            return 0.0;
        }
        self.scale * self.gradation.of(toward.z) * self.indicatrix_at(toward)
    }

    fn indicatrix_at(&self, toward: DVec3) -> f64 {
        let [c, d, e] = self.indicatrix;
        // Most gray skies have no dependence on azimuth.
        if c == 0.0 && e == 0.0 {
            return 1.0;
        }
        let cos = toward.dot(self.sun).clamp(-1.0, 1.0);
        1.0 + c * ((d * cos.acos()).exp() - (d * FRAC_PI_2).exp()) + e * cos * cos
    }

    /// Bounds of the luminance, relative to the zenith: everywhere at most `even` + `glow` exp(-`decay` χ).
    pub(crate) fn bound(&self) -> SkyBound {
        let [c, d, e] = self.indicatrix;
        // The gradation is monotonic: its largest value is at one of its ends.
        let most = self.scale * self.gradation.of(1.0).max(self.gradation.of(0.0));
        SkyBound {
            even: most * (1.0 - c * (d * FRAC_PI_2).exp() + e),
            glow: most * c,
            decay: -d,
            sun: self.sun,
        }
    }
}

/// Upper bound of a sky's luminance: an even part, and a glow about the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SkyBound {
    /// The even part, relative to the zenith, 1.
    pub(crate) even: f64,
    /// The glow in the direction of the sun, relative to the zenith, 1; 0 where there is none.
    pub(crate) glow: f64,
    /// Fall-off of the glow with the angle from the sun, 1/rad.
    pub(crate) decay: f64,
    /// Unit vector toward the sun.
    pub(crate) sun: DVec3,
}

impl Gradation {
    /// At the cosine of the angle from the zenith, 0..=1.
    fn of(self, cos: f64) -> f64 {
        match self {
            // b is negative: at the horizon the exponential is 0.
            Self::Standard([a, b]) => 1.0 + a * (b / cos).exp(),
            Self::Overcast => (1.0 + 2.0 * cos) / 3.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn toward(elevation_deg: f64, azimuth_deg: f64) -> DVec3 {
        let (elevation, azimuth) = (elevation_deg.to_radians(), azimuth_deg.to_radians());
        (elevation.cos() * DVec3::new(azimuth.sin(), azimuth.cos(), 0.0)).with_z(elevation.sin())
    }

    #[test]
    fn every_sky_is_one_at_the_zenith_and_dark_below_the_horizon() {
        let sun = toward(35.0, 120.0);
        let types = (1..=CIE_TYPES).map(|number| SkyModel::of_type(number, sun).unwrap());
        for sky in types.chain([SkyModel::uniform(), SkyModel::overcast()]) {
            assert!((sky.luminance(DVec3::Z) - 1.0).abs() < 1e-15);
            assert_eq!(sky.luminance(toward(-0.1, 0.0)), 0.0);
        }
        assert_eq!([0, 16].map(|number| SkyModel::of_type(number, sun)), [None; 2]);
    }

    #[test]
    fn known_skies_have_their_known_shapes() {
        let sun = toward(40.0, 180.0);
        assert_eq!(SkyModel::of_type(5, sun).unwrap().luminance(toward(3.0, 7.0)), 1.0);
        let overcast = SkyModel::overcast().luminance(toward(1e-9, 0.0));
        assert!((overcast - 1.0 / 3.0).abs() < 1e-9);
        // Type 1 is nearly the overcast sky 1:3: within 3 % of it at 30 and 60 degrees.
        for elevation in [30.0, 60.0] {
            let ratio = SkyModel::of_type(1, sun).unwrap().luminance(toward(elevation, 0.0))
                / SkyModel::overcast().luminance(toward(elevation, 0.0));
            assert!((ratio - 1.0).abs() < 0.03, "{elevation}: {ratio}");
        }
    }

    #[test]
    fn the_clear_sky_is_that_of_kittler() {
        // CIE clear sky (Kittler 1967, CIE 22:1973) with the sun at 30 degrees, directly toward the
        // sun: (0.91 + 10 + 0.45) (1 - exp(-0.32 / sin 30°)) over (0.91 + 10 exp(-3 π/3) + 0.45
        // cos² 60°) (1 - exp(-0.32)).
        let printed = 11.36 * (1.0 - (-0.64f64).exp())
            / ((0.91 + 10.0 * (-std::f64::consts::PI).exp() + 0.45 * 0.25)
                * (1.0 - (-0.32f64).exp()));
        let sun = toward(30.0, 0.0);
        let own = SkyModel::of_type(12, sun).unwrap().luminance(sun);
        // 0.91 is 1 - 10 exp(-3 π/2), rounded: 0.9102.
        assert!((own / printed - 1.0).abs() < 2e-4, "{own}, {printed}");
    }

    #[test]
    fn bounds_hold_everywhere() {
        for number in 1..=CIE_TYPES {
            let sky = SkyModel::of_type(number, toward(15.0, 200.0)).unwrap();
            let SkyBound { even, glow, decay, sun } = sky.bound();
            for (elevation, azimuth) in (1..90).flat_map(|e| (0..72).map(move |a| (e, 5 * a))) {
                let toward = toward(f64::from(elevation), f64::from(azimuth));
                let angle = toward.dot(sun).clamp(-1.0, 1.0).acos();
                let bound = even + glow * (-decay * angle).exp();
                assert!(sky.luminance(toward) <= bound * (1.0 + 1e-12), "type {number}");
            }
        }
    }
}
