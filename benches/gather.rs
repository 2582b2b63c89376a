//! Gathering against backward tracing on the remote cells of docs/method.md: variance at equal CPU time, bias against
//! committed truths, and what looking up records adds to a stream of photons.
//!
//! `cargo bench --bench gather`. One thread; both estimators run in turn on each scene, gathering with its automatic
//! settings. The variances are those of the flux within the widest window of the first stage and of the value freed of
//! the bias that goes with the window's square, from 64 passes; confidence intervals are those of the ratio of two variances of
//! normal samples. The truths are long unbiased runs, made once: see `ROWS`.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;

use clock::cpu_seconds;
use lumiduct::input::{self, Job, Settings};
use lumiduct::scene::plan::{GatherPlan, Request, RunPlan, StopRules};
use lumiduct::scene::{Scene, SensorId, SourceId};
use lumiduct::tally::Tally;
use lumiduct::transport::{Findings, GatherSettings, Layout, Readings, Run};
use rayon::ThreadPoolBuilder;
use std::path::Path;

/// A scene, and the flux on its sensor by a long backward run, lm.
struct Row {
    scene: &'static str,
    truth: f64,
    std_error: f64,
}

/// `lumiduct run scenes/NAME.toml --estimator backward --paths 60M` with the seeds named, means weighted by variance.
const ROWS: [Row; 4] = [
    // Seeds 20261, 20262, 20263.
    Row { scene: "remote_cell_sun", truth: 0.10938, std_error: 0.00028 },
    // Seeds 20261, 20262.
    Row { scene: "remote_cell_long", truth: 0.035457, std_error: 0.000154 },
    // Seed 20261, and 30M with seed 7.
    Row { scene: "remote_cell_rod", truth: 0.1400, std_error: 0.0005 },
    // `cargo bench --bench connected`, seed 20261.
    Row { scene: "remote_cell_scatter", truth: 0.011507, std_error: 0.000023 },
];
/// Passes of the gather method, and waves of backward paths.
const PASSES: u64 = 64;
const WAVES: u64 = 8;

fn main() {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    println!(
        "| scene | backward | gather E1 | value/truth | variance, backward/gather (95 %) | 2 E2 - E1 | value/truth | variance, backward/gather | look-up over photons |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    for row in &ROWS {
        println!("{}", pool.install(|| compare(row)));
    }
}

/// Flux with its error, and the CPU seconds it took.
struct Found {
    flux: Tally,
    seconds: f64,
}

impl Found {
    /// Relative variance times CPU seconds.
    fn cost(&self) -> f64 {
        (self.flux.std_error() / self.flux.mean()).powi(2) * self.seconds
    }

    /// Relative noise after three seconds, in percent.
    fn noise(&self) -> f64 {
        100.0 * (self.cost() / 3.0).sqrt()
    }
}

fn compare(row: &Row) -> String {
    let path = format!("scenes/{}.toml", row.scene);
    let job = input::load(Path::new(&path), &Settings::default()).expect("the scenes are valid");
    let (backward_seconds, findings) = traced(&job, &plan(&job, Request::Backward, None), WAVES);
    let backward = findings.backward.expect("it was asked for");
    let backward = Found { flux: flux(&job.scene, &backward), seconds: backward_seconds };
    let gathering = plan(&job, Request::Gather, None);
    let (seconds, findings) = traced(&job, &gathering, PASSES / 16);
    let mut gathered = findings.gathered.expect("it was asked for");
    let windows = gathered.stages.remove(0).windows;
    let of = |readings: &Readings| Found { flux: flux(&job.scene, readings), seconds };
    let look_up = (seconds - records_alone(&job, &gathered.settings)) / photons_alone(&job) - 1.0;
    let columns = |found: &Found| {
        let ratio = backward.cost() / found.cost();
        // The logarithm of a variance from n samples has a standard deviation of √(2/(n - 1)).
        let spread = (2.0 / (PASSES as f64 - 1.0) + 2.0 / (128.0 - 1.0)).sqrt();
        let [low, high] = [-1.96, 1.96].map(|sigmas: f64| ratio * (sigmas * spread).exp());
        let value = found.flux.mean() / row.truth;
        let error =
            value * (found.flux.std_error() / found.flux.mean()).hypot(row.std_error / row.truth);
        format!(
            "{:.2} % | {value:.4} ± {error:.4} | {ratio:.0} ({low:.0} to {high:.0})",
            found.noise()
        )
    };
    format!(
        "| {} | {:.2} % | {} | {} | {look_up:.2} |",
        row.scene,
        backward.noise(),
        columns(&of(&windows.wide)),
        columns(&of(&windows.extrapolated)),
    )
}

/// Traces some waves of a scene; CPU seconds and what was found.
fn traced(job: &Job, plan: &RunPlan, waves: u64) -> (f64, Findings) {
    let mut run = Run::new(&job.scene, plan);
    let (seconds, ()) = cpu_seconds(|| (0..waves).for_each(|_| run.next_wave()));
    (seconds, run.findings())
}

/// CPU seconds of the photons of all passes without any record.
fn photons_alone(job: &Job) -> f64 {
    let run = Run::new(&job.scene, &plan(job, Request::Gather, None));
    let paths = PASSES * run.photons_per_batch();
    let mut run = Run::new(&job.scene, &plan(job, Request::Forward, Some(paths)));
    let (seconds, ()) = cpu_seconds(|| {
        while !run.is_complete() {
            run.next_wave();
        }
    });
    seconds
}

/// CPU seconds of the gather paths of all passes, of their records and of the index, with a photon for each.
fn records_alone(job: &Job, settings: &GatherSettings) -> f64 {
    let gather = GatherPlan {
        records: Some(settings.gather_paths),
        photons: Some(1),
        ..GatherPlan::default()
    };
    traced(job, &RunPlan { gather, ..plan(job, Request::Gather, None) }, PASSES / 16).0
}

/// What to run, with automatic settings of the gather method.
fn plan(job: &Job, estimator: Request, paths: Option<u64>) -> RunPlan {
    RunPlan {
        estimator,
        gather: GatherPlan::default(),
        stop: StopRules { paths, ..StopRules::default() },
        ..job.run.clone()
    }
}

/// The flux of the only sensor, group by group.
fn flux(scene: &Scene, readings: &Readings) -> Tally {
    let slot = Layout::new(scene).sensor_flux(SensorId::new(0), SourceId::new(0));
    readings.scalar(slot)
}
