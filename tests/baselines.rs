//! The baselines of the comparison against closed forms. They are small programs, but a comparison
//! with a wrong one would be worthless.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

use lumiduct_baselines::{Baseline, BaselineRun};
use lumiduct_core::measure::{self, Measure};
use lumiduct_core::scene::SensorId;
use lumiduct_core::transport::{Findings, Readings};
use lumiduct_input::{self as input, Job, Settings};
use std::f64::consts::PI;
use std::path::Path;

/// A job of a scene that lacks its head, with its sensor first.
fn job(text: &str) -> Job {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, format!("lumiduct = 1\ntitle = \"Baselines\"\n{text}")).unwrap();
    load(&path)
}

fn load(path: &Path) -> Job {
    match input::load(path, &Settings { seed: Some(5), ..Settings::default() }) {
        Ok(job) => job,
        Err(error) => panic!("{}: {error}", path.display()),
    }
}

/// The readings of some batches, and the share of throughput that was cut off.
fn traced(job: &Job, baseline: Baseline, batches: u64) -> (Readings, f64) {
    let mut run = BaselineRun::new(&job.scene, SensorId::new(0), &job.run, baseline);
    run.trace_until(batches);
    (run.readings().unwrap(), run.cut())
}

fn value(job: &Job, readings: &Readings, name: &str) -> Measure {
    measure::value_of(&job.scene, &Findings::forward(readings.clone()), name).unwrap()
}

/// Asserts the expected flux within a bias and 4 standard errors of at most `most` each.
fn assert_flux(job: &Job, baseline: Baseline, batches: u64, expected: f64, [most, bias]: [f64; 2]) {
    let (readings, _) = traced(job, baseline, batches);
    let name = format!("{}.flux", job.scene.sensors[0].name);
    let flux = value(job, &readings, &name);
    let what = format!("{}: {} ± {}, not {expected}", baseline.name(), flux.value, flux.std_error);
    assert!(flux.std_error <= most * expected, "noise of {what}");
    assert!((flux.value - expected).abs() <= 4.0 * flux.std_error + bias * expected, "{what}");
}

#[test]
fn all_find_the_exit_flux_of_a_mirror_tube() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/validation/b1_p10_r95.toml");
    let job = load(&path);
    for baseline in Baseline::ALL {
        assert_flux(&job, baseline, 64, 0.510_844_74, [0.01, 0.0]);
    }
}

