//! Sums over the cells of a sensor, sparse while few of them are lit.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A map is kept dense once it is no larger than this many cells, or once a quarter of it is lit.
const DENSE_CELLS: usize = 4096;

/// For every cell: the sum over batches of the flux that the batch counted, lm or W, and the sum of its square.
///
/// Every batch carries the whole flux of the sources, so the mean over batches is the flux in the cell.
///
/// A batch itself is an accumulator whose squares are filled in by `Cells::close_batch`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Cells {
    /// Lit cells only, with the total number of cells.
    Sparse(usize, BTreeMap<u32, [f64; 2]>),
    /// All cells.
    Dense(Vec<[f64; 2]>),
}

impl Cells {
    /// Nothing counted yet.
    pub(crate) fn new(cells: usize) -> Self {
        if cells <= DENSE_CELLS {
            Self::Dense(vec![[0.0; 2]; cells])
        } else {
            Self::Sparse(cells, BTreeMap::new())
        }
    }

    /// Number of cells.
    pub fn count(&self) -> usize {
        match self {
            Self::Sparse(cells, _) => *cells,
            Self::Dense(sums) => sums.len(),
        }
    }

    /// Counts flux in a cell.
    #[inline]
    pub fn add(&mut self, cell: usize, flux: f64) {
        match self {
            Self::Sparse(_, sums) => sums.entry(cell as u32).or_default()[0] += flux,
            Self::Dense(sums) => sums[cell][0] += flux,
        }
    }

    /// The counts of a batch that is `a` times this one and `b` times another of the same size.
    pub(crate) fn combined(&self, [a, b]: [f64; 2], other: &Self) -> Self {
        let mut sum = self.clone();
        match &mut sum {
            Self::Sparse(_, sums) => sums.values_mut().for_each(|own| own[0] *= a),
            Self::Dense(sums) => sums.iter_mut().for_each(|own| own[0] *= a),
        }
        match other {
            Self::Sparse(_, sums) => {
                sums.iter().for_each(|(&cell, other)| sum.add(cell as usize, b * other[0]));
            }
            Self::Dense(sums) => {
                let lit = sums.iter().enumerate().filter(|(_, other)| other[0] != 0.0);
                lit.for_each(|(cell, other)| sum.add(cell, b * other[0]));
            }
        }
        sum
    }

    /// Ends a batch: sets the squares of its sums, which stay.
    pub(crate) fn close_batch(&mut self) {
        let square = |sum: &mut [f64; 2]| sum[1] = sum[0] * sum[0];
        match self {
            Self::Sparse(_, sums) => sums.values_mut().for_each(square),
            Self::Dense(sums) => sums.iter_mut().for_each(square),
        }
    }

    /// Adds the sums of the batches that follow.
    pub(crate) fn merge(&mut self, later: &Self) {
        match later {
            Self::Sparse(_, sums) => {
                for (&cell, sum) in sums {
                    self.add_sums(cell as usize, *sum);
                }
            }
            Self::Dense(sums) => {
                for (cell, sum) in sums.iter().enumerate().filter(|(_, sum)| sum[0] != 0.0) {
                    self.add_sums(cell, *sum);
                }
            }
        }
        self.densify();
    }

    /// Mean over batches and its standard error, for a cell.
    pub fn mean(&self, cell: usize, batches: u64) -> (f64, f64) {
        let [sum, squares] = match self {
            Self::Sparse(_, sums) => sums.get(&(cell as u32)).copied().unwrap_or_default(),
            Self::Dense(sums) => sums[cell],
        };
        let n = batches as f64;
        let mean = sum / n;
        // Rounding may leave a tiny negative variance where all batches agree.
        let variance = (squares / n - mean * mean).max(0.0) / (n - 1.0);
        (mean, variance.sqrt())
    }

    fn add_sums(&mut self, cell: usize, sum: [f64; 2]) {
        let own = match self {
            Self::Sparse(_, sums) => sums.entry(cell as u32).or_default(),
            Self::Dense(sums) => &mut sums[cell],
        };
        own[0] += sum[0];
        own[1] += sum[1];
    }

    fn densify(&mut self) {
        if let Self::Sparse(cells, sums) = self
            && sums.len() * 4 > *cells
        {
            let mut dense = vec![[0.0; 2]; *cells];
            for (&cell, sum) in sums.iter() {
                dense[cell as usize] = *sum;
            }
            *self = Self::Dense(dense);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn batch(cells: usize, counts: &[(usize, f64)]) -> Cells {
        let mut batch = Cells::new(cells);
        for &(cell, flux) in counts {
            batch.add(cell, flux);
        }
        batch.close_batch();
        batch
    }

    #[test]
    fn sparse_and_dense_maps_agree_bit_for_bit() {
        let big = DENSE_CELLS + 1;
        let batches = [[(1, 0.1), (5, 0.2)], [(5, 0.7), (5, 0.1)], [(2, 1e-3), (1, 0.3)]];
        let sum = |cells| {
            let mut sum = batch(cells, &batches[0]);
            sum.merge(&batch(cells, &batches[1]));
            sum.merge(&batch(cells, &batches[2]));
            sum
        };
        let (sparse, dense) = (sum(big), sum(10));
        assert!(matches!(sparse, Cells::Sparse(..)) && matches!(dense, Cells::Dense(_)));
        for cell in 0..10 {
            assert_eq!(sparse.mean(cell, 3), dense.mean(cell, 3));
        }
    }

    #[test]
    fn a_map_becomes_dense_when_a_quarter_is_lit() {
        let cells = DENSE_CELLS + 4;
        let mut sum = Cells::new(cells);
        sum.merge(&batch(cells, &(0..cells / 3).map(|cell| (cell, 1.0)).collect::<Vec<_>>()));
        assert!(matches!(sum, Cells::Dense(_)));
        assert_eq!(sum.mean(0, 2).0, 0.5);
        assert_eq!(sum.mean(cells - 1, 2).0, 0.0);
    }
}
