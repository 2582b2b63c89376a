//! What a face does to a gather path, which follows light backwards and carries basic radiance L* = L/n².
//!
//! A photon of direction i scatters into o with the density `f(i→o) cos θ_o` of its finish. The
//! gather path arrives along -o and must choose i: `L*_o = ∫ (n_i²/n_o²) f(i→o) cos θ_i L*_i dω_i`,
//! and the factor of a drawn i is the integrand without `L*_i` over its density (Veach, Robust
//! Monte Carlo Methods for Light Transport Simulation, 1997, section 5.2, there for L). For the
//! finishes this gives:
//!
//! * Smooth: refraction conserves n² cos θ dω, and Fresnel's R and T are the same from both sides.
//!   The gather path does what a photon does, without a factor.
//! * Light that passes without being bent, whatever the indices are, conserves cos θ dω and not n²
//!   cos θ dω; and a diffuser mixes radiance, not basic radiance. The factor `n_i²/n_o²` then
//!   remains.
//! * Small facets, and haze between two media: `f/n_o²` is the same both ways, which is sufficient.
//! * Prism films: every path through the film consists of smooth interfaces, so it is the same both
//!   ways. So is the position in the period, which is drawn evenly.
//! * Gaussian scatter: a photon meets a smooth face or a thin sheet first and the lobe afterwards,
//!   so the gather path meets the lobe first. It draws the mean direction m of the photon from
//!   p(m|o), which costs `p(o|m) cos θ_m / (p(m|o) cos θ_o)`, and continues from m as at a face
//!   without scatter. So exactly the photon directions that scatter into o are drawn, even through
//!   a face that totally reflects the gather path's own direction.

use crate::optics::incidence::{choose_side, leaving_normal, specular, straight};
use crate::optics::scatter::pick;
use crate::optics::smooth::smooth_direction;
use crate::optics::{Bsdf, Gaussian, Haze, Incidence, Lobe, Scattered, Shares, Side, shares};
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::{Frame, cosine_hemisphere, unit};

#[cfg(test)]
mod tests;

/// The finishes that a gather path meets at a face.
#[derive(Debug, Clone, Copy)]
pub struct Faces<'a> {
    /// Acts on light that arrives from the gather path's side: on reflected light.
    pub own: &'a Bsdf,
    /// Acts on light that arrives from the other side: on transmitted light.
    pub behind: &'a Bsdf,
}

/// Sends a gather path on toward the origin of its light, or ends it where there is none (`None`).
///
/// `incidence` is that of the gather path: it travels along `dir`, the light it collects leaves
/// along `-dir`, and `index_to` is that of the medium from which transmitted light came. The
/// returned `factor` applies to basic radiance; unlike a photon's it can exceed 1.
#[inline]
pub fn scatter_radiance(
    faces: Faces<'_>,
    incidence: &Incidence,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    match (faces.own, faces.behind) {
        (Bsdf::Smooth, Bsdf::Smooth) => Bsdf::Smooth.scatter(incidence, sampler),
        // Behind a film is the same film.
        (own @ Bsdf::PrismFilm { .. }, _) => own.scatter(incidence, sampler),
        (own, behind) if std::ptr::eq(own, behind) => by_one_finish(own, incidence, sampler),
        (own, behind) => by_two_finishes(own, behind, incidence, sampler),
    }
}

