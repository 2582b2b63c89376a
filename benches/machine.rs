//! What a run takes from the machine: allocations per path, memory, threads, time before the first photon, the report, and cells.
//!
//! `cargo bench --bench machine`. Allocations and CPU seconds are those of one thread; two threads are timed by the clock, in
//! turn with one, and want a quiet machine.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;

use allocation_counter::AllocationInfo;
use clock::cpu_seconds;
use lumiduct::pipeline::{compose, trace};
use lumiduct_core::plan::{Request, StopRules};
use lumiduct_core::transport::forward::Forward;
use lumiduct_core::transport::{Interrupt, Run, StopSignal};
use lumiduct_input::{self as input, Job, Settings};
use lumiduct_report::Pictures;
use rayon::ThreadPoolBuilder;
use std::path::Path;
use std::time::{Duration, Instant};

/// Scenes of mirrors, of total reflection in a bend, of scattering, of film, of holes, and of daylight.
const SCENES: [&str; 6] = [
    "mirror_tube",
    "led_indicator",
    "white_box",
    "prismatic_duct_film",
    "line_light_holes",
    "daylight_tube",
];
/// Photon paths of a small and of a large batch.
const PATHS: [u64; 2] = [1 << 10, 1 << 14];
/// Paths of a short and of a long run.
const RUNS: [u64; 2] = [200_000, 2_000_000];
/// Length of a run on one or two threads, and turns.
const LENGTH: Duration = Duration::from_secs(2);
const TURNS: usize = 3;

fn main() {
    println!(
        "| scene | allocations per path | bounces per path | most memory of 0.2 M and 2 M paths, MB | before the first photon, ms | report, and without pictures, s |"
    );
    println!("|---|--:|--:|--:|--:|--:|");
    for name in SCENES {
        println!("{}", row(name));
    }
    println!("\n| scene | paths of two threads over those of one |\n|---|--:|");
    for name in SCENES {
        println!("| {name} | {:.2} |", threads(name));
    }
    println!("\n| cells | ns/path |\n|---|--:|");
    for cells in [32, 1024] {
        println!("| {cells} x {cells} | {:.0} |", cost_of_cells(cells));
    }
}

fn load(name: &str, overrides: &[String], paths: Option<u64>) -> Job {
    let path = format!("scenes/{name}.toml");
    let estimator = Some(Request::Forward);
    let settings =
        Settings { overrides: overrides.to_vec(), paths, estimator, ..Settings::default() };
    input::load(Path::new(&path), &settings).expect("the scenes are valid")
}

/// The row of a scene.
fn row(name: &str) -> String {
    let (loading, job) = cpu_seconds(|| load(name, &[], Some(RUNS[0])));
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    pool.install(|| {
        let [few, many] = PATHS.map(|paths| batch(&job, paths));
        let per_path =
            (many.0.count_total - few.0.count_total) as f64 / (PATHS[1] - PATHS[0]) as f64;
        let segments = many.1 as f64 / PATHS[1] as f64;
        let signal = StopSignal::default();
        let (starting, _) = cpu_seconds(|| {
            Run::start(&job.scene, &job.run, &signal, &mut |_| ()).expect("nothing stops it")
        });
        let memory = RUNS.map(|paths| {
            let job = load(name, &[], Some(paths));
            let run = || _ = trace(&job, &Interrupt::default(), &mut |_| ());
            1e-6 * allocation_counter::measure(run).bytes_max as f64
        });
        let traced = trace(&job, &Interrupt::default(), &mut |_| ()).expect("nothing stops it");
        let [drawn, without] = [Pictures::Drawn, Pictures::LeftOut].map(|pictures| {
            let reporting = || {
                let report =
                    compose(&job, &traced.findings, traced.stop).expect("it can be composed");
                lumiduct_report::files(&report, &job.text, pictures).expect("it can be drawn")
            };
            cpu_seconds(reporting).0
        });
        format!(
            "| {name} | {per_path:.4} | {segments:.1} | {:.2}, {:.2} | {:.1} | {drawn:.3}, {without:.3} |",
            memory[0],
            memory[1],
            1e3 * (loading + starting),
        )
    })
}

/// Allocations of a batch with this many photon paths, and its segments.
fn batch(job: &Job, paths: u64) -> (AllocationInfo, u64) {
    let forward = Forward::new(&job.scene, job.run.seed, job.run.bounce_limit, paths);
    let mut segments = 0;
    let info = allocation_counter::measure(|| {
        let readings = forward.batch(0, &StopSignal::default()).expect("nothing stops it");
        segments = readings.segments;
    });
    (info, segments)
}

/// Photon paths on two threads over those on one, in as much time; the median of a few turns.
fn threads(name: &str) -> f64 {
    let paths = |threads: usize| {
        let pool =
            ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had");
        let stop = StopRules { time: Some(LENGTH), ..StopRules::default() };
        let mut job = load(name, &[], None);
        job.run.stop = stop;
        let start = Instant::now();
        let traced = pool.install(|| trace(&job, &Interrupt::default(), &mut |_| ()));
        traced.expect("nothing stops it").findings.paths as f64 / start.elapsed().as_secs_f64()
    };
    let mut ratios: Vec<f64> = (0..TURNS).map(|_| paths(2) / paths(1)).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[TURNS / 2]
}

/// CPU time of a photon path in `mirror_tube` with this many cells along each side of its exit, ns.
fn cost_of_cells(cells: u32) -> f64 {
    let overrides = [format!("sensors.exit.plane.cells=[{cells}, {cells}]")];
    let job = load("mirror_tube", &overrides, None);
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    pool.install(|| {
        let run = || trace(&job, &Interrupt::default(), &mut |_| ()).expect("nothing stops it");
        let (seconds, traced) = cpu_seconds(run);
        1e9 * seconds / traced.findings.paths as f64
    })
}
