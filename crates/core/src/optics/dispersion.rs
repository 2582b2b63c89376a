//! Laws of refractive index and absorption by wavelength.

use crate::colour::SpectralTable;

/// The wavelength of light without a spectrum, nm: the peak of V(λ), CIE 018:2019.
pub const REFERENCE_WAVELENGTH: f64 = 555.0;

/// Refractive index by wavelength λ.
#[derive(Debug, Clone, PartialEq)]
pub enum IndexLaw {
    /// The same for all wavelengths.
    Constant(f64),
    /// n = A + B/λ² + C/λ⁴, λ in µm; A, 1, B, µm², C, µm⁴ (Cauchy 1836; Born & Wolf, 7th ed., 2.3.4).
    Cauchy([f64; 3]),
    /// n² = 1 + Σ Bᵢ λ²/(λ² - Cᵢ), λ in µm; pairs of Bᵢ, 1, and Cᵢ, µm² (Sellmeier 1871; as in data sheets of Schott).
    Sellmeier(Vec<[f64; 2]>),
    /// n² = Σ cᵢ λ^pᵢ, λ in µm; pairs of cᵢ and whole pᵢ (Schott's formula of 1967, and longer ones of the same kind).
    Powers(Vec<(f64, i32)>),
    /// A table of indices.
    Table(SpectralTable),
}

impl IndexLaw {
    /// Refractive index at a wavelength, in nm; 1. Not a number where a law has no index.
    #[inline]
    pub fn at(&self, nm: f64) -> f64 {
        match self {
            Self::Constant(index) => *index,
            Self::Cauchy(_) | Self::Sellmeier(_) | Self::Powers(_) | Self::Table(_) => {
                self.dispersed(nm)
            }
        }
    }

    #[inline(never)]
    fn dispersed(&self, nm: f64) -> f64 {
        // µm².
        let square = (1e-3 * nm) * (1e-3 * nm);
        match self {
            Self::Constant(index) => *index,
            Self::Cauchy([a, b, c]) => a + (b + c / square) / square,
            Self::Sellmeier(terms) => {
                (1.0 + terms.iter().map(|[b, c]| b * square / (square - c)).sum::<f64>()).sqrt()
            }
            Self::Powers(terms) => {
                let micrometres = 1e-3 * nm;
                terms.iter().map(|(c, p)| c * micrometres.powi(*p)).sum::<f64>().sqrt()
            }
            Self::Table(table) => table.at(nm),
        }
    }

    /// The Abbe number `(n_d - 1)/(n_F - n_C)`, 1; infinite without dispersion (ISO 7944: lines of 587.5618, 486.1327 and
    /// 656.2725 nm).
    pub fn abbe_number(&self) -> f64 {
        let [d, f, c] = [587.5618, 486.1327, 656.2725].map(|nm| self.at(nm));
        (d - 1.0) / (f - c)
    }
}

/// Coefficient of absorption (natural) or scattering by wavelength, 1/mm.
#[derive(Debug, Clone, PartialEq)]
pub enum CoefficientLaw {
    /// The same for all wavelengths.
    Constant(f64),
    /// A table.
    Table(SpectralTable),
}

impl CoefficientLaw {
    /// The coefficient at a wavelength, in nm; 1/mm.
    #[inline]
    pub fn at(&self, nm: f64) -> f64 {
        match self {
            Self::Constant(coefficient) => *coefficient,
            Self::Table(table) => table.at(nm),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bk7_has_the_indices_of_its_data_sheet() {
        // Schott, data sheet of N-BK7.
        let glass = IndexLaw::Sellmeier(vec![
            [1.03961212, 0.00600069867],
            [0.231792344, 0.0200179144],
            [1.01046945, 103.560653],
        ]);
        for (nm, index) in [(656.2725, 1.51432), (587.5618, 1.51680), (486.1327, 1.52238)] {
            assert!((glass.at(nm) - index).abs() < 5e-6, "{nm}: {}", glass.at(nm));
        }
        assert!((glass.abbe_number() - 64.17).abs() < 0.005, "{}", glass.abbe_number());
    }

    #[test]
    fn the_index_of_cauchy_falls_to_its_constant() {
        let law = IndexLaw::Cauchy([1.5, 0.004, 0.0001]);
        assert!((law.at(500.0) - (1.5 + 0.016 + 0.0016)).abs() < 1e-12);
        assert!((law.at(1e9) - 1.5).abs() < 1e-12);
        let powers = IndexLaw::Powers(vec![(2.25, 0), (0.003, -2)]);
        assert!((powers.at(500.0) - (2.25 + 0.012_f64).sqrt()).abs() < 1e-12);
        assert_eq!(IndexLaw::Constant(1.5).abbe_number(), f64::INFINITY);
    }
}
