//! Rows of discrete distributions.

/// Distributions over columns, one for each row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CumulativeRows {
    /// Sums up to and with each column, row after row.
    sums: Vec<f64>,
    /// Where each row begins, and the end.
    starts: Vec<usize>,
}

impl CumulativeRows {
    /// Rows of weights that are not negative.
    pub(crate) fn new(rows: impl Iterator<Item = Vec<f64>>) -> Self {
        let (mut sums, mut starts) = (Vec::new(), vec![0]);
        for row in rows {
            let mut sum = 0.0;
            sums.extend(row.into_iter().map(|weight| {
                sum += weight;
                sum
            }));
            starts.push(sums.len());
        }
        Self { sums, starts }
    }

    /// All weights times a factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let sums = self.sums.iter().map(|sum| factor * sum).collect();
        Self { sums, starts: self.starts.clone() }
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.sums[self.starts[row]..self.starts[row + 1]]
    }

    /// The sum of a row.
    pub(crate) fn total(&self, row: usize) -> f64 {
        self.row(row).last().copied().unwrap_or(0.0)
    }

    /// The weight of a column.
    pub(crate) fn weight(&self, row: usize, column: usize) -> f64 {
        let sums = self.row(row);
        sums[column] - if column > 0 { sums[column - 1] } else { 0.0 }
    }

    /// A column in proportion to its weight, and what is left of `u`, uniform in 0..1 within the column. The sum of the row
    /// is above 0.
    pub(crate) fn sample(&self, row: usize, u: f64) -> (usize, f64) {
        let sums = self.row(row);
        let total = self.total(row);
        let at = u * total;
        // The product may round to the sum, which the last column of any weight has as well.
        let last = sums.partition_point(|sum| *sum < total);
        let column = sums.partition_point(|sum| *sum <= at).min(last);
        let before = if column > 0 { sums[column - 1] } else { 0.0 };
        let weight = sums[column] - before;
        let rest = if weight > 0.0 { (at - before) / weight } else { 0.5 };
        // Rounding may leave the column.
        (column, rest.clamp(0.0, 1.0 - f64::EPSILON))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_drawn_by_their_weights() {
        let rows = CumulativeRows::new(
            [vec![0.0, 2.0, 0.0, 6.0, 0.0], vec![1.0], vec![0.0, 0.0]].into_iter(),
        );
        assert_eq!([0, 1, 2].map(|row| rows.total(row)), [8.0, 1.0, 0.0]);
        assert_eq!([0, 1, 3, 4].map(|column| rows.weight(0, column)), [0.0, 2.0, 6.0, 0.0]);
        assert_eq!(rows.sample(0, 0.0), (1, 0.0));
        assert_eq!(rows.sample(0, 0.125), (1, 0.5));
        assert_eq!(rows.sample(0, 0.25), (3, 0.0));
        assert_eq!(rows.sample(0, 0.625), (3, 0.5));
        assert_eq!(rows.sample(0, 1.0 - 1e-17).0, 3);
        assert_eq!(rows.sample(1, 0.5), (0, 0.5));
    }
}
