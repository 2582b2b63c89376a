//! Gaussian scatter about a mean direction, normalised above the horizon.
//!
//! The density about the mean direction m is p(o) = exp(-θ²/2σ²) / N(m), θ the angle between o and
//! m, over the half space of m; N keeps the integral at 1 even where the horizon cuts the lobe. The
//! shape exp(-θ²/2σ²) is symmetric in o and m, so p(o|i) N(i) = p(i|o) N(o): the adjoint of a path
//! needs only the two norms and cosines.

use crate::optics::{Incidence, Lobe, Scattered};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, unit};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Nodes of the table of norms over the elevation of the mean direction.
const NODES: usize = 513;
/// The horizon cuts a negligible part (4e-10) beyond this many σ.
const REACH: f64 = 6.5;

/// A Gaussian lobe of directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Gaussian {
    sigma: f64,
    /// Elevation at the last node of `norms`, rad.
    reach: f64,
    /// Integral of exp(-θ²/2σ²) above the horizon, in sr, against the elevation of the mean direction.
    norms: Vec<f64>,
}

/// A gather path before it met a lobe, as if it had come along the mean direction m of the photons
/// that scatter into it.
pub(crate) struct Before {
    /// At the face without scatter.
    pub(crate) incidence: Incidence,
    /// `p(o|m) cos θ_m / (p(m|o) cos θ_o)`.
    factor: f64,
}

impl Before {
    /// The gather path after it met the face without scatter as well.
    pub(crate) fn continued(&self, out: Scattered) -> Scattered {
        let factor = out.factor * self.factor;
        Scattered { dir: unit(out.dir), factor, lobe: Lobe::Diffuse, ..out }
    }
}

impl Gaussian {
    /// A lobe of standard deviation `sigma`, in rad, per angular coordinate.
    pub fn new(sigma: f64) -> Self {
        let reach = (REACH * sigma).min(FRAC_PI_2);
        let norms =
            (0..NODES).map(|i| norm(sigma, reach * i as f64 / (NODES - 1) as f64)).collect();
        Self { sigma, reach, norms }
    }

    /// Standard deviation, rad.
    pub(crate) fn sigma(&self) -> f64 {
        self.sigma
    }

    /// Density, in 1/sr, of scattering into `dir` about `mean`, both on the side of `normal`; 0 below the horizon.
    pub(crate) fn pdf(&self, mean: DVec3, dir: DVec3, normal: DVec3) -> f64 {
        if dir.dot(normal) <= 0.0 {
            return 0.0;
        }
        // The half chord keeps the digits of small angles.
        let theta = 2.0 * (0.5 * (dir - mean).length()).min(1.0).asin();
        (-0.5 * (theta / self.sigma).powi(2)).exp() / self.norm_at(mean.dot(normal))
    }

    /// `p(o|mean) / cos θ_o`, 1/sr; 0 along the horizon, where it has no value.
    pub(crate) fn over_cosine(&self, mean: DVec3, out: DVec3, normal: DVec3) -> f64 {
        let cos = out.dot(normal);
        if cos > 0.0 { self.pdf(mean, out, normal) / cos } else { 0.0 }
    }

