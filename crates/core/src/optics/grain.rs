//! Finishes with a direction on the face, or a different response from behind.

use crate::optics::Bsdf;

impl Bsdf {
    /// Whether light leaves in one discrete direction to each side, or not at all.
    pub fn has_one_direction_a_side(&self) -> bool {
        self.is_specular() && !self.has_grain()
    }

    /// Whether it has a direction of its own on the face, so that the grain of [`crate::optics::Incidence`] is needed.
    #[inline]
    pub fn has_grain(&self) -> bool {
        match self {
            Self::PrismFilm { .. } => true,
            Self::Mixture(parts) => parts.iter().any(|(_, part)| part.has_grain()),
            Self::Smooth
            | Self::Specular { .. }
            | Self::Metal { .. }
            | Self::Absorber
            | Self::Open
            | Self::Lambertian { .. }
            | Self::GaussianSheet { .. }
            | Self::GaussianDielectric { .. }
            | Self::Tabulated { .. }
            | Self::Coated { .. }
            | Self::Microfacet(_)
            | Self::Haze(_) => false,
        }
    }

    /// The same finish as met by light from the other side, if it differs there.
    pub fn from_behind(&self) -> Option<Self> {
        if let Self::PrismFilm { film, face } = self {
            return Some(Self::PrismFilm { film: film.clone(), face: face.opposite() });
        }
        if let (Self::Mixture(parts), true) = (self, self.has_grain()) {
            let turned = |part: &Self| part.from_behind().unwrap_or_else(|| part.clone());
            let parts = parts.iter().map(|(weight, part)| (*weight, turned(part)));
            return Some(Self::Mixture(parts.collect()));
        }
        None
    }
}
