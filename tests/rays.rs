//! Rays from files as sources, and of sensors for files.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod traced;

use lumiduct_base::units::FluxUnit;
use lumiduct_core::measure::{Measure, Measures};
use lumiduct_core::plan::Request;
use lumiduct_core::scene::SensorId;
use lumiduct_core::transport::{CountedRay, RayCollection, counted_rays};
use lumiduct_files::rays::{FileRay, RayFormat, RaySetInfo, write};
use lumiduct_input::Settings;
use std::path::{Path, PathBuf};

/// Writes rays as (position, direction, flux).
fn file(
    folder: &Path,
    format: RayFormat,
    unit: FluxUnit,
    rays: &[([f32; 3], [f32; 3], f32)],
) -> PathBuf {
    let path = folder.join(format!("lamp.{}", format.ending()));
    let rays: Vec<FileRay> = rays
        .iter()
        .map(|&(position_mm, direction, flux)| FileRay { position_mm, direction, flux })
        .collect();
    let info = RaySetInfo {
        count: rays.len() as u64,
        unit,
        flux: rays.iter().map(|ray| f64::from(ray.flux)).sum(),
        luminous_flux_lm: None,
        is_measured: false,
        texts: Vec::new(),
    };
    let mut out = std::fs::File::create(&path).unwrap();
    write(&mut out, format, &info, rays.into_iter().map(Ok)).unwrap();
    path
}

fn measured(text: &str, paths: u64, estimator: Request) -> Measures {
    let settings =
        Settings { paths: Some(paths), estimator: Some(estimator), ..Settings::default() };
    traced::measures(&traced::load(text, &settings))
}

/// A window of index 1.5 and two planes behind it.
const WINDOW: &str = r#"
[media.glass]
index = 1.5
[solids.window.box]
size_mm = [20, 20, 2]
medium = "glass"
at = { position_mm = [0, 0, 5] }
[sensors]
left = { plane = { rectangle = { width_mm = 2, height_mm = 2 } }, at = { position_mm = [-2, 0, 20], axis = [0, 0, -1] } }
right = { plane = { rectangle = { width_mm = 2, height_mm = 2 } }, at = { position_mm = [4, 0, 20], axis = [0, 0, -1] } }
"#;

#[test]
fn rays_start_where_the_file_says_with_their_share_of_the_flux() {
    let folder = tempfile::tempdir().unwrap();
    let along = [0.0, 0.0, 1.0];
    let rays = [
        ([-2.0, 0.0, 0.0], along, 1.0),
        ([2.0, 0.0, 0.0], [0.1, 0.0, 0.995], 3.0),
        ([0.0, 5.0, 0.0], along, 0.0),
    ];
    for format in [RayFormat::Tm25, RayFormat::Zemax, RayFormat::Csv] {
        let path = file(folder.path(), format, FluxUnit::Lumen, &rays);
        let source = format!("[sources.lamp.rays]\nfile = {path:?}\n{WINDOW}");
        let measures = measured(&source, 40_000, Request::Forward);
        // At normal incidence the window passes 2 n / (n² + 1) = 3 / 3.25; at 5.7 degrees as much to 1e-4.
        let passed = 3.0 / 3.25;
        for (name, flux) in [("left.flux", 1.0), ("right.flux", 3.0)] {
            let Measure { value, std_error, .. } = measures.values[name];
            let (expected, allowed) = (flux * passed, 4.0 * std_error + 1e-3 * flux);
            assert!((value - expected).abs() < allowed, "{format} {name}: {value}");
        }
        assert_eq!(measures.source_flux, 4.0);
    }
}

#[test]
fn flux_is_that_of_the_scene_or_the_luminous_one_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let rays = [([0.0; 3], [0.0, 0.0, 1.0], 2.0)];
    let path = file(folder.path(), RayFormat::Tm25, FluxUnit::Watt, &rays);
    for (keys, unit, flux) in [("flux_lm = 700", "lm", 700.0), ("flux_w = 1.5", "W", 1.5)] {
        let text = format!("[sources.lamp.rays]\nfile = {path:?}\n{keys}\n{WINDOW}");
        let measures = measured(&text, 1000, Request::Forward);
        assert_eq!(measures.source_flux, flux);
        assert_eq!(measures.values["left.flux"].unit, unit);
    }
}

