//! The cost of design elements: prism film against its planes, many elements against few, and
//! building reliefs.
//!
//! `cargo bench --bench elements`. One thread, two programs in turn; medians of the ratios of pairs, with their extremes.
#![allow(clippy::print_stdout, reason = "a bench prints its results")]

mod clock;
mod spread;

use clock::cpu_seconds;
use lumiduct_core::transport::Run;
use lumiduct_input::{self as input, Job, Settings};
use spread::Spread;

/// Pairs of runs.
const PAIRS: usize = 7;
/// Approximate number of segments of a run.
const SEGMENTS: u64 = 3_000_000;

/// A scene of the repository with some keys set.
fn load(scene: &str, overrides: &[&str]) -> Job {
    let overrides = overrides.iter().map(|text| (*text).to_owned()).collect();
    let settings = Settings { overrides, ..Settings::default() };
    let path = std::path::Path::new("scenes").join(scene);
    input::load(&path, &settings).expect("the scene is valid")
}

/// Paths and segments per CPU second.
fn speeds(job: &Job) -> [f64; 2] {
    let mut run = Run::new(&job.scene, &job.run);
    let (seconds, done) = cpu_seconds(|| {
        loop {
            run.next_piece();
            let done = run.findings().photons;
            if done.segments >= SEGMENTS {
                break done;
            }
        }
    });
    [done.paths() as f64 / seconds, done.segments as f64 / seconds]
}

/// Runs both in turn: paths per second of the first over those of the second, and segments per
/// second of each.
fn compare(one: &Job, other: &Job) -> [Spread; 3] {
    let pairs: Vec<[[f64; 2]; 2]> = (0..PAIRS).map(|_| [speeds(one), speeds(other)]).collect();
    [
        Spread::of(pairs.iter().map(|[one, other]| one[0] / other[0])),
        Spread::of(pairs.iter().map(|[one, _]| one[1] * 1e-6)),
        Spread::of(pairs.iter().map(|[_, other]| other[1] * 1e-6)),
    ]
}

fn show(spread: Spread) -> String {
    let Spread { median, min, max } = spread;
    format!("{median:.2} ({min:.2} to {max:.2})")
}

fn main() {
    // On this thread, so that its clock counts all the work.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    pool.expect("one thread can be had").install(measure);
}

fn measure() {
    println!(
        "| pair | paths/s, first over second | M segments/s, first | second |\n|---|--:|--:|--:|"
    );
    let panel = |grid: &str, diameter: &str| {
        let layout = format!("patterns.dots.layout={{ grid = {grid} }}");
        let element =
            format!("patterns.dots.element={{ circle = {{ diameter_mm = {diameter} }} }}");
        load("extraction_panel.toml", &[&layout, &element])
    };
    let pairs = [
        (
            "prismatic duct, 30 prisms a side: film / planes",
            load("prismatic_duct_film.toml", &[]),
            load("prismatic_duct.toml", &[]),
        ),
        (
            "prismatic duct, 100 prisms a side: film / planes",
            load("prismatic_duct_film.toml", &[]),
            load("prismatic_duct.toml", &["solids.duct.tube.outer.prisms.count=100"]),
        ),
        (
            "the same, 30 a side, five times as long: film / planes",
            load("prismatic_duct_film.toml", &["sheets.duct.tube.path.0.straight_mm=3000"]),
            load("prismatic_duct.toml", &["solids.duct.tube.length_mm=3000"]),
        ),
        (
            "panel of dots: 10 million / 9",
            panel("{ across_pitch_mm = 0.02, pitch_mm = 0.03 }", "0.01"),
            panel("{ across_pitch_mm = 20, pitch_mm = 30 }", "10"),
        ),
    ];
    for (name, one, other) in &pairs {
        let [ratio, first, second] = compare(one, other);
        println!("| {name} | {} | {} | {} |", show(ratio), show(first), show(second));
    }
    println!("\n| relief on a plate | elements | CPU seconds to read and build |\n|---|--:|--:|");
    for (pitch, count) in [(0.34, "10,000"), (0.107, "100,000")] {
        let layout = format!(
            "reliefs.grooves.layout={{ grid = {{ across_pitch_mm = {pitch}, pitch_mm = {pitch} }} }}"
        );
        let element = "reliefs.grooves.element={ dimple = { radius_mm = 0.1, depth_mm = 0.005 } }";
        let load = || load("relief_light_bar.toml", &[element, &layout]);
        let seconds = Spread::of((0..PAIRS).map(|_| cpu_seconds(load).0));
        println!("| dimples | {count} | {} |", show(seconds));
    }
}
