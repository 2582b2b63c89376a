//! The questions that each finish answers, and how far a finish spreads light.
//!
//! Photons carry flux. Gather paths follow light backwards and carry basic radiance L* = L/n². A
//! photon of direction i scatters into o with the density `f(i→o) cos θ_o` of its finish. The
//! gather path arrives along -o and must choose i: `L*_o = ∫ (n_i²/n_o²) f(i→o) cos θ_i L*_i dω_i`,
//! and the factor of a drawn i is the integrand without `L*_i` over its density (Veach, Robust
//! Monte Carlo Methods for Light Transport Simulation, 1997, section 5.2, there for L). Each
//! finish gives its factor at its `scatter_radiance`.

use crate::optics::{FaceMueller, Incidence, Scattered, Shares, Side};
use crate::rng::{Numbers, Sampler};
use glam::DVec3;

/// Below this standard deviation, rad, scatter is narrow: within twice this the solid angle is 0.13
/// sr, 2 % of a half space, so light must still be searched near a discrete direction.
const NARROW: f64 = 0.1;

/// What a finish does to light.
///
/// The provided answers are those of a finish that sends light into the mirrored direction and
/// straight on, and absorbs the rest.
pub trait FinishModel {
    /// Shares of light that arrives with `incidence`, 1.
    fn shares(&self, incidence: &Incidence) -> Shares;

    /// Sends a photon on, or absorbs it (`None`).
    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered>;

    /// Sends a gather path on toward the origin of its light, where both sides of a face have this
    /// finish, or ends it where there is none (`None`).
    ///
    /// `incidence` is that of the gather path: it travels along `dir`, the light it collects leaves
    /// along `-dir`, and `index_to` is that of the medium from which transmitted light came. The
    /// returned `factor` applies to basic radiance; unlike a photon's it can exceed 1.
    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        // Unbent light conserves cos θ dω, and not n² cos θ dω.
        self.scatter(incidence, sampler).map(|out| out.normalised().unrefracted(incidence))
    }

    /// The part of [`FinishModel::scatter_radiance`] that goes to one side: the factor includes the
    /// share of that side. The finish acts on the light that comes from there: it is the one met for
    /// reflection, the one behind for transmission.
    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        _sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        let share = self.shares(incidence).of(side);
        let out = Scattered::specular(incidence.straight(side), share, side);
        (share > 0.0).then(|| out.unrefracted(incidence))
    }

    /// Share of the light that leaves to either side, 1: roughly, where [`FinishModel::shares`] takes
    /// long. For weights, which any function serves.
    fn albedo_about(&self, incidence: &Incidence) -> f64 {
        self.shares(incidence).sum()
    }

    /// Probabilities with which [`FinishModel::scatter`] sends light that it does not absorb to the
    /// two sides, 1; the parts of a mixture count by their weights. They only serve as weights, so where
    /// [`FinishModel::shares`] takes long they are approximate, but not 0 for a side that light takes.
    fn chances(&self, incidence: &Incidence) -> Shares {
        let shares = self.shares(incidence);
        let sum = shares.sum();
        shares.scaled(if sum > 0.0 { 1.0 / sum } else { 0.0 })
    }

    /// Chances close to the shares of gather paths, but nowhere 0 where the adjoint is not.
    fn radiance_chances(&self, incidence: &Incidence) -> Shares {
        self.shares(incidence)
    }

    /// The bidirectional distribution function f(i→o), in 1/sr, for a photon that arrives with
    /// `incidence` and leaves along the unit vector `out`: reflected on the side of the normal,
    /// otherwise transmitted. `f cos θ_o dω_o` is the share of the photon's flux that leaves into
    /// `dω_o`; discrete directions have no finite value and count as 0.
    ///
    /// Photons that arrive with flux `Φ_p` on an area ΔA give the radiance `L(o) = Σ f(i_p→o) Φ_p /
    /// ΔA` (Jensen, Realistic Image Synthesis Using Photon Mapping, 2001, chapter 7).
    fn evaluate(&self, _incidence: &Incidence, _out: DVec3) -> f64 {
        0.0
    }

    /// The action on polarised light that leaves to a side in a discrete direction; `None` if it is depolarised. Only finishes that
    /// answer may have shares that depend on the polarisation: what depolarises must act on all light alike, or gather paths,
    /// for which this is reversed, would differ from photons.
    fn mueller(&self, _incidence: &Incidence, _side: Side) -> Option<FaceMueller> {
        None
    }

    /// Standard deviation of scatter about discrete directions, rad; `None` without any. For a
    /// mixture it is that of the narrowest such part, since a window must resolve it.
    fn width(&self) -> Option<f64> {
        None
    }

    /// How far the finish spreads light. A mixture is as broad as its broadest part, whatever its
    /// weight: it can also have discrete directions and narrower lobes.
    fn spread(&self) -> Spread {
        match self.width() {
            None => Spread::Discrete,
            Some(width) if width < NARROW => Spread::Narrow(width),
            Some(_) => Spread::Broad,
        }
    }

    /// Whether light that arrives in this way is either absorbed or mirrored, always in the same proportion.
    fn only_mirrors(&self, _incidence: &Incidence) -> bool {
        false
    }

    /// Whether light that arrives in this way, or at a flatter angle, is only mirrored, and all of it in the same proportion.
    fn mirrors_alike(&self, _incidence: &Incidence) -> bool {
        false
    }

    /// Whether light can go through without being bent, as if both sides were of one index.
    fn passes_straight(&self) -> bool {
        false
    }

    /// Whether it has a direction of its own on the face, so that the grain of [`Incidence`] is needed.
    fn has_grain(&self) -> bool {
        false
    }

    /// Whether all directions that leave are discrete.
    fn is_specular(&self) -> bool {
        self.spread() == Spread::Discrete
    }
}

/// How far a finish spreads light, for the choice of windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spread {
    /// Into discrete directions only, or nowhere.
    Discrete,
    /// About them, with this standard deviation in rad, less than 0.1.
    Narrow(f64),
    /// Over a large part of the half space.
    Broad,
}

impl Spread {
    /// The spread of two finishes together.
    pub(crate) fn broader(self, other: Self) -> Self {
        match (self, other) {
            (Self::Broad, _) | (_, Self::Broad) => Self::Broad,
            (Self::Narrow(a), Self::Narrow(b)) => Self::Narrow(a.max(b)),
            (Self::Discrete, other) => other,
            (Self::Narrow(_), Self::Discrete) => self,
        }
    }
}
