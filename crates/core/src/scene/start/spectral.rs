//! Wavelengths of paths, and their weights.
//!
//! A path has one wavelength. Photons draw theirs from the spectrum of their source, gather paths from those of all sources
//! in proportion to their flux. The spectral weight makes means of luminous flux independent of
//! how wavelengths are drawn. In a scene without spectra every path has the reference wavelength and a spectral weight of 1, and no number is
//! drawn.
//!
//! Photons only meet records of their own wavelength, so those of a pass share a few: docs/method.md, eq. (41).

use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::{DrawnWavelength, Scene, Source, SourceId, Wavelengths};

impl Source {
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

    /// The wavelength of a photon of a source.
    #[inline]
    pub(crate) fn photon_wavelength(
        &self,
        source: SourceId,
        wavelengths: Wavelengths,
        sampler: &mut Sampler<impl Numbers>,
    ) -> DrawnWavelength {
        let Some(spectrum) = &self.sources[source.index()].spectrum else {
            return DrawnWavelength::REFERENCE;
        };
        let bands = &self.spectra.bands[source.index()];
        wavelengths.of((spectrum, bands), sampler.one(Dimension::Wavelength))
    }

    /// The wavelength of a gather path.
    pub(crate) fn gather_wavelength(
        &self,
        wavelengths: Wavelengths,
        sampler: &mut Sampler<impl Numbers>,
    ) -> DrawnWavelength {
        if !self.is_spectral() {
            return DrawnWavelength::REFERENCE;
        }
        let mut left = self.source_flux() * sampler.one(Dimension::Wavelength);
        let mut last = None;
        for (index, source) in self.sources.iter().enumerate().filter(|(_, own)| own.is_lit()) {
            let Some(spectrum) = &source.spectrum else { continue };
            let drawn = (spectrum.as_ref(), &self.spectra.bands[index]);
            if left < source.flux {
                return wavelengths.of(drawn, left / source.flux);
            }
            left -= source.flux;
            last = Some(drawn);
        }
        // Rounding of a sum of fluxes.
        let at_end = |drawn| wavelengths.of(drawn, 1.0f64.next_down());
        last.map_or(DrawnWavelength::REFERENCE, at_end)
    }

    /// n/p of docs/method.md, eq. (41), the weight of pairs: records of a band receive only the light of its spectrum, a share p of all, and of
    /// the band, 1/n of that.
    #[inline]
    pub(crate) fn pair_weight(&self, band: u32) -> f64 {
        self.spectra.pair_weights.get(band as usize).copied().unwrap_or(1.0)
    }

    /// The same for light of a source.
    #[inline]
    pub(crate) fn pair_weight_of(&self, source: SourceId) -> f64 {
        self.pair_weight(self.spectra.bands[source.index()].start)
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
            for of_path in [|_| Wavelengths::All, |path| Wavelengths::of_pass(2, path)] {
                let (mut photons, mut paths) = (0.0, 0.0);
                for path in 0..COUNT {
                    let mut sampler = Sampler::for_path(1, index as u64, path);
                    let id = SourceId::new(index);
                    let photon = scene.photon_wavelength(id, of_path(path), &mut sampler);
                    photons += source.spectral_weight(photon.nm);
                    let path = scene.gather_wavelength(of_path(path), &mut sampler);
                    paths += scene.gathered_spectral_weight(id, path.nm);
                }
                let [photons, paths] = [photons, paths].map(|sum| sum / COUNT as f64);
                // Five standard errors: weights of photons scatter by 0.4, those of paths by 1.8, as a quarter of them see the line.
                assert!((photons - 1.0).abs() < 0.01, "{photons}");
                assert!((paths - 1.0).abs() < 0.045, "{paths}");
            }
        }
        Ok(())
    }

    #[test]
    fn bands_belong_to_a_spectrum_and_have_one_wavelength_in_a_pass() -> Result<(), NoSpectrum> {
        let scene = scene()?;
        // The dark lamp has the spectrum of the white one, the line its own.
        let [white, dark, line] = [0, 1, 2].map(|source| scene.spectra.bands[source].clone());
        assert_eq!((&white, line.len()), (&dark, 1));
        assert!((5..=8).contains(&white.len()) && line.start == white.end, "{white:?} {line:?}");
        assert!(!scene.spectra.are_narrow());
        let share = |source| scene.pair_weight_of(SourceId::new(source));
        assert!((share(0) - white.len() as f64 / 0.75).abs() < 1e-12, "{}", share(0));
        assert!((share(2) - 4.0).abs() < 1e-12, "{}", share(2));
        let of_pass = Wavelengths::of_pass(5, 7);
        let mut known = vec![None; line.end as usize];
        for path in 0..2000 {
            let mut sampler = Sampler::for_path(1, 0, path);
            let photon = scene.photon_wavelength(SourceId::new(0), of_pass, &mut sampler);
            let gather = scene.gather_wavelength(of_pass, &mut sampler);
            assert!(white.contains(&photon.band));
            for drawn in [photon, gather] {
                let nm = known[drawn.band as usize].get_or_insert(drawn.nm);
                assert_eq!(*nm, drawn.nm, "photons and gather paths of a band");
            }
        }
        assert!(known.iter().all(Option::is_some), "{known:?}");
        Ok(())
    }
}
