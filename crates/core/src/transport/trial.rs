//! Trials of estimators before a run: what each costs, measured on every sensor with the same
//! effort. This module does not draw conclusions.

pub(crate) mod strata;

use crate::plan::{Estimator, RunPlan};
use crate::scene::{Scene, SensorId, SourceId};
use crate::tally::Tally;
use crate::transport::batches::BatchSizes;
use crate::transport::photon_pilot::PhotonPilot;
use crate::transport::stop::StopSignal;
use crate::transport::tally::sensor_reading::SensorReading;
use crate::transport::trial::strata::{PAIR, TriedStrata};
use crate::transport::{Cells, Layout, Readings};
use serde::{Deserialize, Serialize};

/// Batches from which an estimator is judged: the error of a variance is then 18 %.
pub(crate) const BATCHES: u64 = 64;
/// Work of the smaller batches that are tried first, over that of the trial, 1.
const SMALL: f64 = 1.0 / 16.0;
/// Smaller batches that must have found light before their variance counts.
const LIT_BATCHES: usize = BATCHES as usize / 2;
/// The pilot uses random numbers of another seed, so that its paths do not count again in the run.
pub(crate) const SEED: u64 = 0x7069_6c6f_7431;

/// Largest power of the size of batches by which a cost may be expected to fall, 1: the variance falls as the square of the size.
const MOST_GAIN: f64 = 1.0;
/// The same of the paths in a stratum: scrambled points of a net reach a variance of n^-3 where light is smooth (Owen, Ann.
/// Stat. 25 (1997) 1541).
const MOST_GAIN_IN_STRATA: f64 = 2.0;
/// Growth of the time to an error with the bias to be removed, log2 3: a stage with half the bias has half of the pairs in a
/// pass, and twice the gather paths, which are half of the work.
const STAGE_COST: f64 = 1.585;

/// Performance of an estimator in a pilot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The estimator.
    pub estimator: Estimator,
    /// Work × relative variance, in seconds of one thread of the reference machine, or of this one if the time of the run is
    /// limited: divided by the square of a relative error, it is the time to reach that error. `None` where nothing was
    /// found.
    pub cost: Option<f64>,
    /// Bias over the value, less three of its standard errors, 1; `None` where nothing is left.
    pub bias: Option<f64>,
    /// Work before there is any result, in seconds of the same thread.
    pub least: f64,
    /// What excludes it, whatever it costs.
    pub objection: Option<Objection>,
}

impl Trial {
    /// Seconds of the same thread until a relative error is reached, 1; `None` where nothing was found.
    /// A stage of gathering that halves the bias takes about three times as long to the same noise.
    pub fn time(&self, error: f64) -> Option<f64> {
        let stages = self.bias.map_or(1.0, |bias| (bias / error).max(1.0).powf(STAGE_COST));
        self.cost.map(|cost| (stages * cost / (error * error)).max(self.least))
    }
}

/// Objections to an estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Objection {
    /// Its bias is above the target, beyond its noise.
    Biased,
    /// Its flux disagrees with an unbiased estimator's; for an unbiased one, it is less than
    /// another's.
    Contradicted,
}

/// The conditions of trials, and the effort.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trials<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) plan: &'a RunPlan,
    pub(crate) photons: PhotonPilot,
    pub(crate) sensors: &'a [SensorId],
    /// Work for each estimator, ns.
    pub(crate) effort: f64,
    /// Sizes of the batches of the run.
    pub(crate) sizes: BatchSizes<'a>,
    /// Stops the trial.
    pub(crate) signal: &'a StopSignal,
}

/// A trial, and the flux it found, batch by batch: in total, and from each source.
#[derive(Debug)]
pub(crate) struct Tried {
    pub(crate) trial: Trial,
    pub(crate) flux: Tally,
    pub(crate) by_source: Vec<Tally>,
    /// For a biased estimator: its bias, batch by batch.
    pub(crate) bias: Option<Tally>,
}

/// Batches of paths that have been traced for a trial.
#[derive(Debug)]
pub(crate) struct TriedBatches {
    pub(crate) batches: Vec<Readings>,
    /// Their work, ns.
    pub(crate) work: f64,
    /// The same if a sensor were alone.
    pub(crate) work_of_one: f64,
    /// Of each sensor, the strata that were tried; none where nothing is divided.
    pub(crate) strata: Vec<Option<TriedStrata>>,
}

impl TriedBatches {
    fn strata_of(&self, sensor: usize) -> Option<&TriedStrata> {
        self.strata.get(sensor)?.as_ref()
    }

    /// For each sensor of a scene, the share of its cost that control variates leave, 1: all of it where its cells are judged.
    fn left_by_controls(&self, scene: &Scene) -> Vec<f64> {
        let layout = Layout::new(scene);
        let counted = all_of(&self.batches);
        let adjusted = counted.clone().adjusted(scene);
        let left = |(id, reading): (usize, &SensorReading)| {
            let flux = layout.flux_slots(SensorId::new(id));
            let [of_counts, left] =
                [&counted, &adjusted].map(|readings| readings.sum(&flux).std_error());
            if reading.cells.count() == 1 && left < of_counts {
                (left / of_counts).powi(2)
            } else {
                1.0
            }
        };
        (0..).zip(&counted.sensors).map(left).collect()
    }
}

