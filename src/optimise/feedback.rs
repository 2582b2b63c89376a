//! The step of one zone: from its light to what it lacks, and from openings to lengths. Pure functions of numbers; nothing is traced here.

use lumiduct_report::optimise::Uncertain;

/// Different lengths in a millimetre: they are written with this resolution.
pub(crate) const PER_MM: f64 = 1e4;
/// Largest change of a length in one step, as a factor.
pub(crate) const LARGEST_STEP: f64 = 1.5;
/// Most of the flux that the zones before one can have taken, 1: the model has no flux beyond.
const MOST_TAKEN: f64 = 0.95;
/// Correction of a zone without any light, as the logarithm of a factor of its openings.
const DARK: f64 = 1.0;

/// Light of zones, and what is wanted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ZoneLight<'a> {
    /// Measured light.
    pub(crate) measured: &'a [Uncertain],
    /// Wanted light, up to a common factor; 0 where a zone does not count.
    pub(crate) wanted: &'a [f64],
    /// Share of the light that the pattern lets out, 1.
    pub(crate) efficiency: f64,
}

impl ZoneLight<'_> {
    /// Ratio of wanted to measured light of each zone, as a logarithm with its error, about a mean of 0; `None` where nothing is
    /// wanted.
    pub(crate) fn lack(&self) -> Vec<Option<Uncertain>> {
        let raw = self.measured.iter().zip(self.wanted).map(|(own, wanted)| {
            let lit = own.value > 0.0;
            (*wanted > 0.0).then(|| {
                if lit {
                    let value = (wanted / own.value).ln();
                    (Uncertain { value, std_error: own.std_error / own.value }, true)
                } else {
                    (Uncertain { value: DARK, std_error: 0.0 }, false)
                }
            })
        });
        let raw: Vec<Option<(Uncertain, bool)>> = raw.collect();
        let lit: Vec<f64> =
            raw.iter().flatten().filter(|own| own.1).map(|own| own.0.value).collect();
        let mean = lit.iter().sum::<f64>() / lit.len().max(1) as f64;
        raw.into_iter()
            .map(|own| {
                own.map(|(lack, is_lit)| {
                    let value = if is_lit { lack.value - mean } else { lack.value };
                    Uncertain { value, ..lack }
                })
            })
            .collect()
    }

    /// The lack of each zone without what noise makes of it; 0 within the error, `None` where nothing is wanted. All zones lack nothing
    /// unless together they deviate by more than noise does, by this number of standard errors.
    pub(crate) fn sure_lack(&self, sigmas: f64) -> Vec<Option<f64>> {
        let lack = self.lack();
        let shown = if beyond_noise(&lack) <= sigmas { |_| 0.0 } else { without_noise };
        lack.into_iter().map(|own| own.map(shown)).collect()
    }

    /// Shares of the flux that entered the guide, 1: what each zone takes, and what is left at its middle.
    pub(crate) fn shares_taken(&self) -> (Vec<f64>, Vec<f64>) {
        let light: Vec<f64> = self.measured.iter().map(|own| own.value.max(0.0)).collect();
        let sum = light.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        let taken: Vec<f64> = light.iter().map(|own| self.efficiency * own / sum).collect();
        let mut before = 0.0;
        let left = taken.iter().map(|own| {
            let here = before + 0.5 * own;
            before += own;
            1.0 - here.min(MOST_TAKEN)
        });
        let left = left.collect();
        (taken, left)
    }
}

/// By how many standard errors zones differ more than noise alone makes those that lack nothing. The sum of their squares, in standard
/// errors, has a chi-squared distribution; the cube root of it over its mean n is nearly normal, with the mean 1 - 2/9n and the variance
/// 2/9n (Wilson and Hilferty, Proc. Natl. Acad. Sci. 17 (1931) 684).
fn beyond_noise(lack: &[Option<Uncertain>]) -> f64 {
    let counted = || lack.iter().flatten();
    let squares: f64 = counted().map(|own| (own.value / own.std_error).powi(2)).sum();
    let freedom = counted().count().saturating_sub(1).max(1) as f64;
    let variance = 2.0 / (9.0 * freedom);
    ((squares / freedom).cbrt() - 1.0 + variance) / variance.sqrt()
}

