//! Sizes of batches. Points fill a larger batch more evenly, so that a run of known length has as few batches as its errors
//! need; a run that may end at any time, with a target, has small ones.

use crate::plan::{RunPlan, StopRules};
use crate::rng::{Points, StratumShares};
use crate::transport::photon_pilot::PhotonPilot;
use crate::transport::tally::readings::GROUPS;
use crate::transport::tally::work;

/// Share of the work for photons where all sensors are estimated backward: for the balance and for
/// light outside the aim, 1.
pub(crate) const LEAST_SHARE: f64 = 0.1;
/// Share of the work for photons beside gather paths otherwise, 1.
pub(crate) const EQUAL_SHARE: f64 = 0.5;
/// Target number of segments of a batch: long enough that summing costs little, short enough
/// that little is lost when a run is stopped.
const BATCH_SEGMENTS: u64 = 1 << 15;
/// Most paths in a batch where a run may end after any.
const BATCH_PATHS: u64 = 4096;
/// Most segments and paths of a batch in a run to a number of paths.
const LARGE_BATCH: [u64; 2] = [1 << 20, 1 << 16];
/// The same in a run of limited time.
const LARGE_TIMED_BATCH: [u64; 2] = [1 << 21, 1 << 17];
/// Longest time of a batch in a run of limited time, ns of one thread: progress shows, and little is lost at the end.
const LONGEST_BATCH: f64 = 2.5e8;
/// Least batches for each thread in a run of limited time: its errors are then known to 18 %.
const LEAST_BATCHES: u64 = 16;
/// Share of the paths for which time is expected to suffice, 1: a run whose paths take longer still has enough batches.
const CERTAIN_SHARE: f64 = 0.8;

/// Photon paths of a batch for a scene, where a run may end after any batch.
pub(crate) fn usual_batch(pilot: PhotonPilot) -> u64 {
    Points::even_count((BATCH_SEGMENTS / pilot.segments_per_path as u64).min(BATCH_PATHS))
}

/// Sizes of the batches of a run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BatchSizes<'a> {
    plan: &'a RunPlan,
    /// Photon paths of a batch where a run may end after any.
    pub(crate) usual: u64,
    /// Most photon paths of a batch.
    most: u64,
    /// Work of a photon path, ns.
    path: f64,
    /// Work of all threads for which time suffices, ns; `None` if time is not limited.
    by_time: Option<f64>,
}

impl<'a> BatchSizes<'a> {
    /// Sizes for a run with `left` ns of work for each thread, if its time is limited.
    pub(crate) fn new(plan: &'a RunPlan, pilot: PhotonPilot, left: Option<f64>) -> Self {
        let usual = plan.batch_paths.unwrap_or(usual_batch(pilot));
        let StopRules { paths, batches, time, target, .. } = &plan.stop;
        let may_end_early = target.is_some() || (paths.is_some() && time.is_some());
        let is_known = plan.batch_paths.is_none() && (batches.is_some() || !may_end_early);
        let threads = rayon::current_num_threads() as f64;
        let left = left.filter(|_| is_known && paths.is_none());
        // A number of batches repeats a run that time has ended.
        let is_timed = left.is_some() || batches.is_some();
        let [segments, large] = if is_timed { LARGE_TIMED_BATCH } else { LARGE_BATCH };
        let path = work::of_photon_path(pilot.segments_per_path);
        // A run that repeats another has its batches, whatever the speed of its machine.
        let by_clock = left.map_or(u64::MAX, |_| (LONGEST_BATCH * pilot.speed / path) as u64);
        let large = large.min(segments / pilot.segments_per_path as u64).min(by_clock);
        let most = if is_known { usual.max(large) } else { usual };
        let by_time = left.map(|left| CERTAIN_SHARE * threads * left);
        Self { plan, usual, most, path, by_time }
    }