/// A disk that shines into a mirror tube, with a plane over its exit.
const TUBE: &str = r#"
[finishes.mirror]
specular = { reflectance = 0.9 }
[sheets.tube.tube]
profile = { circle = { radius_mm = 2 } }
path = [{ straight_mm = 8 }]
finish = "mirror"
"#;
const SENSORS: &str = r#"
[sensors]
exit = { plane = { cells = [2, 2] }, on = "tube.exit", counts = "leaving" }
above = { plane = { rectangle = { width_mm = 6, height_mm = 6 }, cells = [3, 3] }, at = { position_mm = [0, 0, 9], axis = [0, 0, -1] } }
"#;

fn exit_rays(count: usize) -> (Vec<CountedRay>, Measures) {
    let text = format!("[sources.led.disk]\nradius_mm = 1\nflux_lm = 5\n{TUBE}{SENSORS}");
    let settings =
        Settings { paths: Some(1 << 20), estimator: Some(Request::Forward), ..Settings::default() };
    let job = traced::load(&text, &settings);
    let asked = RayCollection { sensor: SensorId::new(0), count, seed: 7, bounce_limit: 1000 };
    (counted_rays(&job.scene, &asked), traced::measures(&job))
}

fn in_file(rays: &[CountedRay]) -> Vec<([f32; 3], [f32; 3], f32)> {
    let single = |v: glam::DVec3| v.as_vec3().to_array();
    rays.iter().map(|ray| (single(ray.point), single(ray.dir), ray.flux as f32)).collect()
}

#[test]
fn rays_of_a_sensor_carry_its_flux_and_light_the_next_scene_alike() {
    let count = 50_000;
    let (rays, measures) = exit_rays(count);
    assert_eq!(rays.len(), count);
    let sum: f64 = rays.iter().map(|ray| ray.flux).sum();
    let flux = measures.values["exit.flux"].value;
    // Their fluxes differ by the reflections: weights of 0.9^n have a variance of less than 0.1.
    assert!((sum / flux - 1.0).abs() < 4.0 * (0.1 / count as f64).sqrt(), "{sum} {flux}");
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), RayFormat::Tm25, FluxUnit::Lumen, &in_file(&rays));
    let above = SENSORS.lines().find(|line| line.starts_with("above")).unwrap();
    let text = format!("[sources.lamp.rays]\nfile = {path:?}\n[sensors]\n{above}\n");
    let again = measured(&text, 1 << 17, Request::Forward);
    let [from_rays, direct] =
        [&again, &measures].map(|of| &of.maps[usize::from(of.maps.len() > 1)]);
    for ((place, found), expected) in from_rays.values.indexed_iter().zip(&direct.values) {
        // What so few rays leave open, beside the error of the direct run: a cell has some 5 % of them.
        let allowed = 4.5
            * (direct.std_errors[place].powi(2) + expected.powi(2) / (0.05 * count as f64)).sqrt();
        assert!((found - expected).abs() < allowed, "{place:?}: {found} {expected}");
    }
}

#[test]
fn photons_of_rays_that_end_in_records_find_the_same_light() {
    let (rays, _) = exit_rays(20_000);
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), RayFormat::Csv, FluxUnit::Lumen, &in_file(&rays));
    let text = format!(
        "{TUBE}[sources.lamp.rays]\nfile = {path:?}\nat = {{ position_mm = [0, 0, -8.5] }}\n[sensors]\n\
         cell = {{ plane = {{ rectangle = {{ width_mm = 1, height_mm = 1 }} }}, at = {{ position_mm = [1, 0, 14], axis = [0, 0, -1] }}, aim = [\"tube.exit\"] }}\n"
    );
    let [forward, merged] = [(4 << 20, Request::Forward), (1 << 20, Request::Mis)]
        .map(|(paths, estimator)| measured(&text, paths, estimator).values["cell.flux"].clone());
    let error = forward.std_error.hypot(merged.total_error());
    assert!((forward.value - merged.value).abs() < 4.0 * error, "{forward} {merged}");
    assert!(merged.total_error() < 0.1 * merged.value, "{merged}");
}

#[test]
fn a_sensor_without_light_has_no_rays() {
    let text = format!("[sources.led.disk]\nradius_mm = 1\nflux_lm = 5\n{TUBE}{SENSORS}");
    let turned = text.replace(
        "position_mm = [0, 0, 9], axis = [0, 0, -1]",
        "position_mm = [0, 0, -9], axis = [0, 0, -1]",
    );
    let job = traced::load(&turned, &Settings::default());
    let asked = RayCollection { sensor: SensorId::new(1), count: 10, seed: 7, bounce_limit: 1000 };
    assert_eq!(counted_rays(&job.scene, &asked), []);
}

