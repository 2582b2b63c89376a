//! The backward estimator: gather paths from the sensors, followed until they meet emission, and
//! joined to sources where they are scattered.
//!
//! A gather path carries basic radiance L/n² and represents an etendue of its sensor: the mean of
//! their product is the flux on the sensor. Points, lines and collimated beams cannot be met; a run
//! with such sources is refused beforehand. When mixed with forward, photons also count on the
//! sensors, and all count by their weights (`mix`).

use crate::plan::{Estimator, RunPlan};
use crate::rng::{Points, Sampler, StratumShares, stream};
use crate::scene::{Arrival, SensorId};
use crate::transport::backward::counter::GatherPathCounter;
use crate::transport::backward::learning::LEARNING;
use crate::transport::backward::paths::{Backward, UNCOUNTED_BATCH, Weights};
use crate::transport::connect::vertex::Turns;
use crate::transport::estimate::Estimate;
use crate::transport::stop::{Pace, StopSignal};
use crate::transport::tally::readings::MIN_LIT_GROUPS;
use crate::transport::tally::work;
use crate::transport::task::Task;
use crate::transport::trial::{BATCHES, SEED, Trials, Tried, TriedBatches};
use crate::transport::walk::follow::{Gathering, follow};
use crate::transport::{Layout, Path, Readings};
use rayon::prelude::*;

/// Most work of a trial from which angles are learned, over all of it, 1.
const LEARNING_SHARE: f64 = 0.125;
/// Standard errors of both by which photons must find more than gather paths to contradict them.
const CONTRADICTED: f64 = 4.0;
/// Possible relative rounding of a flux.
const ROUNDING: f64 = 1e-9;

impl<'s> Backward<'s> {
    /// Work of a gather path, mean of a few that are not counted; `None` if they were stopped.
    pub(crate) fn work_of_path(&self, signal: &StopSignal) -> Option<f64> {
        let pace = Pace::new(signal);
        let task = Task { batch: UNCOUNTED_BATCH, stage: 0, photon_fluxes: &[], pace: &pace };
        let traced = self.trace(task)?;
        Some(work::of_gather_paths(self.batch_paths(), &traced) / self.batch_paths() as f64)
    }

    /// Traces the gather paths of a batch. It is not closed, since photons may contribute to it.
    /// `None` if it was stopped.
    pub(crate) fn trace(&self, task: Task<'_>) -> Option<Readings> {
        self.trace_watched(task, &mut |_, _, _| ())
    }

    /// The same; `watch` is shown each path: the place of its sensor among the sensors, its start, and the basic
    /// radiance that it found.
    pub(crate) fn trace_watched(
        &self,
        task: Task<'_>,
        watch: &mut impl FnMut(usize, &Arrival, f64),
    ) -> Option<Readings> {
        let Task { batch, pace, .. } = task;
        let mut readings =
            Readings::of_batch(self.scene, &self.layout, self.seed, self.paths, batch);
        let mut joints = Sampler::for_path(self.seed, stream::JOINED_SOURCES, batch);
        for (sensor, (id, _)) in self.sensors.iter().enumerate() {
            let shares = self.shares_of_batch(sensor, batch);
            readings.sensors[id.index()].paths = shares.paths;
            let of_sensor = stream::BACKWARD_POINTS + id.index() as u64;
            let mut points = Points::of_batch((self.seed, of_sensor, batch), shares.paths);
            for place in 0..shares.paths {
                if pace.spend(1).is_break() {
                    return None;
                }
                self.trace_path(
                    (sensor, &mut points),
                    (place, shares),
                    (task, &mut joints),
                    (&mut readings, watch),
                );
            }
        }
        (!pace.is_stopped()).then_some(readings)
    }

