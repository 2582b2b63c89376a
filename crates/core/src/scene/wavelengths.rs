//! The wavelengths that paths draw.

use crate::colour::SpectralDraw;
use crate::optics::REFERENCE_WAVELENGTH;
use crate::rng::{Dimension, Sampler, stream};
use std::ops::Range;

/// The wavelengths that paths draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wavelengths {
    /// All of a spectrum.
    All,
    /// One of each band, all at the same offset.
    OfBands {
        /// Offset in the band, from 0 to 1.
        offset: f64,
    },
}

/// The wavelength that a path has drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnWavelength {
    /// Wavelength, nm.
    pub nm: f64,
    /// Its band among those of all spectra of a scene; 0 where they are not divided.
    pub band: u32,
}

impl Wavelengths {
    /// Those of a pass.
    pub(crate) fn of_pass(seed: u64, pass: u64) -> Self {
        let mut sampler = Sampler::for_path(seed, stream::WAVELENGTHS, pass);
        Self::OfBands { offset: sampler.one(Dimension::Wavelength) }
    }

    /// A wavelength of a spectrum with these bands, for a uniform number.
    #[inline]
    pub(super) fn of(
        self,
        (spectrum, bands): (&SpectralDraw, &Range<u32>),
        u: f64,
    ) -> DrawnWavelength {
        match self {
            Self::All => DrawnWavelength { nm: spectrum.sample(u), band: 0 },
            Self::OfBands { offset } => {
                let count = f64::from(bands.end - bands.start);
                let band = (count * u).floor();
                let nm = spectrum.sample((band + offset) / count);
                DrawnWavelength { nm, band: bands.start + band as u32 }
            }
        }
    }
}

impl DrawnWavelength {
    /// That of all light without a spectrum.
    pub const REFERENCE: Self = Self { nm: REFERENCE_WAVELENGTH, band: 0 };
}
