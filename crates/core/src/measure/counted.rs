//! Values that are known with noise, as counts are: how they scatter, and how they would come out if counted again.
//!
//! The error of a count goes as its root, and so does that of a sum of equal counts. This module knows nothing of sensors;
//! units are those of its input.

use crate::measure::multiscale::Multiscale;
use crate::measure::noise::Noise;

/// Counts by which the size of a count in all cells weighs against that in one, 1.
const COUNTS_OF_ALL: f64 = 4.0;

/// A value that is known with noise, zero or positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Noisy {
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    /// What one count more would add: how far a value of zero can be trusted.
    pub(crate) count: f64,
}

/// A value with its weight in the average, such as its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Part {
    pub(crate) read: Noisy,
    pub(crate) weight: f64,
}

impl Noisy {
    /// What one count is worth here: from the value's own noise as far as it has counts, else from that of all. The error
    /// then goes as the root of the value times this.
    fn count_size(&self) -> f64 {
        let own = self.std_error * self.std_error / self.value;
        if self.value <= 0.0 || self.count == 0.0 || own == 0.0 {
            return if self.value > 0.0 { own } else { self.count };
        }
        let counts = self.value / own;
        (counts * own + COUNTS_OF_ALL * self.count) / (counts + COUNTS_OF_ALL)
    }

    /// The value that light can have: what extrapolation has made negative is zero.
    fn lit(&self) -> f64 {
        self.value.max(0.0)
    }
}

/// Values with what their noise is like.
#[derive(Debug)]
pub(crate) struct Sample {
    /// Shares of the weight.
    pub(crate) weights: Vec<f64>,
    /// As read, but not below zero.
    pub(crate) values: Vec<f64>,
    /// Worth of a count in each.
    pub(crate) counts: Vec<f64>,
    scales: Multiscale,
}

impl Sample {
    /// Of at least one value. Neighbours in the list are neighbours on the sensor.
    pub(crate) fn of(parts: &[Part]) -> Self {
        let total: f64 = parts.iter().map(|part| part.weight).sum();
        let weights: Vec<f64> = parts.iter().map(|part| part.weight / total).collect();
        let counts: Vec<f64> = parts.iter().map(|part| part.read.count_size()).collect();
        let values = parts.iter().map(|part| part.read.lit()).collect();
        let scales = Multiscale::new(&weights, &counts);
        Self { weights, values, counts, scales }
    }

    /// The smallest value with the worth of a count there.
    pub(crate) fn darkest(&self) -> (f64, f64) {
        let cells = self.values.iter().copied().zip(self.counts.iter().copied());
        cells.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there is at least one value")
    }

    /// Such values with their noise taken out.
    pub(crate) fn without_noise(&self, values: &[f64]) -> Vec<f64> {
        self.scales.without_noise(values)
    }

    /// The values as if counted anew about some means.
    pub(crate) fn drawn(&self, means: &[f64], noise: &mut Noise) -> Vec<f64> {
        let again = |(&mean, &count): (&f64, &f64)| {
            if count > 0.0 { count * noise.poisson(mean / count) } else { mean }
        };
        means.iter().zip(&self.counts).map(again).collect()
    }
}