    /// Photon paths of a batch without other paths. A number of paths is divided evenly among the batches of whole waves, where
    /// powers of two would often be much smaller, which loses more than it gains. Where only time is limited, they are
    /// powers of two.
    pub(crate) fn photons(&self) -> u64 {
        if let Some(paths) = self.plan.stop.paths {
            let waves = paths.div_ceil(GROUPS * self.most).max(1);
            return paths.div_ceil(self.plan.stop.batches.unwrap_or(GROUPS * waves));
        }
        self.by_time.map_or(self.usual, |work| {
            // Where hardly any time is left, a batch may still take a part of the grace.
            let paths = ((work / self.path) as u64).max(self.usual);
            1 << (paths / Self::least_batches()).clamp(1, self.most).ilog2()
        })
    }

    /// Least batches of a run of limited time: it may end while every thread is in one, and few of them may be lost.
    fn least_batches() -> u64 {
        LEAST_BATCHES * rayon::current_num_threads() as u64
    }

    /// Work of such a batch, ns.
    pub(crate) fn work(&self) -> f64 {
        self.photons() as f64 * self.path
    }

    /// Photon paths of a usual batch in which they have this share of the work, and the work of its other paths, ns.
    pub(crate) fn shared(&self, share: f64) -> (u64, f64) {
        let photons = Points::even_count((share * self.usual as f64) as u64);
        (photons, (1.0 - share) / share * photons as f64 * self.path)
    }

    /// Gather paths of a batch from one sensor alone, of `of_path` ns each, before they are divided evenly among its strata.
    pub(crate) fn gather_paths(&self, of_path: f64, strata: u64) -> u64 {
        let (photons, others) = self.shared(LEAST_SHARE);
        let usual = Points::even_count((others / of_path) as u64);
        let divided = StratumShares::of(strata, usual).paths;
        let work = photons as f64 * self.path + divided as f64 * of_path;
        usual * self.growth(photons + divided, work)
    }

