//! How fast paths are traced: segments per second and their worth, compared with hand-written
//! loops.
//!
//! `cargo bench --bench segments`. Ours and the plain loop run in turn on one thread; the ratio is
//! the median over the pairs, with the smallest and largest. Worth is 1/(relative variance of the
//! exit flux × CPU s). A last table compares two threads with one by elapsed time, which is
//! meaningful only on an otherwise idle machine. Fluxes are checked against the exact values, for
//! speed of a wrong answer means nothing.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;
#[allow(dead_code, reason = "shared with other benches")]
mod guides;
#[allow(dead_code, reason = "rows are for the other bench")]
mod plain;
mod spread;

use clock::cpu_seconds;
use guides::{B1_P10, B1_P100, B2, B4, mesh_scene, rod_mesh, rod_scene, tube_scene};
use lumiduct_base::math::Frame;
use lumiduct_core::plan::{GatherPlan, Request, RunPlan, StopRules};
use lumiduct_core::scene::mesh::Mesh;
use lumiduct_core::scene::{Scene, SensorId, SourceId};
use lumiduct_core::tally::Tally;
use lumiduct_core::transport::{Layout, ROULETTE_BELOW, Readings, Run};
use plain::{Counted, Steps, Work, trace_rod, trace_tube};
use rayon::{ThreadPool, ThreadPoolBuilder};
use spread::Spread;
use std::hint::black_box;
use std::time::Instant;

/// Pairs of runs of each guide.
const PAIRS: u64 = 7;
/// Batches of both programs: one per group of the readings.
const BATCHES: u64 = 128;
/// A flux further than this from the exact value is wrong, in standard errors.
const TOO_FAR: f64 = 5.0;

/// A guide and how to trace it by hand.
struct Case {
    name: &'static str,
    scene: Scene,
    plain: Option<fn(&Work) -> Counted>,
    batch_paths: u64,
    /// Exit flux, DESIGN section 6; 1.
    exact: f64,
}

fn main() {
    let cases = cases();
    println!(
        "one thread, {PAIRS} runs each, ours and the plain loop in turn; median (smallest to largest)\n"
    );
    println!(
        "| guide | segments/path | ours, M segments/s | plain, M segments/s | ours/plain | ours: 1/(rel. variance x CPU s) | plain |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|");
    for case in &cases {
        println!("{}", compare(case, &pool(1)));
    }
    println!("\nelapsed time of one thread over that of two, in turn\n");
    println!("| guide | two threads against one |");
    println!("|---|--:|");
    for case in &cases {
        println!("| {} | {} |", case.name, spread(scaling(case), 2));
    }
}

fn cases() -> Vec<Case> {
    let mesh = rod_mesh(1.5, B2.length, 316, 158);
    vec![
        Case {
            name: "B1 p10 R95",
            scene: tube_scene(&B1_P10),
            plain: Some(|work| trace_tube(&B1_P10, work)),
            batch_paths: 4096,
            exact: 0.51084474,
        },
        Case {
            name: "B1 p100 R95",
            scene: tube_scene(&B1_P100),
            plain: Some(|work| trace_tube(&B1_P100, work)),
            batch_paths: 2048,
            exact: 0.04442615,
        },
        Case {
            name: "B2 L60",
            scene: rod_scene(&B2),
            plain: Some(|work| trace_rod(&B2, work)),
            batch_paths: 2048,
            exact: 0.84190538,
        },
        Case {
            name: "B4",
            scene: rod_scene(&B4),
            plain: Some(|work| trace_rod(&B4, work)),
            batch_paths: 4096,
            exact: 0.8464698,
        },
        Case {
            name: "B2 L60 as a mesh of 100k triangles",
            scene: mesh_scene(&B2, Mesh::new(&mesh, &Frame::WORLD)),
            plain: None,
            batch_paths: 48,
            exact: 0.84190538,
        },
    ]
}

