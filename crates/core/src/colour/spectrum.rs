//! The spectrum of light, relative to its whole.

use crate::colour::observer::{MAX_EFFICACY, VISIBLE, colour_matching, luminous_efficiency};
use crate::colour::table::between_rows;

/// Half the width of a spectral line where it is zero, nm: far below what dispersion resolves.
const LINE_HALF_WIDTH: f64 = 0.01;

/// Radiant flux by wavelength, as a share of all radiant flux of the visible range, 1/nm: linear between knots.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Wavelength, nm, strictly ascending, and share, 1/nm.
    knots: Vec<[f64; 2]>,
}

/// Why a table is not a spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoSpectrum {
    /// Fewer than two wavelengths.
    #[error("it has fewer than two wavelengths")]
    TooShort,
    /// Wavelengths do not ascend.
    #[error("its wavelengths do not ascend")]
    NotAscending,
    /// A value is negative or not a number.
    #[error("it has a value that is negative or not a number")]
    Negative,
    /// All is zero in the visible range.
    #[error("it has no light from 380 to 780 nm")]
    Dark,
}

impl Spectrum {
    /// The spectrum of a table of wavelength, nm, and radiant flux per wavelength in any unit. Light outside of the visible
    /// range is left out.
    ///
    /// # Errors
    ///
    /// [`NoSpectrum`] if it is too short, does not ascend, has a negative value or no visible light.
    pub fn new(table: &[[f64; 2]]) -> Result<Self, NoSpectrum> {
        if table.len() < 2 {
            return Err(NoSpectrum::TooShort);
        }
        if table
            .windows(2)
            .any(|pair| pair[0][0].partial_cmp(&pair[1][0]).is_none_or(|o| o.is_ge()))
        {
            return Err(NoSpectrum::NotAscending);
        }
        if table.iter().any(|[_, value]| !value.is_finite() || *value < 0.0) {
            return Err(NoSpectrum::Negative);
        }
        Self::normalised(visible_part(table))
    }

    /// The share of the radiant flux of such a table that is visible, 1; not a number if there is none.
    pub fn visible_share(table: &[[f64; 2]]) -> f64 {
        trapezium(&visible_part(table)) / trapezium(table)
    }

    /// The spectrum of a law, tabulated every nm: radiant flux per wavelength in any unit, at a wavelength in nm.
    ///
    /// # Errors
    ///
    /// As [`Self::new`].
    pub fn of_law(law: impl Fn(f64) -> f64) -> Result<Self, NoSpectrum> {
        let [first, last] = VISIBLE;
        let whole = (first.ceil() as u32..=last as u32).map(f64::from);
        let places = std::iter::once(first).chain(whole).chain(std::iter::once(last));
        Self::new(&places.map(|nm| [nm, law(nm)]).collect::<Vec<_>>())
    }

    /// A spectral line: a triangle 0.01 nm wide at half height.
    ///
    /// # Errors
    ///
    /// [`NoSpectrum::Dark`] if it is not visible.
    pub fn line(nm: f64) -> Result<Self, NoSpectrum> {
        let [first, last] = VISIBLE;
        if nm - LINE_HALF_WIDTH < first || nm + LINE_HALF_WIDTH > last {
            return Err(NoSpectrum::Dark);
        }
        Self::new(&[[nm - LINE_HALF_WIDTH, 0.0], [nm, 1.0], [nm + LINE_HALF_WIDTH, 0.0]])
    }

    /// Light of several spectra, each with its radiant flux in any unit.
    ///
    /// # Errors
    ///
    /// [`NoSpectrum::Dark`] if there is no light.
    pub fn sum(parts: &[(f64, Self)]) -> Result<Self, NoSpectrum> {
        let mut places: Vec<f64> =
            parts.iter().flat_map(|(_, part)| part.knots.iter().map(|[nm, _]| *nm)).collect();
        places.sort_by(f64::total_cmp);
        places.dedup();
        let value = |nm: f64| parts.iter().map(|(flux, part)| flux * part.at(nm)).sum();
        Self::normalised(places.into_iter().map(|nm| [nm, value(nm)]).collect())
    }

    fn normalised(mut knots: Vec<[f64; 2]>) -> Result<Self, NoSpectrum> {
        let total = trapezium(&knots);
        if !(total > 0.0 && total.is_finite()) {
            return Err(NoSpectrum::Dark);
        }
        knots.iter_mut().for_each(|[_, value]| *value /= total);
        Ok(Self { knots })
    }

    /// Share of the radiant flux per wavelength, 1/nm; 0 outside of the knots.
    pub fn at(&self, nm: f64) -> f64 {
        let inside = nm >= self.knots[0][0] && nm <= self.knots[self.knots.len() - 1][0];
        if inside { between_rows(&self.knots, nm) } else { 0.0 }
    }

    /// Luminous efficacy of its radiation of the visible range, lm/W.
    pub fn efficacy(&self) -> f64 {
        MAX_EFFICACY * self.integral(luminous_efficiency)
    }