#[test]
fn all_see_a_patch_of_light() {
    // Two disks of radius 2 and 3 that face each other at 4 mm.
    let job = job(r#"
[sources.patch.disk]
radius_mm = 2
flux_lm = 10
[sensors.cell]
plane = { disk = { radius_mm = 3 }, rings = 2, sectors = 4 }
at = { position_mm = [0, 0, 4] }
side = "back"
"#);
    // Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-41.
    let [r1, r2] = [2.0 / 4.0, 3.0 / 4.0f64];
    let x: f64 = 1.0 + (1.0 + r2 * r2) / (r1 * r1);
    let factor = 0.5 * (x - (x * x - 4.0 * (r2 / r1).powi(2)).sqrt());
    for baseline in Baseline::ALL {
        assert_flux(&job, baseline, 64, 10.0 * factor, [0.005, 0.0]);
    }
}

#[test]
fn whitted_splits_light_in_a_glass_plate_as_fresnel_does() {
    let [radius, distance, thickness, index] = [50.0, 20.0, 5.0, 1.5f64];
    let job = job(r#"
[media.glass]
index = 1.5
[solids.plate.box]
size_mm = [2000, 2000, 5]
medium = "glass"
at = { position_mm = [0, 0, 5] }
[sources.patch.disk]
radius_mm = 50
flux_lm = 10
[sensors.cell]
plane = { rectangle = { width_mm = 0.01, height_mm = 0.01 } }
at = { position_mm = [0, 0, 20] }
side = "back"
"#);
    // Illuminance behind the plate: ∫ L Σ T² R^2k cos θ dω over the orders k that meet the source.
    let luminance = 10.0 / (PI * PI * radius * radius);
    let steps = 200_000;
    let mut sum = 0.0;
    for step in 0..steps {
        let sin = (f64::from(step) + 0.5) / f64::from(steps);
        let (cos, sin_t) = ((1.0 - sin * sin).sqrt(), sin / index);
        let cos_t = (1.0 - sin_t * sin_t).sqrt();
        let s = ((cos - index * cos_t) / (cos + index * cos_t)).powi(2);
        let p = ((index * cos - cos_t) / (index * cos + cos_t)).powi(2);
        let reflectance = 0.5 * (s + p);
        for order in 0..40 {
            let passes = f64::from(2 * order + 1);
            let offset = (distance - thickness) * sin / cos + passes * thickness * sin_t / cos_t;
            if offset < radius {
                sum += (1.0 - reflectance).powi(2) * reflectance.powi(2 * order) * sin;
            }
        }
    }
    let expected = 1e-4 * luminance * 2.0 * PI * sum / f64::from(steps);
    assert_flux(&job, Baseline::Whitted, 64, expected, [0.002, 1e-5]);
    let (_, cut) = traced(&job, Baseline::Whitted, 4);
    assert!(0.0 < cut && cut < 1e-3, "{cut}");
    assert_flux(&job, Baseline::Metropolis, 64, expected, [0.01, 0.0]);
}

#[test]
fn sppm_gathers_the_light_of_a_lambertian_room() {
    // Light of the wall of a closed white sphere through a small port that faces away from the lamp.
    let job = job(r#"
[finishes.white]
lambertian = { reflectance = 0.6 }
[sheets.wall.spherical_cap]
radius_mm = 50
half_angle_deg = 180
finish = "white"
[sources.lamp.point]
flux_lm = 1
emission = "isotropic"
[sensors.cell]
plane = { disk = { radius_mm = 2 } }
at = { position_mm = [0, 0, 20] }
side = "front"
[run.gather]
radius_mm = 4
"#);
    // ρ/(1 - ρ) over the sphere's area.
    let expected = PI * 4.0 * 0.6 / 0.4 / (4.0 * PI * 2500.0);
    assert_flux(&job, Baseline::Sppm, 24, expected, [0.01, 0.002]);
}

#[test]
fn metropolis_divides_light_among_cells_as_gather_paths_do() {
    // A lamp of two parts, one of them nine times as bright, behind a rod: most paths carry
    // nothing.
    let job = job(&format!(
        "{}{}",
        include_str!("rod.toml"),
        r#"
[sensors.cell]
plane = { cells = [2, 1] }
on = "rod.exit"
counts = "leaving"
[sources.side.disk]
radius_mm = 0.3
at = { position_mm = [1.2, 0, -0.1] }
flux_lm = 1
[run]
estimator = "backward"
paths = 1_000_000
"#
    ));
    let mut run = lumiduct_core::transport::Run::new(&job.scene, &job.run);
    while !run.is_complete() {
        run.next_wave();
    }
    let findings = run.findings();
    let (readings, _) = traced(&job, Baseline::Metropolis, 256);
    let names = ["cell.flux", "cell.flux.from.side", "cell.cell.0.0", "cell.cell.1.0"];
    for name in names {
        let expected = measure::value_of(&job.scene, &findings, name).unwrap();
        let found = value(&job, &readings, name);
        let error = expected.std_error.hypot(found.std_error);
        assert!(found.std_error < 0.03 * found.value, "{name}: {found:?}");
        assert!(
            (found.value - expected.value).abs() < 4.0 * error,
            "{name}: {found:?} {expected:?}"
        );
    }
}

#[test]
fn the_same_seed_gives_the_same_bits_whatever_is_traced_at_a_time() {
    let job = job(&format!(
        "{}\n[sensors.cell]\nplane = {{}}\non = \"rod.exit\"\ncounts = \"leaving\"\n",
        include_str!("rod.toml")
    ));
    for baseline in Baseline::ALL {
        let (at_once, _) = traced(&job, baseline, 8);
        let mut run = BaselineRun::new(&job.scene, SensorId::new(0), &job.run, baseline);
        for batches in [1, 3, 8] {
            run.trace_until(batches);
        }
        assert_eq!(run.readings().unwrap(), at_once, "{}", baseline.name());
    }
}
