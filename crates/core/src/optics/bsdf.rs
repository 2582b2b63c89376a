//! What a face does to light that meets it.
//!
//! A closed set of finishes. Mirrors and total internal reflection draw no random numbers; a dielectric draws one to
//! choose between the reflected and the refracted part. Everything that a finish does not send on is absorbed by it.

use crate::optics::shares::smooth_direction;
use crate::optics::{AngleTable, FilmFace, Gaussian, Haze, Microfacet, PrismFilm, fresnel, shares};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, cosine_hemisphere, unit};

#[cfg(test)]
mod tests;

/// Light arriving at a face.
#[derive(Debug, Clone, Copy)]
pub struct Incidence {
    /// Unit direction of travel.
    pub dir: DVec3,
    /// Unit normal on the side from which the light comes: `dir · normal` is negative.
    pub normal: DVec3,
    /// Refractive index of the medium it comes from.
    pub index_from: f64,
    /// Refractive index of the medium behind the face.
    pub index_to: f64,
    /// Unit direction along the face by which a finish with a grain is laid; zero for finishes without.
    pub grain: DVec3,
}

impl Incidence {
    /// Cosine of the angle of incidence, in 0..=1.
    #[inline]
    pub fn cos(&self) -> f64 {
        let cos = -self.dir.dot(self.normal);
        let cos = if cos < 1.0 { cos } else { 1.0 };
        if cos > 0.0 { cos } else { 0.0 }
    }
}

/// Which side of a face light leaves to, seen from where it came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Back to the side it came from.
    Reflected,
    /// Through the face.
    Transmitted,
}

/// Whether a direction was one of a discrete few or drawn from a density.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lobe {
    /// A discrete direction: mirrored, refracted or straight on.
    Specular,
    /// A direction drawn from a density over solid angle.
    Diffuse,
}

/// Light that goes on from a face.
#[derive(Debug, Clone, Copy)]
pub struct Scattered {
    /// New direction of travel, not yet normalised.
    pub dir: DVec3,
    /// Share of the arriving flux that this path goes on with; 1 - factor is absorbed by the face.
    pub factor: f64,
    /// Reflected or transmitted.
    pub side: Side,
    /// Discrete or drawn.
    pub lobe: Lobe,
}

/// A finish: what a face does to light.
#[derive(Debug, Clone, PartialEq)]
pub enum Bsdf {
    /// The smooth interface of the two media: Fresnel for unpolarised light, Snell, total reflection.
    Smooth,
    /// A mirror, or a beam splitter, with the same shares at every angle; transmitted light goes straight on.
    Specular {
        /// Share that is mirrored, 0..=1.
        reflectance: f64,
        /// Share that goes straight on, 0..=1 with the reflectance.
        transmittance: f64,
    },
    /// A bare metal of complex index n + ik.
    Metal {
        /// Real part of the index.
        n: f64,
        /// Imaginary part of the index, positive.
        k: f64,
    },
    /// Takes everything.
    Absorber,
    /// Nothing is there: light goes straight on.
    Open,
    /// Diffuse reflection and transmission by Lambert's law.
    Lambertian {
        /// Share that is reflected, 0..=1.
        reflectance: f64,
        /// Share that is transmitted, 0..=1 with the reflectance.
        transmittance: f64,
    },
    /// Gaussian scatter about the mirrored and the straight direction, with shares that do not depend on the angle.
    GaussianSheet {
        /// The lobe.
        lobe: Gaussian,
        /// Share that is reflected, 0..=1.
        reflectance: f64,
        /// Share that is transmitted, 0..=1 with the reflectance.
        transmittance: f64,
    },
    /// A rough dielectric: shares by Fresnel, Gaussian scatter about the mirrored and the refracted direction.
    GaussianDielectric {
        /// The lobe.
        lobe: Gaussian,
    },
    /// A mirror or a window with shares by the angle of incidence; transmitted light goes straight on.
    Tabulated {
        /// Share that is mirrored.
        reflectance: AngleTable,
        /// Share that goes straight on.
        transmittance: AngleTable,
    },
    /// A coated interface of two media: it reflects as the table says, by the angle in the medium of the lower index,
    /// and refracts the rest; total reflection stays.
    Coated {
        /// Share that is mirrored.
        reflectance: AngleTable,
    },
    /// A rough interface or mirror of small facets.
    Microfacet(Microfacet),
    /// Haze about discrete directions.
    Haze(Box<Haze>),
    /// A thin film with prisms on one face.
    PrismFilm {
        /// The film.
        film: Box<PrismFilm>,
        /// The face that is met.
        face: FilmFace,
    },
    /// Each photon meets one of several finishes, chosen by weight.
    Mixture(Vec<(f64, Bsdf)>),
}