    fn trace_path(
        &self,
        (sensor, points): (usize, &mut Points),
        (place, shares): (u64, StratumShares),
        (task, joints): (Task<'_>, &mut Sampler),
        (readings, watch): (&mut Readings, &mut impl FnMut(usize, &Arrival, f64)),
    ) {
        let (id, arrivals) = (self.sensors[sensor].0, &self.sensors[sensor].1);
        let index = task.batch * shares.paths + place;
        let mut fresh = Sampler::for_path(self.seed, stream::BACKWARD + id.index() as u64, index);
        let mut sampler = points.lead(&mut fresh);
        let start = match self.strata.get(sensor) {
            None => arrivals.draw(&mut sampler),
            Some(strata) => {
                let stratum = shares.stratum(place, &mut sampler);
                arrivals.draw_in((strata, stratum), &mut sampler)
            }
        };
        let Some(arrival) = start else { return };
        let gathering = Gathering {
            scene: self.scene,
            emitters: &self.emitters,
            sensor: id,
            bounce_limit: self.bounce_limit,
            pace: Some(task.pace),
        };
        let photon_fluxes = match self.weights {
            Weights::Full => None,
            Weights::Shared => Some(task.photon_fluxes),
        };
        let etendue = Path::arriving(self.scene, &arrival).etendue(self.scene, arrival.extent);
        let mut counter = GatherPathCounter {
            backward: self,
            arrival: &arrival,
            etendue: etendue / shares.paths as f64,
            radiance: 0.0,
            share: arrivals.polar_reciprocal(&arrival) / shares.paths as f64,
            id,
            photon_fluxes,
            batches: 1.0,
            records: None,
            turns: Turns::default(),
            joints,
            readings,
        };
        let segments = follow(gathering, &arrival, &mut sampler, &mut counter);
        watch(sensor, &arrival, counter.radiance);
        readings.segments += segments;
    }
}

/// Gather paths of some sensors with this much work in total, divided into batches, and the work of each, ns.
pub(crate) fn paths_for<'a>(trials: &Trials<'a>, effort: f64) -> Option<(Backward<'a>, f64)> {
    let Trials { scene, plan, sensors, signal, .. } = *trials;
    let RunPlan { seed, bounce_limit, .. } = plan;
    let backward = Backward::new(scene, sensors, seed ^ SEED, *bounce_limit);
    let work = backward.work_of_path(signal)?;
    let of_batch = effort / BATCHES as f64;
    Some((backward.with_paths((of_batch / sensors.len() as f64 / work) as u64), work))
}

/// Batches of a trial after `by_photons` ns of work by photons. A sensor that is alone takes its share of the gather paths.
pub(crate) fn tried_batches(
    backward: &Backward<'_>,
    batches: Vec<Readings>,
    by_photons: f64,
) -> TriedBatches {
    let of_batch = |batch: &Readings| work::of_gather_paths(backward.batch_paths(), batch);
    let by_paths: f64 = batches.iter().map(of_batch).sum();
    let work_of_one = by_photons + by_paths / backward.sensors.len() as f64;
    let strata = (0..backward.sensors.len()).map(|sensor| backward.tried_strata(sensor)).collect();
    TriedBatches { batches, work: by_photons + by_paths, work_of_one, strata }
}

/// Tries gather paths that meet the sources; `None` if stopped. Both sizes start at the angles that are learned once.
pub(crate) fn trial(trials: &Trials<'_>) -> Option<Vec<Tried>> {
    let (backward, of_path) = paths_for(trials, trials.effort)?;
    let laws = backward
        .learned_laws(LEARNING.min(LEARNING_SHARE * trials.effort) / of_path, trials.signal)?;
    trials.by_size(Estimator::Backward, |effort| {
        let (backward, of_path) = paths_for(trials, effort)?;
        let of_run = |strata| trials.sizes.gather_paths(of_path, strata);
        let backward = backward.with_laws(&laws).in_cells().trying(of_run);
        let traced = |batch| {
            let pace = Pace::new(trials.signal);
            let mut readings =
                backward.trace(Task { batch, stage: 0, photon_fluxes: &[], pace: &pace })?;
            readings.close_batch();
            Some(readings)
        };
        let batches: Option<Vec<Readings>> = (0..BATCHES).into_par_iter().map(traced).collect();
        Some(tried_batches(&backward, batches?, 0.0))
    })
}

/// The estimate of a sensor. It is unbiased, but its standard error knows only light that gather paths have met. Where they have
/// hardly met a source, photons of that source, even a single one, contradict it if they carry more flux than the error
/// allows.
pub(crate) fn estimate<'a>(
    own: &'a Readings,
    photons: &Readings,
    layout: &Layout,
    id: SensorId,
) -> Estimate<'a> {
    let slots = layout.flux_slots(id);
    let is_contradicted = slots.iter().any(|&slot| {
        let [by_photons, by_paths] = [photons, own].map(|one| one.scalar(slot));
        let error = if own.lit_groups(&[slot]) < MIN_LIT_GROUPS {
            own.sum(&slots).std_error()
        } else if photons.lit_groups(&[slot]) >= MIN_LIT_GROUPS {
            by_photons.std_error().hypot(by_paths.std_error())
        } else {
            return false;
        };
        let room = CONTRADICTED * error + ROUNDING * by_paths.mean().abs();
        by_photons.mean() - by_paths.mean() > room
    });
    Estimate { estimator: Estimator::Backward, readings: own, bias: None, is_contradicted }
}
