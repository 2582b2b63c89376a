//! A trial of the gather estimator, with passes that are a part of those of a run.

use crate::plan::{Estimator, RunPlan, Schedule};
use crate::scene::SensorId;
use crate::transport::forward::{Forward, photons_of};
use crate::transport::gather::bias::USUAL_SHARE;
use crate::transport::gather::estimator::Gather;
use crate::transport::gather::kernel::ORDERS;
use crate::transport::gather::merged::MergedStream;
use crate::transport::gather::settings::{GatherSettings, SensorGroup, WAVE_PASSES, groups};
use crate::transport::gather::stages::FIRST_PASSES;
use crate::transport::gather::stream::PhotonStream;
use crate::transport::photon_pilot::PhotonPilot;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::work::{self, RecordWork};
use crate::transport::task::Task;
use crate::transport::trial::{SEED, Trials, Tried, flux};
use crate::transport::{Observer, Readings};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;

/// Passes from which gathering is judged, in blocks like those of a run. Fewer would contain more pairs, but give a less
/// accurate variance.
const TRIED_PASSES: u64 = 2 * WAVE_PASSES;
/// Variance of E0 over that of E1 where pairs of the position-and-angle estimate limit both, 1 (`kernel`); it is smaller for
/// the other estimates. The few pairs of a pilot give the variance of E1 much more accurately.
const FOURTH_ORDER: f64 = 7.0;
/// Smallest relative variance of a pass times its photons: the limit for unlimited pairs.
const PER_PHOTON: f64 = 6.0;
/// Smallest relative variance of a pass times its gather paths in a cell.
const PER_GATHER_PATH: f64 = 1.0;
/// Standard errors that are taken off a bias, since the passes of a pilot are few.
const CERTAIN: f64 = 3.0;
/// Most work of pairs over the rest of a pass, 1: with more of them, a larger pass hardly gains.
const MOST_PAIR_WORK: f64 = 2.0;
/// Segments of photon paths of a pass that measures the work of a whole one.
const PROBED_SEGMENTS: f64 = 1e5;

/// A block of passes of a trial.
struct TriedBlock {
    /// Work of the photons of all passes, ns.
    photons: f64,
    /// Segments of the photons of all passes.
    segments: u64,
    /// E1, E0 and E00 of each pass; not closed.
    passes: Vec<[Readings; ORDERS]>,
    work: RecordWork,
}

/// Tries all sensors, group by group; `None` if stopped.
pub(crate) fn trial(trials: &Trials<'_>) -> Option<Vec<Tried>> {
    let Trials { scene, plan, photons, sensors, effort, signal, .. } = *trials;
    let groups = groups(scene, plan, (sensors, sensors.len()), photons, signal)?;
    let effort = effort / groups.len().max(1) as f64;
    let mut all = BTreeMap::new();
    for SensorGroup { sensors, settings, .. } in &groups {
        let tried = group_trial(&Trials { sensors, effort, ..*trials }, *settings)?;
        all.extend(sensors.iter().copied().zip(tried));
    }
    sensors.iter().map(|sensor| all.remove(sensor)).collect()
}

