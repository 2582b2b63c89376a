//! Fall-off of scatter from the mirrored or refracted direction, in the space of direction cosines.
//!
//! This module knows neither directions nor a horizon: only the distance d between two points of
//! that plane.

use crate::rng::{Dimension, Numbers, Sampler};
use std::f64::consts::PI;

/// Rings of a table over the distance.
const RINGS: usize = 256;
/// The largest distance: that of two directions along a face between two media of index 4.
pub(crate) const FARTHEST: f64 = 8.0;

/// The law of the scatter, 1/sr, over the distance d of direction cosines; it never increases with
/// d.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HazeLaw {
    /// `A / (B + d^g)`: the `ABg` model of data sheets.
    Abg {
        /// A, 1/sr.
        a: f64,
        /// B, above 0.
        b: f64,
        /// g, not negative.
        g: f64,
    },
    /// `b0 (1 + (d/l)²)^(s/2)`: Harvey, Light-scattering characteristics of optical surfaces (thesis, Arizona, 1976), with a
    /// shoulder, as in Dittman, Proc. SPIE 6291 (2006), K-correlation power spectral density and surface scatter model.
    Harvey {
        /// Value in the middle, 1/sr.
        b0: f64,
        /// Distance of the shoulder, above 0.
        shoulder: f64,
        /// Slope beyond it on log-log axes, not positive.
        slope: f64,
    },
}

impl HazeLaw {
    /// The value at a distance, 1/sr.
    pub(crate) fn at(&self, distance: f64) -> f64 {
        match *self {
            Self::Abg { a, b, g } => a / (b + distance.powf(g)),
            Self::Harvey { b0, shoulder, slope } => {
                let d = distance / shoulder;
                b0 * (1.0 + d * d).powf(0.5 * slope)
            }
        }
    }

    /// The distance at which it starts to fall.
    fn knee(&self) -> f64 {
        match *self {
            // g = 0 has no knee.
            Self::Abg { b, g, .. } => b.powf(1.0 / g.max(0.1)),
            Self::Harvey { shoulder, .. } => shoulder,
        }
    }
}

/// A law with its integrals over rings.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LawProfile {
    pub(crate) law: HazeLaw,
    /// From the middle outwards, the last one at the largest distance.
    rings: Vec<Ring>,
}

/// The integral within a circle, and the value of the law there.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ring {
    /// Square of its radius.
    radius2: f64,
    /// Value of the law there, 1/sr.
    value: f64,
    /// ∫ S dA within, 1.
    within: f64,
    /// The same for steps, with the value of the inner circle between two circles. 1
    bound: f64,
}

impl LawProfile {
    pub(crate) fn new(law: HazeLaw) -> Self {
        let first = (0.02 * law.knee()).clamp(1e-9, 0.01);
        let growth = (FARTHEST / first).powf(1.0 / (RINGS - 2) as f64);
        let mut rings = vec![Ring { radius2: 0.0, value: law.at(0.0), within: 0.0, bound: 0.0 }];
        let mut inner = 0.0;
        for ring in 0..RINGS - 1 {
            let outer = if ring + 2 == RINGS { FARTHEST } else { first * growth.powi(ring as i32) };
            let last = rings[ring];
            let area = PI * (outer * outer - inner * inner);
            rings.push(Ring {
                radius2: outer * outer,
                value: law.at(outer),
                within: last.within + ring_integral(&law, inner, outer),
                bound: last.bound + area * last.value,
            });
            inner = outer;
        }
        Self { law, rings }
    }

    /// `∫ S dA` within a circle about the middle, 1: the share of light scattered there.
    pub(crate) fn within(&self, distance: f64) -> f64 {
        let radius2 = distance * distance;
        let ring = self.inner(|ring| ring.radius2 <= radius2);
        let (inner, outer) = (self.rings[ring], self.rings[ring + 1]);
        let fraction = (radius2 - inner.radius2) / (outer.radius2 - inner.radius2);
        inner.within + (outer.within - inner.within) * fraction.min(1.0)
    }

