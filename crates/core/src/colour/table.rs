//! Properties of matter, tabulated by wavelength.

use crate::colour::observer::VISIBLE;

/// First wavelength of dense values, nm.
const DENSE_FROM: u32 = VISIBLE[0] as u32;

/// Values by wavelength, linear in between, and constant beyond the ends.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectralTable {
    /// Wavelength, nm, strictly ascending, and value.
    rows: Vec<[f64; 2]>,
    /// Values at whole nm of the visible range, if they are all that is needed.
    dense: Option<Vec<f64>>,
}

impl SpectralTable {
    /// A table of at least two rows; `None` if there are fewer, or if wavelengths are not positive and ascending.
    pub fn new(rows: Vec<[f64; 2]>) -> Option<Self> {
        let ascend = rows.windows(2).all(|pair| 0.0 < pair[0][0] && pair[0][0] < pair[1][0]);
        let finite = rows.iter().flatten().all(|number| number.is_finite());
        (rows.len() > 1 && ascend && finite).then_some(())?;
        let mut table = Self { rows, dense: None };
        if table.rows.iter().all(|[nm, _]| nm.fract() == 0.0) {
            let whole = DENSE_FROM..=VISIBLE[1].ceil() as u32;
            table.dense = Some(whole.map(|nm| table.at(f64::from(nm))).collect());
        }
        Some(table)
    }

    /// The value at a wavelength, nm.
    #[inline]
    pub fn at(&self, nm: f64) -> f64 {
        let at = nm - f64::from(DENSE_FROM);
        if let Some(dense) =
            self.dense.as_ref().filter(|dense| at >= 0.0 && at < (dense.len() - 1) as f64)
        {
            let row = at as usize;
            return dense[row] + (at - row as f64) * (dense[row + 1] - dense[row]);
        }
        between_rows(&self.rows, nm)
    }

    /// The first and the last wavelength, nm.
    pub fn range(&self) -> [f64; 2] {
        [self.rows[0][0], self.rows[self.rows.len() - 1][0]]
    }

    /// The rows: wavelength, nm, and value.
    pub fn rows(&self) -> &[[f64; 2]] {
        &self.rows
    }
}

/// The value of a table of two or more ascending rows at a wavelength, nm: linear within, constant beyond.
pub(super) fn between_rows(rows: &[[f64; 2]], nm: f64) -> f64 {
    let after = rows.partition_point(|[place, _]| *place <= nm).clamp(1, rows.len() - 1);
    let ([low, a], [high, b]) = (rows[after - 1], rows[after]);
    a + ((nm - low) / (high - low)).clamp(0.0, 1.0) * (b - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_linear_within_and_constant_beyond() -> Result<(), &'static str> {
        for shift in [0.0, 0.5] {
            let rows = vec![[400.0 + shift, 1.0], [500.0 + shift, 3.0], [510.0 + shift, 0.0]];
            let table = SpectralTable::new(rows).ok_or("a table")?;
            let values = [300.0, 400.0, 450.0, 505.0, 800.0].map(|nm| table.at(nm + shift));
            assert_eq!(values, [1.0, 1.0, 2.0, 1.5, 0.0]);
            assert_eq!(table.range(), [400.0 + shift, 510.0 + shift]);
        }
        Ok(())
    }

    #[test]
    fn rows_that_do_not_ascend_make_no_table() {
        assert_eq!(SpectralTable::new(vec![]), None);
        assert_eq!(SpectralTable::new(vec![[500.0, 1.0], [400.0, 1.0]]), None);
        assert_eq!(SpectralTable::new(vec![[500.0, 1.0]]), None);
        assert_eq!(SpectralTable::new(vec![[0.0, 1.0], [500.0, 1.0]]), None);
        assert_eq!(SpectralTable::new(vec![[400.0, 1.0], [f64::NAN, 1.0]]), None);
    }
}