    /// How many times the usual paths a batch of photons and other paths has: a power of two, so that every path's number is one.
    /// A usual batch has this many paths, and this much work, ns.
    pub(crate) fn growth(&self, paths: u64, work: f64) -> u64 {
        let by_time = self.by_time.map(|all| (all / work) as u64);
        let by_paths = self.plan.stop.paths.map(|all| all / paths);
        let Some(batches) = by_paths.or(by_time) else { return 1 };
        let least = by_time.map_or(GROUPS, |_| Self::least_batches());
        let wanted = batches / self.plan.stop.batches.unwrap_or(least);
        let most = (self.most / self.usual).max(1);
        1 << wanted.clamp(1, most).ilog2()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{GatherPlan, Request, Target};
    use std::time::Duration;

    fn plan(stop: StopRules) -> RunPlan {
        RunPlan {
            estimator: Request::Forward,
            sensor_estimators: Vec::new(),
            gather: GatherPlan::default(),
            seed: 1,
            bounce_limit: 1000,
            batch_paths: None,
            stop,
        }
    }

    /// Paths of nine segments take 1150 ns.
    fn pilot() -> PhotonPilot {
        PhotonPilot::new(9.0, 20.0)
    }

    #[test]
    fn a_run_of_limited_time_has_as_few_batches_as_errors_need() {
        let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        one.install(|| {
            let time = Some(Duration::from_secs(1));
            let plan = plan(StopRules { time, ..StopRules::default() });
            let none = BatchSizes::new(&plan, pilot(), Some(0.0));
            assert_eq!(none.photons(), usual_batch(pilot()) / LEAST_BATCHES, "in the grace");
            for seconds in [0.1, 1.0, 5.0] {
                let sizes = BatchSizes::new(&plan, pilot(), Some(1e9 * seconds));
                let batches = 1e9 * seconds / sizes.work();
                assert!((20.0..=40.0).contains(&batches), "{batches} in {seconds} s");
                assert!(sizes.photons().is_power_of_two());
            }
            let long = BatchSizes::new(&plan, pilot(), Some(1e12));
            assert!(long.photons() <= LARGE_TIMED_BATCH[1], "{}", long.photons());
            let slow = PhotonPilot { speed: 0.05, ..pilot() };
            let paths = BatchSizes::new(&plan, slow, Some(1e12)).photons();
            assert_eq!(paths, 8192, "0.19 s at 23,000 ns each");
        });
    }

    #[test]
    fn gather_paths_take_about_the_work_of_a_batch() {
        let plan = plan(StopRules { time: Some(Duration::from_secs(60)), ..StopRules::default() });
        let sizes = BatchSizes::new(&plan, pilot(), Some(6e10));
        for (of_path, strata) in [(500.0, 1), (5000.0, 1), (500.0, 856)] {
            let paths = sizes.gather_paths(of_path, strata);
            let work = StratumShares::of(strata, paths).paths as f64 * of_path;
            let share = work / sizes.work();
            assert!((0.5..2.0).contains(&share), "{share}: to powers of two");
        }
    }

    #[test]
    fn a_run_that_a_target_may_end_has_usual_batches() {
        let target = Some(Target { measure: "exit.flux".into(), relative_error: 0.01 });
        let plan = plan(StopRules { target, ..StopRules::default() });
        let sizes = BatchSizes::new(&plan, pilot(), Some(1e10));
        assert_eq!((sizes.photons(), sizes.growth(100, 1e3)), (usual_batch(pilot()), 1));
    }

    #[test]
    fn the_clock_decides_nothing_where_a_number_of_paths_may_end_the_run() {
        let time = Some(Duration::from_secs(100));
        let of = |batches, paths| {
            let stop = StopRules { paths: Some(paths), batches, time, ..StopRules::default() };
            let plan = plan(stop);
            [1e8, 1e12].map(|left| {
                let sizes = BatchSizes::new(&plan, pilot(), Some(left));
                (sizes.photons(), sizes.growth(3000, 1e3))
            })
        };
        let [soon, late] = of(None, 75_000_000);
        assert_eq!(soon, late);
        assert!(soon.0 <= usual_batch(pilot()));
        assert_eq!(of(Some(100), 1_000_000), [(10_000, 2); 2]);
    }

    #[test]
    fn many_threads_have_batches_enough_each() {
        let many = rayon::ThreadPoolBuilder::new().num_threads(32).build().unwrap();
        many.install(|| {
            let time = Some(Duration::from_secs(1));
            let plan = plan(StopRules { time, ..StopRules::default() });
            let sizes = BatchSizes::new(&plan, pilot(), Some(1e8));
            let batches = 32.0 * 1e8 / sizes.work();
            assert!(batches > 600.0, "{batches}");
        });
    }

    #[test]
    fn a_stopped_run_is_repeated_with_batches_of_its_size() {
        let asked = |paths, batches| {
            plan(StopRules { paths: Some(paths), batches, ..StopRules::default() })
        };
        for growth in [1, 2, 4, 8] {
            let whole = asked(growth * GROUPS * 3000, None);
            assert_eq!(BatchSizes::new(&whole, pilot(), None).growth(3000, 1.0), growth);
        }
        let timed = plan(StopRules { time: Some(Duration::MAX), ..StopRules::default() });
        let slow = PhotonPilot { speed: 0.05, ..pilot() };
        let [most, of_slow] = [pilot(), slow]
            .map(|pilot| BatchSizes::new(&timed, pilot, Some(1e15)).growth(3000, 1e6));
        assert!(most > 8 && of_slow < most, "{most} {of_slow}");
        for growth in [1, 2, 4, 8, most, of_slow] {
            let part = asked(growth * 40 * 3000, Some(40));
            assert_eq!(BatchSizes::new(&part, pilot(), None).growth(3000, 1.0), growth);
        }
    }
}
