//! Wavelengths of paths, and their weights.
//!
//! A path has one wavelength. Photons draw theirs from the spectrum of their source, gather paths from those of all sources
//! in proportion to their flux. The spectral weight makes means of luminous flux independent of
//! how wavelengths are drawn. In a scene without spectra every path has the reference wavelength and a spectral weight of 1, and no number is
//! drawn.

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
    pub(crate) fn spectral_weight(&self, nm: f64) -> f64 {
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
    pub(crate) fn gathered_spectral_weight(&self, source: SourceId, nm: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{NoSpectrum, SpectralDraw, Spectrum, illuminant_d65};
    use crate::optics::Medium;
    use crate::scene::{Builder, Emission, Emitter, StartSolids};
    use glam::DVec3;
    use lumiduct_base::math::Frame;
    use lumiduct_base::units::FluxUnit;
    use std::sync::Arc;

    /// A white lamp of 3 lm, a dark one, and a line of 1 lm.
    fn scene() -> Result<Scene, NoSpectrum> {
        let air = Medium::new("air", 1.0, 0.0);
        let mut builder = Builder::new(DVec3::ZERO, air, FluxUnit::Lumen);
        let white = Spectrum::of_law(illuminant_d65)?;
        let lamps = [(3.0, white.clone()), (0.0, white), (1.0, Spectrum::line(546.1)?)];
        for (flux, spectrum) in lamps {
            builder.add_source(Source {
                name: format!("{flux} lm"),
                flux,
                emitter: Emitter::Point(Frame::WORLD),
                emission: Emission::Isotropic,
                start: StartSolids::Outside,
                on: Vec::new(),
                spectrum: Some(Arc::new(SpectralDraw::new(spectrum))),
                elevation: None,
                sun: None,
            });
        }
        Ok(builder.build())
    }

    #[test]
    fn the_mean_spectral_weight_is_1_for_photons_and_for_gather_paths() -> Result<(), NoSpectrum> {
        const COUNT: u64 = 40_000;
        let scene = scene()?;
        for (index, source) in scene.sources.iter().enumerate().filter(|(_, own)| own.is_lit()) {
            let (mut photons, mut paths) = (0.0, 0.0);
            for path in 0..COUNT {
                let mut sampler = Sampler::for_path(1, index as u64, path);
                photons += source.spectral_weight(source.wavelength(&mut sampler));
                let nm = scene.wavelength(&mut sampler);
                paths += scene.gathered_spectral_weight(SourceId::new(index), nm);
            }
            let [photons, paths] = [photons, paths].map(|sum| sum / COUNT as f64);
            // Five standard errors: weights of photons scatter by 0.4, those of paths by 1.8, as a quarter of them see the line.
            assert!((photons - 1.0).abs() < 0.01, "{photons}");
            assert!((paths - 1.0).abs() < 0.045, "{paths}");
        }
        Ok(())
    }
}
