//! What a second of tracing is worth, against loops written by hand for the one guide.
//!
//! `cargo bench --bench worth`. One thread; all in turn. Worth is 1/(relative variance × CPU s), of the flux at the exit or over
//! the cells of its map (Σσ²/Σmean²), relative to the loop that goes from wall to wall. Ours are runs of a second: for the flux
//! `forward`, for the map the better of `forward` and `backward`.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;
#[allow(dead_code, reason = "scenes are for other benches")]
mod guides;
mod noise;
mod plain;
mod spread;

use clock::cpu_seconds;
use guides::{B1_P10, B1_P10_R99, B1_P100, B1_P100_R99, B2, B2_L600, B4, Rod, Tube};
use lumiduct_core::plan::{Request, RunPlan, StopRules};
use lumiduct_core::scene::SensorId;
use lumiduct_core::tally::Tally;
use lumiduct_core::transport::{Interrupt, ROULETTE_BELOW, Run, StopSignal};
use lumiduct_input::{self as input, Job, Settings};
use noise::{flux, noise};
use plain::{Counted, Steps, Work, trace_rod, trace_tube};
use rayon::ThreadPoolBuilder;
use spread::Spread;
use std::path::Path;
use std::time::{Duration, Instant};

/// Length of a run of ours.
const LENGTH: Duration = Duration::from_secs(1);
/// Turns.
const TURNS: u64 = 5;
/// Batches of a loop by hand.
const BATCHES: usize = 128;
/// A flux further than this from the exact value is wrong, in standard errors.
const TOO_FAR: f64 = 5.0;

/// A guide of the validation, and how to trace it by hand.
struct Case {
    scene: &'static str,
    guide: Guide,
    /// Paths in a batch of the loop by hand that takes about half a second, from wall to wall and in rows.
    batch_paths: [u64; 2],
    /// Exit flux, DESIGN section 6; 1.
    exact: f64,
}

enum Guide {
    Tube(Tube),
    Rod(Rod),
}

fn main() {
    let tube = |scene, tube, batch_paths, exact| Case {
        scene,
        guide: Guide::Tube(tube),
        batch_paths,
        exact,
    };
    let rod =
        |scene, rod, batch_paths, exact| Case { scene, guide: Guide::Rod(rod), batch_paths, exact };
    let cases = [
        tube("b1_p10_r95", B1_P10, [8192, 16384], 0.51084474),
        tube("b1_p10_r99", B1_P10_R99, [8192, 16384], 0.84395879),
        tube("b1_p100_r95", B1_P100, [2048, 16384], 0.04442615),
        tube("b1_p100_r99", B1_P100_R99, [1024, 16384], 0.32754091),
        rod("b2_l60", B2, [4096, 16384], 0.84190538),
        rod("b2_l600", B2_L600, [1024, 16384], 0.84190538),
        rod("b4", B4, [8192, 16384], 0.8464698),
    ];
    println!("| guide | flux: rows by hand | ours | map: rows by hand | ours |");
    println!("|---|--:|--:|--:|--:|");
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    for case in &cases {
        println!("{}", pool.install(|| row(case)));
    }
}

fn row(case: &Case) -> String {
    let mut ratios: [Vec<f64>; 4] = Default::default();
    for seed in 1..=TURNS {
        let bare = by_hand(case, Steps::Single, seed);
        let rows = by_hand(case, Steps::Rows, seed);
        let forward = ours(case, Request::Forward, seed);
        let backward = ours(case, Request::Backward, seed);
        let found = [rows[0], forward[0], rows[1], forward[1].max(backward[1])];
        for (place, worth) in found.into_iter().enumerate() {
            ratios[place].push(worth / bare[usize::from(place > 1)]);
        }
    }
    let shown = ratios.map(|ratios| {
        let Spread { median, min, max } = Spread::of(ratios);
        let digits = usize::from(median < 10.0);
        format!("{median:.digits$} ({min:.digits$} to {max:.digits$})")
    });
    format!("| {} | {} |", case.scene, shown.join(" | "))
}

/// Worth of the flux and of the map by a loop.
fn by_hand(case: &Case, stepping: Steps, seed: u64) -> [f64; 2] {
    let work = Work {
        stepping,
        batches: BATCHES,
        batch_paths: case.batch_paths[usize::from(stepping == Steps::Rows)],
        roulette_below: ROULETTE_BELOW,
        seed,
    };
    let (seconds, counted) = cpu_seconds(|| match &case.guide {
        Guide::Tube(tube) => trace_tube(tube, &work),
        Guide::Rod(rod) => trace_rod(rod, &work),
    });
    let Counted { batches, map, .. } = counted;
    let flux = Tally::of(batches);
    check(case, "by hand", flux);
    let (mut variance, mut square) = (0.0, 0.0);
    for [mean, of_square] in map {
        let error2 = (of_square - mean * mean) / (BATCHES - 1) as f64;
        variance += error2;
        square += mean * mean - error2;
    }
    let of_flux = flux.mean().powi(2) / flux.std_error().powi(2);
    [of_flux, square / variance].map(|worth| worth / seconds)
}

/// Worth of the flux and of the map by a run of one second.
fn ours(case: &Case, estimator: Request, seed: u64) -> [f64; 2] {
    let path = format!("scenes/validation/{}.toml", case.scene);
    let mut job: Job =
        input::load(Path::new(&path), &Settings::default()).expect("the scenes are valid");
    // A run backward is for the map alone.
    job.scene.sensors.truncate(if estimator == Request::Backward { 1 } else { usize::MAX });
    let stop = StopRules { time: Some(LENGTH), ..StopRules::default() };
    let plan = RunPlan { estimator, seed, stop, ..job.run.clone() };
    let start = Instant::now();
    let signal = StopSignal::new(&Interrupt::default(), Some(start + LENGTH));
    let (seconds, run) = cpu_seconds(|| {
        let mut run = Run::start(&job.scene, &plan, &signal, &mut |_| ()).expect("time is enough");
        while start.elapsed() < LENGTH {
            run.next_piece();
        }
        run
    });
    let findings = run.findings();
    let id = SensorId::new(0);
    let readings = findings.readings(&job.scene, id);
    let flux = flux(&job.scene, readings, id);
    check(case, case.scene, flux);
    let [variance, square] = noise(&job.scene, readings, id);
    let of_flux = flux.mean().powi(2) / flux.std_error().powi(2);
    [of_flux, square / variance].map(|worth| worth / seconds)
}

fn check(case: &Case, what: &str, flux: Tally) {
    let sigmas = flux.sigmas_from(case.exact);
    assert!(sigmas.abs() < TOO_FAR, "{what}: {flux:?}, {sigmas} standard errors off");
}