/// A sheet of paper beside the light of a lamp, seen by a cell, and the lamp's rays as a source.
fn paper(path: &Path) -> String {
    format!(
        "[sources.lamp.rays]\nfile = {path:?}\nfitted = true\nat = {{ position_mm = [0, 0, -8.5] }}\n\
         [finishes.paper]\nlambertian = {{ reflectance = 0.8 }}\n\
         [sheets.card.rectangle]\nwidth_mm = 8\nheight_mm = 8\nfinish = \"paper\"\nat = {{ position_mm = [0, 0, 6], axis = [0.3, 0, -1] }}\n\
         [sensors]\n\
         cell = {{ plane = {{ rectangle = {{ width_mm = 3, height_mm = 3 }} }}, at = {{ position_mm = [6, 0, 2], axis = [-1, 0, 1] }} }}\n"
    )
}

#[test]
fn every_estimator_finds_the_same_light_of_a_fit() {
    let (rays, _) = exit_rays(20_000);
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), RayFormat::Tm25, FluxUnit::Lumen, &in_file(&rays));
    let found = [Request::Forward, Request::Backward, Request::Mix, Request::Mis, Request::Gather]
        .map(|estimator| measured(&paper(&path), 1 << 20, estimator).values["cell.flux"].clone());
    let [forward, others @ ..] = &found;
    assert!(forward.std_error < 0.01 * forward.value, "{forward}");
    for (number, other) in others.iter().enumerate() {
        let error = forward.std_error.hypot(other.total_error());
        assert!((forward.value - other.value).abs() < 4.0 * error, "{number}: {forward} {other}");
        assert!(other.total_error() < 0.1 * other.value, "{number}: {other}");
    }
}

#[test]
fn a_fit_shows_the_luminance_of_the_lamp_to_a_lens() {
    const LENS: &str = r#"
[sensors.lens]
luminance = { cells = [5, 5], rectangle = { width_mm = 3, height_mm = 3 }, directions = [
    { theta_deg = 0, phi_deg = 0 },
], acceptance_half_angle_deg = 12 }
at = { position_mm = [0.4, 0, 6], axis = [0, 0, -1] }
"#;
    const DISK: &str = "[sources.led.disk]\nradius_mm = 1\nflux_lm = 5\n";
    const NEAR: &str = "[sensors.near]\nplane = { rectangle = { width_mm = 40, height_mm = 40 } }\nat = { position_mm = [0, 0, 1], axis = [0, 0, -1] }";
    let job = traced::load(&format!("{DISK}{NEAR}"), &Settings::default());
    let asked =
        RayCollection { sensor: SensorId::new(0), count: 40_000, seed: 7, bounce_limit: 1000 };
    let rays = in_file(&counted_rays(&job.scene, &asked));
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), RayFormat::Tm25, FluxUnit::Lumen, &rays);
    let of_rays = |keys: &str| {
        let text = format!("[sources.lamp.rays]\nfile = {path:?}\n{keys}\n{LENS}");
        measured(&text, 1 << 20, if keys.is_empty() { Request::Forward } else { Request::Backward })
    };
    let lamp = format!("{DISK}{LENS}");
    let lamp = measured(&lamp, 1 << 21, Request::Backward);
    let [rays, fitted] = [of_rays(""), of_rays("fitted = true")];
    // Root mean square of the differences of cells without what the errors of both explain, relative to the mean.
    let difference = |of: &Measures| {
        let [ours, theirs] = [&of.maps[0], &lamp.maps[0]];
        let squares = ours.values.indexed_iter().map(|(place, value)| {
            let errors = ours.std_errors[place].hypot(theirs.std_errors[place]);
            (value - theirs.values[place]).powi(2) - errors.powi(2)
        });
        let mean = theirs.values.mean().unwrap();
        (squares.sum::<f64>() / ours.values.len() as f64).max(0.0).sqrt() / mean
    };
    let [of_rays, of_fit] = [difference(&rays), difference(&fitted)];
    assert!(of_fit < 0.03 && of_rays > 0.08, "{of_rays} {of_fit}");
}
