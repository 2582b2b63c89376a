//! Light that arrives at a face, light that leaves it, and the sides to which it leaves.

use crate::optics::fresnel;
use crate::rng::{Dimension, Numbers, Sampler};
use glam::DVec3;
use lumiduct_base::math::unit;

/// Light arriving at a face.
#[derive(Debug, Clone, Copy)]
pub struct Incidence {
    /// Unit direction of travel.
    pub dir: DVec3,
    /// Unit normal on the side the light comes from: `dir · normal` is negative.
    pub normal: DVec3,
    /// Refractive index of the medium it comes from.
    pub index_from: f64,
    /// Refractive index of the medium behind the face.
    pub index_to: f64,
    /// Wavelength of the light, nm.
    pub wavelength: f64,
    /// Unit direction of the grain of a finish along the face; zero for finishes without grain.
    pub grain: DVec3,
    /// Share of the light whose electric field is perpendicular to the plane of incidence (s), 0..=1;
    /// [`UNPOLARISED`](Self::UNPOLARISED) where polarisation is ignored.
    pub s_share: f64,
}

impl Incidence {
    /// [`Incidence::s_share`] of unpolarised light, 1.
    pub const UNPOLARISED: f64 = 0.5;

    /// The same light without its polarisation.
    #[inline]
    pub(crate) fn unpolarised(&self) -> Self {
        Self { s_share: Self::UNPOLARISED, ..*self }
    }

    /// Cosine of the angle of incidence, in 0..=1.
    #[inline]
    pub(crate) fn cos(&self) -> f64 {
        let cos = -self.dir.dot(self.normal);
        let cos = if cos < 1.0 { cos } else { 1.0 };
        if cos > 0.0 { cos } else { 0.0 }
    }

    /// The side to which light goes along `out`.
    pub(crate) fn side_of(&self, out: DVec3) -> Side {
        if out.dot(self.normal) > 0.0 { Side::Reflected } else { Side::Transmitted }
    }

    /// The normal of the side to which light leaves.
    #[inline]
    pub(crate) fn leaving_normal(&self, side: Side) -> DVec3 {
        match side {
            Side::Reflected => self.normal,
            Side::Transmitted => -self.normal,
        }
    }

    /// The discrete direction of a thin sheet: mirrored, or straight on.
    #[inline]
    pub(crate) fn straight(&self, side: Side) -> DVec3 {
        match side {
            Side::Reflected => fresnel::mirrored(self.dir, self.normal),
            Side::Transmitted => self.dir,
        }
    }
}

/// The side of a face to which light leaves, as seen from where it came.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Back to the side it came from.
    Reflected,
    /// Through the face.
    Transmitted,
}

/// Whether a direction was discrete or drawn from a density.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lobe {
    /// A discrete direction: mirrored, refracted or straight on.
    Specular,
    /// A direction drawn from a density over solid angle.
    Diffuse,
}

/// Light that leaves a face.
#[derive(Debug, Clone, Copy)]
pub struct Scattered {
    /// New direction of travel, not yet normalised.
    pub dir: DVec3,
    /// Share of the arriving flux that this path carries on; 1 - factor is absorbed by the face.
    pub factor: f64,
    /// Reflected or transmitted.
    pub side: Side,
    /// Discrete or drawn.
    pub lobe: Lobe,
    /// Probability with which this side was chosen, given that the light was not absorbed, 1; also 1 where a finish does not
    /// state it (haze, facets, prism film).
    pub chance: f64,
}

impl Scattered {
    /// Light that leaves in a discrete direction.
    #[inline]
    pub(crate) fn specular(dir: DVec3, factor: f64, side: Side) -> Self {
        Self { dir, factor, side, lobe: Lobe::Specular, chance: 1.0 }
    }

    /// Light that leaves in a drawn direction.
    pub(crate) fn diffuse(dir: DVec3, factor: f64, side: Side) -> Self {
        Self { dir, factor, side, lobe: Lobe::Diffuse, chance: 1.0 }
    }

    /// The same light, whose side was chosen in proportion to these shares.
    #[inline]
    pub(crate) fn chosen_by(self, shares: Shares) -> Self {
        Self { chance: shares.of(self.side) / shares.sum(), ..self }
    }

    /// The same light along a unit vector.
    #[inline]
    pub(crate) fn normalised(self) -> Self {
        Self { dir: unit(self.dir), ..self }
    }

    /// A gather path whose light passed the face without being bent, or was mixed by a diffuser:
    /// that conserves radiance and not basic radiance, so the factor `n_i²/n_o²` remains.
    #[inline]
    pub(crate) fn unrefracted(self, incidence: &Incidence) -> Self {
        match self.side {
            Side::Reflected => self,
            Side::Transmitted => {
                let ratio = incidence.index_to / incidence.index_from;
                Self { factor: self.factor * ratio * ratio, ..self }
            }
        }
    }
}

/// Shares of the arriving flux that leave to the two sides; the rest is absorbed. 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shares {
    /// Share that is reflected.
    pub reflected: f64,
    /// Share that is transmitted.
    pub transmitted: f64,
}

impl Shares {
    /// Of light that is absorbed.
    pub(crate) const NONE: Self = Self { reflected: 0.0, transmitted: 0.0 };

    /// The share that leaves to one side, 1.
    #[inline]
    pub(crate) fn of(self, side: Side) -> f64 {
        match side {
            Side::Reflected => self.reflected,
            Side::Transmitted => self.transmitted,
        }
    }

    /// The share that is not absorbed, 1.
    #[inline]
    pub(crate) fn sum(self) -> f64 {
        self.reflected + self.transmitted
    }

    /// The shares of both together.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            reflected: self.reflected + other.reflected,
            transmitted: self.transmitted + other.transmitted,
        }
    }

    /// Both shares times a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self { reflected: factor * self.reflected, transmitted: factor * self.transmitted }
    }

    /// A side in proportion to the shares; no draw where only one is possible.
    #[inline]
    pub(crate) fn choose_side(self, sampler: &mut Sampler<impl Numbers>) -> Option<Side> {
        let Self { reflected, transmitted } = self;
        if transmitted == 0.0 {
            return (reflected > 0.0).then_some(Side::Reflected);
        }
        let is_reflected =
            reflected > 0.0 && sampler.one(Dimension::Lobe) * (reflected + transmitted) < reflected;
        Some(if is_reflected { Side::Reflected } else { Side::Transmitted })
    }
}
