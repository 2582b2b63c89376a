//! All colours of the pictures: on white, safe for colour-blind readers, and distinguishable in
//! grey as well.
//!
//! Series differ in colour (Okabe & Ito, Color Universal Design, 2008) and in their dashes.

/// Red, green, blue of sRGB.
pub(crate) type Rgb = [u8; 3];

/// The paper.
pub(crate) const PAPER: Rgb = [255, 255, 255];
/// Titles, frames, tick labels.
pub(crate) const INK: Rgb = [32, 36, 42];
/// Subtitles and remarks.
pub(crate) const SOFT_INK: Rgb = [96, 102, 110];
/// Lines of a grid.
pub(crate) const GRID: Rgb = [222, 225, 230];
/// Cells without a value: outside the sensor.
pub(crate) const NEUTRAL: Rgb = [206, 209, 213];

/// Which map from values to colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ColourMap {
    /// From dark to light, for values from nothing to much.
    Sequential,
    /// From blue over white to red, for values on both sides of zero.
    Diverging,
}

impl ColourMap {
    /// The colours between which pictures and pages interpolate, evenly from one end of the range to the other.
    pub(crate) fn stops(self) -> Vec<Rgb> {
        (0..=STOPS).map(|index| self.stop(index)).collect()
    }

    /// The colour at a fraction of the range; beyond its ends, the colour of the end.
    pub(crate) fn colour(self, fraction: f64) -> Rgb {
        let place = fraction.clamp(0.0, 1.0) * f64::from(STOPS);
        let low = (place as u8).min(STOPS - 1);
        let (one, other, share) = (self.stop(low), self.stop(low + 1), place - f64::from(low));
        let mixed = |part: usize| {
            let [from, to] = [one[part], other[part]].map(f64::from);
            (from + share * (to - from)).round() as u8
        };
        [mixed(0), mixed(1), mixed(2)]
    }

    fn stop(self, index: u8) -> Rgb {
        let fraction = f64::from(index) / f64::from(STOPS);
        let colour = match self {
            Self::Sequential => colorous::INFERNO.eval_continuous(fraction),
            Self::Diverging => colorous::RED_BLUE.eval_continuous(1.0 - fraction),
        };
        [colour.r, colour.g, colour.b]
    }
}

/// Steps between the stops of a colour map; the interpolation error is invisible.
const STOPS: u8 = 32;

/// How a series is distinguished from the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SeriesInk {
    /// Colour of lines and bands.
    pub(crate) colour: Rgb,
    /// Lengths of dashes and gaps in turn, pixels; empty for a solid line.
    pub(crate) dash: &'static [f64],
}

/// Colours of series.
const COLOURS: [Rgb; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [32, 36, 42],
    [204, 121, 167],
    [86, 180, 233],
    [230, 159, 0],
];

/// Additional colours of pairs.
const MORE: [Rgb; 2] = [[94, 60, 153], [140, 81, 10]];

/// All colours of curves, those of series first.
pub(crate) fn curve_colours() -> Vec<Rgb> {
    COLOURS.into_iter().chain(MORE).collect()
}

/// The colour of pair number `index` of curves that belong together and differ in their dashes; they repeat after 9.
pub(crate) fn paired_colour(index: usize) -> Rgb {
    let index = index % (COLOURS.len() + MORE.len());
    COLOURS.get(index).copied().unwrap_or_else(|| MORE[index - COLOURS.len()])
}

/// The colour and dashes of series number `index`; they repeat after 28.
pub(crate) fn series_ink(index: usize) -> SeriesInk {
    const DASHES: [&[f64]; 4] = [&[], &[9.0, 5.0], &[2.0, 4.0], &[10.0, 4.0, 2.0, 4.0]];
    SeriesInk { colour: COLOURS[index % COLOURS.len()], dash: DASHES[index % DASHES.len()] }
}

/// The colour of outlines of kind `index`: darker than the light that is drawn among them; they repeat after 6.
pub(crate) fn outline_colour(index: usize) -> Rgb {
    const COLOURS: [Rgb; 6] =
        [[32, 36, 42], [120, 126, 134], [94, 60, 153], [140, 81, 10], [0, 90, 90], [150, 20, 60]];
    COLOURS[index % COLOURS.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(colour: Rgb) -> f64 {
        0.2126 * f64::from(colour[0])
            + 0.7152 * f64::from(colour[1])
            + 0.0722 * f64::from(colour[2])
    }

    #[test]
    fn the_sequential_map_grows_lighter_all_the_way() {
        let greys: Vec<f64> = (0..=64)
            .map(|step| grey(ColourMap::Sequential.colour(f64::from(step) / 64.0)))
            .collect();
        assert!(greys.windows(2).all(|pair| pair[0] < pair[1]), "{greys:?}");
    }

    #[test]
    fn zero_is_the_lightest_of_the_diverging_map() {
        let middle = grey(ColourMap::Diverging.colour(0.5));
        assert!(middle > 235.0);
        for fraction in [0.0, 0.25, 0.75, 1.0] {
            assert!(grey(ColourMap::Diverging.colour(fraction)) < middle - 20.0);
        }
    }

    #[test]
    fn no_two_of_the_first_28_series_look_the_same() {
        for first in 0..28 {
            for second in 0..first {
                assert_ne!(series_ink(first), series_ink(second));
            }
        }
    }
}
