//! Finishes: what a face does to light. Each finish has a file that answers every question of
//! `model` about it; `faces` joins the two finishes of a face. This file has the list of all finishes and passes each
//! question on to the file of the finish.
//!
//! Mirrors and total internal reflection draw no random numbers; a dielectric draws one to choose
//! between the reflected and the refracted part. A finish absorbs all light that it does not send
//! on.

mod absorber;
mod coated;
pub(crate) mod faces;
mod gaussian_dielectric;
mod gaussian_sheet;
pub(crate) mod haze;
mod lambertian;
mod measured;
mod metal;
pub(crate) mod microfacet;
mod mixture;
pub(crate) mod model;
mod open;
#[cfg(test)]
mod polarised;
mod prism_film;
mod smooth;
pub(crate) mod spectral;
mod specular;
mod stack;
mod tabulated;
#[cfg(test)]
mod testing;

use crate::optics::bsdf::sheet::{MeasuredSheet, SheetSide};
use crate::optics::finish::absorber::Absorber;
use crate::optics::finish::coated::Coated;
use crate::optics::finish::gaussian_dielectric::GaussianDielectric;
use crate::optics::finish::gaussian_sheet::GaussianSheet;
use crate::optics::finish::haze::Haze;
use crate::optics::finish::lambertian::Lambertian;
use crate::optics::finish::measured::MetSheet;
use crate::optics::finish::metal::Metal;
use crate::optics::finish::microfacet::Microfacet;
use crate::optics::finish::mixture::Mixture;
use crate::optics::finish::model::{FinishModel, Spread};
use crate::optics::finish::open::Open;
use crate::optics::finish::prism_film::MetFilm;
use crate::optics::finish::smooth::SmoothInterface;
use crate::optics::finish::spectral::{ScatterLaw, SpectralFinish};
use crate::optics::finish::specular::Specular;
use crate::optics::finish::stack::Stacked;
use crate::optics::finish::tabulated::Tabulated;
use crate::optics::{
    AngleTable, FaceMueller, FilmFace, Gaussian, Incidence, LayerStack, PrismFilm, Scattered,
    Shares, Side,
};
use crate::rng::{Numbers, Sampler};
use glam::DVec3;
use std::sync::Arc;

/// A finish: what a face does to light.
#[derive(Debug, Clone, PartialEq)]
pub enum Finish {
    /// The smooth interface of the two media: Fresnel, Snell, total reflection.
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
    /// Absorbs all light.
    Absorber,
    /// No interface: light goes straight on.
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
    /// A coated interface of two media: it reflects as the table says, by the angle in the medium
    /// of the lower index, and refracts the rest; total reflection is unchanged.
    Coated {
        /// Share that is mirrored.
        reflectance: AngleTable,
    },
    /// An interface or a sheet with a stack of thin layers, in the order in which light meets them; light is refracted into
    /// the medium behind.
    Stack(Arc<LayerStack>),
    /// A mirror, a diffuser or a Gaussian sheet with shares by wavelength.
    Spectral(Box<SpectralFinish>),
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
    /// A sheet with measured scatter.
    MeasuredSheet {
        /// The sheet.
        sheet: Arc<MeasuredSheet>,
        /// The side that is met.
        met: SheetSide,
    },
    /// Each photon meets one of several finishes, chosen by weight.
    Mixture(Vec<(f64, Finish)>),
}

/// The answer of a [`Finish`] to a question of [`FinishModel`]: the only match over all finishes. `scatter`
/// tests for the two most frequent ones before it, for speed.
macro_rules! ask {
    ($asked:expr, $finish:ident => $answer:expr) => {
        match $asked {
            Finish::Smooth => {
                let $finish = SmoothInterface;
                $answer
            }
            Finish::Specular { reflectance, transmittance } => {
                let $finish = Specular { shares: both(reflectance, transmittance) };
                $answer
            }
            Finish::Metal { n, k } => {
                let $finish = Metal { n: *n, k: *k };
                $answer
            }
            Finish::Absorber => {
                let $finish = Absorber;
                $answer
            }
            Finish::Open => {
                let $finish = Open;
                $answer
            }
            Finish::Lambertian { reflectance, transmittance } => {
                let $finish = Lambertian { shares: both(reflectance, transmittance) };
                $answer
            }
            Finish::GaussianSheet { lobe, reflectance, transmittance } => {
                let $finish = GaussianSheet { lobe, shares: both(reflectance, transmittance) };
                $answer
            }
            Finish::GaussianDielectric { lobe } => {
                let $finish = GaussianDielectric { lobe };
                $answer
            }
            Finish::Tabulated { reflectance, transmittance } => {
                let $finish = Tabulated { reflectance, transmittance };
                $answer
            }
            Finish::Coated { reflectance } => {
                let $finish = Coated { reflectance };
                $answer
            }
            Finish::Stack(stack) => {
                let $finish = Stacked { stack };
                $answer
            }
            Finish::Spectral($finish) => $answer,
            Finish::Microfacet($finish) => $answer,
            Finish::Haze($finish) => $answer,
            Finish::PrismFilm { film, face } => {
                let $finish = MetFilm { film, face: *face };
                $answer
            }
            Finish::MeasuredSheet { sheet, met } => {
                let $finish = MetSheet { sheet, side: *met };
                $answer
            }
            Finish::Mixture(parts) => {
                let $finish = Mixture { parts };
                $answer
            }
        }
    };
}