/// A lack of light without the part that noise would make of it: 0 within the error, and nearly the whole where it is many errors. The
/// factor 1 - (σ/x)² is that of Wiener's filter.
fn without_noise(lack: Uncertain) -> f64 {
    if lack.value.abs() <= lack.std_error {
        return 0.0;
    }
    let noise = lack.std_error / lack.value;
    lack.value * (1.0 - noise * noise)
}

/// The length after its openings have changed by the factor exp(`change`), mm; openings go with the length to the power `exponent`.
pub(crate) fn length_after(value: f64, change: f64, exponent: f64) -> f64 {
    rounded(value * (change / exponent).exp())
}

/// A length with a resolution of a tenth of a micrometre, mm.
pub(crate) fn rounded(value: f64) -> f64 {
    (PER_MM * value).round() / PER_MM
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(values: &[f64], error: f64) -> Vec<Uncertain> {
        values.iter().map(|value| Uncertain { value: *value, std_error: error * value }).collect()
    }

    #[test]
    fn no_zone_lacks_light_within_its_error() {
        let measured = light(&[1.0, 1.01, 0.99, 1.0], 0.02);
        let light = ZoneLight { measured: &measured, wanted: &[1.0; 4], efficiency: 0.5 };
        assert_eq!(light.sure_lack(2.0), [Some(0.0); 4]);
    }

    #[test]
    fn one_zone_beyond_its_error_may_be_noise_and_many_are_not() {
        let sure = |values: &[f64], sigmas: f64| {
            let measured = light(values, 0.02);
            let light = ZoneLight { measured: &measured, wanted: &[1.0; 4], efficiency: 0.5 };
            light.sure_lack(sigmas)
        };
        assert_eq!(sure(&[1.0, 1.03, 0.99, 1.0], 2.0), [Some(0.0); 4]);
        assert!(sure(&[1.0, 1.05, 0.95, 1.0], 2.0)[1] < Some(-0.03));
        // It takes more to be sure by three errors.
        assert_eq!(sure(&[1.0, 1.05, 0.95, 1.0], 3.0), [Some(0.0); 4]);
        assert!(sure(&[1.0, 1.07, 0.93, 1.0], 3.0)[1] < Some(-0.05));
    }

    /// Chi-squared is above 7.815, 124.342 and 11.345 by chance in 5 %, 5 % and 1 % of cases: 1.645 and 2.326 standard deviations of a
    /// normal distribution.
    #[test]
    fn deviations_beyond_noise_are_those_of_tables_of_chi_squared() {
        for (zones, squares, expected) in
            [(4, 7.815_f64, 1.645), (101, 124.342, 1.645), (4, 11.345, 2.326)]
        {
            let value = (squares / f64::from(zones)).sqrt();
            let lack: Vec<Option<Uncertain>> =
                (0..zones).map(|_| Some(Uncertain { value, std_error: 1.0 })).collect();
            assert!(
                (beyond_noise(&lack) - expected).abs() < 0.03,
                "{zones}: {}",
                beyond_noise(&lack)
            );
        }
    }

    #[test]
    fn zones_that_do_not_count_lack_nothing_and_dark_ones_lack_much() {
        let measured = light(&[2.0, 1.0, 0.0], 0.001);
        let light = ZoneLight { measured: &measured, wanted: &[1.0, 0.0, 1.0], efficiency: 0.0 };
        let found = light.sure_lack(3.0);
        assert_eq!(found[1], None);
        assert!(found[2] > Some(0.5), "{found:?}");
    }

    #[test]
    fn zones_take_their_share_of_the_efficiency() {
        let measured = light(&[3.0, 1.0], 0.001);
        let light = ZoneLight { measured: &measured, wanted: &[1.0; 2], efficiency: 0.8 };
        let (taken, left) = light.shares_taken();
        for (found, expected) in taken.iter().chain(&left).zip([0.6, 0.2, 0.7, 0.3]) {
            assert!((found - expected).abs() < 1e-12, "{taken:?} {left:?}");
        }
    }

    #[test]
    fn a_length_follows_the_exponent() {
        assert_eq!(length_after(10.0, 4.0_f64.ln(), -1.0), 2.5);
        assert_eq!(length_after(10.0, 1.21_f64.ln(), 2.0), 11.0);
    }
}
