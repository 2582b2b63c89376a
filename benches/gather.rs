//! The method against forward and backward tracing on the scenes of docs/method.md: noise after the
//! same CPU time, bias against committed truths, what the pilot of `auto` chooses, and what record
//! look-ups add to tracing photons.
//!
//! `cargo bench --bench gather`, with scene names after `--` to restrict it to those. One thread;
//! the estimators run in turn on each scene, gathering with its automatic settings. The variances
//! are those of the flux (of an image: Σσ²/Σmean² over its pixels) of second order, within the windows of the
//! first stage, and of the value without the bias that scales with the window's
//! square, from four runs of 64 passes with separate seeds. Confidence intervals are those of the
//! ratio of two variances of normal samples. The truths are long unbiased runs, made once: benches/truths.rs.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;
mod noise;
mod truths;

use clock::cpu_seconds;
use lumiduct_core::plan::{Estimator, GatherPlan, Request, RunPlan, StopRules, Target};
use lumiduct_core::scene::{Scene, SensorId};
use lumiduct_core::transport::{Findings, GatherSettings, Orders, Readings, Run};
use lumiduct_input::{self as input, Job, Settings};
use noise::{flux, noise};
use rayon::ThreadPoolBuilder;
use std::path::Path;
use truths::{TRUTHS, Truth};

/// Runs of each estimator, each with its own seed.
const RUNS: u64 = 4;
/// Passes of the gather method in a run; also waves of photons or backward paths.
const PASSES: u64 = 64;
const WAVES: u64 = 8;
/// Groups of batches in a wave, and passes in a wave of passes.
const GROUPS: f64 = 128.0;
const WAVE_PASSES: u64 = 4;
/// Relative error that the reported times refer to, 1.
const ERROR: f64 = 0.01;

fn main() {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    println!(
        "| scene | forward | backward | E1 | value/truth | variance, backward/E1 (95 %) | E0 | value/truth | variance, backward/E0 | look-up over photons | s to 1 %: forward, backward, mix, gather | auto | its time over the best |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|---|--:|");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|name| name != "--bench").collect();
    for row in
        TRUTHS.iter().filter(|row| wanted.is_empty() || wanted.iter().any(|name| name == row.scene))
    {
        println!("{}", pool.install(|| compare(row)));
    }
}

/// Result of an estimator on the only sensor of a scene, and the CPU seconds it took.
struct Found {
    /// The flux and its standard error, lm.
    flux: f64,
    std_error: f64,
    /// Σ σ² over the cells, lm².
    variance: f64,
    /// Σ mean² over the cells, less the contribution of noise, lm².
    square: f64,
    seconds: f64,
}

impl Found {
    /// Result of one run.
    fn new(scene: &Scene, readings: &Readings, seconds: f64) -> Self {
        let sensor = SensorId::new(0);
        let total = flux(scene, readings, sensor);
        let [variance, square] = noise(scene, readings, sensor);
        Self { flux: total.mean(), std_error: total.std_error(), variance, square, seconds }
    }

    /// Result of several runs of the same length together.
    fn in_all(runs: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| runs.iter().map(of).sum::<f64>() / runs.len() as f64;
        let shared = 1.0 / runs.len() as f64;
        Self {
            flux: mean(|run| run.flux),
            std_error: (shared * mean(|run| run.std_error.powi(2))).sqrt(),
            variance: shared * mean(|run| run.variance),
            square: mean(|run| run.square),
            seconds: runs.iter().map(|run| run.seconds).sum(),
        }
    }

    /// CPU seconds until the noise is the share `ERROR` of the measured value, whose square is
    /// given.
    fn time(&self, square: f64) -> f64 {
        self.variance / square * self.seconds / (ERROR * ERROR)
    }

    /// Relative noise after three CPU seconds, in percent.
    fn noise(&self, square: f64) -> String {
        format!("{:.2} %", 100.0 * ERROR * (self.time(square) / 3.0).sqrt())
    }
}

fn compare(row: &Truth) -> String {
    let path = format!("scenes/{}.toml", row.scene);
    let job = input::load(Path::new(&path), &Settings::default()).expect("the scenes are valid");
    let [forward, backward, mix] =
        [Request::Forward, Request::Backward, Request::Mix].map(|request| plain(&job, request));
    let Gathering { second, value, look_up } = gathered(&job);
    let square = second.square;
    let columns = |found: &Found| {
        let ratio = backward.time(square) / found.time(square);
        // The logarithm of a variance from n samples has a standard deviation of √(2/(n - 1)).
        let freedom = RUNS as f64 * (PASSES as f64 - 1.0);
        let spread = (2.0 / freedom + 2.0 / (RUNS as f64 * (GROUPS - 1.0))).sqrt();
        let [low, high] = [-1.96, 1.96].map(|sigmas: f64| ratio * (sigmas * spread).exp());
        let (value, error) = over_truth(row, found);
        let noise = found.noise(square);
        format!("{noise} | {value:.4} ± {error:.4} | {ratio:.1} ({low:.1} to {high:.1})")
    };
    let times = [
        forward.time(square),
        backward.time(square),
        mix.time(square),
        // There is no value before the first wave of passes.
        value.time(square).max(value.seconds * WAVE_PASSES as f64 / (RUNS * PASSES) as f64),
    ];
    let [by_forward, by_backward, by_mix, by_gather] = times.map(|time| format!("{time:.1}"));
    let (value_off, value_error) = over_truth(row, &value);
    let is_true = (value_off - 1.0).abs() < ERROR + 3.0 * value_error;
    let best = times[..if is_true { 4 } else { 3 }].iter().copied().fold(f64::INFINITY, f64::min);
    let (pilot, chosen) = pilot(&job);
    let chosen_time = match chosen {
        Estimator::Forward => times[0],
        Estimator::Backward => times[1],
        Estimator::Mix => times[2],
        Estimator::Gather | Estimator::Mis => times[3],
    };
    format!(
        "| {} | {} | {} | {} | {} | {look_up:.2} | {by_forward}, {by_backward}, {by_mix}, {by_gather}{} | {} | {:.2} |",
        row.scene,
        forward.noise(square),
        backward.noise(square),
        columns(&second),
        columns(&value),
        if is_true { "" } else { " (biased)" },
        chosen.name(),
        (pilot + chosen_time) / best,
    )
}