impl Finish {
    /// A finish with constant shares, 0..=1 together.
    pub fn with_shares(scatter: ScatterLaw, [reflectance, transmittance]: [f64; 2]) -> Self {
        match scatter {
            ScatterLaw::Specular => Self::Specular { reflectance, transmittance },
            ScatterLaw::Lambertian => Self::Lambertian { reflectance, transmittance },
            ScatterLaw::Gaussian(lobe) => Self::GaussianSheet { lobe, reflectance, transmittance },
        }
    }

    /// The sheets with measured scatter among it and its parts.
    pub fn measured_sheets(&self) -> Vec<&MeasuredSheet> {
        if let Self::Mixture(parts) = self {
            return parts.iter().flat_map(|(_, part)| part.measured_sheets()).collect();
        }
        if let Self::MeasuredSheet { sheet, .. } = self { vec![sheet] } else { Vec::new() }
    }

    /// Whether it, or a part of it, is a whole sheet: what light meets from behind belongs to it.
    pub fn is_of_both_sides(&self) -> bool {
        match self {
            Self::PrismFilm { .. } | Self::MeasuredSheet { .. } | Self::Stack(_) => true,
            Self::Mixture(parts) => parts.iter().any(|(_, part)| part.is_of_both_sides()),
            _ => false,
        }
    }

    /// The same finish as met by light from the other side, if it differs there.
    pub fn from_behind(&self) -> Option<Self> {
        if let Self::PrismFilm { film, face } = self {
            return Some(Self::PrismFilm { film: film.clone(), face: face.opposite() });
        }
        if let Self::MeasuredSheet { sheet, met } = self {
            return Some(Self::MeasuredSheet { sheet: sheet.clone(), met: met.opposite() });
        }
        if let Self::Stack(stack) = self {
            return stack.reversed().map(|stack| Self::Stack(Arc::new(stack)));
        }
        let Self::Mixture(parts) = self else { return None };
        let turned: Vec<_> = parts.iter().map(|(_, part)| part.from_behind()).collect();
        turned.iter().any(Option::is_some).then(|| {
            let part = |((weight, part), turned): (&(f64, Self), Option<Self>)| {
                (*weight, turned.unwrap_or_else(|| part.clone()))
            };
            Self::Mixture(parts.iter().zip(turned).map(part).collect())
        })
    }

    /// [`FinishModel::scatter`] out of line, so that the loop around mirrors and smooth faces stays
    /// small.
    #[inline(never)]
    fn scatter_rarely(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        ask!(self, finish => finish.scatter(incidence, sampler))
    }
}

impl FinishModel for Finish {
    fn shares(&self, incidence: &Incidence) -> Shares {
        ask!(self, finish => finish.shares(incidence))
    }

    #[inline(always)]
    fn scatter(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        if let Self::Smooth = self {
            return SmoothInterface.scatter(incidence, sampler);
        }
        if let Self::Specular { reflectance, transmittance } = self {
            let shares = both(reflectance, transmittance);
            return Specular { shares }.scatter(incidence, sampler);
        }
        // Normalised here rather than copied, so light from mirrors need not go through memory
        // either.
        self.scatter_rarely(incidence, sampler).map(Scattered::normalised)
    }

    fn scatter_radiance(
        &self,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        ask!(self, finish => finish.scatter_radiance(incidence, sampler))
    }

    fn scatter_toward(
        &self,
        side: Side,
        incidence: &Incidence,
        sampler: &mut Sampler<impl Numbers>,
    ) -> Option<Scattered> {
        ask!(self, finish => finish.scatter_toward(side, incidence, sampler))
    }

    fn albedo_about(&self, incidence: &Incidence) -> f64 {
        ask!(self, finish => finish.albedo_about(incidence))
    }

    fn chances(&self, incidence: &Incidence) -> Shares {
        ask!(self, finish => finish.chances(incidence))
    }

    fn radiance_chances(&self, incidence: &Incidence) -> Shares {
        ask!(self, finish => finish.radiance_chances(incidence))
    }

    fn evaluate(&self, incidence: &Incidence, out: DVec3) -> f64 {
        ask!(self, finish => finish.evaluate(incidence, out))
    }

    fn mueller(&self, incidence: &Incidence, side: Side) -> Option<FaceMueller> {
        ask!(self, finish => finish.mueller(incidence, side))
    }

    fn width(&self) -> Option<f64> {
        ask!(self, finish => finish.width())
    }

    fn spread(&self) -> Spread {
        ask!(self, finish => finish.spread())
    }

    fn only_mirrors(&self, incidence: &Incidence) -> bool {
        ask!(self, finish => finish.only_mirrors(incidence))
    }

    fn mirrors_alike(&self, incidence: &Incidence) -> bool {
        ask!(self, finish => finish.mirrors_alike(incidence))
    }

    fn passes_straight(&self) -> bool {
        ask!(self, finish => finish.passes_straight())
    }

    #[inline]
    fn has_grain(&self) -> bool {
        ask!(self, finish => finish.has_grain())
    }
}

fn both(reflectance: &f64, transmittance: &f64) -> Shares {
    Shares { reflected: *reflectance, transmitted: *transmittance }
}
