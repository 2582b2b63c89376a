//! Summed over the cells of a sensor, sparse while few of them are lit.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A map is kept dense once it is no larger than this many cells, or once a quarter of it is lit.
const DENSE_CELLS: usize = 4096;

/// What is summed in a cell. A batch itself is an accumulator whose products are filled in at its end.
pub trait Summed: Copy + Default {
    /// Whether the cell is lit.
    fn is_lit(&self) -> bool;
    /// Adds the sums of others, times a factor.
    fn add(&mut self, others: &Self, factor: f64);
    /// Ends a batch: sets the products of its sums, which stay.
    fn close_batch(&mut self);
}

/// Summed in every cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum CellSums<S> {
    /// Lit cells only, with the total number of cells.
    Sparse(usize, BTreeMap<u32, S>),
    /// All cells.
    Dense(Vec<S>),
}

/// For every cell: the sum over batches of the flux that the batch counted, lm or W, and the sum of its square.
///
/// Every batch carries the whole flux of the sources, so the mean over batches is the flux in the cell.
pub type Cells = CellSums<[f64; 2]>;

impl Summed for [f64; 2] {
    fn is_lit(&self) -> bool {
        self[0] != 0.0
    }

    #[inline]
    fn add(&mut self, others: &Self, factor: f64) {
        self[0] += factor * others[0];
        self[1] += factor * others[1];
    }

    #[inline]
    fn close_batch(&mut self) {
        self[1] = self[0] * self[0];
    }
}

impl<S: Summed> CellSums<S> {
    /// Nothing counted yet.
    pub(crate) fn new(cells: usize) -> Self {
        if cells <= DENSE_CELLS {
            Self::Dense(vec![S::default(); cells])
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

    /// The sums of a cell.
    pub(crate) fn get(&self, cell: usize) -> S {
        match self {
            Self::Sparse(_, sums) => sums.get(&(cell as u32)).copied().unwrap_or_default(),
            Self::Dense(sums) => sums[cell],
        }
    }

    /// The sums of a cell, to add to them.
    #[inline]
    pub(crate) fn get_mut(&mut self, cell: usize) -> &mut S {
        match self {
            Self::Sparse(_, sums) => sums.entry(cell as u32).or_default(),
            Self::Dense(sums) => &mut sums[cell],
        }
    }

    /// The counts of a batch that is `a` times this one and `b` times another of the same size.
    pub(crate) fn combined(&self, [a, b]: [f64; 2], other: &Self) -> Self {
        let mut sum = Self::new(self.count());
        sum.add_all(self, a);
        sum.add_all(other, b);
        sum
    }

    /// Ends a batch.
    pub(crate) fn close_batch(&mut self) {
        self.each_mut(S::close_batch);
    }

    /// Adds the sums of the batches that follow.
    pub(crate) fn merge(&mut self, later: &Self) {
        self.add_all(later, 1.0);
        self.densify();
    }

    /// Shows the sums of lit cells.
    pub(crate) fn each_lit(&self, act: impl FnMut(&S)) {
        match self {
            Self::Sparse(_, sums) => sums.values().for_each(act),
            Self::Dense(sums) => sums.iter().filter(|sums| sums.is_lit()).for_each(act),
        }
    }

    fn each_mut(&mut self, act: impl FnMut(&mut S)) {
        match self {
            Self::Sparse(_, sums) => sums.values_mut().for_each(act),
            Self::Dense(sums) => sums.iter_mut().for_each(act),
        }
    }

    fn add_all(&mut self, others: &Self, factor: f64) {
        match others {
            Self::Sparse(_, sums) => {
                sums.iter().for_each(|(&cell, sums)| self.get_mut(cell as usize).add(sums, factor));
            }
            Self::Dense(sums) => {
                let lit = sums.iter().enumerate().filter(|(_, sums)| sums.is_lit());
                lit.for_each(|(cell, sums)| self.get_mut(cell).add(sums, factor));
            }
        }
    }

    fn densify(&mut self) {
        if let Self::Sparse(cells, sums) = self
            && sums.len() * 4 > *cells
        {
            let mut dense = vec![S::default(); *cells];
            for (&cell, sum) in sums.iter() {
                dense[cell as usize] = *sum;
            }
            *self = Self::Dense(dense);
        }
    }
}

impl Cells {
    /// Counts flux in a cell.
    #[inline]
    pub fn add(&mut self, cell: usize, flux: f64) {
        self.get_mut(cell)[0] += flux;
    }

    /// Multiplies all flux of batches that have ended.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.each_mut(|[sum, squares]| {
            *sum *= factor;
            *squares *= factor * factor;
        });
    }

    /// Mean over batches and its standard error, for a cell.
    pub fn mean(&self, cell: usize, batches: u64) -> (f64, f64) {
        let [sum, squares] = self.get(cell);
        let n = batches as f64;
        let mean = sum / n;
        // Rounding may leave a tiny negative variance where all batches agree.
        let variance = (squares / n - mean * mean).max(0.0) / (n - 1.0);
        (mean, variance.sqrt())
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
