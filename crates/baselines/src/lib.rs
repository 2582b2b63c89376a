//! Baselines: methods that others use, for comparison with the estimators of this program.
//!
//! Each is a small textbook implementation that estimates one sensor: flux per cell and by source,
//! as [`Readings`] of batches that the measure layer reads like any other. A scene cannot select
//! them. This crate does not know what they are compared with, nor the clock.

mod metropolis;
mod one_sensor;
mod primary;
mod sppm;
mod whitted;

use lumiduct_core::plan::RunPlan;
use lumiduct_core::scene::{Scene, SensorId};
use lumiduct_core::tally::Tally;
use lumiduct_core::transport::Readings;
use lumiduct_core::transport::tally::sums::Sums;
use metropolis::Metropolis;
use rayon::prelude::*;
use sppm::Sppm;
use whitted::Whitted;

pub use sppm::sppm_area_ratio;

use crate::one_sensor::{BaselineBatch, OneSensor};

/// A method to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Baseline {
    /// Stochastic progressive photon mapping without an estimate on specular surfaces.
    Sppm,
    /// Gather paths that split at every smooth interface.
    Whitted,
    /// Metropolis light transport in primary sample space, on gather paths.
    Metropolis,
}

impl Baseline {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Sppm, Self::Whitted, Self::Metropolis];

    /// Its name on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sppm => "sppm",
            Self::Whitted => "whitted",
            Self::Metropolis => "metropolis",
        }
    }
}

/// A running baseline on one sensor.
#[derive(Debug)]
pub struct BaselineRun<'s> {
    work: Work<'s>,
    sums: Sums<Readings>,
    batches: u64,
    cut: Tally,
}

#[derive(Debug)]
enum Work<'s> {
    Sppm(Box<Sppm<'s>>),
    Whitted(Whitted<'s>),
    Metropolis(Metropolis<'s>),
}

impl<'s> BaselineRun<'s> {
    /// Prepares a run; nothing is counted yet. Of the plan it uses the seed, the bounce limit and
    /// the gather settings.
    pub fn new(scene: &'s Scene, sensor: SensorId, plan: &RunPlan, baseline: Baseline) -> Self {
        let sensor = OneSensor::new(scene, sensor, plan);
        let work = match baseline {
            Baseline::Sppm => Work::Sppm(Box::new(Sppm::new(sensor, plan))),
            Baseline::Whitted => Work::Whitted(Whitted::new(sensor)),
            Baseline::Metropolis => Work::Metropolis(Metropolis::new(sensor)),
        };
        Self { work, sums: Sums::default(), batches: 0, cut: Tally::default() }
    }

    /// Traces a batch for each thread.
    pub fn next_piece(&mut self) {
        let end = self.batches + rayon::current_num_threads() as u64;
        self.trace_until(end);
    }

    /// Traces until `batches` batches are done.
    pub fn trace_until(&mut self, batches: u64) {
        let traced: Vec<BaselineBatch> =
            (self.batches..batches).into_par_iter().map(|batch| self.work.batch(batch)).collect();
        for batch in traced {
            self.sums.push(batch.readings);
            self.cut.add(batch.cut);
        }
        self.batches = self.batches.max(batches);
    }

    /// Everything counted so far; `None` before the first batch.
    pub fn readings(&self) -> Option<Readings> {
        self.sums.total()
    }

    /// Throughput that was cut off, as a share of all gather paths, 1: the light along it is
    /// missing.
    pub fn cut(&self) -> f64 {
        self.cut.mean()
    }
}

impl Work<'_> {
    fn batch(&self, batch: u64) -> BaselineBatch {
        match self {
            Self::Sppm(sppm) => BaselineBatch { readings: sppm.pass(batch), cut: 0.0 },
            Self::Whitted(whitted) => whitted.batch(batch),
            Self::Metropolis(metropolis) => {
                BaselineBatch { readings: metropolis.chain(batch), cut: 0.0 }
            }
        }
    }
}
