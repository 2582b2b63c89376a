//! Uniformity of a field: extremes over average, extremes over each other, and the coefficient of
//! variation.
//!
//! All of these are biased by noise and corrected for it (see [`crate::measure::extremes`]), depend
//! on the size of the cells, and have an interval for 95 of 100 cases. This module knows values and
//! areas, not sensors.

use crate::measure::evidence::{Evidence, MIN_COUNTS, enough_batches, status_by_error};
use crate::measure::extremes::{CorrectedStatistic, TWO_SIDED_95, evenness, maximum};
use crate::measure::noisy::WeightedValue;
use crate::measure::{Measure, Status};
use serde::Serialize;

/// An extreme that was corrected by more than this share (of the average for the smallest, of itself for the
/// largest) is mostly noise.
const NOISE_LIMIT: f64 = 0.1;

/// Ends of an interval.
const LOW: usize = 0;
const HIGH: usize = 1;

/// A statistic of a map, corrected for noise.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Statistic {
    /// Corrected value, in the unit of the map or 1. Where the status is `noise_limited`, a bound
    /// of the true value: a lower bound for smallest values and their ratios, an upper bound for
    /// largest values.
    pub value: f64,
    /// Standard error of the value.
    pub std_error: f64,
    /// Possible bias of the corrected value, in addition to the noise; `None` where it is unbiased.
    pub bias: Option<f64>,
    /// Contains the true value in 95 of 100 cases.
    pub interval: [f64; 2],
    /// The correction included in the value: the value as read is `value - correction`.
    pub correction: f64,
    /// Whether these values are reliable.
    pub status: Status,
}

impl Statistic {
    /// The same as a measure.
    pub(crate) fn measure(&self, evidence: &Evidence<'_>, unit: &str) -> Measure {
        let Self { value, std_error, bias, status, .. } = *self;
        Measure { bias, ..evidence.measure(value, std_error, unit, status) }
    }
}

/// Extremes and their ratios over a set of cells or points.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Uniformity {
    /// The smallest value, in the unit of the map.
    pub min: Statistic,
    /// The largest value, in the unit of the map.
    pub max: Statistic,
    /// The average value, in the unit of the map.
    pub avg: Statistic,
    /// Smallest over average, 1.
    pub min_avg: Statistic,
    /// Smallest over largest, 1.
    pub min_max: Statistic,
    /// Largest over smallest, 1; infinite where the smallest is zero.
    pub max_min: Statistic,
}

/// Uniformity of a map.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UniformitySummary {
    /// Number of parts of the sensor that the extremes use: cells with at least half of their own
    /// area on it, and groups of cells cut to less by the rim, merged until they make half a cell.
    pub cells: usize,
    /// Size of a cell in the unit of the map's axes: width and height; for rings, their width and
    /// the mean length of an arc; for an image, the size of a pixel in its middle.
    pub cell_size: [f64; 2],
    /// Over all these cells; the average is over the whole sensor.
    pub all: Uniformity,
    /// Standard deviation over mean by area, over the whole sensor, 1.
    pub cv: Statistic,
    /// Over the middles of 3 x 3 equal fields; `None` where one of them is not on the sensor or
    /// there are too few cells.
    pub nine: Option<Uniformity>,
    /// Over these nine and four points near the corners.
    pub thirteen: Option<Uniformity>,
}

/// Values over a surface with their noise.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ValueField<'a> {
    /// The values that count for the extremes, with their areas; neighbours in the list are neighbours on the surface.
    pub(crate) cells: &'a [WeightedValue],
    /// Their average and its standard error.
    pub(crate) avg: [f64; 2],
    /// Counts in an average cell, 1.
    pub(crate) counts: f64,
    /// Number of batches.
    pub(crate) batches: u64,
    /// Whether no source emits this light: its zeros are exact.
    pub(crate) is_dark: bool,
}

impl ValueField<'_> {
    fn status(&self) -> Status {
        if self.avg[0] <= 0.0 || self.cells.is_empty() {
            Status::NoSignal
        } else if self.counts < MIN_COUNTS {
            Status::TooFew
        } else {
            enough_batches(self.batches)
        }
    }

    /// Status of the largest value alone: it may be well known where most of a field is dark.
    fn status_of_largest(&self, status: Status) -> Status {
        let reads = self.cells.iter().map(|part| part.read);
        match reads.max_by(|a, b| a.value.total_cmp(&b.value)) {
            Some(largest) if status == Status::TooFew => {
                status_by_error(largest.value, largest.std_error)
                    .worst(enough_batches(self.batches))
            }
            Some(_) | None => status,
        }
    }
}

