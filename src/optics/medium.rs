//! Media: refractive index and absorption.

/// A homogeneous medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    name: String,
    index: f64,
    absorption: f64,
}

impl Medium {
    /// A medium of constant refractive index and absorption coefficient, in 1/mm, (natural logarithm).
    pub fn new(name: &str, index: f64, absorption_per_mm: f64) -> Self {
        Self { name: name.to_owned(), index, absorption: absorption_per_mm }
    }

    /// Its name in the scene file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Refractive index at a wavelength, in nm; 1.
    #[inline]
    pub fn index(&self, _wavelength: f64) -> f64 {
        self.index
    }

    /// Absorption coefficient at a wavelength, in nm; 1/mm.
    #[inline]
    pub fn absorption(&self, _wavelength: f64) -> f64 {
        self.absorption
    }

    /// Share of the flux that survives `length` mm: Beer-Lambert, exp(-αl).
    #[inline]
    pub fn transmittance(&self, wavelength: f64, length: f64) -> f64 {
        let absorption = self.absorption(wavelength);
        if absorption == 0.0 { 1.0 } else { (-absorption * length).exp() }
    }
}