/// Tries passes with fewer photons and gather paths than those of a run, by one factor, and finds
/// the cost of the run's passes: pairs, and the work they cause, grow with the square of that
/// factor. `None` if stopped.
fn group_trial(trials: &Trials<'_>, settings: GatherSettings) -> Option<Vec<Tried>> {
    let Trials { scene, plan, photons: pilot, sensors, effort, signal, .. } = *trials;
    let segments = pilot.segments_past_records(settings.depth);
    let by_photons = settings.photons as f64 * work::of_photon_path(segments);
    let all = (settings.gather_paths * sensors.len() as u64) as f64;
    let by_records = all * work::of_recorded_path(f64::from(settings.depth) + 1.0);
    let part = (effort / TRIED_PASSES as f64 / (by_photons + by_records)).min(1.0);
    let scaled = |count: u64| scaled(count, part);
    let forward = photons_of(trials, scaled(settings.photons)).of_passes();
    let own = GatherSettings {
        gather_paths: scaled(settings.gather_paths),
        schedule: Schedule::Stages,
        ..settings
    };
    let gather = Gather::new(scene, sensors, plan.seed ^ SEED, own);
    let together = gather.passes_together();
    let block =
        |block| TriedBlock::trace((&gather, &forward), (block * together, together), signal);
    let blocks = (0..TRIED_PASSES / together).into_par_iter().map(block);
    let blocks: Option<Vec<TriedBlock>> = blocks.collect();
    let blocks = blocks?;
    let [second, values, bias] = [[1.0, 0.0], [0.0, 1.0], [USUAL_SHARE, -USUAL_SHARE]]
        .map(|factors| combined(&blocks, factors));
    let gathered = gather.batch_paths(0);
    let works: Vec<PassWork> =
        blocks.iter().map(|block| block.work_of_whole((gathered, together), part)).collect();
    let whole = PassWork::mean(&works);
    let is_given = plan.gather.photons.or(plan.gather.records).is_some();
    let size = if is_given { 1.0 } else { whole.size_for(pilot.pass_work) };
    let settings = settings.with_passes_of_size(size, &plan.gather);
    let seconds = 1e-9 * whole.of_size(size);
    let limit = |cells: usize| {
        let in_cell = settings.gather_paths as f64 / cells as f64;
        let by_paths = PER_PHOTON / settings.photons as f64 + PER_GATHER_PATH / in_cell;
        by_paths + scene.spectra.flux_variance()
    };
    // A few pairs can agree by chance, but the relative variance of a sum over a Poisson number of events of mean k is at
    // least 1/k: it is E[w²]/(k E[w]²). Without pairs, the gather paths themselves have met all light.
    let pairs: u64 = blocks.iter().map(|block| block.work.pairs).sum();
    let tried = trials.judged(&second, 1e9 * seconds, Estimator::Gather);
    let judged = tried.into_iter().zip(sensors).map(|(mut tried, &sensor): (Tried, &SensorId)| {
        let [second, flux, bias] = [&second, &values, &bias].map(|sums| flux(scene, sums, sensor));
        let trial = &mut tried.trial;
        let certain = bias.mean().abs() - CERTAIN * bias.std_error();
        trial.bias = (certain > 0.0).then(|| (certain / second.mean()).abs());
        trial.least = FIRST_PASSES as f64 * seconds;
        let limit = limit(blocks[0].passes[0][0].sensors[sensor.index()].cells.count());
        // From the cost of the trial to that of passes of a run.
        let of_run = |cost: f64| {
            let cost = if pairs > 0 { cost.max(seconds / pairs as f64) } else { cost };
            let by_pairs = FOURTH_ORDER * cost * TRIED_PASSES as f64 * (part / size).powi(2);
            by_pairs.max(seconds * limit)
        };
        trial.cost = trial.cost.map(of_run);
        Tried { flux, bias: Some(bias), ..tried }
    });
    Some(judged.collect())
}

/// Sums of E1 and E0 with factors, pass by pass.
fn combined(blocks: &[TriedBlock], factors: [f64; 2]) -> Vec<Readings> {
    let of_pass = |[second, fourth, _]: &[Readings; ORDERS]| {
        let mut sum = second.combined(factors, fourth);
        sum.close_batch();
        sum
    };
    blocks.iter().flat_map(|block| &block.passes).map(of_pass).collect()
}

/// A part of a number of paths, at least one.
fn scaled(count: u64, part: f64) -> u64 {
    ((part * count as f64).ceil() as u64).max(1)
}

/// Work of a pass of a block, ns.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PassWork {
    /// Its photons, which all groups share.
    pub(crate) photons: f64,
    /// What else grows with its photons and gather paths.
    pub(crate) by_size: f64,
    /// What grows with the square of their number.
    pub(crate) by_square: f64,
}

impl PassWork {
    /// Work of a pass of all groups, which share its photons.
    pub(crate) fn of_all(groups: &[Self]) -> Self {
        groups.iter().fold(Self { photons: 0.0, by_size: 0.0, by_square: 0.0 }, |all, own| Self {
            photons: all.photons.max(own.photons),
            by_size: all.by_size + own.by_size,
            by_square: all.by_square + own.by_square,
        })
    }

    /// The mean over blocks of one group.
    fn mean(blocks: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| blocks.iter().map(of).sum::<f64>() / blocks.len() as f64;
        Self {
            photons: mean(|pass| pass.photons),
            by_size: mean(|pass| pass.by_size),
            by_square: mean(|pass| pass.by_square),
        }
    }

    /// Work of a pass of another size, relative to this one, ns.
    fn of_size(self, size: f64) -> f64 {
        (self.photons + self.by_size + self.by_square * size) * size
    }

    /// Suitable size of passes relative to this one, at most 1: pairs take no more than their share, and the whole takes at
    /// most `work`, ns, if given.
    pub(crate) fn size_for(self, work: Option<f64>) -> f64 {
        let by_size = self.photons + self.by_size;
        // Roots of a x + b x² = work, and of b x² = most a x.
        let by_work = work.map_or(1.0, |work| {
            let root = (by_size * by_size + 4.0 * self.by_square * work).sqrt();
            2.0 * work / (by_size + root)
        });
        let by_pairs = MOST_PAIR_WORK * by_size / self.by_square;
        by_work.min(by_pairs).min(1.0)
    }
}

