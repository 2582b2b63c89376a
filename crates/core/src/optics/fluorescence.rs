//! Fluorescence within a medium: light that phosphors or dyes absorb and emit at other wavelengths.
//!
//! This module knows one point in a medium. Emission is isotropic, unpolarised and without delay.

use crate::colour::{MAX_EFFICACY, SpectralDraw, Spectrum, luminous_efficiency};
use crate::optics::CoefficientLaw;

/// Fluorescent particles or molecules, evenly distributed.
#[derive(Debug, Clone, PartialEq)]
pub struct Fluorescence {
    absorption: CoefficientLaw,
    quantum_yield: f64,
    /// Drawn by photons, so that light of many conversions keeps the number of its photons, but for the yield.
    emission: SpectralDraw,
    /// Mean wavelength of the radiant flux of the emission, nm.
    mean_wavelength: f64,
    /// Mean of the luminous efficiency over the radiant flux of the emission, 1.
    luminous: f64,
}

/// Light that has been absorbed and emitted again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reemission {
    /// Wavelength, nm.
    pub(crate) wavelength: f64,
    /// Luminous flux after over luminous flux before, 1.
    pub(crate) factor: f64,
    /// Radiant flux that becomes heat, over luminous flux before, W/lm.
    pub(crate) heat: f64,
}

impl Fluorescence {
    /// Fluorescence by an absorption coefficient, the mean number of visible photons emitted for each one absorbed, from 0
    /// to 1, and the spectrum of their radiant flux.
    pub fn new(absorption: CoefficientLaw, quantum_yield: f64, emission: Spectrum) -> Self {
        debug_assert!((0.0..=1.0).contains(&quantum_yield), "{quantum_yield} photons for each one");
        let mean_wavelength = emission.mean_wavelength();
        let luminous = emission.efficacy() / MAX_EFFICACY;
        let emission = SpectralDraw::of_photons(emission);
        Self { absorption, quantum_yield, emission, mean_wavelength, luminous }
    }

    /// Its absorption coefficient by wavelength.
    pub fn absorption_law(&self) -> &CoefficientLaw {
        &self.absorption
    }

    /// Photons emitted for each one absorbed, 1.
    pub fn quantum_yield(&self) -> f64 {
        self.quantum_yield
    }

    /// The spectrum of its emission.
    pub fn emission(&self) -> &Spectrum {
        self.emission.spectrum()
    }

    /// Radiant flux emitted over radiant flux absorbed at a wavelength, nm: a photon of wavelength λ has the energy hc/λ, so
    /// the spectrum s(λ') of the emission, whose integral is 1, holds ∫ s λ' dλ' / hc photons per joule, and the share is
    /// the quantum yield times λ / ∫ s λ' dλ'.
    pub fn power_yield(&self, wavelength: f64) -> f64 {
        self.quantum_yield * wavelength / self.mean_wavelength
    }

    /// Luminous flux emitted over luminous flux absorbed at a wavelength, nm, on average.
    pub(crate) fn luminous_yield(&self, wavelength: f64) -> f64 {
        self.power_yield(wavelength) * self.luminous / luminous_efficiency(wavelength)
    }

    /// Distance that light travels before it is absorbed, mm, for uniform `u` in [0, 1): density `α exp(-α s)`, in 1/mm.
    #[inline]
    pub(crate) fn free_path(&self, wavelength: f64, u: impl FnOnce() -> f64) -> f64 {
        let absorption = self.absorption.at(wavelength);
        if absorption == 0.0 { f64::INFINITY } else { -(-u()).ln_1p() / absorption }
    }

    /// What becomes of absorbed light, for uniform `u`. Its heat is the mean over the emission; it is negative where light of
    /// a longer wavelength than the mean of the emission is absorbed, and thermal energy makes up the difference.
    pub(crate) fn emit(&self, wavelength: f64, u: f64) -> Reemission {
        let (drawn, power) = (self.emission.sample(u), self.power_yield(wavelength));
        let before = luminous_efficiency(wavelength);
        let luminous = self.emission.relative_power(drawn) * luminous_efficiency(drawn) / before;
        Reemission {
            wavelength: drawn,
            factor: power * luminous,
            heat: (1.0 - power) / (MAX_EFFICACY * before),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{NoSpectrum, gaussian};

    fn phosphor() -> Result<Fluorescence, NoSpectrum> {
        let emission = Spectrum::of_law(|nm| gaussian(nm, 560.0, 120.0))?;
        Ok(Fluorescence::new(CoefficientLaw::Constant(2.0), 0.9, emission))
    }

    #[test]
    fn as_many_photons_are_emitted_as_the_yield_says() -> Result<(), NoSpectrum> {
        const COUNT: u32 = 20_000;
        let phosphor = phosphor()?;
        for wavelength in [380.0, 450.0, 500.0] {
            let (mut photons, mut power) = (0.0, 0.0);
            for step in 0..COUNT {
                let out = phosphor.emit(wavelength, (f64::from(step) + 0.5) / f64::from(COUNT));
                let radiant = out.factor * luminous_efficiency(wavelength)
                    / luminous_efficiency(out.wavelength);
                power += radiant / f64::from(COUNT);
                photons += radiant * out.wavelength / wavelength / f64::from(COUNT);
            }
            assert!((photons - 0.9).abs() < 1e-3, "{photons} photons");
            assert!((power - phosphor.power_yield(wavelength)).abs() < 1e-3, "{power}");
            let heat = phosphor.emit(wavelength, 0.5).heat * MAX_EFFICACY;
            assert!((heat * luminous_efficiency(wavelength) + power - 1.0).abs() < 1e-3);
        }
        Ok(())
    }

    #[test]
    fn the_mean_distance_is_the_inverse_of_the_absorption() -> Result<(), NoSpectrum> {
        const COUNT: u32 = 20_000;
        let phosphor = phosphor()?;
        let at = |step: u32| (f64::from(step) + 0.5) / f64::from(COUNT);
        let sum: f64 = (0..COUNT).map(|step| phosphor.free_path(450.0, || at(step))).sum();
        assert!((sum / f64::from(COUNT) - 0.5).abs() < 1e-3);
        let clear = Fluorescence { absorption: CoefficientLaw::Constant(0.0), ..phosphor };
        assert_eq!(clear.free_path(450.0, || unreachable!("no number is drawn")), f64::INFINITY);
        Ok(())
    }
}
