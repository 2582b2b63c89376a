//! From the scalars of the readings to measures: sums, shares, and when they can be trusted.
//!
//! Errors come from groups of batches. This module does not know what the scalars mean.

use crate::measure::light::LightSelection;
use crate::measure::{Measure, Status};
use crate::plan::Estimator;
use crate::scene::{Scene, SensorId};
use crate::transport::{Layout, MIN_LIT_GROUPS, Readings};
use std::ops::Range;

/// With fewer counts than this, the error bar of a value is not trustworthy. n counts of equal flux have a
/// relative error of 1/sqrt(n), so this is a relative error above 32 %.
pub(crate) const MIN_COUNTS: f64 = 10.0;

/// Variance between batches, relative to the square of the mean, that rounding in a sum of squares
/// may cause.
const SQUARES_ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A scene and what was counted in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Evidence<'a> {
    pub(crate) scene: &'a Scene,
    /// The readings that give a sensor's light.
    pub(crate) readings: &'a Readings,
    /// The readings for all that only photons can measure.
    photons: &'a Readings,
    /// Number of paths that could find the light.
    paths: u64,
    pub(crate) layout: Layout,
    estimator: Estimator,
}

impl<'a> Evidence<'a> {
    /// Photons give all values.
    pub(crate) fn new(scene: &'a Scene, photons: &'a Readings) -> Self {
        let (layout, estimator) = (Layout::new(scene), Estimator::Forward);
        Self { scene, readings: photons, photons, paths: photons.paths(), layout, estimator }
    }

    /// Other readings give the light of a sensor.
    pub(crate) fn by(self, readings: &'a Readings, (estimator, id): (Estimator, SensorId)) -> Self {
        Self { readings, estimator, paths: readings.paths_for(id), ..self }
    }

    /// The evidence of photons alone.
    pub(crate) fn of_photons(&self) -> Self {
        let (readings, paths) = (self.photons, self.photons.paths());
        Self { readings, paths, estimator: Estimator::Forward, ..*self }
    }

    /// Mean flux of one path, lm or W.
    pub(crate) fn path_flux(&self) -> f64 {
        self.scene.source_flux() * self.scene.luminous_gain() / self.paths as f64
    }

    /// A measure from these readings.
    pub(crate) fn measure(
        &self,
        value: f64,
        std_error: f64,
        unit: &str,
        status: Status,
    ) -> Measure {
        Measure {
            value,
            // A single group of batches leaves the error undefined.
            std_error: if std_error.is_nan() { f64::INFINITY } else { std_error },
            bias: None,
            unit: unit.to_owned(),
            batches: self.readings.batch_count(),
            paths: self.paths,
            estimator: self.estimator,
            status,
        }
    }

    /// Sum of fluxes, times a factor that leads to `unit`.
    pub(crate) fn sum(&self, slots: &[usize], factor: f64, unit: &str) -> Measure {
        let total = self.readings.sum(slots);
        let lit = self.readings.lit_groups(slots);
        if lit == 0 {
            return self.measure(0.0, self.path_flux() * factor, unit, Status::NoSignal);
        }
        let (value, std_error) = (total.mean() * factor, total.std_error() * factor);
        self.measure(value, std_error, unit, trust(value, std_error, lit))
    }

    /// Parts over a whole, with the error of the ratio.
    pub(crate) fn ratio(&self, parts: &[usize], whole: &[usize]) -> Measure {
        let sum = |flux: &dyn Fn(usize) -> f64, slots: &[usize]| {
            slots.iter().map(|&slot| flux(slot)).sum::<f64>()
        };
        if self.readings.lit_groups(whole) == 0 {
            return self.measure(0.0, f64::INFINITY, "1", Status::NoSignal);
        }
        let lit = self.readings.lit_groups(parts);
        if lit == 0 {
            let whole = self.readings.function(|flux| sum(flux, whole)).mean();
            return self.measure(0.0, self.path_flux() / whole, "1", Status::NoSignal);
        }
        let (value, std_error) =
            self.readings.jackknife(|flux| sum(flux, parts) / sum(flux, whole));
        self.measure(value, std_error, "1", trust(value, std_error, lit))
    }

