//! The spectra of the sources of a scene, as passes of gathering divide them: docs/method.md, eq. (41).

use crate::colour::{CombScatter, SpectralDraw};
use crate::scene::Source;
use std::ops::Range;

/// Largest scatter by the wavelengths of a pass for which a spectrum needs no more bands: of its flux, relative, and of its chromaticity, distance in
/// u', v'. A usual run of 24 passes knows both to a fifth of that.
const SCATTER: CombScatter = CombScatter { flux: 0.025, colour: 0.02 };
/// Largest number of bands of a spectrum: photons meet the records of one band only, so pairs are rarer by this factor.
const MOST_BANDS: u32 = 8;
/// Largest number of bands of a narrow spectrum.
const NARROW_BANDS: u32 = 4;

/// The spectra of the sources of a scene, divided into bands of equal probability, with one wavelength each in a pass.
#[derive(Debug, Clone, Default)]
pub struct SourceSpectra {
    /// By source: the bands of its spectrum, which sources of the same spectrum share.
    pub(super) bands: Vec<Range<u32>>,
    /// By band: what pairs of its photons and records are weighted by, 1.
    pub(super) pair_weights: Vec<f64>,
    /// Relative variance of the flux of all sources by the wavelengths of a pass.
    flux_variance: f64,
    /// Most bands of the spectrum of a lit source.
    most_bands: u32,
}

impl SourceSpectra {
    /// The spectra of some sources.
    pub(crate) fn new(sources: &[Source]) -> Self {
        let total: f64 = sources.iter().map(|source| source.flux).sum();
        let mut spectra = Self::default();
        let mut known: Vec<(&Source, Range<u32>)> = Vec::new();
        for source in sources {
            let is_same = |other: &&Source| other.spectrum == source.spectrum;
            let earlier = known.iter().find(|(first, _)| is_same(first));
            let bands = earlier.map(|(_, bands)| bands.clone()).unwrap_or_else(|| {
                let flux: f64 = sources.iter().filter(is_same).map(|other| other.flux).sum();
                let share = if flux > 0.0 { flux / total } else { 0.0 };
                let bands = spectra.add(source.spectrum.as_deref(), share);
                known.push((source, bands.clone()));
                bands
            });
            spectra.bands.push(bands);
        }
        spectra
    }

    /// Adds a spectrum that a share of all flux has: its bands.
    fn add(&mut self, spectrum: Option<&SpectralDraw>, share: f64) -> Range<u32> {
        let mut count = 1;
        if let Some(spectrum) = spectrum {
            let is_enough = |bands: &u32| {
                let CombScatter { flux, colour } = spectrum.scatter_by(*bands);
                flux <= SCATTER.flux && colour <= SCATTER.colour
            };
            count = (1..MOST_BANDS).find(is_enough).unwrap_or(MOST_BANDS);
            if share > 0.0 {
                self.flux_variance += (share * spectrum.scatter_by(count).flux).powi(2);
                self.most_bands = self.most_bands.max(count);
            }
        }
        let first = self.pair_weights.len() as u32;
        // No path draws the spectrum of a source without flux.
        let weight = if share > 0.0 { f64::from(count) / share } else { 0.0 };
        self.pair_weights.extend((0..count).map(|_| weight));
        first..first + count
    }

    /// Whether all are so narrow that few wavelengths know their colours; also if there are none.
    pub fn are_narrow(&self) -> bool {
        self.most_bands <= NARROW_BANDS
    }

    /// Relative variance of the flux of a pass by its wavelengths.
    pub(crate) fn flux_variance(&self) -> f64 {
        self.flux_variance
    }
}
