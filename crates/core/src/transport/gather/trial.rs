//! A trial of the gather estimator, with passes that are a part of those of a run.

use crate::plan::{Estimator, Schedule};
use crate::scene::SensorId;
use crate::transport::Readings;
use crate::transport::forward::photons_of;
use crate::transport::gather::estimator::Gather;
use crate::transport::gather::settings::{GatherSettings, settle};
use crate::transport::gather::stages::FIRST_PASSES;
use crate::transport::gather::window::ESTIMATES;
use crate::transport::stop::Pace;
use crate::transport::tally::work::{self, RecordWork};
use crate::transport::task::Task;
use crate::transport::trial::{SEED, Trials, Tried, flux};
use rayon::prelude::*;

/// Passes from which gathering is judged: fewer would contain more pairs, but give the variance
/// less accurately.
const PASSES: u64 = 8;
/// Variance of E0 over that of E1 where pairs limit both, 1: weights of 5, 1, 1 and -3 in the
/// quarters of the window. With the few pairs of a pilot, the latter is known much better.
const EXTRAPOLATED: f64 = 9.0;
/// Smallest relative variance of a pass times its photons, or its gather paths: the limit for
/// unlimited pairs.
const PER_PATH: f64 = 4.0;

/// A pass of a trial.
struct TriedPass {
    photons: Readings,
    /// E1, E2, E3 and E0; not closed.
    windows: [Readings; ESTIMATES],
    work: RecordWork,
}

/// Tries passes with fewer photons and gather paths than those of a run, by one factor, and finds
/// the cost of the run's passes: pairs, and the work they cause, grow with the square of that
/// factor. `None` if stopped.
pub(crate) fn trial(trials: &Trials<'_>) -> Option<Vec<Tried>> {
    let Trials { scene, plan, photons: pilot, sensors, effort, signal } = *trials;
    let settings = settle(scene, plan, sensors, pilot, signal)?;
    let by_photons = settings.photons as f64 * work::of_photon_path(pilot.segments_per_path);
    let all = (settings.gather_paths * sensors.len() as u64) as f64;
    let by_records = all * work::of_recorded_path(f64::from(settings.depth) + 1.0);
    let part = (effort / PASSES as f64 / (by_photons + by_records)).min(1.0);
    let scaled = |count: u64| ((part * count as f64).ceil() as u64).max(1);
    let forward = photons_of(trials, scaled(settings.photons));
    let own = GatherSettings {
        gather_paths: scaled(settings.gather_paths),
        schedule: Schedule::Stages,
        ..settings
    };
    let gather = Gather::new(scene, sensors, plan.seed ^ SEED, own);
    let photon_fluxes = forward.photon_fluxes();
    let pass = |batch| {
        let pace = Pace::new(signal);
        let task = Task { batch, stage: 0, photon_fluxes: &photon_fluxes, pace: &pace };
        let mut stream = gather.begin(task)?;
        let photons = forward.batch_observed(batch, &mut stream, &pace)?;
        let (windows, work) = stream.finish();
        (!pace.is_stopped()).then_some(TriedPass { photons, windows, work })
    };
    let passes: Option<Vec<TriedPass>> = (0..PASSES).into_par_iter().map(pass).collect();
    let passes = passes?;
    let [wide, values, apart] = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, -1.0, 0.0]]
        .map(|factors| combined(&passes, factors));
    let gathered = gather.settings.batch_paths(0);
    let work: f64 = passes.iter().map(|pass| work_of_whole(pass, gathered, part)).sum();
    let seconds = 1e-9 * work / PASSES as f64;
    let least = PER_PATH / settings.photons as f64 + PER_PATH / settings.gather_paths as f64;
    let tried = trials.judged(&wide, 1e9 * seconds, Estimator::Gather);
    let judged = tried.into_iter().zip(sensors).map(|(mut tried, &sensor): (Tried, &SensorId)| {
        let [wide, flux, apart] = [&wide, &values, &apart].map(|sums| flux(scene, sums, sensor));
        let trial = &mut tried.trial;
        trial.bias = (wide.mean() != 0.0).then(|| (apart.mean() / wide.mean()).abs());
        trial.least = FIRST_PASSES as f64 * seconds;
        // The cost of one pass, and of one of the run's.
        let of_pass =
            |cost: f64| (EXTRAPOLATED * cost * PASSES as f64 * part * part).max(seconds * least);
        trial.cost = trial.cost.map(of_pass);
        Tried { flux, bias: Some(apart), ..tried }
    });
    Some(judged.collect())
}

/// Sums of E1, E2 and E0 with factors, pass by pass.
fn combined(passes: &[TriedPass], [e1, e2, e0]: [f64; 3]) -> Vec<Readings> {
    let of_pass = |pass: &TriedPass| {
        let [wide, middle, _, extrapolated] = &pass.windows;
        let mut sum = wide.combined([e1, e2], middle).combined([1.0, e0], extrapolated);
        sum.close_batch();
        sum
    };
    passes.iter().map(of_pass).collect()
}

/// Work of a pass of the run, from a pass of the pilot that is a part of it with this many gather
/// paths.
fn work_of_whole(pass: &TriedPass, gather_paths: u64, part: f64) -> f64 {
    let RecordWork { records, look_ups, near, pairs } = pass.work;
    let grown = |count: u64, factor: f64| (count as f64 / factor) as u64;
    let near_of_whole = grown(near, part * part).min(grown(pass.photons.segments, part));
    let records = RecordWork {
        records: grown(records, part),
        // The filter is built for the records, so its errors scale with the photons alone.
        look_ups: grown(look_ups - near, part) + near_of_whole,
        near: near_of_whole,
        pairs: grown(pairs, part * part),
    };
    let gathering = work::of_gather_paths(gather_paths, pass.windows[0].segments);
    (work::of_photons(&pass.photons) + gathering) / part + work::of_records(records)
}