fn by_one_finish(
    bsdf: &Bsdf,
    incidence: &Incidence,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    match bsdf {
        Bsdf::Smooth
        | Bsdf::Metal { .. }
        | Bsdf::Absorber
        | Bsdf::Coated { .. }
        | Bsdf::Microfacet(_)
        | Bsdf::PrismFilm { .. } => bsdf.scatter(incidence, sampler),
        Bsdf::Specular { .. } | Bsdf::Tabulated { .. } | Bsdf::Open | Bsdf::Lambertian { .. } => {
            bsdf.scatter(incidence, sampler).map(|out| unrefracted(out, incidence))
        }
        Bsdf::Haze(haze) => {
            bsdf.scatter(incidence, sampler).map(|out| through_haze(haze, out, incidence))
        }
        Bsdf::GaussianSheet { lobe, reflectance, transmittance } => {
            let (mean, factor) = scattered_from(lobe, incidence, sampler)?;
            let side = choose_side(*reflectance, *transmittance, sampler)?;
            let out = specular(straight(&mean, side), reflectance + transmittance, side);
            Some(diffused(unrefracted(out, incidence), factor))
        }
        Bsdf::GaussianDielectric { lobe } => {
            let (mean, factor) = scattered_from(lobe, incidence, sampler)?;
            Bsdf::Smooth.scatter(&mean, sampler).map(|out| diffused(out, factor))
        }
        Bsdf::Mixture(parts) => by_one_finish(pick(parts, sampler), incidence, sampler),
    }
}

/// A two-sided face: reflection by one finish, transmission by the other, chosen in proportion to their shares.
fn by_two_finishes(
    own: &Bsdf,
    behind: &Bsdf,
    incidence: &Incidence,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    let reflected = chances(own, incidence).reflected;
    let transmitted = chances(behind, incidence).transmitted;
    let side = choose_side(reflected, transmitted, sampler)?;
    let (bsdf, chance) = match side {
        Side::Reflected => (own, reflected),
        Side::Transmitted => (behind, transmitted),
    };
    let out = scatter_toward(bsdf, side, incidence, sampler)?;
    Some(Scattered { factor: out.factor * ((reflected + transmitted) / chance), ..out })
}

/// Probabilities close to the shares of [`shares()`], but nowhere 0 where the adjoint is not:
/// scatter of a rough dielectric reaches directions that are themselves totally reflected, or
/// hardly reflected.
fn chances(bsdf: &Bsdf, incidence: &Incidence) -> Shares {
    match bsdf {
        Bsdf::GaussianDielectric { .. } if incidence.index_from != incidence.index_to => {
            let reflected = shares(bsdf, incidence).reflected.clamp(0.1, 0.9);
            Shares { reflected, transmitted: 1.0 - reflected }
        }
        Bsdf::Microfacet(_) => {
            let reflected = shares(&Bsdf::Smooth, incidence).reflected.clamp(0.1, 0.9);
            Shares { reflected, transmitted: 1.0 - reflected }
        }
        // Whatever the shares are, no side is left out.
        Bsdf::PrismFilm { .. } => Shares { reflected: 0.5, transmitted: 0.5 },
        Bsdf::Mixture(parts) => {
            let mut sum = Shares { reflected: 0.0, transmitted: 0.0 };
            for (weight, part) in parts {
                let of_part = chances(part, incidence);
                sum.reflected += weight * of_part.reflected;
                sum.transmitted += weight * of_part.transmitted;
            }
            let total: f64 = parts.iter().map(|(weight, _)| weight).sum();
            Shares { reflected: sum.reflected / total, transmitted: sum.transmitted / total }
        }
        Bsdf::Smooth
        | Bsdf::Specular { .. }
        | Bsdf::Metal { .. }
        | Bsdf::Absorber
        | Bsdf::Open
        | Bsdf::Lambertian { .. }
        | Bsdf::GaussianSheet { .. }
        | Bsdf::GaussianDielectric { .. }
        | Bsdf::Tabulated { .. }
        | Bsdf::Coated { .. }
        | Bsdf::Haze(_) => shares(bsdf, incidence),
    }
}

