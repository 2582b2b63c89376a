//! Memory of the gather method scales with its records: neither passes nor photons are kept.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]
#![allow(clippy::print_stdout, reason = "figures, shown by --nocapture and on failure")]

use lumiduct_core::plan::{GatherPlan, Request, Schedule};
use lumiduct_core::transport::Run;
use lumiduct_input::{self as input, Settings};
use peak_alloc::PeakAlloc;

/// Counts allocated memory: what the system gives a process beyond that depends on threads and
/// load.
#[global_allocator]
static ALLOCATED: PeakAlloc = PeakAlloc;

/// A mirror tube and its exit, cell by cell.
const TUBE: &str = r#"
lumiduct = 1
title = "Memory"
[finishes.mirror]
specular = { reflectance = 0.95 }
[sheets.guide.tube]
profile = { circle = { radius_mm = 3 } }
path = [{ straight_mm = 20 }]
finish = "mirror"
[sources.led.disk]
radius_mm = 2
flux_lm = 10
[sensors]
exit = { plane = { cells = [16, 16] }, on = "guide.exit", counts = "incident", side = "back" }
"#;

/// Gather paths of a pass; each leaves a record of some 200 bytes.
const RECORDS: u64 = 4000;
/// Photons of a pass. Kept, those of 1,000 passes would take 100 MB at 50 bytes each, and records 800 MB.
const PHOTONS: u64 = 2000;
const WAVE: u64 = 4;
/// Allowed change of memory, MB: the sums over passes, as many as their number has binary digits,
/// each of 0.2 MB here.
const LEEWAY_MB: f64 = 2.0;

/// Memory after each of some numbers of passes: current and peak, MB.
fn memory<const N: usize>(photons: u64, passes: [u64; N]) -> [[f64; 2]; N] {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("tube.toml");
    std::fs::write(&path, TUBE).unwrap();
    let gather = GatherPlan {
        depth: Some(2),
        radius_mm: Some(0.3),
        angle_deg: Some(3.0),
        records: Some(RECORDS),
        photons: Some(photons),
        schedule: Some(Schedule::Fixed),
    };
    let settings = Settings { estimator: Some(Request::Gather), gather, ..Settings::default() };
    let job = input::load(&path, &settings).unwrap_or_else(|error| panic!("{error}"));
    let mut run = Run::new(&job.scene, &job.run);
    passes.map(|passes| {
        while run.waves() * WAVE < passes {
            run.next_wave();
        }
        assert!(run.paths() >= passes * (photons + RECORDS));
        [ALLOCATED.current_usage_as_mb(), ALLOCATED.peak_usage_as_mb()].map(f64::from)
    })
}

/// A scene of plain cylinders side by side, each a separate solid.
fn cylinders(count: usize) -> String {
    let mut text = String::from(
        "lumiduct = 1\ntitle = \"Many\"\n[media.acrylic]\nindex = 1.49\n[sources.led.point]\nat = { position_mm = [0, 0, -1] }\n\
         flux_lm = 1\n[sensors]\nexit = { plane = {}, on = \"rod_0.exit\", counts = \"leaving\" }\n",
    );
    for rod in 0..count {
        let (x, y) = (5 * (rod % 40), 5 * (rod / 40));
        text += &format!(
            "[solids.rod_{rod}.cylinder]\nradius_mm = 2\nlength_mm = 50\nmedium = \"acrylic\"\nat = {{ position_mm = [{x}, {y}, 0] }}\n"
        );
    }
    text
}

/// Peak memory beyond the initial one: to read a scene, to trace a wave, and to draw it for its
/// page, MB.
fn most_for_cylinders(count: usize) -> f64 {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("many.toml");
    std::fs::write(&path, cylinders(count)).unwrap();
    let before = ALLOCATED.current_usage_as_mb();
    ALLOCATED.reset_peak_usage();
    let settings = Settings { batch_paths: Some(1), ..Settings::default() };
    let job = input::load(&path, &settings).unwrap_or_else(|error| panic!("{error}"));
    let mut run = Run::new(&job.scene, &job.run);
    run.next_wave();
    let drawing = lumiduct_report::drawing(&job.scene, &[]);
    assert!(drawing.faces.len() <= 1501, "{} faces are drawn", drawing.faces.len());
    f64::from(ALLOCATED.peak_usage_as_mb() - before)
}

/// Largest memory of a plain solid, MB: its three faces have six sums in each of 128 groups, twice.
const SOLID_MB: f64 = 0.020;

/// A single test, as memory is counted for the whole process.
#[test]
fn memory_grows_neither_with_passes_nor_with_photons_and_little_with_solids() {
    let [few, many] = [600, 1600].map(most_for_cylinders);
    let each = (many - few) / 1000.0;
    println!("600 cylinders take {few:.1} MB, 1600 take {many:.1} MB: {:.1} kB each", 1e3 * each);
    assert!(each < SOLID_MB, "{:.1} kB for a cylinder", 1e3 * each);
    let [[early, _], [late, most]] = memory(PHOTONS, [112, 1120]);
    println!("held after 112 passes {early:.1} MB, after 1120 {late:.1} MB, at most {most:.1} MB");
    assert!(late - early < LEEWAY_MB, "1,008 passes took {:.1} MB", late - early);
    // The peak within a pass counts here, as the memory of a pass is freed at its end.
    let [[_, with_many]] = memory(50 * PHOTONS, [32]);
    println!("with 50 times the photons at most {with_many:.1} MB");
    assert!(with_many - most < LEEWAY_MB, "photons took {:.1} MB", with_many - most);
}