    /// A function of mean scalars that is not defined without `light`, with its error.
    pub(crate) fn function(
        &self,
        light: &[usize],
        unit: &str,
        function: impl Fn(&dyn Fn(usize) -> f64) -> f64,
    ) -> Measure {
        let lit = self.readings.lit_groups(light);
        if lit == 0 {
            return self.measure(0.0, f64::INFINITY, unit, Status::NoSignal);
        }
        let (value, std_error) = self.readings.jackknife(function);
        let light = self.readings.sum(light);
        // Where it is undefined without some group, its error is unknown.
        let status = if std_error.is_finite() {
            trust(light.mean(), light.std_error(), lit)
        } else {
            Status::TooFew
        };
        self.measure(value, std_error, unit, status)
    }

    /// The mean of a number over the light of a sensor, from the sum of flux times that number and the flux of
    /// light beyond some numbers. One more count whose number differs by 1 is always possible: where all
    /// counted ones agree, that is the error. The error cannot be trusted where photons show that such a tail shifts the mean by
    /// more than that, and the paths have hardly sampled it.
    pub(crate) fn mean_number(
        &self,
        weighted: &[usize],
        flux: &[usize],
        mut tails: impl Iterator<Item = (usize, f64)>,
    ) -> Measure {
        let mean = self.ratio(weighted, flux);
        if mean.status == Status::NoSignal {
            return mean;
        }
        let all = self.readings.sum(flux);
        // n counts of equal flux have a relative error of 1/sqrt(n), and photons have counts of known flux.
        let by_error = (all.std_error() / all.mean()).powi(2);
        let one_count = match self.estimator {
            Estimator::Forward => by_error.max(self.path_flux() / all.mean()),
            _ => by_error,
        };
        let std_error = mean.std_error.hypot(one_count);
        let photons = self.of_photons();
        let is_missed = |(tail, number): (usize, f64)| {
            let known = photons.ratio(&[tail], flux);
            known.status == Status::Ok
                && known.value * number > std_error
                && self.ratio(&[tail], flux).status != Status::Ok
        };
        let misses = self.estimator != Estimator::Forward && tails.any(is_missed);
        let status = if misses { mean.status.worst(Status::TooFew) } else { mean.status };
        Measure { std_error, status, ..mean }
    }

    /// Flux of a sensor over flux that only photons know.
    pub(crate) fn ratio_to_photons(&self, parts: &[usize], whole: &[usize]) -> Measure {
        if self.estimator == Estimator::Forward {
            return self.ratio(parts, whole);
        }
        let whole = self.of_photons().sum(whole, 1.0, "1");
        let part = self.sum(parts, 1.0, "1");
        if whole.value == 0.0 {
            return self.measure(0.0, f64::INFINITY, "1", Status::NoSignal);
        }
        // Counted by different paths, the two are independent; where photons contribute to both,
        // the error is slightly too large.
        let value = part.value / whole.value;
        let std_error = part.std_error.hypot(value * whole.std_error) / whole.value;
        self.measure(value, std_error, "1", part.status.worst(whole.status))
    }

    /// A level of light that is known to be zero.
    pub(crate) fn no_light(&self, unit: &str) -> Measure {
        self.measure(0.0, 0.0, unit, Status::Ok)
    }

    /// A line of the run's own books: the count is exact, even where it is zero.
    pub(crate) fn entry(&self, value: impl Fn(&dyn Fn(usize) -> f64) -> f64) -> Measure {
        let tally = self.readings.function(value);
        let unit = self.scene.unit.flux();
        self.measure(tally.mean(), tally.std_error(), unit, Status::Ok)
    }

    /// Mean flux of some light over batches with its standard error for some values of a sensor, lm
    /// or W. A single batch leaves the errors infinite. No flux is negative: where negative weights make it
    /// so, its error is at least as large.
    pub(crate) fn cell_flux(
        &self,
        id: SensorId,
        light: LightSelection,
        values: Range<usize>,
    ) -> Vec<(f64, f64)> {
        let reading = &self.readings.sensors[id.index()];
        let cells = match light {
            LightSelection::All => &reading.cells,
            LightSelection::Group(group) => &reading.groups[group.index()],
        };
        let batches = self.readings.batch_count();
        let known = |mean: f64, error: f64| {
            if error.is_nan() {
                f64::INFINITY
            } else if error <= self.rounding(mean) {
                0.0
            } else {
                error
            }
        };
        let mean = |cell| cells.mean(cell, batches);
        values.map(mean).map(|(mean, error)| (mean, known(mean, error).max(-mean))).collect()
    }

