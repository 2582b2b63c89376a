//! A model of white LEDs: a blue die and the light of its phosphor, a Gaussian each. Such models come within a few per cent of the colour
//! temperatures and a few points of the Ra of real LEDs (Jin et al., IEEE Photonics J. 5 (2013) 1600110).
//!
//! Widths and the ranges of peaks are assumptions: they are of the order of those of indium gallium nitride dies and of cerium and europium phosphors.

use crate::colour::chromaticity::Chromaticity;
use crate::colour::standard::gaussian;
use crate::colour::temperature::planckian;
use crate::colour::tristimulus::{sampled, tristimulus};

/// Peak and full width at half maximum of the die, nm.
const DIE: [f64; 2] = [450.0, 20.0];
/// Full width at half maximum of the light of the phosphor, nm.
const PHOSPHOR_WIDTH: f64 = 120.0;
/// Peaks of phosphors, nm.
const PHOSPHORS: [f64; 2] = [540.0, 625.0];
/// Colour temperatures that phosphors of these peaks reach, K.
const TEMPERATURES: std::ops::RangeInclusive<f64> = 2000.0..=20_000.0;

/// The spectrum of a white LED on the Planckian locus: two Gaussians, a die at 450 nm and a phosphor. The peak of the phosphor
/// and the share of the die are those that give the colour; blue light leaks more, and phosphors are greener, the higher the
/// colour temperature is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhosphorWhite {
    /// Peak of the light of the phosphor, nm.
    peak: f64,
    /// Peak value of the die over that of the phosphor, 1.
    blue: f64,
}

impl PhosphorWhite {
    /// The LED of a colour temperature from 2000 to 20,000 K; `None` beyond.
    pub fn new(kelvin: f64) -> Option<Self> {
        if !TEMPERATURES.contains(&kelvin) {
            return None;
        }
        let target = planckian(kelvin);
        let die = sums(DIE);
        // Positive where the phosphor lies on the red side of the line from the die through the target.
        let side = |peak: f64| {
            let [phosphor, die] = [sums([peak, PHOSPHOR_WIDTH]), die].map(chromaticity);
            (phosphor.x - die.x) * (target.y - die.y) - (phosphor.y - die.y) * (target.x - die.x)
        };
        let [mut low, mut high] = PHOSPHORS;
        for _ in 0..48 {
            let middle = 0.5 * (low + high);
            if side(middle) < 0.0 { low = middle } else { high = middle }
        }
        let peak = 0.5 * (low + high);
        let phosphor = sums([peak, PHOSPHOR_WIDTH]);
        let excess = |of: [f64; 3]| of[0] - target.x * of.iter().sum::<f64>();
        Some(Self { peak, blue: -excess(phosphor) / excess(die) })
    }

    /// The spectrum at a wavelength in nm, 1 at the peak of the phosphor alone.
    pub fn at(self, nm: f64) -> f64 {
        let [peak, width] = DIE;
        self.blue * gaussian(nm, peak, width) + gaussian(nm, self.peak, PHOSPHOR_WIDTH)
    }
}

/// Tristimulus values of a peak.
fn sums([peak, width]: [f64; 2]) -> [f64; 3] {
    tristimulus(&sampled::<401>(|nm| gaussian(nm, peak, width)))
}

fn chromaticity(of: [f64; 3]) -> Chromaticity {
    Chromaticity::from_tristimulus(of).expect("a visible peak has light")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::{Spectrum, colour_rendering, correlated_colour_temperature};

    #[test]
    fn it_has_its_colour_temperature_on_the_locus() {
        for kelvin in [2000.0, 2700.0, 4000.0, 6500.0, 20_000.0] {
            let led = PhosphorWhite::new(kelvin).unwrap();
            let found = chromaticity(Spectrum::of_law(|nm| led.at(nm)).unwrap().tristimulus());
            let found = correlated_colour_temperature(found).unwrap();
            assert!((found.kelvin / kelvin - 1.0).abs() < 1e-3, "{found:?}");
            assert!(found.duv.abs() < 1e-4, "{found:?}");
        }
        assert_eq!([1999.0, 20_001.0, f64::NAN].map(PhosphorWhite::new), [None; 3]);
    }

    #[test]
    fn it_renders_colours_as_leds_with_one_phosphor_do() {
        // A single phosphor lacks red: Ra is near 70, and R9 below 0.
        for kelvin in [2000.0, 2700.0, 4000.0, 6500.0, 20_000.0] {
            let led = PhosphorWhite::new(kelvin).unwrap();
            let found = colour_rendering(&sampled(|nm| led.at(nm))).unwrap();
            assert!((68.0..75.0).contains(&found.general), "{found:?}");
            assert!((-45.0..0.0).contains(&found.special[8]), "{found:?}");
        }
    }
}