impl Trials<'_> {
    /// Tries an estimator; `trace` traces [`BATCHES`] batches with about as much work as it is given, ns. `None` if stopped.
    ///
    /// Small batches come first. They show how much work there really is, and how much more evenly points fill larger ones: a
    /// variance that falls faster than the work grows is expected to do so up to the batches of the run.
    pub(crate) fn by_size(
        &self,
        estimator: Estimator,
        trace: impl Fn(f64) -> Option<TriedBatches>,
    ) -> Option<Vec<Tried>> {
        let expected = SMALL * self.effort;
        let small = trace(expected)?;
        let large = trace(self.effort * expected / small.work)?;
        let judged = |tried: &TriedBatches| {
            let mut all = self.judged(&tried.batches, tried.work_of_one, estimator);
            for ((own, sensor), strata) in all.iter_mut().zip(self.sensors).zip(&tried.strata) {
                let Some(strata) = strata else { continue };
                own.trial.cost = strata.cost(&tried.batches, *sensor, tried.work_of_one);
                // The batches of a pair have the same strata: only means over pairs are independent.
                let of = (*sensor, PAIR);
                own.flux = flux_of(self.scene, &tried.batches, of, sources(self.scene));
                own.by_source = by_source(self.scene, &tried.batches, of);
            }
            all
        };
        let sizes = |place: usize| match [&large, &small].map(|tried| tried.strata_of(place)) {
            [Some(own), Some(few)] => Growth {
                tried: own.each as f64 / few.each as f64,
                to_run: own.each_of_run as f64 / own.each as f64,
                most_gain: MOST_GAIN_IN_STRATA,
            },
            _ => Growth {
                tried: large.work / small.work,
                to_run: BATCHES as f64 * self.sizes.work() / large.work_of_one,
                most_gain: MOST_GAIN,
            },
        };
        let left = large.left_by_controls(self.scene);
        let of_sensor = |((mut tried, smaller), place): ((Tried, Tried), usize)| {
            let lit = |batch: &&Readings| is_lit(self.scene, batch, self.sensors[place]);
            let lit = small.batches.iter().filter(lit).count();
            if let (Some(own), Some(smaller)) = (&mut tried.trial.cost, smaller.trial.cost)
                && lit >= LIT_BATCHES
            {
                *own = sizes(place).extrapolated([*own, smaller]);
            }
            tried.trial.cost = tried.trial.cost.map(|own| own * left[self.sensors[place].index()]);
            tried
        };
        let both = judged(&large).into_iter().zip(judged(&small));
        Some(both.zip(0..).map(of_sensor).collect())
    }

    /// Performance of an estimator on each sensor with this much work.
    pub(crate) fn judged(
        &self,
        batches: &[Readings],
        work: f64,
        estimator: Estimator,
    ) -> Vec<Tried> {
        let merged = all_of(batches);
        let of_sensor = |&sensor: &SensorId| {
            let variance = relative_variance(self.scene, batches, &merged, sensor);
            let cost = variance.map(|variance| 1e-9 * work * variance);
            let trial = Trial { estimator, cost, bias: None, least: 0.0, objection: None };
            let by_source = by_source(self.scene, batches, (sensor, 1));
            Tried { trial, flux: flux(self.scene, batches, sensor), by_source, bias: None }
        };
        self.sensors.iter().map(of_sensor).collect()
    }
}

/// By how much batches, or the paths in a stratum, are larger.
#[derive(Debug, Clone, Copy)]
struct Growth {
    /// In the second set of batches than in the first, 1.
    tried: f64,
    /// In the run than in the second set, 1.
    to_run: f64,
    /// Largest power of the size by which a cost falls, 1.
    most_gain: f64,
}

impl Growth {
    /// A cost in the run, from that in the second set of batches and that in the first.
    fn extrapolated(self, [own, smaller]: [f64; 2]) -> f64 {
        // A flux without noise costs nothing in batches of any size.
        if own == 0.0 { 0.0 } else { own * self.to_run.powf(-self.gain(smaller / own)) }
    }

    /// The power of the size by which a cost falls that was this much larger in the first set.
    fn gain(self, larger: f64) -> f64 {
        if self.tried <= 1.0 {
            return 0.0;
        }
        (larger.ln() / self.tried.ln()).clamp(0.0, self.most_gain)
    }
}

/// The counts of some batches together.
fn all_of(batches: &[Readings]) -> Readings {
    batches.iter().skip(1).fold(batches[0].clone(), |sum, batch| sum.merge(batch))
}

/// Whether a batch has found light on a sensor.
fn is_lit(scene: &Scene, batch: &Readings, sensor: SensorId) -> bool {
    let slots = Layout::new(scene).flux_slots(sensor);
    slots.iter().any(|&slot| batch.groups[0].sums[slot] != 0.0)
}

