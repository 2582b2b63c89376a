//! Gathering against backward tracing on the remote cells of docs/method.md: variance at equal CPU time, bias against
//! committed truths, and what looking up records adds to a stream of photons.
//!
//! `cargo bench --bench gather`. One thread; both estimators run in turn on each scene. The variance is that of the
//! flux within the widest window of the first stage, from 64 passes; its confidence interval is that of the ratio of two
//! variances of normal samples. The truths are long backward runs, made once: see `ROWS`.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;

use clock::cpu_seconds;
use lumiduct::input::{self, Job, Settings};
use lumiduct::scene::plan::{Request, RunPlan, StopRules};
use lumiduct::scene::{Scene, SensorId, SourceId};
use lumiduct::tally::Tally;
use lumiduct::transport::{Findings, Layout, Readings, Run};
use rayon::ThreadPoolBuilder;
use std::path::Path;

/// A scene, and the flux on its sensor by a long backward run, lm.
struct Row {
    scene: &'static str,
    truth: f64,
    std_error: f64,
}

/// `lumiduct run scenes/NAME.toml --estimator backward --paths 60M --seed 20261` and further seeds.
const ROWS: [Row; 4] = [
    // Seeds 20261, 20262, 20263.
    Row { scene: "remote_cell_sun", truth: 0.10938, std_error: 0.00028 },
    Row { scene: "remote_cell_long", truth: f64::NAN, std_error: f64::NAN },
    // Seed 20261.
    Row { scene: "remote_cell_rod", truth: 0.13950, std_error: 0.00057 },
    Row { scene: "remote_cell_scatter", truth: f64::NAN, std_error: f64::NAN },
];
/// Passes of the gather method, and waves of backward paths.
const PASSES: u64 = 64;
const WAVES: u64 = 8;

fn main() {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    println!(
        "| scene | backward | gather | value/truth | variance, backward/gather (95 %) | look-up over photons |"
    );
    println!("|---|--:|--:|--:|--:|--:|");
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
    let backward = traced(&job, Request::Backward, WAVES, |findings| {
        findings.backward.expect("it was asked for")
    });
    let gather = traced(&job, Request::Gather, PASSES / 16, |mut findings| {
        let mut gathered = findings.gathered.take().expect("it was asked for");
        gathered.stages.pop().expect("waves were traced").windows.wide
    });
    let photons = photons_alone(&job);
    let ratio = backward.cost() / gather.cost();
    // The logarithm of a variance from n samples has a standard deviation of √(2/(n - 1)).
    let spread = (2.0 / (PASSES as f64 - 1.0) + 2.0 / (128.0 - 1.0)).sqrt();
    let [low, high] = [-1.96, 1.96].map(|sigmas: f64| ratio * (sigmas * spread).exp());
    format!(
        "| {} | {:.2} % | {:.2} % | {:.4} ± {:.4} | {ratio:.0} ({low:.0} to {high:.0}) | {:.2} |",
        row.scene,
        backward.noise(),
        gather.noise(),
        gather.flux.mean() / row.truth,
        gather.flux.mean() / row.truth
            * (gather.flux.std_error() / gather.flux.mean()).hypot(row.std_error / row.truth),
        gather.seconds / photons - 1.0,
    )
}

/// Traces some waves of a scene with one estimator; `choose` names the readings that speak for its sensor.
fn traced(
    job: &Job,
    estimator: Request,
    waves: u64,
    choose: impl Fn(Findings) -> Readings,
) -> Found {
    let mut run = Run::new(&job.scene, &plan(job, estimator, None));
    let (seconds, ()) = cpu_seconds(|| (0..waves).for_each(|_| run.next_wave()));
    Found { flux: flux(&job.scene, &choose(run.findings())), seconds }
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

fn plan(job: &Job, estimator: Request, paths: Option<u64>) -> RunPlan {
    RunPlan { estimator, stop: StopRules { paths, ..StopRules::default() }, ..job.run.clone() }
}

/// The flux of the only sensor, group by group.
fn flux(scene: &Scene, readings: &Readings) -> Tally {
    let slot = Layout::new(scene).sensor_flux(SensorId::new(0), SourceId::new(0));
    readings.scalar(slot)
}
