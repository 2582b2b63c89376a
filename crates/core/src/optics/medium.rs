//! Media: refractive index, absorption, scattering and fluorescence.

use crate::optics::dispersion::{AbsorptionLaw, IndexLaw};
use crate::optics::{Fluorescence, VolumeScattering};
use std::sync::Arc;

/// A homogeneous medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    name: String,
    index: IndexLaw,
    absorption: AbsorptionLaw,
    scattering: Option<VolumeScattering>,
    fluorescence: Option<Arc<Fluorescence>>,
}

impl Medium {
    /// A medium of constant refractive index and absorption coefficient, in 1/mm, (natural logarithm).
    pub fn new(name: &str, index: f64, absorption_per_mm: f64) -> Self {
        let absorption = AbsorptionLaw::Constant(absorption_per_mm);
        Self::dispersive(name, IndexLaw::Constant(index), absorption)
    }

    /// A medium by its laws.
    pub fn dispersive(name: &str, index: IndexLaw, absorption: AbsorptionLaw) -> Self {
        Self { name: name.to_owned(), index, absorption, scattering: None, fluorescence: None }
    }

    /// The same medium, turbid.
    pub fn with_scattering(self, scattering: VolumeScattering) -> Self {
        Self { scattering: Some(scattering), ..self }
    }

    /// The same medium with phosphors or dyes in it.
    pub fn with_fluorescence(self, fluorescence: Fluorescence) -> Self {
        Self { fluorescence: Some(Arc::new(fluorescence)), ..self }
    }

    /// Its name in the scene file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Refractive index at a wavelength, in nm; 1.
    #[inline]
    pub fn index(&self, wavelength: f64) -> f64 {
        self.index.at(wavelength)
    }

    /// Absorption coefficient at a wavelength, in nm; 1/mm.
    #[inline]
    pub fn absorption(&self, wavelength: f64) -> f64 {
        self.absorption.at(wavelength)
    }

    /// Its refractive index by wavelength.
    pub fn index_law(&self) -> &IndexLaw {
        &self.index
    }

    /// Its absorption coefficient by wavelength.
    pub fn absorption_law(&self) -> &AbsorptionLaw {
        &self.absorption
    }

    /// Scattering of the medium; `None` for a clear medium.
    #[inline]
    pub fn scattering(&self) -> Option<&VolumeScattering> {
        self.scattering.as_ref()
    }

    /// Fluorescence of the medium, if it has any.
    #[inline]
    pub fn fluorescence(&self) -> Option<&Fluorescence> {
        self.fluorescence.as_deref()
    }

    /// Share of the flux that survives `length` mm without its fluorescence: Beer-Lambert, exp(-αl).
    #[inline]
    pub(crate) fn transmittance(&self, wavelength: f64, length: f64) -> f64 {
        let absorption = self.absorption(wavelength);
        if absorption == 0.0 { 1.0 } else { (-absorption * length).exp() }
    }
}
