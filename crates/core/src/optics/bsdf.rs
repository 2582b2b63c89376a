//! What a face does to light that meets it.
//!
//! A closed set of finishes. Mirrors and total internal reflection draw no random numbers; a
//! dielectric draws one to choose between the reflected and the refracted part. A finish absorbs
//! all light that it does not send on.

use crate::optics::{AngleTable, FilmFace, Gaussian, Haze, Microfacet, PrismFilm};

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
}
