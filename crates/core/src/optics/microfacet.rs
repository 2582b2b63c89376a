//! Rough interfaces and rough mirrors made of many unresolved plane facets.
//!
//! Slopes follow GGX with Smith masking, separately for arriving and leaving light (Walter,
//! Marschner, Li & Torrance, Microfacet models for refraction through rough surfaces, EGSR 2007:
//! WMLT below). Facets are drawn from the distribution of visible normals (Heitz, Sampling the GGX
//! distribution of visible normals, JCGT 7 (2018) 4). Light meets one facet: light that another
//! facet would catch on the way out counts as absorbed. This module knows media only by their
//! indices.
//!
//! `f(i→o)/n_o²` is the same both ways, so a gather path does what a photon does, without a factor.

use crate::optics::incidence::{choose_side, specular};
use crate::optics::{Incidence, Lobe, Scattered, Shares, Side, fresnel};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, disk};
use std::f64::consts::PI;

#[cfg(test)]
mod tests;

/// Facets of a quadrature over the visible ones, along each of two axes.
const FACETS: u32 = 48;

/// A rough surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Microfacet {
    roughness: f64,
    facets: Facets,
}

/// The kind of its facets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Facets {
    /// Smooth interfaces of the two media.
    Interface,
    /// Mirrors with the same reflectance, 1, at every angle.
    Mirror {
        /// Share that is mirrored, 0..=1.
        reflectance: f64,
    },
    /// Metal of complex index n + ik.
    Metal {
        /// Real part of the index.
        n: f64,
        /// Imaginary part of the index, not negative.
        k: f64,
    },
}

impl Microfacet {
    /// A surface of roughness α (WMLT eq. 33): the root mean square slope of the facets visible in
    /// its middle, above 0.
    pub fn new(roughness: f64, facets: Facets) -> Self {
        Self { roughness, facets }
    }

    /// Approximate spread of mirrored light, rad: twice the tilt of its facets.
    pub fn spread(&self) -> f64 {
        2.0 * self.roughness
    }

    /// Whether light can only pass through it, unbent: facets between equal indices have no effect.
    fn is_nothing(&self, incidence: &Incidence) -> bool {
        self.facets == Facets::Interface && incidence.index_from == incidence.index_to
    }

