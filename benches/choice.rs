//! The choice of `auto` against the estimators themselves: 20 scenes, each run for six seconds with every estimator.
//!
//! `cargo bench --bench choice`, with scene names after `--` to restrict it to those. One thread. A cost is CPU seconds times
//! relative variance, of the flux or over the cells, without bias: divided by the square of an error, the time to reach it.
//! The table gives for each sensor what the pilot predicts over what a run of each estimator needs for it alone (*: with an
//! objection), the CPU time of the pilot with all preparation, and the regret: the cost of the run of `auto` for all sensors, pilot
//! included, over that of the best run of one estimator for all sensors, without an objection.
//! A run of gathering has so few passes that its variance is known to 40 % only: where `auto` gathers, it and gathering have
//! the mean over eight seeds.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;
mod noise;

use clock::cpu_seconds;
use lumiduct_core::plan::{Estimator, Request, RunPlan, StopRules};
use lumiduct_core::scene::{Scene, SensorId};
use lumiduct_core::transport::{Findings, Interrupt, Run, StopSignal};
use lumiduct_input::{self as input, Job, Settings};
use noise::noise;
use rayon::ThreadPoolBuilder;
use std::path::Path;
use std::time::{Duration, Instant};

/// Surface maps, far fields, remote cells, diffusers, media, several sources, sun and sky.
const SCENES: [&str; 20] = [
    "remote_cell_sun",
    "remote_cell_rod",
    "remote_cell_long",
    "remote_cell_bend",
    "remote_cell_scatter",
    "remote_cell_led",
    "luminance_image_scatter",
    "led_indicator",
    "colour_indicator",
    "mirror_tube",
    "solid_rod",
    "line_light_holes",
    "daylight_tube",
    "daylight_haze",
    "prismatic_duct_film",
    "diffuser_rod",
    "white_box",
    "opal_desk",
    "validation/b1_p100_r95",
    "validation/b3",
];
/// In the order of `Estimator::TRIED`.
const REQUESTS: [Request; 4] = [Request::Forward, Request::Backward, Request::Mix, Request::Gather];
/// Length of a run. Its pilot should take 5 % of it.
const LENGTH: Duration = Duration::from_secs(6);
/// Seeds, beyond that of the scene, of runs of gathering.
const FURTHER_SEEDS: u64 = 7;

fn main() {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    let names = Estimator::TRIED.map(Estimator::name).join(" | ");
    println!("predicted cost over measured cost\n");
    println!("| sensor | {names} | pilot | auto takes | regret |");
    println!("|---|--:|--:|--:|--:|--:|---|--:|");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|name| name != "--bench").collect();
    for name in SCENES {
        if wanted.is_empty() || wanted.iter().any(|one| one == name) {
            pool.install(|| survey(name));
        }
    }
}

