//! Spectra, and how a standard observer sees them.

mod chromaticity;
mod dominant;
mod draw;
mod observer;
mod phosphor;
mod rendering;
mod spectrum;
mod standard;
mod table;
mod temperature;
mod tristimulus;

pub use chromaticity::Chromaticity;
pub use dominant::{DominantWavelength, WavelengthKind, dominant_wavelength};
pub(crate) use draw::CombScatter;
pub use draw::SpectralDraw;
pub use observer::{MAX_EFFICACY, VISIBLE};
pub(crate) use observer::{colour_matching, colour_matching_10_deg, luminous_efficiency};
pub use phosphor::PhosphorWhite;
pub use rendering::{ColourRendering, colour_rendering};
pub use spectrum::{NoSpectrum, Spectrum};
pub use standard::{
    DaylightPhase, blackbody, equal_energy, gaussian, illuminant_a, illuminant_d65,
};
pub use table::SpectralTable;
pub use temperature::{ColourTemperature, correlated_colour_temperature};
pub use tristimulus::{sampled, tristimulus};