    /// Sends light on, or absorbs it: photons and gather paths.
    pub(crate) fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        if self.is_nothing(incidence) {
            return Some(specular(incidence.dir, 1.0, Side::Transmitted));
        }
        let facet = self.draw(incidence, sampler);
        let Shares { reflected, transmitted } = self.of_facet(&facet, incidence);
        let side = choose_side(reflected, transmitted, sampler)?;
        self.sent(&facet, side, incidence, reflected + transmitted)
    }

    /// The same to one side only; the factor includes the share of that side.
    pub(crate) fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        if self.is_nothing(incidence) {
            return (side == Side::Transmitted).then(|| specular(incidence.dir, 1.0, side));
        }
        let facet = self.draw(incidence, sampler);
        let share = self.of_facet(&facet, incidence).of(side);
        if share > 0.0 { self.sent(&facet, side, incidence, share) } else { None }
    }

    /// f(i→o), 1/sr: WMLT eq. 20 and, with the square of the index on the exit side, eq. 21.
    pub(crate) fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        let frame = Frame::from_axis(DVec3::ZERO, incidence.normal);
        let (from, out) = (frame.to_local(-incidence.dir), frame.to_local(out));
        let (n_i, n_o) = (incidence.index_from, incidence.index_to);
        let reflected = out.z > 0.0;
        if self.is_nothing(incidence) {
            return 0.0;
        }
        let half = if reflected { from + out } else { -(n_i * from + n_o * out) };
        let normal = (half * half.z.signum()).try_normalize().unwrap_or(DVec3::Z);
        let (cos_i, cos_o) = (from.dot(normal), out.dot(normal));
        if cos_i <= 0.0 || (cos_o > 0.0) != reflected || from.z <= 0.0 || out.z == 0.0 {
            return 0.0;
        }
        let facet = Facet { normal, cos: cos_i.min(1.0), frame };
        let shares = self.of_facet(&facet, incidence);
        let seen =
            self.density(normal.z) * self.seen_over_cos(from.z) * self.seen_over_cos(out.z.abs());
        if reflected {
            return 0.25 * shares.reflected * seen;
        }
        let jacobian = n_i * cos_i + n_o * cos_o;
        shares.transmitted * seen * cos_i * cos_o.abs() * (n_o * n_o) / (jacobian * jacobian)
    }

    /// The shares of the two sides, and the probabilities with which light goes there: integrals
    /// over the visible facets, to 4e-3.
    pub(crate) fn sides(&self, incidence: &Incidence) -> (Shares, Shares) {
        if self.is_nothing(incidence) {
            let through = Shares { reflected: 0.0, transmitted: 1.0 };
            return (through, through);
        }
        let middle = |cell: u32| (f64::from(cell) + 0.5) / f64::from(FACETS);
        let (mut flux, mut chance) = ([0.0; 2], [0.0; 2]);
        for cell in 0..FACETS * FACETS {
            // Steep facets are few, and light is totally reflected there.
            let steep = middle(cell / FACETS);
            let weight = 3.0 * steep * steep / f64::from(FACETS * FACETS);
            let facet = self.seen(incidence, [1.0 - steep.powi(3), middle(cell % FACETS)]);
            let shares = self.of_facet(&facet, incidence);
            let sum = shares.reflected + shares.transmitted;
            for (k, side) in [Side::Reflected, Side::Transmitted].into_iter().enumerate() {
                let share = shares.of(side);
                let Some(out) = self.sent(&facet, side, incidence, share) else { continue };
                flux[k] += weight * out.factor;
                chance[k] += if share > 0.0 { weight * share / sum } else { 0.0 };
            }
        }
        let of = |[reflected, transmitted]: [f64; 2]| Shares { reflected, transmitted };
        (of(flux), of(chance))
    }

    fn draw(&self, incidence: &Incidence, sampler: &mut Sampler<impl Numbers>) -> Facet {
        self.seen(incidence, sampler.pair(Dimension::Scatter))
    }

    /// The facet of two numbers in 0..1, in proportion to its area as seen from the direction of
    /// the light (Heitz 2018, section 3). The surface is stretched until it is a hemisphere; its
    /// projection is a disk cut by its own edge.
    fn seen(&self, incidence: &Incidence, u: [f64; 2]) -> Facet {
        let frame = Frame::from_axis(DVec3::ZERO, incidence.normal);
        let local = frame.to_local(-incidence.dir);
        let from = local.with_z(local.z.max(0.0));
        let stretch = DVec3::new(self.roughness, self.roughness, 1.0);
        let view = (stretch * from).normalize();
        let across = DVec3::new(-view.y, view.x, 0.0).try_normalize().unwrap_or(DVec3::X);
        let up = view.cross(across);
        let DVec3 { x, y, .. } = disk(u);
        let lower = 0.5 * (1.0 + view.z);
        let y = (1.0 - lower) * (1.0 - x * x).max(0.0).sqrt() + lower * y;
        let toward = (1.0 - x * x - y * y).max(0.0).sqrt();
        let bump = x * across + y * up + toward * view;
        let normal = (stretch * bump.with_z(bump.z.max(1e-12))).normalize();
        Facet { normal, cos: from.dot(normal).clamp(0.0, 1.0), frame }
    }

    /// Light that one facet reflects and transmits.
    fn of_facet(&self, facet: &Facet, incidence: &Incidence) -> Shares {
        let Incidence { index_from, index_to, .. } = *incidence;
        match self.facets {
            Facets::Interface => {
                let reflected = fresnel::dielectric(facet.cos, index_from, index_to).unpolarised();
                Shares { reflected, transmitted: 1.0 - reflected }
            }
            Facets::Mirror { reflectance } => Shares { reflected: reflectance, transmitted: 0.0 },
            Facets::Metal { n, k } => {
                let reflected = fresnel::conductor(facet.cos, index_from, n, k).unpolarised();
                Shares { reflected, transmitted: 0.0 }
            }
        }
    }

    /// Light that a facet sends to a side with this share, less the part masked on the way out;
    /// `None` into the surface.
    fn sent(
        &self,
        facet: &Facet,
        side: Side,
        incidence: &Incidence,
        share: f64,
    ) -> Option<Scattered> {
        let Incidence { dir, index_from, index_to, .. } = *incidence;
        let normal = facet.frame.to_world(facet.normal);
        let (dir, height) = match side {
            Side::Reflected => {
                let dir = fresnel::mirrored(dir, normal);
                (dir, dir.dot(incidence.normal))
            }
            Side::Transmitted => {
                let cos_t = fresnel::cos_transmitted(facet.cos, index_from, index_to)?;
                let eta = index_from / index_to;
                let dir = fresnel::refracted(dir, normal, facet.cos, cos_t, eta);
                (dir, -dir.dot(incidence.normal))
            }
        };
        let factor = share * self.seen_over_cos(height) * height;
        (height > 0.0).then_some(Scattered { dir, factor, side, lobe: Lobe::Diffuse })
    }

    /// Area of facets per area and solid angle of their normal, 1/sr (WMLT eq. 33).
    fn density(&self, cos: f64) -> f64 {
        let alpha2 = self.roughness * self.roughness;
        let stretched = 1.0 - cos * cos * (1.0 - alpha2);
        alpha2 / (PI * stretched * stretched)
    }

    /// Share of facets that is not masked in a direction of this cosine (WMLT eq. 34), over the cosine; 1.
    fn seen_over_cos(&self, cos: f64) -> f64 {
        let alpha2 = self.roughness * self.roughness;
        2.0 / (cos + (alpha2 + (1.0 - alpha2) * cos * cos).sqrt())
    }
}

/// A facet that light meets.
struct Facet {
    /// Its unit normal in the frame of the surface.
    normal: DVec3,
    /// Cosine of the angle of incidence on it.
    cos: f64,
    /// The frame of the surface, with +z on the side the light comes from.
    frame: Frame,
}
