//! Rows of discrete distributions.

/// Distributions over columns, one for each row, stored by runs of columns of one weight.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CumulativeRows {
    /// Sums up to and with each run, row after row.
    sums: Vec<f64>,
    /// The column after each run, row after row; empty where each column is a run.
    ends: Vec<u32>,
    /// Where the runs of each row begin, and the end.
    starts: Vec<usize>,
}

impl CumulativeRows {
    /// Rows of weights that are not negative, each of them a run.
    pub(crate) fn new(rows: impl Iterator<Item = Vec<f64>>) -> Self {
        let mut all = Self { sums: Vec::new(), ends: Vec::new(), starts: vec![0] };
        for row in rows {
            let mut sum = 0.0;
            all.sums.extend(row.into_iter().map(|weight| {
                sum += weight;
                sum
            }));
            all.starts.push(all.sums.len());
        }
        all
    }

    /// The same with runs of equal neighbours: tables whose patches are a part of a coarser division take little space.
    pub(crate) fn merged(rows: impl Iterator<Item = Vec<f64>>) -> Self {
        let mut all = Self { sums: Vec::new(), ends: Vec::new(), starts: vec![0] };
        for row in rows {
            let (mut sum, mut end) = (0.0, 0);
            for run in row.chunk_by(|weight, next| weight == next) {
                sum += run[0] * run.len() as f64;
                end += run.len() as u32;
                all.sums.push(sum);
                all.ends.push(end);
            }
            all.starts.push(all.sums.len());
        }
        all.sums.shrink_to_fit();
        all.ends.shrink_to_fit();
        all
    }

    /// All weights times a factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let sums = self.sums.iter().map(|sum| factor * sum).collect();
        Self { sums, ends: self.ends.clone(), starts: self.starts.clone() }
    }

    /// Number of runs in all rows.
    #[cfg(test)]
    pub(crate) fn runs(&self) -> usize {
        self.sums.len()
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
        let run = match self.row_ends(row) {
            Some(ends) => ends.partition_point(|end| *end as usize <= column),
            None => column,
        };
        let sums = self.row(row);
        let sum = sums[run] - if run > 0 { sums[run - 1] } else { 0.0 };
        sum / self.columns(row, run).1
    }

    /// A column in proportion to its weight, and what is left of `u`, uniform in 0..1 within the column. The sum of the row
    /// is above 0.
    pub(crate) fn sample(&self, row: usize, u: f64) -> (usize, f64) {
        let sums = self.row(row);
        let total = self.total(row);
        let at = u * total;
        // The product may round to the sum, which the last run of any weight has as well.
        let last = sums.partition_point(|sum| *sum < total);
        let run = sums.partition_point(|sum| *sum <= at).min(last);
        let before = if run > 0 { sums[run - 1] } else { 0.0 };
        let weight = sums[run] - before;
        let rest = if weight > 0.0 { (at - before) / weight } else { 0.5 };
        let (first, count) = self.columns(row, run);
        // Rounding may leave the run.
        let place = rest.clamp(0.0, 1.0 - f64::EPSILON) * count;
        (first + place as usize, place.fract())
    }

    /// The column after each run of a row; `None` where each column is a run.
    fn row_ends(&self, row: usize) -> Option<&[u32]> {
        (!self.ends.is_empty()).then(|| &self.ends[self.starts[row]..self.starts[row + 1]])
    }

    /// The first column of a run, and their number.
    fn columns(&self, row: usize, run: usize) -> (usize, f64) {
        let Some(ends) = self.row_ends(row) else { return (run, 1.0) };
        let first = if run > 0 { ends[run - 1] } else { 0 };
        (first as usize, f64::from(ends[run] - first))
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

    #[test]
    fn runs_of_equal_columns_are_the_columns() {
        let weights = vec![vec![0.0, 0.0, 2.0, 2.0, 2.0, 0.5, 0.0, 1.0, 1.0], vec![3.0; 5], vec![]];
        let single = CumulativeRows::new(weights.clone().into_iter());
        let merged = CumulativeRows::merged(weights.clone().into_iter());
        assert_eq!((single.sums.len(), merged.sums.len()), (14, 6));
        for (row, weights) in weights.iter().enumerate() {
            assert_eq!(merged.total(row), single.total(row));
            for (column, weight) in weights.iter().enumerate() {
                assert_eq!(merged.weight(row, column), *weight, "{row} {column}");
            }
        }
        for row in [0, 1] {
            for point in 0..1000 {
                let u = (f64::from(point) + 0.3) / 1000.0;
                let [(column, rest), expected] = [&merged, &single].map(|own| own.sample(row, u));
                assert_eq!(column, expected.0, "{row} {u}");
                assert!((rest - expected.1).abs() < 1e-12, "{row} {u}: {rest} {expected:?}");
            }
        }
        assert_eq!(merged.sample(0, 1.0 - 1e-17).0, 8);
        assert_eq!(merged.scaled(2.0).weight(0, 4), 4.0);
    }
}