    /// Largest standard error of a cell that a sum of squares may hide by rounding.
    pub(crate) fn rounding(&self, mean: f64) -> f64 {
        mean.abs() * (SQUARES_ROUNDING / self.readings.batch_count() as f64).sqrt()
    }

    /// Flux that one count adds to a cell, lm or W. n counts have a mean of n and a variance of n
    /// squares.
    pub(crate) fn count_flux(&self, cells: &[(f64, f64)]) -> f64 {
        let total: f64 = cells.iter().map(|(mean, _)| mean).sum();
        let variance: f64 = cells.iter().map(|(_, error)| error * error).sum();
        if total > 0.0 { variance / total } else { self.path_flux() }
    }
}

/// Whether a positive value with this error can be relied on.
fn trust(value: f64, std_error: f64, lit_groups: usize) -> Status {
    if lit_groups < MIN_LIT_GROUPS { Status::TooFew } else { status_by_error(value, std_error) }
}

/// Whether enough was counted for a positive value: by its relative error.
pub(crate) fn status_by_error(value: f64, std_error: f64) -> Status {
    if value == 0.0 {
        Status::NoSignal
    } else if std_error * std_error * MIN_COUNTS <= value * value {
        Status::Ok
    } else {
        Status::TooFew
    }
}

/// Whether there are enough batches for any error bar: each is a sample, as each group is for a flux.
pub(crate) fn enough_batches(batches: u64) -> Status {
    if batches < MIN_LIT_GROUPS as u64 { Status::TooFew } else { Status::Ok }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::samples::{add, readings, rectangle, scene};
    use crate::scene::SourceId;

    #[test]
    fn a_function_of_light_that_is_hardly_known_has_found_too_few() {
        let scene = scene(&[("led", 1.0)], vec![("exit", rectangle(1.0, 1, 1))]);
        let slot = Layout::new(&scene).sensor_flux(SensorId::new(0), SourceId::new(0));
        let status = |flux: &dyn Fn(u64) -> f64| {
            let found = readings(&scene, 64, |index, _, batch| add(batch, slot, flux(index)));
            let evidence = Evidence::new(&scene, &found.photons);
            evidence.function(&[slot], "1", |flux| flux(slot) / flux(slot)).status
        };
        assert_eq!(status(&|_| 1.0), Status::Ok);
        // Lit in every group, but known from one of them.
        assert_eq!(status(&|index| if index == 5 { 1.0 } else { 1e-20 }), Status::TooFew);
        assert_eq!(status(&|_| 0.0), Status::NoSignal);
    }

    #[test]
    fn a_mean_whose_tail_only_photons_have_met_has_found_too_few() {
        let scene = scene(&[("led", 1.0)], vec![("exit", rectangle(1.0, 1, 1))]);
        let (exit, layout) = (SensorId::new(0), Layout::new(&scene));
        let [flux, weighted, tail] = [
            layout.sensor_flux(exit, SourceId::new(0)),
            layout.depth_weighted(exit),
            layout.deeper(exit, 0),
        ];
        // Light of one bounce, and a share of light of 20.
        let counted = |deep: &dyn Fn(u64) -> f64| {
            readings(&scene, 64, |index, _, batch| {
                // Errors of half a per cent.
                let shallow = if index % 2 == 0 { 0.96 } else { 1.04 };
                add(batch, flux, shallow + deep(index));
                add(batch, weighted, shallow + 20.0 * deep(index));
                add(batch, tail, deep(index));
            })
        };
        let status = |share: f64, met: &dyn Fn(u64) -> f64| {
            let (photons, paths) = (counted(&|_| share), counted(met));
            let evidence = Evidence::new(&scene, &photons.photons)
                .by(&paths.photons, (Estimator::Backward, exit));
            evidence.mean_number(&[weighted], &[flux], [(tail, 10.0)].into_iter()).status
        };
        assert_eq!(status(0.01, &|_| 0.0), Status::TooFew);
        assert_eq!(status(0.01, &|index| if index == 5 { 0.01 } else { 0.0 }), Status::TooFew);
        assert_eq!(status(0.01, &|_| 0.01), Status::Ok);
        // A tail that moves the mean by less than its error may be missed.
        assert_eq!(status(1e-7, &|_| 0.0), Status::Ok);
    }
}