/// Work of a whole pass, from a small one; `None` if stopped.
pub(crate) fn pass_work(
    gather: &Gather<'_>,
    plan: &RunPlan,
    pilot: PhotonPilot,
    signal: &StopSignal,
) -> Option<PassWork> {
    let GatherSettings { photons, gather_paths, depth, .. } = gather.settings;
    let segments = photons as f64 * pilot.segments_past_records(depth);
    let part = (PROBED_SEGMENTS / segments).min(1.0);
    let scaled = |count: u64| scaled(count, part);
    let sensors: Vec<SensorId> = gather.sensors().collect();
    let settings = GatherSettings { gather_paths: scaled(gather_paths), ..gather.settings };
    let seed = plan.seed ^ SEED;
    let alone = Gather::new(gather.scene, &sensors, seed, settings);
    let probe = if gather.merging.is_some() { alone.merged(plan.bounce_limit) } else { alone };
    let forward = Forward::new(gather.scene, seed, plan.bounce_limit, scaled(photons)).of_passes();
    let block = TriedBlock::trace((&probe, &forward), (0, 1), signal)?;
    Some(block.work_of_whole((probe.batch_paths(0), probe.passes_together()), part))
}

impl TriedBlock {
    /// Traces a block of this many passes, from the first on; `None` if stopped.
    fn trace(
        (gather, forward): (&Gather<'_>, &Forward<'_>),
        (first, passes): (u64, u64),
        signal: &StopSignal,
    ) -> Option<Self> {
        let pace = Pace::new(signal);
        let photon_fluxes = forward.photon_fluxes();
        let task = Task { batch: first, stage: 0, photon_fluxes: &photon_fluxes, pace: &pace };
        let photons = (forward, first..first + passes, &pace);
        let (traced, (counts, work)) = if gather.merging.is_some() {
            let mut stream = MergedStream::begin(gather, task, passes)?;
            (trace_photons(photons, &mut stream, MergedStream::begin_pass)?, stream.finish())
        } else {
            let mut stream = gather.begin(task, passes)?;
            (trace_photons(photons, &mut stream, PhotonStream::begin_pass)?, stream.finish())
        };
        let photons = traced.iter().map(work::of_photons).sum();
        let segments = traced.iter().map(|batch| batch.segments).sum();
        let passes = counts.into_passes();
        (!pace.is_stopped()).then_some(Self { photons, segments, passes, work })
    }

    /// Work of a pass of a whole block of passes `together`, scaled up from this one, whose passes traced this many gather
    /// paths and a `part` of the photons each.
    fn work_of_whole(&self, (gather_paths, together): (u64, u64), part: f64) -> PassWork {
        let RecordWork { records, look_ups, near, pairs } = self.work;
        let grown = |count: u64, factor: f64| (count as f64 / factor) as u64;
        let passes = self.passes.len() as f64;
        let all = part * passes;
        let all_pairs = all * all / together as f64;
        let near_of_whole = grown(near, all_pairs).min(grown(self.segments, all));
        // The filter is built for the records, so its errors scale with the photons alone.
        let single = RecordWork {
            records: grown(records, all),
            look_ups: grown(look_ups - near, all),
            ..RecordWork::default()
        };
        let paired = RecordWork {
            look_ups: near_of_whole,
            near: near_of_whole,
            pairs: grown(pairs, all_pairs),
            records: 0,
        };
        let of_gathering =
            |orders: &[Readings; ORDERS]| work::of_gather_paths(gather_paths, &orders[0]);
        let gathering =
            self.passes.iter().map(of_gathering).sum::<f64>() + work::of_filtered(self.segments);
        PassWork {
            photons: self.photons / all,
            by_size: gathering / all + work::of_records(single),
            by_square: work::of_records(paired),
        }
    }
}

/// Traces the photons of some passes past the records of a stream; `None` if stopped.
fn trace_photons<O: Observer>(
    (forward, passes, pace): (&Forward<'_>, Range<u64>, &Pace<'_>),
    stream: &mut O,
    begin_pass: impl Fn(&mut O, usize),
) -> Option<Vec<Readings>> {
    let trace = |(place, pass)| {
        begin_pass(stream, place);
        forward.batch_observed(pass, stream, pace)
    };
    passes.enumerate().map(trace).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_share_the_photons_of_a_pass_and_not_its_records() {
        let group = |photons| PassWork { photons, by_size: 2.0, by_square: 5.0 };
        let all = PassWork::of_all(&[group(3.0), group(4.0)]);
        assert_eq!((all.photons, all.by_size, all.by_square), (4.0, 4.0, 10.0));
    }

    #[test]
    fn a_pass_takes_the_work_that_its_size_was_found_for() {
        let pass = PassWork { photons: 30.0, by_size: 10.0, by_square: 20.0 };
        let size = pass.size_for(Some(25.0));
        assert!((pass.of_size(size) - 25.0).abs() < 1e-9, "{size}");
        assert_eq!(pass.size_for(Some(1000.0)), 1.0, "never larger than asked");
        assert_eq!(pass.size_for(None), 1.0);
    }

    #[test]
    fn pairs_take_at_most_two_thirds_of_a_pass() {
        let pass = PassWork { photons: 30.0, by_size: 10.0, by_square: 800.0 };
        let size = pass.size_for(None);
        assert!((pass.by_square * size * size / pass.of_size(size) - 2.0 / 3.0).abs() < 1e-12);
        let none = PassWork { by_square: 0.0, ..pass };
        assert_eq!(none.size_for(None), 1.0, "no pairs, no limit");
    }
}