    /// What a gather path meets before the face. A photon meets a smooth face or a thin sheet first
    /// and the lobe afterwards, so the gather path meets the lobe first: it draws m from p(m|o), and
    /// continues from m as at a face without scatter. So exactly the photon directions that scatter
    /// into o are drawn, even through a face that totally reflects the gather path's own direction.
    /// `None` along the face, where the factor has no value.
    pub(crate) fn before(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Before> {
        let cos = incidence.cos();
        if cos == 0.0 {
            return None;
        }
        let mean = unit(self.sample(-incidence.dir, incidence.normal, sampler));
        let inner = Incidence { dir: -mean, ..*incidence };
        // p(o|m) / p(m|o)
        let exchange = self.exchange(cos, inner.cos());
        Some(Before { incidence: inner, factor: exchange * inner.cos() / cos })
    }

    /// p(a|b) / p(b|a) for two directions of cosines `cos_a` and `cos_b` to the normal: the shape is the same, the
    /// norms are not. 1.
    pub(crate) fn exchange(&self, cos_a: f64, cos_b: f64) -> f64 {
        self.norm_at(cos_a) / self.norm_at(cos_b)
    }

    /// A direction about `mean` on the side of `normal`, with the density of [`Gaussian::pdf`].
    pub(crate) fn sample(
        &self,
        mean: DVec3,
        normal: DVec3,
        sampler: &mut Sampler<impl Numbers>,
    ) -> DVec3 {
        let frame = Frame::from_axis(DVec3::ZERO, mean);
        loop {
            let [u, v] = sampler.pair(Dimension::Scatter);
            // Density θ exp(-θ²/2σ²), thinned by sin θ/θ: exact on the sphere, not only for small angles.
            let theta = self.sigma * (-2.0 * (1.0 - u).ln()).sqrt();
            if theta >= PI || (theta > 0.0 && sampler.one(Dimension::Scatter) > theta.sin() / theta)
            {
                continue;
            }
            let (sin_phi, cos_phi) = (TAU * v).sin_cos();
            let (sin, cos) = theta.sin_cos();
            let dir = frame.to_world(DVec3::new(sin * cos_phi, sin * sin_phi, cos));
            if dir.dot(normal) > 0.0 {
                return dir;
            }
        }
    }

    /// The norm for a mean direction of cosine `cos` to the normal, sr.
    fn norm_at(&self, cos: f64) -> f64 {
        let place =
            (cos.clamp(0.0, 1.0).asin() / self.reach * (NODES - 1) as f64).min((NODES - 1) as f64);
        let node = (place as usize).min(NODES - 2);
        let fraction = place - node as f64;
        self.norms[node] * (1.0 - fraction) + self.norms[node + 1] * fraction
    }
}

/// ∫ exp(-θ²/2σ²) dω above the horizon, for a mean direction at `elevation`.
fn norm(sigma: f64, elevation: f64) -> f64 {
    let end = (9.0 * sigma).min(PI);
    let integrand = |theta: f64| {
        (-0.5 * (theta / sigma).powi(2)).exp() * theta.sin() * azimuth_above(theta, elevation)
    };
    // The horizon starts to cut the circle of angle θ at θ = elevation, and nothing is left from π
    // - elevation on.
    let cut = elevation.min(end);
    simpson(0.0, cut, integrand) + simpson(cut, (PI - elevation).min(end).max(cut), integrand)
}

/// Simpson's rule over `from..to`; the ends are evaluated slightly inside, where a kink lies on
/// them.
fn simpson(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    if to.next_down() <= from.next_up() {
        return 0.0;
    }
    let steps = 2000;
    let h = (to - from) / f64::from(steps);
    let at = |i: i32| f((from + h * f64::from(i)).clamp(from.next_up(), to.next_down()));
    let inner: f64 = (1..steps).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * at(i)).sum();
    (at(0) + inner + at(steps)) * h / 3.0
}

