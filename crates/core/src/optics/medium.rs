//! Media: refractive index, absorption, scattering and fluorescence.

use crate::optics::dispersion::{CoefficientLaw, IndexLaw};
use crate::optics::{Fluorescence, VolumeScattering};
use std::sync::Arc;

/// A homogeneous medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    name: String,
    index: IndexLaw,
    absorption: CoefficientLaw,
    turbidity: Option<Turbidity>,
    fluorescence: Option<Arc<Fluorescence>>,
}

/// Scattering of a medium by wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct Turbidity {
    /// Scattering coefficient: the reciprocal of the mean free path.
    pub coefficient: CoefficientLaw,
    /// Mean cosine of the scattering angle, 1, between -1 and 1.
    pub anisotropy: f64,
}

impl Medium {
    /// A medium of constant refractive index and absorption coefficient, in 1/mm, (natural logarithm).
    pub fn new(name: &str, index: f64, absorption_per_mm: f64) -> Self {
        let absorption = CoefficientLaw::Constant(absorption_per_mm);
        Self::dispersive(name, IndexLaw::Constant(index), absorption)
    }

    /// A medium by its laws.
    pub fn dispersive(name: &str, index: IndexLaw, absorption: CoefficientLaw) -> Self {
        Self { name: name.to_owned(), index, absorption, turbidity: None, fluorescence: None }
    }

    /// The same medium, turbid.
    pub fn with_scattering(self, turbidity: Turbidity) -> Self {
        Self { turbidity: Some(turbidity), ..self }
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
    pub fn absorption_law(&self) -> &CoefficientLaw {
        &self.absorption
    }

    /// Scattering of the medium at any wavelength; `None` for a clear medium.
    #[inline]
    pub fn turbidity(&self) -> Option<&Turbidity> {
        self.turbidity.as_ref()
    }

    /// Scattering of the medium at a wavelength, in nm; `None` where it is clear.
    #[inline]
    pub fn scattering(&self, wavelength: f64) -> Option<VolumeScattering> {
        let Turbidity { coefficient, anisotropy } = self.turbidity.as_ref()?;
        let coefficient = coefficient.at(wavelength);
        (coefficient > 0.0).then(|| VolumeScattering::new(coefficient, *anisotropy))
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
