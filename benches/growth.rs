//! How the time of a photon path grows with bounces, cells, elements, triangles, sensors and threads.
//!
//! `cargo bench --bench growth`, or with a file after `--` to draw the curves there as well. CPU seconds of one thread, the median of
//! several turns; threads are timed by the clock, and want a quiet machine.
#![allow(clippy::print_stdout, reason = "a bench prints its table")]

mod clock;
#[allow(dead_code, reason = "shared with other benches")]
mod guides;
#[allow(dead_code, reason = "extremes are for other benches")]
mod spread;

use clock::cpu_seconds;
use guides::{B2, mesh_scene, rod_mesh};
use lumiduct_base::math::Frame;
use lumiduct_core::plan::Request;
use lumiduct_core::scene::Scene;
use lumiduct_core::scene::mesh::Mesh;
use lumiduct_core::transport::forward::Forward;
use lumiduct_core::transport::stop::{Pace, StopSignal};
use lumiduct_core::transport::{Observer, Run, Stepping, Unobserved};
use lumiduct_input::{self as input, Job, Settings};
use plotters::prelude::*;
use plotters::style::register_font;
use rayon::ThreadPoolBuilder;
use spread::Spread;
use std::fs::File;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// Photon paths of a batch.
const BATCH_PATHS: u64 = 1024;
/// CPU seconds of a measurement.
const ENOUGH: f64 = 0.3;
/// Measurements of a point.
const TURNS: usize = 5;
/// Paths of a run on one or more threads.
const RUN_PATHS: u64 = 2_000_000;
const BOUNCE_LIMIT: u32 = 100_000;
/// Width and height of a panel, pixels.
const PANEL: [u32; 2] = [440, 330];
const FONT: (&str, i32) = ("lumiduct", 17);
const BLUE_INK: RGBColor = RGBColor(31, 99, 180);
const RED_INK: RGBColor = RGBColor(190, 60, 40);

/// A number that grows, and the time of a path.
struct Growth {
    of: &'static str,
    scene: &'static str,
    curves: Vec<(&'static str, Vec<[f64; 2]>)>,
}

fn main() {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    let alone = [bounces, cells, elements, triangles, sensors];
    let mut all: Vec<Growth> = alone.iter().map(|of| pool.install(of)).collect();
    all.push(threads());
    println!("| growing | scene | value: ns/path |\n|---|---|---|");
    for Growth { of, scene, curves } in &all {
        for (name, points) in curves {
            let points = points.iter().map(|[x, y]| format!("{x}: {y:.0}"));
            let points = points.collect::<Vec<_>>().join(", ");
            println!("| {of} | {scene}{name} | {points} |");
        }
    }
    if let Some(file) = std::env::args().skip(1).find(|argument| argument != "--bench") {
        draw(&all, Path::new(&file)).expect("the picture can be drawn");
    }
}

fn load(name: &str, overrides: Vec<String>) -> Job {
    let settings = Settings { overrides, estimator: Some(Request::Forward), ..Settings::default() };
    let path = format!("scenes/{name}.toml");
    input::load(Path::new(&path), &settings).expect("the scenes are valid")
}

/// CPU time of a photon path, ns.
fn path_time(scene: &Scene, observer: &mut impl Observer) -> f64 {
    let forward = Forward::new(scene, 1, BOUNCE_LIMIT, BATCH_PATHS);
    let signal = StopSignal::default();
    let pace = Pace::new(&signal);
    let mut batches = 0..;
    let mut trace = || {
        let batch = batches.next().expect("there is always another");
        black_box(forward.batch_observed(batch, observer, &pace).expect("nothing stops it"));
    };
    // Into the caches.
    trace();
    let mut turn = || {
        let (mut seconds, mut count) = (0.0, 0);
        while seconds < ENOUGH {
            seconds += cpu_seconds(&mut trace).0;
            count += 1;
        }
        1e9 * seconds / (count * BATCH_PATHS) as f64
    };
    Spread::of((0..TURNS).map(|_| turn())).median
}

fn bounces() -> Growth {
    let lengths = [30, 100, 300, 1000, 3000, 10_000];
    let tube = |length: &u32| {
        let overrides = vec![
            format!("sheets.duct.tube.path.0.straight_mm={length}"),
            "finishes.mirror.specular.reflectance=0.999".to_owned(),
        ];
        (f64::from(*length) / 10.0, load("validation/b1_p10_r95", overrides).scene)
    };
    let tubes: Vec<_> = lengths.iter().map(tube).collect();
    let rows = tubes.iter().map(|(aspect, scene)| [*aspect, path_time(scene, &mut Unobserved)]);
    let steps = tubes.iter().map(|(aspect, scene)| [*aspect, path_time(scene, &mut Stepping)]);
    Growth {
        of: "length over diameter",
        scene: "mirror tube, R 0.999",
        curves: vec![(", rows of bounces", rows.collect()), (", step by step", steps.collect())],
    }
}

fn cells() -> Growth {
    let point = |cells: &u32| {
        let cells_key = format!("sensors.exit.plane.cells=[{cells}, {cells}]");
        let job = load("mirror_tube", vec![cells_key]);
        [f64::from(cells * cells), path_time(&job.scene, &mut Unobserved)]
    };
    let points = [16, 64, 256, 1024].iter().map(point).collect();
    Growth { of: "cells of the exit", scene: "mirror_tube", curves: vec![("", points)] }
}

fn elements() -> Growth {
    // Dots that cover the same share of the panel.
    let point = |pitch: &f64| {
        let pitches = format!("{{ across_pitch_mm = {pitch}, pitch_mm = {} }}", 1.5 * pitch);
        let overrides = vec![
            format!("patterns.dots.layout={{ grid = {pitches} }}"),
            format!("patterns.dots.element={{ circle = {{ diameter_mm = {} }} }}", 0.5 * pitch),
        ];
        let job = load("extraction_panel", overrides);
        let count = 9.0 * (20.0 / pitch).powi(2);
        [count.round(), path_time(&job.scene, &mut Unobserved)]
    };
    let points = [20.0, 6.0, 2.0, 0.6, 0.2, 0.06, 0.02].iter().map(point).collect();
    Growth { of: "dots", scene: "extraction_panel", curves: vec![("", points)] }
}

fn triangles() -> Growth {
    let point = |[around, along]: &[u32; 2]| {
        let mesh = rod_mesh(1.5, B2.length, *around, *along);
        let scene = mesh_scene(&B2, Mesh::new(&mesh, &Frame::WORLD));
        let count = 2.0 * f64::from(*around) * f64::from(along + 1);
        [count, path_time(&scene, &mut Unobserved)]
    };
    let sizes = [[32, 15], [100, 50], [316, 158], [980, 500]];
    let points = sizes.iter().map(point).collect();
    Growth { of: "triangles", scene: "round rod", curves: vec![("", points)] }
}

fn sensors() -> Growth {
    let point = |count: &u32| {
        let plane = |place: u32| {
            let z = 100.0 * f64::from(place + 1) / f64::from(count + 1);
            let rectangle = "rectangle = { width_mm = 10, height_mm = 10 }, cells = [16, 16]";
            let at = format!("position_mm = [0, 0, {z}]");
            format!("sensors.plane{place}={{ plane = {{ {rectangle} }}, at = {{ {at} }} }}")
        };
        let job = load("mirror_tube", (0..*count).map(plane).collect());
        [f64::from(count + 3), path_time(&job.scene, &mut Unobserved)]
    };
    let points = [0, 1, 3, 7, 15, 31, 61].iter().map(point).collect();
    Growth { of: "sensors", scene: "mirror_tube, planes across it", curves: vec![("", points)] }
}

fn threads() -> Growth {
    let most = std::thread::available_parallelism().map_or(1, |count| count.get());
    let mut job = load("mirror_tube", Vec::new());
    job.run.stop.paths = Some(RUN_PATHS);
    let point = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let turn = || {
            let start = Instant::now();
            pool.install(|| {
                let mut run = Run::new(&job.scene, &job.run);
                while !run.is_complete() {
                    run.next_wave();
                }
            });
            1e9 * start.elapsed().as_secs_f64() / RUN_PATHS as f64
        };
        [threads as f64, Spread::of((0..TURNS).map(|_| turn())).median]
    };
    let counts = std::iter::successors(Some(1), |count| Some(2 * count));
    let points = counts.take_while(|count| *count <= most).map(point).collect();
    Growth { of: "threads", scene: "mirror_tube, by the clock", curves: vec![("", points)] }
}