/// Azimuth range of the circle at angle `theta` about the mean that lies above the horizon, rad.
fn azimuth_above(theta: f64, elevation: f64) -> f64 {
    let across = elevation.cos() * theta.sin();
    let along = elevation.sin() * theta.cos();
    if across <= along.abs() {
        return if along >= 0.0 { TAU } else { 0.0 };
    }
    2.0 * (-along / across).acos()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mean_at(elevation: f64) -> DVec3 {
        DVec3::new(elevation.cos(), 0.0, elevation.sin())
    }

    /// Integral of the pdf over the upper half space on a grid about the mean direction.
    fn integral(lobe: &Gaussian, mean: DVec3) -> f64 {
        let frame = Frame::from_axis(DVec3::ZERO, mean);
        let (rings, sectors) = (3000, 720);
        let end = (9.0 * lobe.sigma()).min(PI);
        let h = end / f64::from(rings);
        let mut sum = 0.0;
        for i in 0..rings {
            let theta = h * (f64::from(i) + 0.5);
            for j in 0..sectors {
                let phi = TAU * (f64::from(j) + 0.5) / f64::from(sectors);
                let dir = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                sum += lobe.pdf(mean, frame.to_world(dir), DVec3::Z) * theta.sin();
            }
        }
        sum * h * TAU / f64::from(sectors)
    }

    #[test]
    fn the_density_integrates_to_one_at_every_elevation() {
        for sigma_deg in [0.2f64, 2.0, 20.0, 60.0] {
            let lobe = Gaussian::new(sigma_deg.to_radians());
            for elevation_deg in [90.0f64, 45.0, 10.0, 1.0, 0.0] {
                let total = integral(&lobe, mean_at(elevation_deg.to_radians()));
                assert!(
                    (total - 1.0).abs() < 2e-4,
                    "sigma {sigma_deg}, elevation {elevation_deg}: {total}"
                );
            }
        }
    }

    #[test]
    fn samples_follow_the_density() {
        // Chi-square over 8 sectors x 10 rings about the mean, against the integrated pdf.
        let lobe = Gaussian::new(12f64.to_radians());
        let mean = mean_at(15f64.to_radians());
        let frame = Frame::from_axis(DVec3::ZERO, mean);
        let (rings, sectors, sub) = (10usize, 8usize, 40usize);
        let end = 50f64.to_radians();
        let mut expected = vec![0.0; rings * sectors];
        let (h, w) = (end / (rings * sub) as f64, TAU / (sectors * sub) as f64);
        for i in 0..rings * sub {
            for j in 0..sectors * sub {
                let (theta, phi) = (h * (i as f64 + 0.5), w * (j as f64 + 0.5));
                let dir = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                let mass = lobe.pdf(mean, frame.to_world(dir), DVec3::Z) * theta.sin() * h * w;
                expected[i / sub * sectors + j / sub] += mass;
            }
        }
        let n = 200_000;
        let mut seen = vec![0.0; rings * sectors];
        for index in 0..n {
            let mut sampler = Sampler::for_path(3, 0, index);
            let dir = frame.to_local(lobe.sample(mean, DVec3::Z, &mut sampler));
            let ring = (dir.z.acos() / end * rings as f64) as usize;
            let sector = (dir.y.atan2(dir.x).rem_euclid(TAU) / TAU * sectors as f64) as usize;
            if ring < rings {
                seen[ring * sectors + sector.min(sectors - 1)] += 1.0;
            }
        }
        let (mut chi2, mut cells) = (0.0, 0);
        for (&p, &count) in expected.iter().zip(&seen) {
            let mean_count: f64 = p * n as f64;
            if mean_count > 10.0 {
                chi2 += (count - mean_count).powi(2) / mean_count;
                cells += 1;
            }
        }
        // Mean + 4 standard deviations of chi-square.
        let freedom = f64::from(cells);
        assert!(
            cells > 50 && chi2 < freedom + 4.0 * (2.0 * freedom).sqrt(),
            "chi-square {chi2} of {cells}"
        );
    }

    #[test]
    fn exchanging_the_directions_changes_only_the_norm() {
        let lobe = Gaussian::new(10f64.to_radians());
        let (a, b) = (mean_at(0.1), mean_at(0.4));
        // pdf(mean, dir) is p(dir|mean).
        let ratio = lobe.pdf(b, a, DVec3::Z) / lobe.pdf(a, b, DVec3::Z);
        assert!((ratio / lobe.exchange(a.z, b.z) - 1.0).abs() < 1e-12);
        assert!((lobe.exchange(a.z, b.z) - 1.0).abs() > 0.1, "the case tells them apart");
    }
}