    /// A distance between two others in proportion to the law, as for light scattered to all sides.
    pub(crate) fn sample(&self, [from, to]: [f64; 2], sampler: &mut Sampler<impl Numbers>) -> f64 {
        let [low, high] = [from, to].map(|distance| self.bound(distance));
        loop {
            let [u, keep] = sampler.pair(Dimension::Scatter);
            let place = low + (high - low) * u;
            let inner = self.rings[self.inner(|ring| ring.bound <= place)];
            let radius2 = inner.radius2 + (place - inner.bound) / (PI * inner.value);
            let distance = radius2.sqrt();
            if keep * inner.value <= self.law.at(distance) {
                return distance;
            }
        }
    }

    fn bound(&self, distance: f64) -> f64 {
        let radius2 = distance * distance;
        let inner = self.rings[self.inner(|ring| ring.radius2 <= radius2)];
        inner.bound + PI * (radius2 - inner.radius2) * inner.value
    }

    /// The last ring that is within; there is always one outside it.
    fn inner(&self, is_within: impl Fn(&Ring) -> bool) -> usize {
        self.rings.partition_point(is_within).clamp(1, self.rings.len() - 1) - 1
    }
}

/// `2π ∫ S d dd` between two distances, by Simpson's rule.
fn ring_integral(law: &HazeLaw, inner: f64, outer: f64) -> f64 {
    let steps = 8;
    let h = (outer - inner) / f64::from(steps);
    let at = |i: i32| {
        let distance = inner + h * f64::from(i);
        2.0 * PI * distance * law.at(distance)
    };
    let middle: f64 = (1..steps).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * at(i)).sum();
    (at(0) + middle + at(steps)) * h / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_over_circles_are_those_of_closed_forms() {
        // g = 2: π A ln(1 + d²/B). Harvey: 2π b0 l²/(s + 2) ((1 + d²/l²)^(s/2 + 1) - 1).
        let (a, b): (f64, f64) = (0.003, 1e-4);
        let abg = LawProfile::new(HazeLaw::Abg { a, b, g: 2.0 });
        let (b0, shoulder, slope): (f64, f64, f64) = (2.0, 0.02, -1.5);
        let harvey = LawProfile::new(HazeLaw::Harvey { b0, shoulder, slope });
        for d in [1e-5, 1e-3, 0.01, 0.2, 1.0, 1.49, 7.9] {
            let expected = PI * a * (d * d / b).ln_1p();
            let off = abg.within(d) / expected - 1.0;
            assert!(off.abs() < 2e-3, "ABg within {d}: {off}");
            let grown = (1.0 + (d / shoulder).powi(2)).powf(0.5 * slope + 1.0) - 1.0;
            let expected = 2.0 * PI * b0 * shoulder * shoulder / (slope + 2.0) * grown;
            let off = harvey.within(d) / expected - 1.0;
            assert!(off.abs() < 2e-3, "Harvey within {d}: {off}");
        }
    }

    #[test]
    fn distances_are_drawn_in_proportion_to_the_law() {
        for law in [
            HazeLaw::Abg { a: 0.01, b: 1e-6, g: 3.0 },
            HazeLaw::Abg { a: 0.2, b: 1.0, g: 0.0 },
            HazeLaw::Harvey { b0: 1.0, shoulder: 0.05, slope: -2.5 },
        ] {
            let profile = LawProfile::new(law);
            let [from, to] = [0.003, 1.3];
            let (bins, paths) = (20, 40_000);
            let mut seen = vec![0.0; bins];
            let all = profile.within(to) - profile.within(from);
            for index in 0..paths {
                let mut sampler = Sampler::for_path(4, 0, index);
                let d = profile.sample([from, to], &mut sampler);
                assert!((from..=to).contains(&d), "{law:?}: {d}");
                let share = ((profile.within(d) - profile.within(from)) / all).clamp(0.0, 1.0);
                seen[((share * bins as f64) as usize).min(bins - 1)] += 1.0;
            }
            let expected = paths as f64 / bins as f64;
            let chi2: f64 = seen.iter().map(|n: &f64| (n - expected).powi(2) / expected).sum();
            // 99.9 % point with 19 degrees of freedom: 43.8.
            assert!(chi2 < 43.8, "{law:?}: chi-square {chi2}");
        }
    }
}