/// Extremes, their ratios, and the coefficient of variation.
pub(crate) fn uniformity(field: &ValueField<'_>) -> (Uniformity, Statistic) {
    let status = field.status();
    let avg = average(field, if field.is_dark { Status::Ok } else { status });
    if status == Status::NoSignal {
        let (unknown, ratio) = (Statistic::unknown(f64::INFINITY), Statistic::unknown(1.0));
        let level = if field.is_dark { avg } else { unknown };
        let max_min = Statistic { value: f64::INFINITY, ..unknown };
        let dark =
            Uniformity { min: level, max: level, avg, min_avg: ratio, min_max: ratio, max_min };
        return (dark, unknown);
    }
    if let [_] = field.cells {
        // A single cell is all three, however noisy it is.
        let (value, std_error, interval) = (1.0, 0.0, [1.0, 1.0]);
        let even = Statistic { value, std_error, interval, ..avg };
        let one =
            Uniformity { min: avg, max: avg, avg, min_avg: even, min_max: even, max_min: even };
        return (one, Statistic { value: 0.0, interval: [0.0; 2], ..even });
    }
    let found = evenness(field.cells);
    let min = extreme(&found.min, LOW, avg.value, status);
    let max = extreme(&found.max, HIGH, found.max.raw, field.status_of_largest(status));
    let min_avg = extreme(&found.min_avg, LOW, 1.0, status).worst(min.status);
    let both = min.status.worst(max.status);
    let min_max = extreme(&found.min_max, LOW, 1.0, status).worst(both);
    // An infinite scale: noise is subtracted from a CV, so no correction of it is too large to be trusted.
    let cv = Statistic { bias: None, ..extreme(&found.cv, HIGH, f64::INFINITY, status) };
    (Uniformity { min, max, avg, min_avg, min_max, max_min: min_max.inverse() }, cv)
}

/// The largest of some values alone. It may be well known where most of them are dark.
pub(crate) fn largest(cells: &[WeightedValue], batches: u64) -> Statistic {
    let reads = cells.iter().map(|part| part.read);
    match reads.max_by(|a, b| a.value.total_cmp(&b.value)) {
        Some(largest) if largest.value > 0.0 => {
            let status =
                status_by_error(largest.value, largest.std_error).worst(enough_batches(batches));
            let found = maximum(cells);
            extreme(&found, HIGH, found.raw, status)
        }
        Some(_) | None => Statistic::unknown(f64::INFINITY),
    }
}

fn average(field: &ValueField<'_>, status: Status) -> Statistic {
    let [value, std_error] = field.avg;
    let reach = TWO_SIDED_95 * std_error;
    Statistic {
        value,
        std_error,
        bias: None,
        interval: [(value - reach).max(0.0), value + reach],
        correction: 0.0,
        status,
    }
}

/// A corrected statistic. Where the correction is large against `scale`, noise hides the value, and
/// it is replaced by a bound of the interval.
fn extreme(found: &CorrectedStatistic, end: usize, scale: f64, status: Status) -> Statistic {
    let is_hidden = (found.value - found.raw).abs() > NOISE_LIMIT * scale;
    let value = if is_hidden { found.interval[end] } else { found.value };
    Statistic {
        value,
        std_error: found.std_error,
        bias: Some(found.bias.hypot(value - found.value)),
        interval: found.interval,
        correction: value - found.raw,
        status: status.worst(if is_hidden { Status::NoiseLimited } else { Status::Ok }),
    }
}

impl Statistic {
    /// A statistic known only by an upper limit.
    fn unknown(limit: f64) -> Self {
        Self {
            value: 0.0,
            std_error: f64::INFINITY,
            bias: None,
            interval: [0.0, limit],
            correction: 0.0,
            status: Status::NoSignal,
        }
    }

    /// The same with a status at least as bad.
    fn worst(self, status: Status) -> Self {
        Self { status: self.status.worst(status), ..self }
    }

