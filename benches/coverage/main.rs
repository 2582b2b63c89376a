//! Whether the stated error of gathering holds: 20 scenes, each with 30 seeds, against unbiased truths.
//!
//! `cargo bench --bench coverage`, with scene names after `--` to restrict it to those. All runs of a scene have the same
//! number of paths, for about two CPU seconds, and the automatic settings for that number. A value holds if it is within its
//! stated bias and two standard errors of the truth; runs that state no error are counted in a column of their own. A truth
//! is that of benches/truths.rs, or of the named estimator, run until its error is a fifth of the scatter of the values, or
//! for two minutes.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod scenes;
#[path = "../truths.rs"]
mod truths;

use lumiduct_core::measure::{self, Measure, Status};
use lumiduct_core::plan::{Request, RunPlan, StopRules};
use lumiduct_core::scene::Scene;
use lumiduct_core::transport::Run;
use lumiduct_input::{self as input, Job, Settings};
use scenes::{ROWS, Reference, Row, Source};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use truths::TRUTHS;

/// Runs of each scene, each with its own seed.
const SEEDS: u64 = 30;
/// Standard errors within which a value should be of the truth, beyond its stated bias.
const SIGMAS: f64 = 2.0;
/// Error of the truth over the scatter of the values, 1.
const FINE: f64 = 0.2;
/// Longest time for a truth.
const MOST_TIME: Duration = Duration::from_secs(120);
/// Waves of the truth between looks at its error.
const WAVES: u64 = 4;

fn main() {
    println!(
        "| scene | | truth | scatter | mean off | bias + 2σ over rms error | held | states none |"
    );
    println!("|---|---|--:|--:|--:|--:|--:|--:|");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|name| name != "--bench").collect();
    let rows =
        ROWS.iter().filter(|row| wanted.is_empty() || wanted.iter().any(|it| it == row.name));
    let counted: Vec<[usize; 2]> = rows.map(survey).collect();
    let [held, none] =
        [0, 1].map(|place| counted.iter().map(|counts| counts[place]).sum::<usize>());
    println!("\n{held} of {} values hold.", counted.len() * SEEDS as usize - none);
}

/// Prints the row of a scene; returns how many values hold, and how many state no error.
fn survey(row: &Row) -> [usize; 2] {
    let job = job(row);
    let values: Vec<Measure> = (1..=SEEDS).map(|seed| gathered(&job, row.paths, seed)).collect();
    let mean = values.iter().map(|own| own.value).sum::<f64>() / SEEDS as f64;
    let scatter =
        (values.iter().map(|own| (own.value - mean).powi(2)).sum::<f64>() / SEEDS as f64).sqrt();
    let [truth, error] = match row.truth {
        Reference::Known => {
            let known = TRUTHS.iter().find(|known| known.scene == row.name);
            known.map(|known| [known.flux, known.std_error]).expect("its truth is listed")
        }
        Reference::Traced(estimator) => truth(&job, estimator, FINE * scatter),
    };
    let offs = || values.iter().map(|own| (own.value - truth).abs());
    let rms = (offs().map(|off| off * off).sum::<f64>() / SEEDS as f64).sqrt();
    let mut stated: Vec<f64> =
        values.iter().map(|own| own.bias.unwrap_or(0.0) + SIGMAS * own.std_error).collect();
    let none = |own: &Measure| matches!(own.status, Status::TooFew | Status::BiasNotResolved);
    let held = offs()
        .zip(&stated)
        .zip(&values)
        .filter(|((off, stated), own)| !none(own) && off <= stated)
        .count();
    let nones = values.iter().filter(|own| none(own)).count();
    stated.sort_by(f64::total_cmp);
    println!(
        "| {} | {} | {truth:.5} ± {:.2} % | {:.2} % | {:+.2} % | {:.1} | {held} | {nones} |",
        row.name,
        row.what,
        100.0 * error / truth,
        100.0 * scatter / truth,
        100.0 * (mean / truth - 1.0),
        stated[SEEDS as usize / 2] / rms,
    );
    [held, nones]
}

/// The scene of a row.
fn job(row: &Row) -> Job {
    let settings = Settings::default();
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let path = match &row.source {
        Source::Shipped => PathBuf::from(format!("scenes/{}.toml", row.name)),
        Source::Text(text) => {
            let path = folder.path().join("scene.toml");
            let head = "lumiduct = 1\ntitle = \"Trial\"\n";
            std::fs::write(&path, head.to_owned() + &text())
                .expect("a temporary file can be written");
            path
        }
    };
    input::load(Path::new(&path), &settings).expect("the scenes are valid")
}

/// The flux on the first sensor by a run of gathering.
fn gathered(job: &Job, paths: u64, seed: u64) -> Measure {
    let stop = StopRules { paths: Some(paths), ..StopRules::default() };
    let plan = RunPlan { estimator: Request::Gather, seed, stop, ..job.run.clone() };
    let mut run = Run::new(&job.scene, &plan);
    let mut round_end = run.round_end();
    while !run.is_complete() {
        run.next_wave();
        if run.waves() >= round_end {
            round_end = run.end_round(None);
        }
    }
    flux(&job.scene, &run)
}

/// The flux on the first sensor by an unbiased estimator, until its error is small enough, with that error.
fn truth(job: &Job, estimator: Request, error: f64) -> [f64; 2] {
    let stop = StopRules::default();
    let plan = RunPlan { estimator, seed: 20301, stop, ..job.run.clone() };
    let (start, mut run) = (Instant::now(), Run::new(&job.scene, &plan));
    loop {
        (0..WAVES).for_each(|_| run.next_wave());
        let found = flux(&job.scene, &run);
        if found.std_error <= error || start.elapsed() > MOST_TIME {
            return [found.value, found.std_error];
        }
    }
}

fn flux(scene: &Scene, run: &Run<'_>) -> Measure {
    let name = format!("{}.flux", scene.sensors[0].name);
    measure::value_of(scene, &run.findings(), &name).expect("every sensor has a flux")
}