/// The part of the adjoint that goes to one side: like [`scatter_radiance`], but the factor
/// includes the share of that side. `bsdf` acts on the light that comes from there: the finish met
/// for reflection, the one behind for transmission.
pub fn scatter_toward(
    bsdf: &Bsdf,
    side: Side,
    incidence: &Incidence,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<Scattered> {
    match bsdf {
        Bsdf::Smooth | Bsdf::Coated { .. } => smooth_toward(bsdf, side, incidence),
        Bsdf::Microfacet(rough) => rough.scatter_toward(side, incidence, sampler),
        Bsdf::Haze(haze) => haze
            .scatter_toward(side, incidence, sampler)
            .map(|out| through_haze(haze, out, incidence)),
        Bsdf::Specular { .. }
        | Bsdf::Tabulated { .. }
        | Bsdf::Metal { .. }
        | Bsdf::Absorber
        | Bsdf::Open => {
            let share = shares(bsdf, incidence).of(side);
            let out = specular(straight(incidence, side), share, side);
            (share > 0.0).then(|| unrefracted(out, incidence))
        }
        Bsdf::Lambertian { .. } => {
            let share = shares(bsdf, incidence).of(side);
            let frame = Frame::from_axis(DVec3::ZERO, leaving_normal(incidence, side));
            let dir = frame.to_world(cosine_hemisphere(sampler.pair(Dimension::Scatter)));
            let out = Scattered { dir, factor: share, side, lobe: Lobe::Diffuse };
            (share > 0.0).then(|| unrefracted(out, incidence))
        }
        Bsdf::GaussianSheet { lobe, .. } => {
            let share = shares(bsdf, incidence).of(side);
            let (mean, factor) = scattered_from(lobe, incidence, sampler)?;
            let out = specular(straight(&mean, side), share, side);
            (share > 0.0).then(|| diffused(unrefracted(out, incidence), factor))
        }
        Bsdf::GaussianDielectric { lobe } => {
            let (mean, factor) = scattered_from(lobe, incidence, sampler)?;
            smooth_toward(&Bsdf::Smooth, side, &mean).map(|out| diffused(out, factor))
        }
        Bsdf::PrismFilm { film, face } => {
            // The light meets the face on its own side; the gather path meets it on the side it
            // comes from.
            let met = match side {
                Side::Reflected => *face,
                Side::Transmitted => face.opposite(),
            };
            film.scatter(met, incidence, sampler).filter(|out| out.side == side)
        }
        Bsdf::Mixture(parts) => scatter_toward(pick(parts, sampler), side, incidence, sampler),
    }
}

/// An interface that mirrors and refracts, whatever its shares are.
fn smooth_toward(bsdf: &Bsdf, side: Side, incidence: &Incidence) -> Option<Scattered> {
    let dir = smooth_direction(incidence, side)?;
    let share = shares(bsdf, incidence).of(side);
    (share > 0.0).then(|| specular(dir, share, side))
}

/// The gather path before it met a lobe, as if it had come along the mean direction of the photons
/// that scatter into it, and the factor `p(o|m) cos θ_m / (p(m|o) cos θ_o)`. `None` along the face,
/// where it has no value.
fn scattered_from(
    lobe: &Gaussian,
    incidence: &Incidence,
    sampler: &mut Sampler<impl Numbers>,
) -> Option<(Incidence, f64)> {
    let cos = incidence.cos();
    if cos == 0.0 {
        return None;
    }
    let mean = unit(lobe.sample(-incidence.dir, incidence.normal, sampler));
    let inner = Incidence { dir: -mean, ..*incidence };
    // p(o|m) / p(m|o)
    let exchange = lobe.exchange(cos, inner.cos());
    Some((inner, exchange * inner.cos() / cos))
}

/// Light that passes a face without being bent, or is mixed by a diffuser, conserves radiance and
/// not basic radiance.
#[inline]
fn unrefracted(out: Scattered, incidence: &Incidence) -> Scattered {
    match out.side {
        Side::Reflected => out,
        Side::Transmitted => {
            let ratio = incidence.index_to / incidence.index_from;
            Scattered { factor: out.factor * ratio * ratio, ..out }
        }
    }
}

fn through_haze(haze: &Haze, out: Scattered, incidence: &Incidence) -> Scattered {
    let out = Scattered { dir: unit(out.dir), ..out };
    if haze.is_sheet() { unrefracted(out, incidence) } else { out }
}

fn diffused(out: Scattered, factor: f64) -> Scattered {
    Scattered { dir: unit(out.dir), factor: out.factor * factor, lobe: Lobe::Diffuse, ..out }
}
