//! Scattering of a photon at a finish.

use crate::optics::bsdf::Bsdf;
use crate::optics::fresnel;
use crate::optics::incidence::{
    Incidence, Scattered, Side, choose_side, diffuse, leaving_normal, specular, straight,
};
use crate::optics::shares::shares;
use crate::optics::smooth::smooth_direction;
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, cosine_hemisphere, unit};

#[cfg(test)]
mod tests;

impl Bsdf {
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
                // Normalised here rather than copied, so light from mirrors need not go through
                // memory either.
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
