//! Wavelengths drawn from a spectrum.

use crate::colour::chromaticity::Chromaticity;
use crate::colour::observer::{colour_matching, luminous_efficiency};
use crate::colour::spectrum::Spectrum;
use glam::{DVec2, DVec3};

/// Shares of the draws in proportion to luminous flux, to the sum of the three tristimulus values, and to radiant flux, 1. A draw
/// then has at most some 1/0.6 of the mean luminous flux, and no visible light is missed.
const SHARES: [f64; 3] = [0.6, 0.3, 0.1];

/// Offsets in a band for which scatter is judged.
const OFFSETS: u32 = 64;

/// Root mean square deviations of the light of a few wavelengths from that of their spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CombScatter {
    /// Of the luminous flux, relative.
    pub(crate) flux: f64,
    /// Of the chromaticity, distance in u', v'.
    pub(crate) colour: f64,
}

/// Draws wavelengths in proportion to a spectrum, by what matters to the eye or by photons.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralDraw {
    spectrum: Spectrum,
    pieces: Vec<SpectralPiece>,
    /// Mean of V(λ) over the spectrum, 1.
    luminous: f64,
}

/// A range of wavelengths over which the density is a multiple of the spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SpectralPiece {
    /// Start and end, nm.
    range: [f64; 2],
    /// Spectrum there, 1/nm.
    values: [f64; 2],
    /// Density over spectrum, 1.
    emphasis: f64,
    /// Probability of it and of all pieces before it.
    up_to: f64,
}

impl SpectralDraw {
    /// Prepares drawing from a spectrum, more where it matters most to the eye.
    pub fn new(spectrum: Spectrum) -> Self {
        let [mean_x, mean_y, mean_z] = spectrum.tristimulus();
        let all = mean_x + mean_y + mean_z;
        let [luminous, stimuli, radiant] = SHARES;
        Self::with_emphasis(spectrum, |nm| {
            let [x, y, z] = colour_matching(nm);
            luminous * y / mean_y + stimuli * (x + y + z) / all + radiant
        })
    }

    /// Prepares drawing in proportion to the number of photons, each of the energy hc/λ.
    pub fn of_photons(spectrum: Spectrum) -> Self {
        Self::with_emphasis(spectrum, |nm| nm)
    }

    /// Prepares drawing with a density over spectrum in proportion to a function of the wavelength, nm.
    fn with_emphasis(spectrum: Spectrum, emphasis: impl Fn(f64) -> f64) -> Self {
        let mut up_to = 0.0;
        let mut pieces: Vec<SpectralPiece> = Vec::new();
        for range in spectrum.pieces() {
            let [low, high] = range;
            let values = range.map(|nm| spectrum.at(nm));
            let emphasis = emphasis(0.5 * (low + high));
            up_to += 0.5 * (high - low) * (values[0] + values[1]) * emphasis;
            pieces.push(SpectralPiece { range, values, emphasis, up_to });
        }
        // The emphasis at the middle of a piece is not its mean, so probabilities do not add up to 1 by themselves.
        for piece in &mut pieces {
            piece.emphasis /= up_to;
            piece.up_to /= up_to;
        }
        let luminous = spectrum.integral(luminous_efficiency);
        Self { spectrum, pieces, luminous }
    }

    /// The spectrum.
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// The wavelength of a number in [0, 1), nm.
    pub fn sample(&self, u: f64) -> f64 {
        let last = self.pieces.len() - 1;
        let place = self.pieces.partition_point(|piece| piece.up_to <= u).min(last);
        let piece = &self.pieces[place];
        let before = place.checked_sub(1).map_or(0.0, |before| self.pieces[before].up_to);
        let share = ((u - before) / (piece.up_to - before)).clamp(0.0, 1.0);
        let ([low, high], [a, b]) = (piece.range, piece.values);
        // The cumulative density of a linear one, inverted: t (2a + t (b - a)) = share (a + b).
        let root = (a * a + share * (b * b - a * a)).max(0.0).sqrt();
        low + (high - low) * (share * (a + b) / (a + root)).min(1.0)
    }

    /// Luminous flux at a wavelength, as a share of all luminous flux, 1/nm.
    pub fn luminous(&self, nm: f64) -> f64 {
        self.spectrum.at(nm) * luminous_efficiency(nm) / self.luminous
    }

    /// Luminous flux of a draw over the mean of all draws, 1; 0 at wavelengths that are never drawn.
    pub fn relative_flux(&self, nm: f64) -> f64 {
        self.piece(nm)
            .map_or(0.0, |piece| luminous_efficiency(nm) / (self.luminous * piece.emphasis))
    }

    /// Radiant flux of a draw over the mean of all draws, 1; 0 at wavelengths that are never drawn.
    pub fn relative_power(&self, nm: f64) -> f64 {
        self.piece(nm).map_or(0.0, |piece| 1.0 / piece.emphasis)
    }