/// Prints the rows of a scene.
fn survey(name: &str) {
    let path = format!("scenes/{name}.toml");
    let job = load(&path);
    let first = Traced::new(&job, Request::Auto, 0);
    let choices = first.findings.choices.clone();
    let is_gathered = choices.iter().any(|choice| choice.chosen == Estimator::Gather);
    let prepared = first.prepared;
    let all = |job: &Job, first: Traced, request: Request| -> Vec<Traced> {
        let further = if is_gathered { FURTHER_SEEDS } else { 0 };
        let further = (1..=further).map(|seed| Traced::new(job, request, seed));
        std::iter::once(first).chain(further).collect()
    };
    let auto = all(&job, first, Request::Auto);
    let with_each = |job: &Job| {
        REQUESTS.map(|request| {
            let first = Traced::new(job, request, 0);
            if request == Request::Gather { all(job, first, request) } else { vec![first] }
        })
    };
    let measured = with_each(&job);
    let cost = |job: &Job, runs: &[Traced], sensor: usize| -> Option<f64> {
        let of_run =
            |run: &Traced| Some(run.seconds * variance(&job.scene, &run.findings, sensor)?);
        let costs: Option<Vec<f64>> = runs.iter().map(of_run).collect();
        costs.map(|costs| costs.iter().sum::<f64>() / costs.len() as f64)
    };
    for (sensor, choice) in choices.iter().enumerate() {
        let in_common = measured.each_ref().map(|runs| cost(&job, runs, sensor));
        let needed = if choices.len() == 1 {
            in_common
        } else {
            let alone = load_alone(&path, sensor);
            with_each(&alone).map(|runs| cost(&alone, &runs, 0))
        };
        let mut best = f64::INFINITY;
        let mut columns = vec![format!("{name} {}", job.scene.sensors[sensor].name)];
        for (place, estimator) in Estimator::TRIED.iter().enumerate() {
            let trial = choice.tried.iter().find(|trial| trial.estimator == *estimator);
            let predicted = trial.and_then(|trial| trial.cost);
            let is_fit = trial.is_some_and(|trial| trial.objection.is_none());
            let objection = if is_fit { "" } else { "*" };
            best = best.min(in_common[place].filter(|_| is_fit).unwrap_or(f64::INFINITY));
            columns.push(match (predicted, needed[place]) {
                (Some(predicted), Some(needed)) => {
                    format!("{:.2} of {needed:.1e}{objection}", predicted / needed)
                }
                (Some(predicted), None) => format!("{predicted:.1e} of none{objection}"),
                (None, Some(needed)) => format!("none of {needed:.1e}{objection}"),
                (None, None) => format!("none{objection}"),
            });
        }
        let chosen = cost(&job, &auto, sensor).filter(|_| best.is_finite());
        let regret = chosen.map(|chosen| chosen / best);
        columns.push(format!("{prepared:.2} s"));
        columns.push(choice.chosen.name().to_owned());
        columns.push(regret.map_or("-".to_owned(), |regret| format!("{regret:.2}")));
        println!("| {} |", columns.join(" | "));
    }
}

fn load(path: &str) -> Job {
    input::load(Path::new(path), &Settings::default()).expect("the scenes are valid")
}

/// A scene with one of its sensors only.
fn load_alone(path: &str, sensor: usize) -> Job {
    let mut job = load(path);
    job.scene.sensors = vec![job.scene.sensors.swap_remove(sensor)];
    job
}

/// A run of [`LENGTH`].
struct Traced {
    /// CPU seconds until the first path counts.
    prepared: f64,
    /// All CPU seconds.
    seconds: f64,
    findings: Findings,
}

impl Traced {
    fn new(job: &Job, estimator: Request, further_seed: u64) -> Self {
        let stop = StopRules { time: Some(LENGTH), ..StopRules::default() };
        let seed = job.run.seed + further_seed;
        let plan = RunPlan { estimator, seed, stop, ..job.run.clone() };
        let start = Instant::now();
        let signal = StopSignal::new(&Interrupt::default(), Some(start + LENGTH));
        let (prepared, run) = cpu_seconds(|| Run::start(&job.scene, &plan, &signal, &mut |_| ()));
        let mut run = run.expect("time is enough");
        let (traced, ()) = cpu_seconds(|| {
            let mut round_end = run.round_end();
            run.next_piece();
            while start.elapsed() < LENGTH {
                if run.is_between_waves() && run.waves() >= round_end {
                    round_end = run.end_round(None);
                }
                run.next_piece();
            }
        });
        Self { prepared, seconds: prepared + traced, findings: run.findings() }
    }
}

/// Relative variance of the flux of a sensor, or over its cells of Σσ²/Σmean².
fn variance(scene: &Scene, found: &Findings, sensor: usize) -> Option<f64> {
    let id = SensorId::new(sensor);
    let [variance, square] = noise(scene, found.readings(scene, id), id);
    (square > 0.0).then(|| variance / square)
}