    /// Its reciprocal.
    fn inverse(self) -> Self {
        let value = 1.0 / self.value;
        if !value.is_finite() {
            return Self { value: f64::INFINITY, ..Self::unknown(f64::INFINITY) };
        }
        let raw = 1.0 / (self.value - self.correction);
        Self {
            value,
            std_error: self.std_error * value * value,
            bias: self.bias.map(|bias| bias * value * value),
            interval: [1.0 / self.interval[1], 1.0 / self.interval[0]],
            correction: value - raw,
            status: self.status,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::noise::Noise;
    use crate::measure::noisy::Noisy;

    fn cell(value: f64, std_error: f64) -> WeightedValue {
        WeightedValue { read: Noisy { value, std_error, count: 0.0 }, weight: 1.0 }
    }

    fn field(cells: &[WeightedValue]) -> ValueField<'_> {
        let n = cells.len() as f64;
        let avg = cells.iter().map(|cell| cell.read.value).sum::<f64>() / n;
        let error = cells.iter().map(|cell| cell.read.std_error.powi(2)).sum::<f64>().sqrt() / n;
        ValueField { cells, avg: [avg, error], counts: 1e4, batches: 128, is_dark: false }
    }

    #[test]
    fn statistics_without_noise_are_the_plain_ones() {
        let cells = [1.0, 2.0, 4.0, 1.0].map(|value| cell(value, 0.0));
        let (found, cv) = uniformity(&field(&cells));
        assert_eq!(
            [found.min_avg.value, found.min_max.value, found.max_min.value],
            [0.5, 0.25, 4.0]
        );
        assert_eq!(found.min_avg.interval, [0.5; 2]);
        assert_eq!((found.min.status, found.min.correction), (Status::Ok, 0.0));
        assert!((cv.value - (1.5f64).sqrt() / 2.0).abs() < 1e-15);
    }

    #[test]
    fn a_single_cell_is_even_and_its_extremes_are_its_value() {
        let (found, _) = uniformity(&field(&[cell(0.3, 0.1)]));
        assert_eq!([found.min.value, found.max.value], [0.3; 2]);
        assert_eq!([found.min.std_error, found.max.std_error], [0.1; 2]);
        let ratios = [found.min_avg, found.min_max, found.max_min];
        assert!(ratios.iter().all(|ratio| (ratio.value, ratio.std_error) == (1.0, 0.0)));
    }

    #[test]
    fn a_flat_field_under_noise_is_flat_again_and_much_noise_is_said() {
        let mut noise_of_cells = Noise::new();
        for (noise, expected) in [(0.01, Status::Ok), (0.1, Status::NoiseLimited)] {
            let cells: Vec<_> =
                (0..1024).map(|_| cell(1.0 + noise * noise_of_cells.normal(), noise)).collect();
            let (found, _) = uniformity(&field(&cells));
            let total = found.min_avg.std_error.hypot(found.min_avg.bias.unwrap());
            assert!((found.min_avg.value - 1.0).abs() < 3.0 * total, "{:?}", found.min_avg);
            assert!(found.min_avg.value - found.min_avg.correction < 1.0 - 2.5 * noise);
            assert_eq!([found.min_avg.status, found.min_max.status], [expected; 2]);
            let [low, high] = found.min_avg.interval;
            assert!(low > 1.0 - 2.5 * noise && high == 1.0, "{:?}", found.min_avg);
        }
    }

    #[test]
    fn the_coefficient_of_variation_loses_the_noise_and_its_interval_holds() {
        let mut noise_of_cells = Noise::new();
        // Half the cells at 1 - d, half at 1 + d: a true CV of d.
        for (d, noise) in [(0.1, 0.03), (0.03, 0.03), (0.01, 0.1), (0.0, 0.03)] {
            let trials = 200;
            let (mut held, mut sum) = (0, 0.0);
            for _ in 0..trials {
                let level = |i: u32| if i.is_multiple_of(2) { 1.0 - d } else { 1.0 + d };
                let cells: Vec<_> = (0..1024)
                    .map(|i| cell(level(i) + noise * noise_of_cells.normal(), noise))
                    .collect();
                let (_, found) = uniformity(&field(&cells));
                held += i32::from(found.interval[0] <= d && d <= found.interval[1]);
                sum += (found.value.powi(2) - d * d) / f64::from(trials);
            }
            // 95 % of 200 is 190, with a standard deviation of 3.1.
            assert!(held > 180, "d {d} noise {noise}: {held} of {trials}");
            // Mean of the squares: clamping at zero can only raise it, by at most the error of one trial.
            assert!(sum.abs() < noise * noise / 16.0, "d {d} noise {noise}: {sum}");
        }
    }

    #[test]
    fn the_largest_of_single_counts_is_not_corrected_to_nothing() {
        let mut cells: Vec<_> =
            (0..1000).map(|i| if i % 10 == 0 { cell(1.0, 1.0) } else { cell(0.0, 0.0) }).collect();
        for cell in &mut cells {
            cell.read.count = 1.0;
        }
        let (found, _) = uniformity(&field(&cells));
        assert!(found.max.value >= 0.1 - 1e-12, "{:?}", found.max);
        assert_eq!(found.min_max.status, Status::NoiseLimited);
        assert_eq!(found.min_max.interval[1], 1.0);
    }

    #[test]
    fn darkness_and_few_counts_are_said() {
        let dark = [cell(0.0, 0.0); 4];
        let (found, _) = uniformity(&field(&dark));
        assert_eq!(
            [found.min.status, found.min_avg.status, found.max_min.status],
            [Status::NoSignal; 3]
        );
        assert_eq!(found.min_avg.std_error, f64::INFINITY);
        let cells = [cell(1.0, 0.5); 9];
        let (few, _) = uniformity(&ValueField { counts: 4.0, ..field(&cells) });
        assert_eq!(few.min_avg.status, Status::TooFew);
        let (few, _) = uniformity(&ValueField { batches: 3, ..field(&cells) });
        assert_eq!(few.min_avg.status, Status::TooFew);
    }

    #[test]
    fn a_dark_spot_makes_the_largest_over_the_smallest_infinite() {
        let cells = [cell(0.0, 0.0), cell(1.0, 0.001), cell(1.0, 0.001)];
        let (found, _) = uniformity(&field(&cells));
        assert_eq!(found.min_max.value, 0.0);
        assert_eq!(found.max_min.value, f64::INFINITY);
        assert_eq!(found.max_min.status, Status::NoSignal);
    }
}
