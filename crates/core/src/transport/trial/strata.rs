//! What a trial of some strata of a sensor says about all of them.
//!
//! Batches of a run have many paths in every stratum, which share its evenly spread points; a trial cannot afford as many in
//! all of them. It takes some strata, drawn anew for every two batches.

use crate::scene::SensorId;
use crate::transport::{Cells, Readings};

/// Batches of the same strata.
pub(crate) const PAIR: usize = 2;

/// The strata of a sensor that batches of a trial take.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TriedStrata {
    /// Their number over that of all, 1.
    pub(crate) share: f64,
    /// Paths in a stratum.
    pub(crate) each: u64,
    /// The same in a batch of the run.
    pub(crate) each_of_run: u64,
}

impl TriedStrata {
    /// Cost of batches with as many paths in all strata, s, from batches of a trial and their work, ns.
    pub(super) fn cost(&self, batches: &[Readings], sensor: SensorId, work: f64) -> Option<f64> {
        let of_pair = |pair: &[Readings]| {
            let mut cells = pair[0].sensors[sensor.index()].cells.clone();
            cells.merge(&pair[1].sensors[sensor.index()].cells);
            cells
        };
        let pairs: Vec<Cells> = batches.chunks_exact(PAIR).map(of_pair).collect();
        let of_batch = 1e-9 * work / batches.len() as f64 / self.share;
        relative_variance(&pairs, self.share).map(|variance| of_batch * variance)
    }
}

/// Relative variance of a batch with paths in all strata, over its cells: Σσ²/Σmean². Where noise hides the squares it is a
/// bound, as for batches of all strata. `None` in the dark.
///
/// Each cell is a stratum of its own. It is tried in `share` of the pairs, with 1/share times its flux in a batch of all strata: sums of squares over all pairs,
/// divided by their number over `share`, are those of such a batch, and the flux is unbiased as it is.
fn relative_variance(pairs: &[Cells], share: f64) -> Option<f64> {
    let (mut variance, mut square, mut sum) = (0.0, 0.0, 0.0);
    for pair in pairs {
        // Of two values a and b: their variance (a - b)²/2, and their product, which is the square of the mean without noise.
        pair.each_lit(|[both, squares]| {
            variance += squares - 0.5 * both * both;
            square += 0.5 * (both * both - squares);
            sum += both;
        });
    }
    let pairs_of_all = pairs.len() as f64 / share;
    let flux = sum / (PAIR * pairs.len()) as f64;
    let least = flux * flux / pairs.first()?.count() as f64;
    let square = (square / pairs_of_all).max(least);
    // Rounding may leave a tiny negative variance where both batches agree.
    (least > 0.0).then(|| variance.max(0.0) / pairs_of_all / square)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pair of batches; each has some flux in one cell of four.
    fn pair(cell: usize, fluxes: [f64; 2]) -> Cells {
        let [mut first, second] = fluxes.map(|flux| {
            let mut batch = Cells::new(4);
            batch.add(cell, flux);
            batch.close_batch();
            batch
        });
        first.merge(&second);
        first
    }

    #[test]
    fn a_quarter_of_the_cells_tells_the_variance_of_all() {
        // Cells have fluxes of 1 to 4 in a batch of all cells, and thus four times as much in one of their own, here ± 10 %.
        let of_cell = |cell: usize| pair(cell, [4.4, 3.6].map(|flux| flux * (cell + 1) as f64));
        let pairs: Vec<Cells> = (0..4).map(of_cell).collect();
        let found = relative_variance(&pairs, 0.25).unwrap();
        assert!((found - 0.02 * 30.0 / (30.0 - 0.01 * 30.0)).abs() < 1e-12, "{found}");
    }

    #[test]
    fn cells_without_noise_have_no_variance() {
        let pairs: Vec<Cells> = (0..4).map(|cell| pair(cell, [0.3, 0.3])).collect();
        assert_eq!(relative_variance(&pairs, 0.25), Some(0.0));
    }

    #[test]
    fn few_events_give_a_bound() {
        let pairs = [pair(0, [8.0, 0.0]), pair(1, [0.0, 0.0]), pair(2, [0.0, 0.0])];
        let dark = relative_variance(&pairs[1..], 0.25);
        assert_eq!(dark, None);
        let found = relative_variance(&pairs, 0.25).unwrap();
        let flux = 8.0 / 6.0;
        assert!((found - 32.0 * 0.25 / 3.0 / (flux * flux / 4.0)).abs() < 1e-12, "{found}");
    }
}
