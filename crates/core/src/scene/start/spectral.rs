//! Wavelengths of paths, and what they are worth.
//!
//! A path has one wavelength. Photons draw theirs from the spectrum of their source, gather paths from those of all sources
//! in proportion to their flux. What is drawn too often counts less, so that means are luminous fluxes. In a scene without
//! spectra every path has the reference wavelength and a worth of 1, and no number is drawn.

use crate::optics::REFERENCE_WAVELENGTH;
use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::{Scene, Source, SourceId};

impl Source {
    /// The wavelength of a photon, nm.
    pub(crate) fn wavelength(&self, sampler: &mut Sampler<impl Numbers>) -> f64 {
        let Some(spectrum) = &self.spectrum else { return REFERENCE_WAVELENGTH };
        spectrum.sample(sampler.one(Dimension::Wavelength))
    }

    /// Flux of a photon of this wavelength over the mean of all photons of the source, 1.
    #[inline]
    pub(crate) fn photon_worth(&self, nm: f64) -> f64 {
        self.spectrum.as_ref().map_or(1.0, |own| own.relative_flux(nm))
    }
}

impl Scene {
    /// Whether its light has spectra.
    pub fn is_spectral(&self) -> bool {
        self.sources.iter().any(|source| source.spectrum.is_some())
    }

    /// The wavelength of a gather path, nm.
    pub(crate) fn wavelength(&self, sampler: &mut Sampler<impl Numbers>) -> f64 {
        if !self.is_spectral() {
            return REFERENCE_WAVELENGTH;
        }
        let mut left = self.source_flux() * sampler.one(Dimension::Wavelength);
        let mut last = None;
        for source in self.sources.iter().filter(|source| source.is_lit()) {
            let Some(spectrum) = &source.spectrum else { continue };
            if left < source.flux {
                return spectrum.sample(left / source.flux);
            }
            left -= source.flux;
            last = Some(spectrum);
        }
        // Rounding of a sum of fluxes.
        last.map_or(REFERENCE_WAVELENGTH, |spectrum| spectrum.sample(1.0))
    }

    /// What a gather path of this wavelength sees of the emission of a source over the whole of it, 1.
    #[inline]
    pub(crate) fn gathered_worth(&self, source: SourceId, nm: f64) -> f64 {
        let Some(spectrum) = &self.sources[source.index()].spectrum else { return 1.0 };
        let luminous = spectrum.luminous(nm);
        if luminous == 0.0 {
            return 0.0;
        }
        let drawn = |source: &Source| {
            source.spectrum.as_ref().map_or(0.0, |own| source.flux * own.density(nm))
        };
        luminous * self.source_flux() / self.sources.iter().map(drawn).sum::<f64>()
    }
}