impl Bsdf {
    /// Whether all directions that leave are discrete.
    pub fn is_specular(&self) -> bool {
        match self {
            Self::Smooth
            | Self::Specular { .. }
            | Self::Metal { .. }
            | Self::Absorber
            | Self::Open
            | Self::Tabulated { .. }
            | Self::Coated { .. }
            | Self::PrismFilm { .. } => true,
            Self::Microfacet(_)
            | Self::Haze(_)
            | Self::Lambertian { .. }
            | Self::GaussianSheet { .. }
            | Self::GaussianDielectric { .. } => false,
            Self::Mixture(parts) => parts.iter().all(|(_, part)| part.is_specular()),
        }
    }

    /// Whether light can go through without being bent, as if both sides were of one index.
    pub fn passes_straight(&self) -> bool {
        match self {
            Self::Open => true,
            Self::Specular { transmittance, .. } | Self::GaussianSheet { transmittance, .. } => {
                *transmittance > 0.0
            }
            Self::Tabulated { transmittance, .. } => transmittance.greatest() > 0.0,
            Self::Haze(haze) => haze.passes_straight(),
            Self::Smooth
            | Self::Metal { .. }
            | Self::Absorber
            | Self::Coated { .. }
            | Self::Microfacet(_)
            | Self::Lambertian { .. }
            | Self::GaussianDielectric { .. }
            | Self::PrismFilm { .. } => false,
            Self::Mixture(parts) => parts.iter().any(|(_, part)| part.passes_straight()),
        }
    }

    /// Sends a photon on, or absorbs it (`None`).
    #[inline(always)]
    pub fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        match self {
            Self::Smooth => Some(smooth(incidence, sampler)),
            Self::Specular { reflectance, transmittance } => {
                let side = choose_side(*reflectance, *transmittance, sampler)?;
                Some(specular(straight(incidence, side), reflectance + transmittance, side))
            }
            Self::Metal { .. }
            | Self::Absorber
            | Self::Open
            | Self::Lambertian { .. }
            | Self::GaussianSheet { .. }
            | Self::GaussianDielectric { .. }
            | Self::Tabulated { .. }
            | Self::Coated { .. }
            | Self::Microfacet(_)
            | Self::Haze(_)
            | Self::PrismFilm { .. }
            | Self::Mixture(_) => {
                let out = self.scatter_rarely(incidence, sampler)?;
                // Normalised here, not copied: so what mirrors send on need not go through memory either.
                Some(Scattered { dir: unit(out.dir), ..out })
            }
        }
    }

    /// The same out of line, so that the loop around mirrors and smooth faces stays small.
    #[inline(never)]
    fn scatter_rarely(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        match self {
            Self::Smooth | Self::Specular { .. } => self.scatter(incidence, sampler),
            Self::Metal { n, k } => {
                let factor =
                    fresnel::conductor(incidence.cos(), incidence.index_from, *n, *k).unpolarised();
                Some(specular(straight(incidence, Side::Reflected), factor, Side::Reflected))
            }
            Self::Absorber => None,
            Self::Open => Some(specular(incidence.dir, 1.0, Side::Transmitted)),
            Self::Lambertian { reflectance, transmittance } => {
                let side = choose_side(*reflectance, *transmittance, sampler)?;
                let local = cosine_hemisphere(sampler.pair(Dimension::Scatter));
                let dir =
                    Frame::from_axis(DVec3::ZERO, leaving_normal(incidence, side)).to_world(local);
                Some(diffuse(dir, reflectance + transmittance, side))
            }
            Self::GaussianSheet { lobe, reflectance, transmittance } => {
                let side = choose_side(*reflectance, *transmittance, sampler)?;
                let dir = lobe.sample(
                    straight(incidence, side),
                    leaving_normal(incidence, side),
                    sampler,
                );
                Some(diffuse(dir, reflectance + transmittance, side))
            }
            Self::GaussianDielectric { lobe } => {
                let Scattered { dir, side, .. } = smooth(incidence, sampler);
                let dir = lobe.sample(dir.normalize(), leaving_normal(incidence, side), sampler);
                Some(diffuse(dir, 1.0, side))
            }
            Self::Tabulated { .. } => {
                let shares = shares(self, incidence);
                let side = choose_side(shares.reflected, shares.transmitted, sampler)?;
                let sum = shares.reflected + shares.transmitted;
                Some(specular(straight(incidence, side), sum, side))
            }
            Self::Coated { .. } => {
                let shares = shares(self, incidence);
                let side = choose_side(shares.reflected, shares.transmitted, sampler)?;
                Some(specular(smooth_direction(incidence, side)?, 1.0, side))
            }
            Self::Microfacet(rough) => rough.scatter(incidence, sampler),
            Self::Haze(haze) => haze.scatter(incidence, sampler),
            Self::PrismFilm { film, face } => film.scatter(*face, incidence, sampler),
            Self::Mixture(parts) => pick(parts, sampler).scatter(incidence, sampler),
        }
    }
}