    /// Its tristimulus values: the integrals of the spectrum times the colour-matching functions, 1.
    pub fn tristimulus(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.integral(|nm| colour_matching(nm)[axis]))
    }

    /// Mean wavelength of its radiant flux, nm.
    pub fn mean_wavelength(&self) -> f64 {
        let mean = |pair: &[[f64; 2]]| {
            let [[low, at_low], [high, at_high]] = [pair[0], pair[1]];
            let middle = (low + high) * (at_low + at_high);
            (high - low) / 6.0 * (low * at_low + middle + high * at_high)
        };
        // Simpson's rule, exact for the product of two linear functions.
        self.knots.windows(2).map(mean).sum()
    }

    /// Share of its radiant flux from one wavelength to another, nm.
    pub fn share(&self, [from, to]: [f64; 2]) -> f64 {
        let pieces = self.pieces().filter_map(|[low, high]| {
            let [low, high] = [low.max(from), high.min(to)];
            (low < high).then(|| 0.5 * (high - low) * (self.at(low) + self.at(high)))
        });
        pieces.sum()
    }

    /// The integral of the spectrum times a function that is linear between whole nm.
    pub fn integral(&self, function: impl Fn(f64) -> f64) -> f64 {
        let value = |nm: f64| self.at(nm) * function(nm);
        // Simpson's rule is exact for products of linear functions.
        let piece = |[low, high]: [f64; 2]| {
            (high - low) / 6.0 * (value(low) + 4.0 * value(0.5 * (low + high)) + value(high))
        };
        self.pieces().map(piece).sum()
    }

    /// Ranges of wavelengths, ascending, nm, within which it and functions tabulated at whole nm are linear.
    pub(super) fn pieces(&self) -> impl Iterator<Item = [f64; 2]> {
        self.knots.windows(2).flat_map(|pair| {
            let [low, high] = [pair[0][0], pair[1][0]];
            let whole = (low.floor() as u32 + 1)..(high.ceil() as u32);
            let inner = whole.map(f64::from);
            let starts = std::iter::once(low).chain(inner.clone());
            starts.zip(inner.chain(std::iter::once(high))).map(|(from, to)| [from, to])
        })
    }
}

/// The part of a table of two or more rows within the visible range.
fn visible_part(table: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let [first, last] = VISIBLE;
    let [start, end] = [table[0][0], table[table.len() - 1][0]];
    let at = |nm: f64| (start <= nm && nm <= end).then(|| [nm, between_rows(table, nm)]);
    let within = table.iter().copied().filter(|[nm, _]| *nm > first && *nm < last);
    at(first).into_iter().chain(within).chain(at(last)).collect()
}

fn trapezium(table: &[[f64; 2]]) -> f64 {
    table.windows(2).map(|pair| 0.5 * (pair[1][0] - pair[0][0]) * (pair[0][1] + pair[1][1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_cut_to_the_visible_range() -> Result<(), NoSpectrum> {
        let spectrum = Spectrum::new(&[[300.0, 1.0], [900.0, 1.0]])?;
        let share = Spectrum::visible_share(&[[300.0, 1.0], [900.0, 1.0]]);
        assert!((share - 405.0 / 600.0).abs() < 1e-12, "{share}");
        assert!((spectrum.at(500.0) - 1.0 / 405.0).abs() < 1e-15);
        assert!((spectrum.share([400.0, 481.0]) - 0.2).abs() < 1e-12);
        assert_eq!(spectrum.at(377.0), 0.0);
        Ok(())
    }

    #[test]
    fn a_line_has_the_efficacy_of_its_wavelength() -> Result<(), NoSpectrum> {
        let green = Spectrum::line(555.0)?;
        assert!((green.efficacy() - MAX_EFFICACY).abs() < 1e-3, "{}", green.efficacy());
        let both = Spectrum::sum(&[(1.0, green), (3.0, Spectrum::line(620.5)?)])?;
        assert!((both.share([600.0, 640.0]) - 0.75).abs() < 1e-12);
        let expected = MAX_EFFICACY * (0.25 + 0.75 * luminous_efficiency(620.5));
        assert!((both.efficacy() - expected).abs() < 2e-3);
        Ok(())
    }

    #[test]
    fn what_is_not_a_spectrum_says_why() {
        assert_eq!(Spectrum::new(&[[500.0, 1.0]]), Err(NoSpectrum::TooShort));
        assert_eq!(Spectrum::new(&[[500.0, 1.0], [500.0, 1.0]]), Err(NoSpectrum::NotAscending));
        assert_eq!(Spectrum::new(&[[500.0, 1.0], [f64::NAN, 1.0]]), Err(NoSpectrum::NotAscending));
        assert_eq!(Spectrum::new(&[[500.0, -1.0], [600.0, 1.0]]), Err(NoSpectrum::Negative));
        assert_eq!(Spectrum::new(&[[800.0, 1.0], [900.0, 1.0]]), Err(NoSpectrum::Dark));
        assert_eq!(Spectrum::line(377.5), Err(NoSpectrum::Dark));
    }
}
