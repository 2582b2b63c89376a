//! Colour of the light in the cells of a sensor, counted beside its flux.

use crate::transport::tally::cells::Cells;
use crate::transport::tally::colour::Stimuli;
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// Sums over the cells of a sensor from which X, Z and their covariances with each other and with Y follow.
///
/// The covariance of two sums is half of what the variance of their sum exceeds that of both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellColours {
    x: Cells,
    z: Cells,
    x_y: Cells,
    y_z: Cells,
    x_z: Cells,
}

/// Tristimulus values of a cell: means over batches, in units in which Y is in lm, and the covariances of these means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct CellStimuli {
    /// X, Y, Z.
    pub(crate) mean: DVec3,
    pub(crate) covariance: DMat3,
}

impl CellColours {
    /// Nothing counted yet.
    pub(crate) fn new(cells: usize) -> Self {
        let [x, z, x_y, y_z, x_z] = std::array::from_fn(|_| Cells::new(cells));
        Self { x, z, x_y, y_z, x_z }
    }

    /// Counts a luminous flux of a wavelength, nm, in a cell.
    #[inline]
    pub(crate) fn add(&mut self, cell: usize, flux: f64, nm: f64) {
        let [x, z, _] = Stimuli::of(flux, nm).values;
        self.x.add(cell, x);
        self.z.add(cell, z);
        self.x_y.add(cell, x + flux);
        self.y_z.add(cell, flux + z);
        self.x_z.add(cell, x + z);
    }

    /// Ends a batch.
    pub(crate) fn close_batch(&mut self) {
        let Self { x, z, x_y, y_z, x_z } = self;
        [x, z, x_y, y_z, x_z].into_iter().for_each(Cells::close_batch);
    }

    /// All sums, each with those of others.
    pub(crate) fn each(&mut self, other: &Self, mut act: impl FnMut(&mut Cells, &Cells)) {
        act(&mut self.x, &other.x);
        act(&mut self.z, &other.z);
        act(&mut self.x_y, &other.x_y);
        act(&mut self.y_z, &other.y_z);
        act(&mut self.x_z, &other.x_z);
    }

    /// A cell, whose luminous flux has this mean over batches and this standard error.
    pub(crate) fn stimuli(&self, cell: usize, batches: u64, luminous: (f64, f64)) -> CellStimuli {
        let of = |cells: &Cells| cells.mean(cell, batches);
        let [x, y, z] = [of(&self.x), luminous, of(&self.z)];
        let covariance = |both: &Cells, a: (f64, f64), b: (f64, f64)| {
            0.5 * (of(both).1.powi(2) - a.1.powi(2) - b.1.powi(2))
        };
        let xy = covariance(&self.x_y, x, y);
        let yz = covariance(&self.y_z, y, z);
        let xz = covariance(&self.x_z, x, z);
        let [xx, yy, zz] = [x, y, z].map(|own| own.1.powi(2));
        CellStimuli {
            mean: DVec3::new(x.0, y.0, z.0),
            covariance: DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]),
        }
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
        let (mut all, mut luminous) = (CellColours::new(2), Cells::new(2));
        let mut sums = Vec::new();
        for fluxes in batches {
            let (mut own, mut flux_of) = (CellColours::new(2), Cells::new(2));
            let mut sum = DVec3::ZERO;
            for (flux, nm) in fluxes.into_iter().zip([460.0, 610.0]) {
                own.add(1, flux, nm);
                flux_of.add(1, flux);
                let seen = DVec3::from_array(colour_matching(nm));
                sum += flux * seen / seen.y;
            }
            own.close_batch();
            flux_of.close_batch();
            all.each(&own, Cells::merge);
            luminous.merge(&flux_of);
            sums.push(sum);
        }
        let found = all.stimuli(1, 4, luminous.mean(1, 4));
        let mean = sums.iter().copied().sum::<DVec3>() / 4.0;
        assert!((found.mean - mean).length() < 1e-14);
        for (i, j) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
            let sum: f64 = sums.iter().map(|own| (own[i] - mean[i]) * (own[j] - mean[j])).sum();
            for own in [found.covariance.col(i)[j], found.covariance.col(j)[i]] {
                assert!((own - sum / 12.0).abs() < 1e-13, "{i} {j}: {own} {}", sum / 12.0);
            }
        }
        assert_eq!(all.stimuli(0, 4, luminous.mean(0, 4)).mean, DVec3::ZERO);
    }
}