    /// How much the light of one wavelength of each of this many bands of equal probability, all at the same random offset in their bands, differs from
    /// that of the whole spectrum.
    pub(crate) fn scatter_by(&self, bands: u32) -> CombScatter {
        let stimuli = |offset: f64| {
            let numbers = (0..bands).map(|band| (f64::from(band) + offset) / f64::from(bands));
            let drawn = numbers.map(|u| {
                let nm = self.sample(u);
                self.relative_power(nm) * DVec3::from_array(colour_matching(nm))
            });
            drawn.sum::<DVec3>() / f64::from(bands)
        };
        let mean = DVec3::from_array(self.spectrum.tristimulus());
        // Without light there is no colour, so that such bands are too few.
        let coordinates = |light: DVec3| {
            Chromaticity::from_tristimulus(light.to_array())
                .map_or(DVec2::NAN, |colour| DVec2::from_array(colour.uv_1976()))
        };
        let offsets = (0..OFFSETS).map(|place| (f64::from(place) + 0.5) / f64::from(OFFSETS));
        let squares = offsets.map(stimuli).map(|light| {
            let flux = (light.y / mean.y - 1.0).powi(2);
            DVec2::new(flux, coordinates(light).distance_squared(coordinates(mean)))
        });
        let [flux, colour] =
            (squares.sum::<DVec2>() / f64::from(OFFSETS)).to_array().map(f64::sqrt);
        CombScatter { flux, colour }
    }

    /// A wavelength of each range of wavelengths that are drawn, nm.
    pub(crate) fn places(&self) -> impl Iterator<Item = f64> {
        let drawn = self.pieces.iter().filter(|piece| piece.values != [0.0; 2]);
        drawn.map(|piece| 0.5 * (piece.range[0] + piece.range[1]))
    }

    /// Probability density of a wavelength, 1/nm.
    pub fn density(&self, nm: f64) -> f64 {
        self.piece(nm).map_or(0.0, |piece| piece.emphasis * self.spectrum.at(nm))
    }

    fn piece(&self, nm: f64) -> Option<&SpectralPiece> {
        let [first, last] = [self.pieces[0].range[0], self.pieces[self.pieces.len() - 1].range[1]];
        if !(first..=last).contains(&nm) {
            return None;
        }
        self.pieces.get(self.pieces.partition_point(|piece| piece.range[1] < nm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::spectrum::NoSpectrum;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_mean_of_weighted_draws_is_the_integral(
            values in proptest::collection::vec(0.0..1.0f64, 2..12),
            line in 390.0..770.0f64,
        ) {
            let step = 405.0 / (values.len() - 1) as f64;
            let table: Vec<_> = values.iter().enumerate().map(|(i, v)| [377.5 + step * i as f64, 1e-6 + v]).collect();
            let spectrum = Spectrum::new(&table)
                .and_then(|even| Spectrum::sum(&[(0.7, even), (0.3, Spectrum::line(line)?)]));
            let spectrum = spectrum.map_err(|none: NoSpectrum| TestCaseError::fail(none.to_string()))?;
            let draw = SpectralDraw::new(spectrum.clone());
            let count = 20_000;
            let mut sums = [0.0; 4];
            for i in 0..count {
                let nm = draw.sample((f64::from(i) + 0.5) / f64::from(count));
                let weight = spectrum.at(nm) / draw.density(nm) / f64::from(count);
                let flux = draw.luminous(nm) / draw.density(nm);
                prop_assert!((draw.relative_flux(nm) / flux - 1.0).abs() < 1e-9);
                let [x, y, z] = colour_matching(nm);
                for (sum, value) in sums.iter_mut().zip([x, y, z, 1.0]) {
                    *sum += weight * value;
                }
            }
            let [x, y, z] = spectrum.tristimulus();
            for (sum, expected) in sums.into_iter().zip([x, y, z, 1.0]) {
                prop_assert!((sum / expected - 1.0).abs() < 2e-3, "{sum} {expected}");
            }
        }
    }

    #[test]
    fn few_wavelengths_know_narrow_spectra_better_than_broad_ones() -> Result<(), NoSpectrum> {
        let scatter = |spectrum: Spectrum, bands| SpectralDraw::new(spectrum).scatter_by(bands);
        let line = scatter(Spectrum::line(546.1)?, 1);
        assert!(line.flux < 1e-4 && line.colour < 1e-4, "{line:?}");
        let red = Spectrum::of_law(|nm| crate::colour::gaussian(nm, 630.0, 18.0))?;
        let [one, two] = [1, 2].map(|bands| scatter(red.clone(), bands));
        assert!((0.03..0.05).contains(&one.flux) && two.flux < 0.7 * one.flux, "{one:?} {two:?}");
        let daylight = scatter(Spectrum::of_law(crate::colour::illuminant_d65)?, 5);
        assert!(daylight.flux < 0.03 && daylight.colour > 0.03, "{daylight:?}");
        Ok(())
    }

    #[test]
    fn ends_of_the_unit_interval_are_wavelengths_of_the_spectrum() -> Result<(), NoSpectrum> {
        let draw = SpectralDraw::new(Spectrum::line(600.0)?);
        for u in [0.0, 0.5, 1.0 - f64::EPSILON] {
            let nm = draw.sample(u);
            assert!((nm - 600.0).abs() <= 0.01, "{nm}");
        }
        assert!((draw.sample(0.5) - 600.0).abs() < 1e-6);
        assert_eq!((draw.density(601.0), draw.relative_flux(601.0)), (0.0, 0.0));
        Ok(())
    }
}