/// Relative variance of the mean over all batches: of the flux, or over the cells. `None` in the dark.
fn relative_variance(
    scene: &Scene,
    batches: &[Readings],
    merged: &Readings,
    sensor: SensorId,
) -> Option<f64> {
    let cells = &merged.sensors[sensor.index()].cells;
    if cells.count() > 1 {
        return variance_over_cells(cells, merged.batch_count());
    }
    let flux = flux(scene, batches, sensor);
    (flux.mean() != 0.0).then(|| (flux.std_error() / flux.mean()).powi(2))
}

/// Σ σ² / Σ mean² over cells. Where noise hides the squares it is a bound: they are at least the square of their sum over
/// their number (Cauchy and Schwarz). `None` in the dark.
fn variance_over_cells(cells: &Cells, batches: u64) -> Option<f64> {
    let (mut variance, mut square, mut sum) = (0.0, 0.0, 0.0);
    for cell in 0..cells.count() {
        let (mean, error) = cells.mean(cell, batches);
        variance += error * error;
        // Noise adds its own square to that of the mean.
        square += mean * mean - error * error;
        sum += mean;
    }
    let least = sum * sum / cells.count() as f64;
    (least > 0.0).then(|| variance / square.max(least))
}

/// The flux of a sensor, batch by batch.
pub(crate) fn flux(scene: &Scene, batches: &[Readings], sensor: SensorId) -> Tally {
    flux_of(scene, batches, (sensor, 1), sources(scene))
}

/// The flux of a sensor from each source, by this many batches at a time.
fn by_source(scene: &Scene, batches: &[Readings], of: (SensorId, usize)) -> Vec<Tally> {
    let one = |source| flux_of(scene, batches, of, std::iter::once(source));
    sources(scene).map(one).collect()
}

/// The flux of some sources, by this many batches at a time.
fn flux_of(
    scene: &Scene,
    batches: &[Readings],
    (sensor, together): (SensorId, usize),
    sources: impl Iterator<Item = SourceId> + Clone,
) -> Tally {
    let layout = Layout::new(scene);
    let flux = |batch: &Readings| -> f64 {
        let sums = &batch.groups[0].sums;
        sources.clone().map(|source| sums[layout.sensor_flux(sensor, source)]).sum()
    };
    let mean = |some: &[Readings]| some.iter().map(flux).sum::<f64>() / some.len() as f64;
    Tally::of(batches.chunks_exact(together).map(mean))
}

fn sources(scene: &Scene) -> impl Iterator<Item = SourceId> + Clone + use<> {
    (0..scene.sources.len()).map(SourceId::new)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums over some batches; each lights the cells that it lists.
    fn cells(batches: &[&[usize]]) -> Cells {
        let mut all = Cells::new(4);
        for lit in batches {
            let mut batch = Cells::new(4);
            lit.iter().for_each(|&cell| batch.add(cell, 1.0));
            batch.close_batch();
            all.merge(&batch);
        }
        all
    }

    #[test]
    fn a_cost_falls_as_far_as_smaller_batches_show() {
        let growth = |tried| Growth { tried, to_run: 4.0, most_gain: 1.0 };
        let quarter = growth(16.0).gain(4.0);
        assert!((quarter - 0.5).abs() < 1e-12, "a quarter of the cost in 16 times the size");
        assert_eq!(growth(16.0).gain(0.9), 0.0, "noise");
        assert_eq!(growth(16.0).gain(100.0), 1.0, "noise");
        assert_eq!(growth(1.0).gain(4.0), 0.0, "batches of one size");
        assert!((growth(16.0).extrapolated([2.0, 8.0]) - 1.0).abs() < 1e-12);
        assert_eq!(growth(16.0).extrapolated([0.0, 0.0]), 0.0, "no noise");
    }

    #[test]
    fn variance_over_cells_is_that_of_their_means() {
        // Cell 0 always, cell 1 in half of the batches: squares 1 and 1/4 less its variance of 1/12.
        let found = variance_over_cells(&cells(&[&[0, 1], &[0, 1], &[0], &[0]]), 4);
        assert!((found.unwrap() - (1.0 / 12.0) / (1.25 - 1.0 / 12.0)).abs() < 1e-12);
    }

    #[test]
    fn events_in_different_cells_give_a_bound() {
        // Their squares are noise; only the sum is known: (Σ mean)²/4.
        let found = variance_over_cells(&cells(&[&[0], &[1], &[2], &[3]]), 4);
        assert!((found.unwrap() - 1.0).abs() < 1e-12);
        let one = variance_over_cells(&cells(&[&[0], &[], &[], &[]]), 4);
        assert!((one.unwrap() - 4.0).abs() < 1e-12, "one event says nothing about the others");
        assert_eq!(variance_over_cells(&cells(&[&[], &[], &[], &[]]), 4), None, "in the dark");
        assert_eq!(
            variance_over_cells(&cells(&[[0, 2].as_slice(); 4]), 4),
            Some(0.0),
            "without noise"
        );
    }
}