/// Fresnel and Snell at a smooth interface; one draw, none under total reflection or between equal indices.
#[inline]
fn smooth(incidence: &Incidence, sampler: &mut Sampler<impl Numbers>) -> Scattered {
    let Incidence { dir, normal, index_from, index_to, .. } = *incidence;
    if index_from == index_to {
        return specular(dir, 1.0, Side::Transmitted);
    }
    let cos_i = incidence.cos();
    if let Some(cos_t) = fresnel::cos_transmitted(cos_i, index_from, index_to) {
        let reflectance =
            fresnel::dielectric_refracting(cos_i, cos_t, index_from, index_to).unpolarised();
        if sampler.one(Dimension::Lobe) >= reflectance {
            let refracted = fresnel::refracted(dir, normal, cos_i, cos_t, index_from / index_to);
            return specular(refracted, 1.0, Side::Transmitted);
        }
    }
    specular(fresnel::mirrored(dir, normal), 1.0, Side::Reflected)
}

/// Light that goes on in a discrete direction.
#[inline]
pub(crate) fn specular(dir: DVec3, factor: f64, side: Side) -> Scattered {
    Scattered { dir, factor, side, lobe: Lobe::Specular }
}

/// Light that goes on in a direction that was drawn.
fn diffuse(dir: DVec3, factor: f64, side: Side) -> Scattered {
    Scattered { dir, factor, side, lobe: Lobe::Diffuse }
}

/// Reflected or transmitted in proportion to the shares; no draw where only one is possible.
#[inline]
pub(crate) fn choose_side(
    reflectance: f64,
    transmittance: f64,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Side> {
    if transmittance == 0.0 {
        return (reflectance > 0.0).then_some(Side::Reflected);
    }
    let reflected = reflectance > 0.0
        && sampler.one(Dimension::Lobe) * (reflectance + transmittance) < reflectance;
    Some(if reflected { Side::Reflected } else { Side::Transmitted })
}

/// The discrete direction of a thin sheet: mirrored, or straight on.
#[inline]
pub(crate) fn straight(incidence: &Incidence, side: Side) -> DVec3 {
    match side {
        Side::Reflected => fresnel::mirrored(incidence.dir, incidence.normal),
        Side::Transmitted => incidence.dir,
    }
}

/// The normal of the side to which light leaves.
#[inline]
pub(crate) fn leaving_normal(incidence: &Incidence, side: Side) -> DVec3 {
    match side {
        Side::Reflected => incidence.normal,
        Side::Transmitted => -incidence.normal,
    }
}

/// One of the parts of a mixture, by its weight.
pub(crate) fn pick<'a>(parts: &'a [(f64, Bsdf)], sampler: &mut Sampler<impl Numbers>) -> &'a Bsdf {
    let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
    let mut left = sampler.one(Dimension::Lobe) * total;
    for (weight, part) in &parts[..parts.len() - 1] {
        left -= weight;
        if left < 0.0 {
            return part;
        }
    }
    &parts[parts.len() - 1].1
}
