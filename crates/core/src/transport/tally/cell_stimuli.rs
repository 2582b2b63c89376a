//! Tristimulus values of the light in the cells of a sensor, counted beside its flux.

use crate::transport::tally::cells::{CellSums, Summed};
use crate::transport::tally::colour::Stimuli;
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// Summed over batches of X, Y and Z, in units in which Y is in lm, and of the products XX, YY, ZZ, XY, YZ and XZ of each batch.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StimulusSums([f64; 3], [f64; 6]);

/// These sums in every cell.
pub(crate) type CellStimuli = CellSums<StimulusSums>;

/// Tristimulus values that are known with noise: means over batches, in units in which Y is in lm, and the covariances of these means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NoisyStimuli {
    /// X, Y, Z.
    pub(crate) mean: DVec3,
    pub(crate) covariance: DMat3,
}

impl Summed for StimulusSums {
    fn is_lit(&self) -> bool {
        self.0 != [0.0; 3]
    }

    #[inline]
    fn add(&mut self, others: &Self, factor: f64) {
        self.0.iter_mut().zip(others.0).for_each(|(own, other)| *own += factor * other);
        self.1.iter_mut().zip(others.1).for_each(|(own, other)| *own += factor * other);
    }

    #[inline]
    fn close_batch(&mut self) {
        let [x, y, z] = self.0;
        self.1 = [x * x, y * y, z * z, x * y, y * z, x * z];
    }
}

impl CellStimuli {
    /// Counts a luminous flux of a wavelength, nm, in a cell.
    #[inline]
    pub(crate) fn add(&mut self, cell: usize, flux: f64, nm: f64) {
        let [x, z, ..] = Stimuli::of(flux, nm).values;
        let StimulusSums(values, _) = self.get_mut(cell);
        values.iter_mut().zip([x, flux, z]).for_each(|(own, more)| *own += more);
    }

    /// Means of a cell over batches.
    pub(crate) fn mean(&self, cell: usize, batches: u64) -> NoisyStimuli {
        let StimulusSums(values, products) = self.get(cell);
        let n = batches as f64;
        let mean = DVec3::from_array(values) / n;
        let [xx, yy, zz, xy, yz, xz] = products;
        let square = DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]) * n.recip();
        let of_mean = DMat3::from_cols(mean * mean.x, mean * mean.y, mean * mean.z);
        NoisyStimuli { mean, covariance: (square - of_mean) * (n - 1.0).recip() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::colour_matching;

    #[test]
    fn means_and_covariances_are_those_of_the_batches() {
        // Luminous fluxes at 460 and 610 nm in each of four batches, lm.
        let batches = [[0.1, 1.0], [0.3, 0.8], [0.2, 0.9], [0.15, 1.3]];
        let mut all = CellStimuli::new(2);
        let mut sums = Vec::new();
        for fluxes in batches {
            let mut own = CellStimuli::new(2);
            let mut sum = DVec3::ZERO;
            for (flux, nm) in fluxes.into_iter().zip([460.0, 610.0]) {
                own.add(1, flux, nm);
                let seen = DVec3::from_array(colour_matching(nm));
                sum += flux * seen / seen.y;
            }
            own.close_batch();
            all.merge(&own);
            sums.push(sum);
        }
        let found = all.mean(1, 4);
        let mean = sums.iter().copied().sum::<DVec3>() / 4.0;
        assert!((found.mean - mean).length() < 1e-14);
        for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
            let sum: f64 = sums.iter().map(|own| (own[i] - mean[i]) * (own[j] - mean[j])).sum();
            for own in [found.covariance.col(i)[j], found.covariance.col(j)[i]] {
                assert!((own - sum / 12.0).abs() < 1e-13, "{i} {j}: {own} {}", sum / 12.0);
            }
        }
        assert_eq!(all.mean(0, 4).mean, DVec3::ZERO);
    }
}
