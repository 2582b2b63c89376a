//! The cells of a truth, and how far the cells of a run are from them.

/// The true fluxes of the cells of a sensor, with their standard errors.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueCells {
    /// Flux and standard error per cell, in the unit of the measure.
    cells: Vec<(f64, f64)>,
    /// Sum of the squares of the fluxes, in the square of that unit.
    square: f64,
}

impl TrueCells {
    /// From the flux of each cell and its standard error, in the unit of the measure; `None` if all fluxes are 0,
    /// a value is not finite, or an error is negative.
    pub fn new(cells: Vec<(f64, f64)>) -> Option<Self> {
        let square: f64 = cells.iter().map(|(flux, _)| flux * flux).sum();
        let are_errors = cells.iter().all(|(_, error)| error.is_finite() && *error >= 0.0);
        (square.is_finite() && square > 0.0 && are_errors).then_some(Self { cells, square })
    }

    /// Flux and standard error of each cell, in the unit of the measure.
    pub fn cells(&self) -> &[(f64, f64)] {
        &self.cells
    }

    /// The error per cell of these fluxes, 1: docs/method.md, eq. (28).
    ///
    /// # Panics
    ///
    /// If their number is not that of the true cells.
    pub fn error_of(&self, fluxes: &[f64]) -> f64 {
        assert_eq!(fluxes.len(), self.cells.len(), "a run has the cells of its sensor");
        let deviations = self.cells.iter().zip(fluxes).map(|((truth, _), flux)| flux - truth);
        (deviations.map(|deviation| deviation * deviation).sum::<f64>() / self.square).sqrt()
    }

    /// The expected error per cell of the truth itself, 1: no run is found to have much less.
    pub fn own_error(&self) -> f64 {
        (self.cells.iter().map(|(_, error)| error * error).sum::<f64>() / self.square).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_per_cell_is_the_root_of_squared_deviations_over_squared_truths() {
        // Squares of the truth: 9 + 16 + 0 = 25; deviations 0.3, -0.4, 1.2: 0.09 + 0.16 + 1.44 = 1.69.
        let truth = TrueCells::new(vec![(3.0, 0.3), (4.0, 0.4), (0.0, 0.0)]).unwrap();
        assert!((truth.error_of(&[3.3, 3.6, 1.2]) - 1.3 / 5.0).abs() < 1e-15);
        assert_eq!(truth.error_of(&[3.0, 4.0, 0.0]), 0.0);
        assert!((truth.own_error() - 0.5 / 5.0).abs() < 1e-15);
    }

    #[test]
    fn cells_without_light_or_with_unknown_errors_are_no_truth() {
        assert_eq!(TrueCells::new(vec![(0.0, 0.1), (0.0, 0.1)]), None);
        assert_eq!(TrueCells::new(Vec::new()), None);
        assert_eq!(TrueCells::new(vec![(1.0, f64::INFINITY), (2.0, 0.1)]), None);
        assert_eq!(TrueCells::new(vec![(1.0, -0.1), (2.0, 0.1)]), None);
        assert_eq!(TrueCells::new(vec![(f64::NAN, 0.1), (2.0, 0.1)]), None);
    }
}
