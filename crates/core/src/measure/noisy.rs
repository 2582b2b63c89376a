//! Values that are known with noise, as counts are: how they scatter, and how they would come out if counted again.
//!
//! The error of a count scales as its square root, and so does that of a sum of equal counts. This
//! module does not know sensors; units are those of its input.

use crate::measure::multiscale::Multiscale;
use crate::measure::noise::Noise;

/// Weight, in counts, of the size of a count over all cells against that in one cell, 1.
const COUNTS_OF_ALL: f64 = 4.0;

/// A value that is known with noise, zero or positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Noisy {
    pub(crate) value: f64,
    pub(crate) std_error: f64,
    /// Size of one more count: how far a value of zero can be trusted.
    pub(crate) count: f64,
}

/// A value with its weight in the average, such as its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WeightedValue {
    pub(crate) read: Noisy,
    pub(crate) weight: f64,
}

impl Noisy {
    /// Size of one count here: from the value's own noise as far as it has counts, otherwise from
    /// all values. The error is then the square root of the value times this.
    fn count_size(&self) -> f64 {
        let own = self.std_error * self.std_error / self.value;
        if self.value <= 0.0 || self.count == 0.0 || own == 0.0 {
            return if self.value > 0.0 { own } else { self.count };
        }
        let counts = self.value / own;
        (counts * own + COUNTS_OF_ALL * self.count) / (counts + COUNTS_OF_ALL)
    }

    /// A physically possible value: one that negative weights made negative is zero.
    fn lit(&self) -> f64 {
        self.value.max(0.0)
    }
}

/// Values and the size of their noise.
#[derive(Debug)]
pub(crate) struct NoisySample {
    /// Shares of the weight.
    pub(crate) weights: Vec<f64>,
    /// As read, but not negative.
    pub(crate) values: Vec<f64>,
    /// Size of a count in each.
    pub(crate) counts: Vec<f64>,
    scales: Multiscale,
}

impl NoisySample {
    /// From at least one value. Neighbours in the list are neighbours on the sensor.
    pub(crate) fn of(parts: &[WeightedValue]) -> Self {
        let total: f64 = parts.iter().map(|part| part.weight).sum();
        let weights: Vec<f64> = parts.iter().map(|part| part.weight / total).collect();
        let counts: Vec<f64> = parts.iter().map(|part| part.read.count_size()).collect();
        let values = parts.iter().map(|part| part.read.lit()).collect();
        let scales = Multiscale::new(&weights, &counts);
        Self { weights, values, counts, scales }
    }

    /// The smallest value with the size of a count there.
    pub(crate) fn darkest(&self) -> (f64, f64) {
        let cells = self.values.iter().copied().zip(self.counts.iter().copied());
        cells.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there is at least one value")
    }

    /// Such values with their noise removed.
    pub(crate) fn without_noise(&self, values: &[f64]) -> Vec<f64> {
        self.scales.without_noise(values)
    }

    /// The values redrawn as counts about some means.
    pub(crate) fn drawn(&self, means: &[f64], noise: &mut Noise) -> Vec<f64> {
        let again = |(&mean, &count): (&f64, &f64)| {
            if count > 0.0 { count * noise.poisson(mean / count) } else { mean }
        };
        means.iter().zip(&self.counts).map(again).collect()
    }
}