/// Result of an estimator without windows.
fn plain(job: &Job, request: Request) -> Found {
    let of_run = |run| {
        let (seconds, findings) = traced(&job.scene, &plan(job, request, run), WAVES);
        let followed = findings.others.first().map(|own| own.stages[0].counts.first());
        Found::new(&job.scene, followed.unwrap_or(&findings.photons), seconds)
    };
    Found::in_all(&(0..RUNS).map(of_run).collect::<Vec<Found>>())
}

/// Result of gathering.
struct Gathering {
    /// The mean over the windows of the first stage, E1.
    second: Found,
    /// Without the bias that scales with the window's square, E0.
    value: Found,
    /// Time of the look-ups over that of the photons alone, 1.
    look_up: f64,
}

fn gathered(job: &Job) -> Gathering {
    let (mut second, mut value, mut look_up) = (Vec::new(), Vec::new(), 0.0);
    for run in 0..RUNS {
        let waves = PASSES / WAVE_PASSES;
        let (seconds, findings) = traced(&job.scene, &plan(job, Request::Gather, run), waves);
        let gathered = findings.of_sensor(SensorId::new(0)).expect("it was asked for");
        let orders = Orders::of(&gathered.stages[0].counts);
        if run == 0 {
            let streamed =
                seconds - records_alone(job, findings.gathering().next().expect("it gathers").1);
            look_up = streamed / photons_alone(job) - 1.0;
        }
        second.push(Found::new(&job.scene, orders.second, seconds));
        value.push(Found::new(&job.scene, orders.fourth, seconds));
    }
    Gathering { second: Found::in_all(&second), value: Found::in_all(&value), look_up }
}

/// A flux over the truth, with the error of both.
fn over_truth(row: &Truth, found: &Found) -> (f64, f64) {
    let ratio = found.flux / row.flux;
    (ratio, ratio * (found.std_error / found.flux).hypot(row.std_error / row.flux))
}

/// Traces some waves of a scene; returns CPU seconds and findings.
fn traced(scene: &Scene, plan: &RunPlan, waves: u64) -> (f64, Findings) {
    let mut run = Run::new(scene, plan);
    let (seconds, ()) = cpu_seconds(|| (0..waves).for_each(|_| run.next_wave()));
    (seconds, run.findings())
}

/// CPU seconds of the photons of all passes without any record.
fn photons_alone(job: &Job) -> f64 {
    let run = Run::new(&job.scene, &plan(job, Request::Gather, 0));
    let stop = StopRules { paths: Some(PASSES * run.photons_per_batch()), ..StopRules::default() };
    let mut run = Run::new(&job.scene, &RunPlan { stop, ..plan(job, Request::Forward, 0) });
    let (seconds, ()) = cpu_seconds(|| {
        while !run.is_complete() {
            run.next_wave();
        }
    });
    seconds
}

/// CPU seconds of the gather paths of all passes, their records and the index, with one photon per
/// pass.
fn records_alone(job: &Job, settings: &GatherSettings) -> f64 {
    let gather = GatherPlan {
        records: Some(settings.gather_paths),
        photons: Some(1),
        ..GatherPlan::default()
    };
    let plan = RunPlan { gather, ..plan(job, Request::Gather, 0) };
    traced(&job.scene, &plan, PASSES / WAVE_PASSES).0
}

/// CPU seconds of the pilot of a run to the error `ERROR`, and the estimator it chooses.
fn pilot(job: &Job) -> (f64, Estimator) {
    let measure = format!("{}.flux", job.scene.sensors[0].name);
    let target = Some(Target { measure, relative_error: ERROR });
    let stop = StopRules { target, ..StopRules::default() };
    let plan = RunPlan { stop, ..plan(job, Request::Auto, 0) };
    let (seconds, mut run) = cpu_seconds(|| Run::new(&job.scene, &plan));
    run.next_piece();
    (seconds, run.findings().estimators[0])
}

/// The plan of a run: automatic settings of the gather method, a seed per run, no stop rule.
fn plan(job: &Job, estimator: Request, run: u64) -> RunPlan {
    RunPlan {
        estimator,
        seed: job.run.seed + run,
        gather: GatherPlan::default(),
        stop: StopRules::default(),
        ..job.run.clone()
    }
}
