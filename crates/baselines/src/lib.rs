//! Baselines: methods that others use, for comparison with the estimators of this program.
//!
//! Each is kept small and ordinary and estimates one sensor: flux per cell and by source, as [`Readings`] of batches
//! that the measure layer reads like any other. No scene can ask for them. What they are compared with, and by
//! what clock, is not known here.

mod metropolis;
mod primary;
mod sppm;
mod whitted;

use lumiduct_core::plan::RunPlan;
use lumiduct_core::rng::Sampler;
use lumiduct_core::scene::{Arrival, Arrivals, Scene, SensorId};
use lumiduct_core::tally::Tally;
use lumiduct_core::transport::tally::readings::Counted;
use lumiduct_core::transport::tally::sums::Sums;
use lumiduct_core::transport::walk::emitters::{Emitters, Met};
use lumiduct_core::transport::walk::follow::{Collector, Gathering, follow};
use lumiduct_core::transport::{Layout, Path, Readings};
use metropolis::Metropolis;
use rayon::prelude::*;
use sppm::Sppm;
use whitted::Whitted;

pub use sppm::sppm_area_ratio;

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

/// Straight pieces that a batch should hold.
const BATCH_SEGMENTS: u64 = 1 << 16;
/// Gather paths from which their length is learnt.
const PILOT_PATHS: u64 = 64;
/// Stream of random numbers of these.
const PILOT_STREAM: u64 = 8 << 32;

/// A baseline at work on one sensor.
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
    /// Prepares a run; nothing is counted yet. Of the plan, its seed, its bounce limit and its wishes for gathering count.
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

    /// Traces until so many batches are done.
    pub fn trace_until(&mut self, batches: u64) {
        let traced: Vec<Batch> =
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

    /// Throughput that was cut off, as a share of all gather paths, 1: light that came that way is missing.
    pub fn cut(&self) -> f64 {
        self.cut.mean()
    }
}

/// What a batch has counted.
struct Batch {
    readings: Readings,
    /// Throughput cut off per gather path, 1.
    cut: f64,
}

impl Work<'_> {
    fn batch(&self, batch: u64) -> Batch {
        match self {
            Self::Sppm(sppm) => Batch { readings: sppm.pass(batch), cut: 0.0 },
            Self::Whitted(whitted) => whitted.batch(batch),
            Self::Metropolis(metropolis) => Batch { readings: metropolis.chain(batch), cut: 0.0 },
        }
    }
}

/// The gather paths of one sensor.
#[derive(Debug)]
struct OneSensor<'s> {
    scene: &'s Scene,
    layout: Layout,
    emitters: Emitters<'s>,
    id: SensorId,
    arrivals: Arrivals<'s>,
    seed: u64,
    bounce_limit: u32,
}

impl<'s> OneSensor<'s> {
    fn new(scene: &'s Scene, id: SensorId, plan: &RunPlan) -> Self {
        Self {
            scene,
            layout: Layout::new(scene),
            emitters: Emitters::new(scene),
            id,
            arrivals: Arrivals::new(scene, id),
            seed: plan.seed,
            bounce_limit: plan.bounce_limit,
        }
    }

    /// What its gather paths have in common, up to a depth.
    fn gathering(&self, bounce_limit: u32) -> Gathering<'_, 's> {
        let Self { scene, emitters, id: sensor, .. } = self;
        Gathering { scene, emitters, sensor: *sensor, bounce_limit, pace: None }
    }

    /// The etendue that a gather path stands for, mm² sr.
    fn etendue(&self, arrival: &Arrival) -> f64 {
        Path::arriving(self.scene, arrival).etendue(self.scene, arrival.extent)
    }

    /// A batch of so many paths, to be counted into.
    fn empty(&self, paths: u64, batch: u64) -> Readings {
        Readings::of_batch(self.scene, &self.layout, self.seed, paths, batch)
    }

    fn count(&self, readings: &mut Readings, cells: &[usize], light: &Counted) {
        readings.count(&self.layout, self.id, cells, light);
    }

    /// Gather paths that make a batch of about as much work in every scene; the same for the same seed.
    fn batch_paths(&self) -> u64 {
        let mut segments = 0;
        for index in 0..PILOT_PATHS {
            let mut sampler = Sampler::for_path(self.seed, PILOT_STREAM, index);
            if let Some(arrival) = self.arrivals.draw(&mut sampler) {
                let gathering = self.gathering(self.bounce_limit.min(10_000));
                segments += follow(gathering, &arrival, &mut sampler, &mut Onlooker);
            }
        }
        (BATCH_SEGMENTS * PILOT_PATHS / segments.max(1)).clamp(16, 1 << 14)
    }
}

/// Collects nothing.
struct Onlooker;

impl Collector for Onlooker {
    fn meet(&mut self, _: &Path, _: Met) {}
}