/// Draws a panel for each, both axes logarithmic.
fn draw(all: &[Growth], file: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let font = include_bytes!("../crates/report/src/png/font/lumiduct-regular.ttf");
    register_font(FONT.0, FontStyle::Normal, font).map_err(|_| "the font is not readable")?;
    let [width, height] = PANEL;
    let size = (3 * width, 2 * height);
    let mut pixels = vec![0; (size.0 * size.1 * 3) as usize];
    let root = BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area();
    root.fill(&WHITE)?;
    for (growth, area) in all.iter().zip(root.split_evenly((2, 3))) {
        let points = || growth.curves.iter().flat_map(|(_, points)| points);
        // Whole decades, so that every axis has labels.
        let range = |axis: usize| {
            let least = points().map(|point| point[axis]).fold(f64::INFINITY, f64::min);
            let most = points().map(|point| point[axis]).fold(0.0, f64::max);
            0.99 * 10_f64.powf(least.log10().floor())..1.01 * 10_f64.powf(most.log10().ceil())
        };
        let label = |value: &f64| match value.log10().round() {
            power if power < 4.0 => format!("{value}"),
            power => format!("1e{power}"),
        };
        let mut chart = ChartBuilder::on(&area)
            .margin(14)
            .caption(growth.scene, FONT)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(range(0).log_scale(), range(1).log_scale())?;
        chart
            .configure_mesh()
            .x_desc(growth.of)
            .y_desc("ns per path")
            .label_style(FONT)
            .axis_desc_style(FONT)
            .light_line_style(WHITE)
            .x_labels(6)
            .y_labels(5)
            .x_label_formatter(&label)
            .y_label_formatter(&label)
            .draw()?;
        for ((_, points), ink) in growth.curves.iter().zip([BLUE_INK, RED_INK]) {
            let line = points.iter().map(|[x, y]| (*x, *y));
            chart.draw_series(LineSeries::new(line.clone(), ink.stroke_width(2)))?;
            chart.draw_series(line.map(|point| Circle::new(point, 4, ink.filled())))?;
        }
    }
    root.present()?;
    drop(root);
    let mut encoder = png::Encoder::new(File::create(file)?, size.0, size.1);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(())
}
