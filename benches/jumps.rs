//! Rows of mirror bounces taken at once against the same paths step by step, on guides of the validation and a
//! hexagonal rod.
//!
//! `cargo bench --bench jumps`, with scene names after `--` to restrict it to those. One thread; both in turn, several times.
//! A cost is CPU seconds times the relative variance of the flux at the exit.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;
mod noise;

use clock::cpu_seconds;
use lumiduct_core::scene::SensorId;
use lumiduct_core::transport::forward::Forward;
use lumiduct_core::transport::stop::{Pace, StopSignal};
use lumiduct_core::transport::{Observer, Readings, Stepping, Unobserved};
use lumiduct_input::{self as input, Job, Settings};
use noise::noise;
use std::path::Path;

const SCENES: [&str; 8] = [
    "validation/b1_p10_r95",
    "validation/b1_p10_r99",
    "validation/b1_p100_r95",
    "validation/b1_p100_r99",
    "validation/b2_l60",
    "validation/b2_l600",
    "validation/b4",
    "rgb_mixing_rod",
];
/// Photon paths of a batch, batches, and turns.
const BATCH_PATHS: u64 = 1024;
const BATCHES: u64 = 128;
const TURNS: u64 = 3;

fn main() {
    println!("| scene | step by step, ns/path | jumping, ns/path | ratio | ratio of costs |");
    println!("|---|--:|--:|--:|--:|");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|name| name != "--bench").collect();
    for name in SCENES {
        if wanted.is_empty() || wanted.iter().any(|one| one == name) {
            println!("{}", row(name));
        }
    }
}

/// The row of a scene.
fn row(name: &str) -> String {
    let path = format!("scenes/{name}.toml");
    let job = input::load(Path::new(&path), &Settings::default()).expect("the scenes are valid");
    let (mut stepped, mut jumped) = (Measured::default(), Measured::default());
    for turn in 0..TURNS {
        stepped.add(&job, turn, &mut Stepping);
        jumped.add(&job, turn, &mut Unobserved);
    }
    let per_path = |one: &Measured| 1e9 * one.seconds / (TURNS * BATCHES * BATCH_PATHS) as f64;
    format!(
        "| {name} | {:.0} | {:.0} | {:.1} | {:.1} |",
        per_path(&stepped),
        per_path(&jumped),
        stepped.seconds / jumped.seconds,
        stepped.cost() / jumped.cost(),
    )
}

/// Photon paths of all turns.
#[derive(Default)]
struct Measured {
    seconds: f64,
    /// Sums over the turns: variance of the mean, and square of the mean.
    noise: [f64; 2],
}

impl Measured {
    fn add(&mut self, job: &Job, turn: u64, observer: &mut impl Observer) {
        let forward = Forward::new(&job.scene, job.run.seed, job.run.bounce_limit, BATCH_PATHS);
        let signal = StopSignal::default();
        let pace = Pace::new(&signal);
        let (seconds, readings) = cpu_seconds(|| {
            let batches = (turn * BATCHES..(turn + 1) * BATCHES)
                .map(|batch| forward.batch_observed(batch, observer, &pace));
            let sum: Option<Readings> = batches
                .reduce(|sum, next| sum.zip(next).map(|(sum, next)| sum.merge(&next)))
                .expect("there are batches");
            sum.expect("nothing stops it")
        });
        self.seconds += seconds;
        let found = noise(&job.scene, &readings, SensorId::new(0));
        (self.noise[0], self.noise[1]) = (self.noise[0] + found[0], self.noise[1] + found[1]);
    }

    fn cost(&self) -> f64 {
        self.seconds * self.noise[0] / self.noise[1]
    }
}