/// A row of the first table.
fn compare(case: &Case, pool: &ThreadPool) -> String {
    let (mut ours, mut plain) = (Series::default(), Series::default());
    for seed in 1..=PAIRS {
        ours.add(pool.install(|| cpu_seconds(|| trace(case, seed))));
        if let Some(by_hand) = case.plain {
            let work = Work {
                stepping: Steps::Single,
                batches: BATCHES as usize,
                batch_paths: case.batch_paths,
                roulette_below: ROULETTE_BELOW,
                seed,
            };
            plain.add(cpu_seconds(|| outcome_by_hand(&by_hand(&work))));
        }
    }
    ours.check(case);
    let paths = (PAIRS * BATCHES * case.batch_paths) as f64;
    let head = format!("| {} | {:.2} | {}", case.name, ours.segments() / paths, ours.speed());
    if case.plain.is_none() {
        return format!("{head} | | | {} | |", ours.worth());
    }
    plain.check(case);
    let ratio = spread(ours.rates().zip(plain.rates()).map(|(ours, plain)| ours / plain), 2);
    format!("{head} | {} | {ratio} | {} | {} |", plain.speed(), ours.worth(), plain.worth())
}

/// Result of a run.
struct Outcome {
    segments: u64,
    flux: Tally,
}

/// The runs of one program.
#[derive(Default)]
struct Series(Vec<(f64, Outcome)>);

impl Series {
    fn add(&mut self, run: (f64, Outcome)) {
        self.0.push(run);
    }

    fn segments(&self) -> f64 {
        self.0.iter().map(|(_, outcome)| outcome.segments as f64).sum()
    }

    /// Segments per CPU second of each run.
    fn rates(&self) -> impl Iterator<Item = f64> + '_ {
        self.0.iter().map(|(seconds, outcome)| outcome.segments as f64 / seconds)
    }

    fn speed(&self) -> String {
        spread(self.rates().map(|rate| rate * 1e-6), 1)
    }

    /// 1/(relative variance × CPU s), from the variance of all runs and the median of their times.
    fn worth(&self) -> String {
        let relative = self.flux().std_error() / self.flux().mean();
        let seconds = Spread::of(self.0.iter().map(|(seconds, _)| *seconds)).median;
        format!("{:.2e}", 1.0 / (relative * relative * seconds * self.0.len() as f64))
    }

    fn flux(&self) -> Tally {
        let mut all = Tally::default();
        self.0.iter().for_each(|(_, outcome)| all.merge(&outcome.flux));
        all
    }

    fn check(&self, case: &Case) {
        let (flux, sigmas) = (self.flux(), self.flux().sigmas_from(case.exact));
        assert!(sigmas.abs() < TOO_FAR, "{}: {flux:?}, {sigmas} standard errors off", case.name);
    }
}

fn trace(case: &Case, seed: u64) -> Outcome {
    let plan = RunPlan {
        estimator: Request::Forward,
        sensor_estimators: Vec::new(),
        gather: GatherPlan::default(),
        seed,
        bounce_limit: 100_000,
        batch_paths: None,
        stop: StopRules { paths: Some(BATCHES * case.batch_paths), ..StopRules::default() },
    };
    let mut run = Run::new(&case.scene, &plan);
    while !run.is_complete() {
        run.next_wave();
    }
    outcome(&case.scene, &run.findings().photons)
}

fn outcome(scene: &Scene, readings: &Readings) -> Outcome {
    let slot = Layout::new(scene).sensor_flux(SensorId::new(0), SourceId::new(0));
    Outcome { segments: readings.segments, flux: readings.scalar(slot) }
}

fn outcome_by_hand(counted: &Counted) -> Outcome {
    Outcome { segments: counted.segments, flux: Tally::of(counted.batches.iter().copied()) }
}

/// Elapsed time of one thread over that of two, for each pair of runs.
fn scaling(case: &Case) -> Vec<f64> {
    let (one, two) = (pool(1), pool(2));
    let seconds = |pool: &ThreadPool, seed| pool.install(|| wall_seconds(|| trace(case, seed))).0;
    (1..=PAIRS).map(|seed| seconds(&one, seed) / seconds(&two, seed)).collect()
}

fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("the system gives two threads")
}

fn spread(values: impl IntoIterator<Item = f64>, digits: usize) -> String {
    let Spread { median, min, max } = Spread::of(values);
    format!("{median:.digits$} ({min:.digits$} to {max:.digits$})")
}

/// Elapsed seconds of a piece of work, and its result.
fn wall_seconds<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = black_box(work());
    (start.elapsed().as_secs_f64(), result)
}
