//! Scattering within a medium: how far light travels before it is scattered, and in which
//! direction.
//!
//! This module knows one point in a medium, not the body the medium fills; absorption belongs to
//! the medium itself.

use glam::DVec3;
use lumiduct_base::math::{Frame, from_cosine};
use std::f64::consts::PI;

/// Anisotropies closer to 0 than this, 1, are drawn as isotropic: the inversion divides by them.
const ISOTROPIC: f64 = 1e-6;

/// Scattering by particles that are small compared with the bodies they are in, evenly distributed:
/// free path lengths are exponential, and angles follow the law of Henyey and Greenstein.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeScattering {
    coefficient: f64,
    anisotropy: f64,
}

impl VolumeScattering {
    /// Scattering with a coefficient, in 1/mm and above 0, and a mean cosine of the angle, 1,
    /// between -1 and 1.
    pub fn new(coefficient_per_mm: f64, anisotropy: f64) -> Self {
        Self { coefficient: coefficient_per_mm, anisotropy }
    }

    /// Scattering coefficient, 1/mm: the reciprocal of the mean free path.
    #[inline]
    pub fn coefficient(&self) -> f64 {
        self.coefficient
    }

    /// Mean cosine of the scattering angle, 1: 0 for isotropic scattering, near 1 for forward
    /// scattering.
    pub fn anisotropy(&self) -> f64 {
        self.anisotropy
    }

    /// A free path length, mm, for uniform `u` in [0, 1): density `σ exp(-σ s)`, in 1/mm.
    #[inline]
    pub(crate) fn free_path(&self, u: f64) -> f64 {
        -(-u).ln_1p() / self.coefficient
    }

    /// The phase function, 1/sr: the share of scattered light that leaves at an angle of this cosine, per solid angle,
    /// `(1 - g²) / (4π (1 + g² - 2 g cos θ)^(3/2))` (Henyey & Greenstein, Astrophys. J. 93 (1941) 70).
    pub(crate) fn phase(&self, cos: f64) -> f64 {
        let g = self.anisotropy;
        let square = 1.0 + g * g - 2.0 * g * cos;
        (1.0 - g * g) / (4.0 * PI * square * square.sqrt())
    }

    /// The direction after scattering of light that travels along `dir`, both unit vectors, for
    /// uniform `u`: the cosine by inversion of the integral of the phase function.
    pub(crate) fn scatter(&self, dir: DVec3, u: [f64; 2]) -> DVec3 {
        let g = self.anisotropy;
        let cos = if g.abs() < ISOTROPIC {
            1.0 - 2.0 * u[0]
        } else {
            let root = (1.0 - g * g) / (1.0 + g - 2.0 * g * u[0]);
            (0.5 * (1.0 + g * g - root * root) / g).clamp(-1.0, 1.0)
        };
        Frame::from_axis(DVec3::ZERO, dir).to_world(from_cosine(cos, u[1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Dimension, Sampler};
    use crate::tally::Tally;

    const ANISOTROPIES: [f64; 7] = [-0.7, -0.2, 0.0, 1e-7, 0.3, 0.8, 0.98];

    /// Integral of a function of the cosine, weighted by the phase function, over all directions.
    /// The cosine varies with the fourth power near 1, where forward peaks are.
    fn over_directions(scattering: &VolumeScattering, f: impl Fn(f64) -> f64) -> f64 {
        const STEPS: u32 = 200_000;
        let step = 2f64.powf(0.25) / f64::from(STEPS);
        (0..STEPS)
            .map(|i| {
                let x = (f64::from(i) + 0.5) * step;
                let cos = 1.0 - x.powi(4);
                2.0 * PI * scattering.phase(cos) * f(cos) * 4.0 * x.powi(3) * step
            })
            .sum()
    }

    /// Legendre polynomials up to the third.
    fn legendre(cos: f64) -> [f64; 4] {
        [1.0, cos, 0.5 * (3.0 * cos * cos - 1.0), 0.5 * (5.0 * cos.powi(3) - 3.0 * cos)]
    }

    #[test]
    fn all_scattered_light_goes_somewhere_and_its_moments_are_powers_of_the_anisotropy() {
        // The Legendre moments of the law are g^k, which defines it.
        for g in ANISOTROPIES {
            let scattering = VolumeScattering::new(1.0, g);
            for k in 0..4 {
                let moment = over_directions(&scattering, |cos| legendre(cos)[k]);
                assert!((moment - g.powi(k as i32)).abs() < 1e-6, "{g}, {k}: {moment}");
            }
        }
    }

    #[test]
    fn directions_are_drawn_by_the_phase_function() {
        // Chi-square over cells of equal probability, and over azimuths about the previous
        // direction.
        const PATHS: u32 = 100_000;
        const CELLS: usize = 20;
        let dir = DVec3::new(0.36, -0.48, 0.8);
        let frame = Frame::from_axis(DVec3::ZERO, dir);
        for g in ANISOTROPIES {
            let scattering = VolumeScattering::new(1.0, g);
            let cut = |share: f64| {
                // The cosine above which this share of the light goes, by bisection of the cumulative phase function.
                let above = |cos: f64| over_cap(g, cos);
                let (mut low, mut high) = (-1.0, 1.0);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if above(middle) > share { low = middle } else { high = middle }
                }
                low
            };
            let cuts: Vec<f64> = (1..CELLS).map(|k| cut(k as f64 / CELLS as f64)).collect();
            let mut counts = [[0u32; CELLS]; 2];
            for index in 0..PATHS {
                let mut sampler = Sampler::for_path(5, 9, u64::from(index));
                let out = scattering.scatter(dir, sampler.pair(Dimension::Scatter));
                assert!((out.length() - 1.0).abs() < 1e-12);
                let cos = out.dot(dir);
                counts[0][cuts.partition_point(|cut| *cut > cos)] += 1;
                let local = frame.to_local(out);
                let turns = local.y.atan2(local.x) / (2.0 * PI) + 0.5;
                counts[1][((turns * CELLS as f64) as usize).min(CELLS - 1)] += 1;
            }
            let expected = f64::from(PATHS) / CELLS as f64;
            for counts in counts {
                let chi2: f64 =
                    counts.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
                // 19 degrees of freedom: 51 is exceeded once in 10,000 draws.
                assert!(chi2 < 51.0, "{g}: chi-square {chi2}");
            }
        }
    }

    /// The share of the light that is scattered to angles of larger cosine, from the antiderivative of the phase function.
    fn over_cap(g: f64, cos: f64) -> f64 {
        if g.abs() < ISOTROPIC {
            return 0.5 * (1.0 - cos);
        }
        let inverse = |cos: f64| 1.0 / (1.0 + g * g - 2.0 * g * cos).sqrt();
        (1.0 - g * g) / (2.0 * g) * (inverse(1.0) - inverse(cos))
    }

    #[test]
    fn free_paths_have_the_mean_and_the_spread_of_an_exponential_law() {
        let scattering = VolumeScattering::new(0.25, 0.0);
        let (mut lengths, mut squares) = (Tally::default(), Tally::default());
        for index in 0..100_000 {
            let mut sampler = Sampler::for_path(2, 4, index);
            let length = scattering.free_path(sampler.one(Dimension::FreePath));
            lengths.add(length);
            squares.add(length * length);
        }
        assert!(lengths.sigmas_from(4.0).abs() < 4.0, "{lengths:?}");
        assert!(squares.sigmas_from(32.0).abs() < 4.0, "{squares:?}");
        assert_eq!(scattering.free_path(0.0), 0.0);
    }
}
