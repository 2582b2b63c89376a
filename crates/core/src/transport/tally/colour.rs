//! Colour of the light on a sensor, counted beside its flux.

use crate::colour::{MAX_EFFICACY, VISIBLE, colour_matching, colour_matching_10_deg};

/// Width of a bin of the spectrum, nm.
pub(crate) const BIN_WIDTH: f64 = 5.0;
/// Middle of the first bin, nm.
pub(crate) const FIRST_BIN: f64 = VISIBLE[0] + 0.5 * BIN_WIDTH;
/// Bins of the spectrum, about 380, 385, ... 780 nm.
pub(crate) const SPECTRUM_BINS: usize = ((VISIBLE[1] - VISIBLE[0]) / BIN_WIDTH) as usize;

/// What is counted of light beside its luminous flux Y.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stimulus {
    /// Tristimulus value X, in units in which Y is in lm.
    X,
    /// Tristimulus value Z, likewise.
    Z,
    /// Radiant flux, W.
    Radiant,
    /// Tristimulus value X of the CIE 1964 observer, in units in which equal energy has Y in lm.
    X10,
    /// Tristimulus value Y, likewise.
    Y10,
    /// Tristimulus value Z, likewise.
    Z10,
}

impl Stimulus {
    /// All of them, in the order of the scalars.
    pub(crate) const ALL: [Self; 6] =
        [Self::X, Self::Z, Self::Radiant, Self::X10, Self::Y10, Self::Z10];
}

/// The stimuli of light of one wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stimuli {
    /// By [`Stimulus::ALL`].
    pub(crate) values: [f64; Stimulus::ALL.len()],
    /// The bin of the spectrum.
    pub(crate) bin: usize,
}

impl Stimuli {
    /// Those of a luminous flux at a wavelength, nm.
    #[inline]
    pub(crate) fn of(flux: f64, nm: f64) -> Self {
        let [x, y, z] = colour_matching(nm);
        let wide = colour_matching_10_deg(nm);
        let bin = ((nm - VISIBLE[0]) / BIN_WIDTH) as usize;
        let [x10, y10, z10] = wide.map(|own| own / y);
        let per_lumen = [x / y, z / y, 1.0 / (MAX_EFFICACY * y), x10, y10, z10];
        Self { values: per_lumen.map(|own| flux * own), bin: bin.min(SPECTRUM_BINS - 1) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lumen_of_green_has_its_watts_and_its_stimuli() {
        // CIE 1931 at 555 nm: 0.5120501, 1, 0.00574999.
        let [x, z, watts, x10, y10, z10] = Stimuli::of(MAX_EFFICACY, 555.0).values;
        assert!((watts - 1.0).abs() < 1e-12);
        assert!((x / MAX_EFFICACY - 0.5120501).abs() < 1e-7, "{x}");
        assert!((z / MAX_EFFICACY - 0.00574999).abs() < 1e-7, "{z}");
        // CIE 1964 at 555 nm.
        for (found, known) in [x10, y10, z10].into_iter().zip([0.616053, 0.999110, 0.001091]) {
            assert!((found / MAX_EFFICACY - known).abs() < 1e-6, "{found}");
        }
    }

    #[test]
    fn every_visible_wavelength_has_a_bin() {
        for nm in [377.5, 380.0, 382.6, 777.4, 779.9, 782.5] {
            let bin = Stimuli::of(1.0, nm).bin;
            assert!((380.0 + BIN_WIDTH * bin as f64 - nm).abs() <= 2.5 + 1e-9);
        }
    }
}
