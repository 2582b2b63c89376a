//! Luminaires from files as sources, and as files of goniometers.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod traced;

use glam::DVec3;
use lumiduct_base::error::DiagnosticKind;
use lumiduct_core::measure::Measures;
use lumiduct_core::plan::Request;
use lumiduct_files::luminaire::{Intensities, LampFlux, LuminaireFormat};
use lumiduct_input::{self as input, Job, Settings};
use lumiduct_report::{LuminaireOrigin, MeasuredLuminaire};
use std::f64::consts::{PI, TAU};

/// A lamp whose light goes up, too: 10 cd down, 5 cd to the sides and 1 cd up, with an opening.
const UPWARD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bad_input/luminaires/upward.ies");
/// An opening of 4 mm by 3 mm, whose light differs from plane to plane.
const SPOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/luminaires/spot.ies");

fn far(source: &str, paths: u64) -> Measures {
    let text = format!(
        "{source}\n[sensors]\nfar = {{ goniometer = {{ c_step_deg = 30, gamma_step_deg = 15 }} }}\n"
    );
    let estimator = Some(Request::Forward);
    let settings = Settings { paths: Some(paths), estimator, ..Settings::default() };
    traced::measures(&traced::load(&text, &settings))
}

/// The mean of intensities over the solid angle of a cell, by its steps, deg, and place in C and γ.
fn mean_of_cell(file: &Intensities, steps_deg: [f64; 2], [sector, ring]: [usize; 2]) -> f64 {
    let parts = 40;
    let middle = |n: usize| (n as f64 + 0.5) / parts as f64;
    let (mut sum, mut weight) = (0.0, 0.0);
    for n in 0..parts * parts {
        let c = steps_deg[0] * (sector as f64 + middle(n / parts));
        let gamma = steps_deg[1] * (ring as f64 + middle(n % parts));
        let solid = gamma.to_radians().sin();
        (sum, weight) = (sum + solid * file.at(c, gamma), weight + solid);
    }
    sum / weight
}

#[test]
fn a_goniometer_reads_the_intensities_of_the_file() {
    let file = lumiduct_files::luminaire::read(SPOT.as_ref()).unwrap().luminaire;
    for extent in ["point", "opening"] {
        let measures = far(
            &format!("[sources.lamp.luminaire]\nfile = {SPOT:?}\nextent = {extent:?}"),
            400_000,
        );
        let flux = measures.values["far.flux"].value;
        assert!((flux / file.intensities.flux() - 1.0).abs() < 1e-9, "{extent}: {flux}");
        let table = &measures.intensities[0];
        let mut checked = 0;
        for ((ring, sector), found) in table.values.indexed_iter() {
            let expected = mean_of_cell(&file.intensities, [30.0, 15.0], [sector, ring]);
            let error = table.std_errors[(ring, sector)];
            assert!(
                (found - expected).abs() <= 4.5 * error + 2e-4 * expected,
                "{extent} {ring} {sector}: {found} {expected} {error}"
            );
            checked += usize::from(expected > 0.0);
        }
        assert_eq!(checked, 60, "{extent}: cells with light");
    }
}

/// Sizes of [`bright_box`] along C0, along C90 and upward, mm, and its luminance, cd/mm².
const BOX: [f64; 3] = [40.0, 20.0, 10.0];
const BOX_LUMINANCE: f64 = 0.5;

/// A file of a box whose faces all have one luminance: the intensity is luminance times projected area. Its width, length and
/// height in the file.
fn bright_box(sizes: &str) -> String {
    let [x, y, z] = BOX;
    let steps = |count: u32| (0..=count).map(|n| f64::from(5 * n));
    let line = |numbers: Vec<String>| numbers.join(" ") + "\n";
    let plane = |c: f64| {
        let intensity = |gamma: f64| {
            let (sin, cos) = gamma.to_radians().sin_cos();
            let (across, along) = c.to_radians().sin_cos();
            let area = x * y * cos.abs() + sin * (y * z * along.abs() + x * z * across.abs());
            (BOX_LUMINANCE * area).to_string()
        };
        line(steps(36).map(intensity).collect())
    };
    let head = format!("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 37 19 1 2 {sizes}\n1 1 0\n");
    let angles = |count| line(steps(count).map(|angle| angle.to_string()).collect());
    head + &angles(36) + &angles(18) + &steps(18).map(plane).collect::<String>()
}

/// Openings that shine to several sides, as width, length and height in m: a box, an upright cylinder, both sides of a
/// rectangle, a disk and a standing rectangle.
const OPEN_TO_ALL_SIDES: [&str; 5] =
    ["0.02 0.04 0.01", "-0.03 -0.03 0.02", "0.02 0.04 0", "-0.03 -0.03 0", "0.02 0 0.03"];

#[test]
fn openings_to_all_sides_have_the_intensities_and_the_flux_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lamp.ies");
    for sizes in OPEN_TO_ALL_SIDES {
        std::fs::write(&path, bright_box(sizes)).unwrap();
        let file = lumiduct_files::luminaire::read(&path).unwrap().luminaire.intensities;
        let source = format!("[sources.lamp.luminaire]\nfile = {path:?}");
        let measures = far(&source, 200_000);
        let flux = measures.values["far.flux"].value;
        assert!((flux / file.flux() - 1.0).abs() < 1e-9, "{sizes}: {flux}");
        let table = &measures.intensities[0];
        for ((ring, sector), found) in table.values.indexed_iter() {
            let expected = mean_of_cell(&file, [30.0, 15.0], [sector, ring]);
            let error = table.std_errors[(ring, sector)];
            assert!(
                (found - expected).abs() <= 4.5 * error + 2e-3 * expected,
                "{sizes} {ring} {sector}: {found} {expected} {error}"
            );
        }
    }
}

#[test]
fn a_box_has_one_luminance_on_the_faces_that_a_place_sees() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("box.ies");
    std::fs::write(&path, bright_box("0.02 0.04 0.01")).unwrap();
    let [x, y, z] = BOX;
    let text = format!(
        "[sources.lamp.luminaire]\nfile = {path:?}\n[sensors]\n\
         side = {{ plane = {{ rectangle = {{ width_mm = 1, height_mm = 1 }} }}, at = {{ position_mm = [35, 0, 0], axis = [-1, 0, 0] }} }}\n\
         top = {{ plane = {{ rectangle = {{ width_mm = 1, height_mm = 1 }} }}, at = {{ position_mm = [0, 0, -20], axis = [0, 0, 1] }} }}\n"
    );
    // The share of the half space, by projected solid angle, of a rectangle in front of its middle.
    let share = |sizes: [f64; 2], distance: f64| {
        let [a, b] = sizes.map(|size| 0.5 * size / distance);
        let part = |a: f64, b: f64| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
        2.0 / PI * (part(a, b) + part(b, a))
    };
    let expected =
        [("side", share([y, z], 35.0 - 0.5 * x)), ("top", share([x, y], 20.0 - 0.5 * z))];
    for estimator in [Request::Backward, Request::Mix] {
        let estimator = Some(estimator);
        let settings = Settings { paths: Some(200_000), estimator, ..Settings::default() };
        let measures = traced::measures(&traced::load(&text, &settings));
        for (sensor, share) in expected {
            let flux = &measures.values[&format!("{sensor}.flux")];
            let (expected, error) = (BOX_LUMINANCE * PI * share, flux.std_error);
            assert!(error < 0.01 * expected, "{sensor}: {flux}");
            // Between the angles of the file, chords lie below the law by up to 0.1 % each in C and γ.
            let is_close = (flux.value - expected).abs() < 4.0 * error + 3e-3 * expected;
            assert!(is_close, "{estimator:?} {sensor}: {flux}, expected {expected}");
        }
    }
}

#[test]
fn openings_to_all_sides_give_the_same_light_by_samples_and_by_radiance() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lamp.ies");
    let text = format!(
        "[sources.lamp.luminaire]\nfile = {path:?}\n[sensors.cell]\n\
         plane = {{ rectangle = {{ width_mm = 50, height_mm = 30 }} }}\n\
         at = {{ position_mm = [30, 25, -20], axis = [-1, -0.7, 0.8] }}\n"
    );
    for sizes in OPEN_TO_ALL_SIDES {
        std::fs::write(&path, bright_box(sizes)).unwrap();
        let flux = |estimator: Request| {
            let estimator = Some(estimator);
            let settings = Settings { paths: Some(400_000), estimator, ..Settings::default() };
            traced::measures(&traced::load(&text, &settings)).values["cell.flux"].clone()
        };
        let forward = flux(Request::Forward);
        for other in [Request::Backward, Request::Mix].map(flux) {
            let error = forward.std_error.hypot(other.std_error);
            assert!(
                (forward.value - other.value).abs() < 4.0 * error,
                "{sizes}: {forward} {other}"
            );
            assert!(error < 0.02 * forward.value, "{sizes}: {forward} {other}");
        }
    }
}

#[test]
fn planes_about_c90_without_c0_give_the_same_light_by_samples_and_by_radiance() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lamp.ies");
    let head = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 4 1 2 0.004 0.004 0\n1 1 0\n0 40 80\n90 150 210 270\n";
    std::fs::write(&path, format!("{head}9 8 0\n9 2 0\n9 1 0\n9 5 0\n")).unwrap();
    let text = format!(
        "[sources.lamp.luminaire]\nfile = {path:?}\n[sensors.cell]\n\
         plane = {{ rectangle = {{ width_mm = 6, height_mm = 6 }} }}\n\
         at = {{ position_mm = [6, 1, 10], axis = [0, 0, -1] }}\n"
    );
    let flux = |estimator: Request| {
        let settings =
            Settings { paths: Some(400_000), estimator: Some(estimator), ..Settings::default() };
        traced::measures(&traced::load(&text, &settings)).values["cell.flux"].clone()
    };
    let [forward, backward] = [Request::Forward, Request::Backward].map(flux);
    let error = forward.std_error.hypot(backward.std_error);
    assert!((forward.value - backward.value).abs() < 4.0 * error, "{forward} {backward}");
    assert!(error < 0.01 * forward.value, "{forward} {backward}");
}

#[test]
fn its_flux_is_that_of_the_file_or_the_given_one() {
    let file = lumiduct_files::luminaire::read(UPWARD.as_ref()).unwrap().luminaire;
    let flux = |keys: &str| {
        let source =
            format!("[sources.lamp.luminaire]\nfile = {UPWARD:?}\nextent = \"point\"\n{keys}");
        far(&source, 2000).values["far.flux"].value
    };
    assert!((flux("") / file.intensities.flux() - 1.0).abs() < 1e-9);
    assert!((flux("flux_lm = 7") - 7.0).abs() < 1e-9);
    assert_eq!(flux("enabled = false"), 0.0);
}

#[test]
fn a_scene_is_another_one_with_another_file_and_remarks_are_warnings() {
    let folder = tempfile::tempdir().unwrap();
    let load = |ies: &str| -> Job {
        std::fs::write(folder.path().join("lamp.ies"), ies).unwrap();
        let scene =
            "lumiduct = 1\ntitle = \"Lamp\"\n[sources.lamp.luminaire]\nfile = \"lamp.ies\"\n";
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, scene).unwrap();
        input::load(&path, &Settings::default()).unwrap()
    };
    let spot = std::fs::read_to_string(SPOT).unwrap();
    let jobs = [&spot, &spot.replace("14 12", "15 12"), &spot].map(|text| load(text));
    assert_ne!(jobs[0].hash, jobs[1].hash);
    assert_eq!(jobs[0].hash, jobs[2].hash);
    let warnings = &jobs[0].warnings;
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert_eq!(warnings[0].kind, DiagnosticKind::Warning);
    assert!(warnings[0].message.contains("beyond them the light is taken as 0"));
}

#[test]
fn a_file_comes_back_from_source_and_goniometer_within_its_errors() {
    let file = lumiduct_files::luminaire::read(SPOT.as_ref()).unwrap().luminaire.intensities;
    let text = format!(
        "[sources.lamp.luminaire]\nfile = {SPOT:?}\nextent = \"point\"\n[sensors.far]\n\
         goniometer = {{ c_step_deg = 15, gamma_step_deg = 3.75 }}\n\
         luminaire = {{ c_step_deg = 30, gamma_step_deg = 15, photometry = \"relative\", lamps = 2 }}\n"
    );
    let settings = Settings {
        paths: Some(1_000_000),
        estimator: Some(Request::Forward),
        ..Settings::default()
    };
    let job = traced::load(&text, &settings);
    let measures = traced::measures(&job);
    let origin = LuminaireOrigin { title: "Spot", hash: "1", date: None, version: "0" };
    let measured = MeasuredLuminaire::new(&job.exports.luminaires[0], &measures, &origin).unwrap();
    let table = &measured.luminaire.intensities;
    assert!((table.flux() / measures.values["far.flux"].value - 1.0).abs() < 1e-9);
    let (mut sum, mut count) = (0.0, 0);
    for (plane, c) in table.planes_deg().iter().enumerate() {
        for (angle, gamma) in table.angles_deg().iter().enumerate() {
            let (found, expected) = (table.plane(plane)[angle], file.at(*c, *gamma));
            let error = measured.std_errors[[plane, angle]];
            // The file ends at 75 deg without light, and beyond there is none.
            if *gamma > 75.0 {
                assert_eq!((found, expected), (0.0, 0.0), "C {c}, gamma {gamma}");
                continue;
            }
            let z = (found - expected) / error;
            assert!(z.abs() < 4.5, "C {c}, gamma {gamma}: {found} {expected} {error}");
            (sum, count) = (sum + z * z, count + 1);
        }
    }
    // Cells are taken as independent, but directions of a bare point fill them so evenly that sums over cells are known better.
    assert!(sum < 1.5 * f64::from(count), "{sum} of {count}");
    // With relative photometry of two lamps, and with seven digits, it is read again.
    let folder = tempfile::tempdir().unwrap();
    for format in [LuminaireFormat::Ies, LuminaireFormat::Ldt] {
        let written = measured.file(format);
        let path = folder.path().join(&written.name);
        std::fs::write(&path, &written.bytes).unwrap();
        let again = lumiduct_files::luminaire::read(&path).unwrap();
        assert!((again.luminaire.intensities.flux() / table.flux() - 1.0).abs() < 1e-6);
        assert_eq!(again.luminaire.text("LUMINAIRE"), Some("Spot"));
        let LampFlux::Relative { count, flux_lm } = again.luminaire.lamps else {
            panic!("absolute")
        };
        assert_eq!(count, 2);
        assert!((flux_lm / measures.source_flux - 1.0).abs() < 1e-6, "{flux_lm}");
    }
}

#[test]
fn files_of_a_cut_off_do_not_overshoot_and_say_where_they_cannot_follow() {
    // 1000 cd within 60 deg of the axis.
    let flux = 1000.0 * PI;
    let text = format!(
        "[sources.lamp.point]\nflux_lm = {flux}\nemission = {{ cone_half_angle_deg = 60 }}\n[sensors.far]\n\
         goniometer = {{ c_step_deg = 360, gamma_step_deg = 2.5 }}\nluminaire = {{}}\n"
    );
    let settings =
        Settings { paths: Some(400_000), estimator: Some(Request::Forward), ..Settings::default() };
    let job = traced::load(&text, &settings);
    let measures = traced::measures(&job);
    let origin = LuminaireOrigin { title: "Cone", hash: "1", date: None, version: "0" };
    let found = MeasuredLuminaire::new(&job.exports.luminaires[0], &measures, &origin).unwrap();
    let table = &found.luminaire.intensities;
    for (gamma, value) in table.angles_deg().iter().zip(table.plane(0)) {
        let expected = match gamma {
            gamma if *gamma <= 55.0 => 970.0..1030.0,
            gamma if *gamma >= 65.0 => 0.0..1.0,
            _ => 0.0..1030.0,
        };
        assert!(expected.contains(value), "{value} cd at {gamma} deg");
    }
    assert!((table.flux() / flux - 1.0).abs() < 1e-6);
    let remarks = found.remarks.join("; ");
    assert!(
        remarks.contains("the light changes within the steps of the table (5 deg): at 58.75 deg"),
        "{remarks}"
    );
}

/// Illuminance times distance squared, cd, at an angle to the axis of a Lambertian disk with this luminance, cd/mm², on a
/// sphere about its middle; sizes in mm.
fn disk_on_sphere(luminance: f64, disk: f64, sphere: f64, gamma: f64) -> f64 {
    let steps = 400;
    let place = DVec3::new(gamma.sin(), 0.0, gamma.cos());
    let part = |n: u32| (f64::from(n) + 0.5) / f64::from(steps);
    let parts = (0..steps * steps).map(|n| {
        let (radius, around) = (disk * part(n / steps).sqrt(), TAU * part(n % steps));
        let to = sphere * place - radius * DVec3::new(around.cos(), around.sin(), 0.0);
        to.z.max(0.0) * to.dot(place) / to.length_squared().powi(2)
    });
    let area = PI * disk * disk / f64::from(steps * steps);
    luminance * area * sphere * sphere * parts.sum::<f64>()
}

#[test]
fn files_of_a_sphere_have_illuminance_times_distance_squared() {
    let (disk, sphere, flux) = (100.0, 250.0, 1000.0);
    let text = format!(
        "[sources.lamp.disk]\nradius_mm = {disk}\nflux_lm = {flux}\n[sensors.near]\n\
         goniometer = {{ c_step_deg = 360, gamma_step_deg = 2.5, radius_mm = {sphere} }}\nluminaire = {{}}\n"
    );
    let estimator = Some(Request::Forward);
    let job =
        traced::load(&text, &Settings { paths: Some(1_000_000), estimator, ..Settings::default() });
    let measures = traced::measures(&job);
    let origin = LuminaireOrigin { title: "Disk", hash: "1", date: None, version: "0" };
    let measured = MeasuredLuminaire::new(&job.exports.luminaires[0], &measures, &origin).unwrap();
    assert_eq!(measured.distance_mm, Some(sphere));
    let table = &measured.luminaire.intensities;
    assert!((table.flux() / flux - 1.0).abs() < 1e-6, "{}", table.flux());
    let luminance = flux / (PI * PI * disk * disk);
    let far = flux / PI;
    for (place, gamma) in table.angles_deg().iter().enumerate().filter(|(_, gamma)| **gamma < 80.0)
    {
        let expected = disk_on_sphere(luminance, disk, sphere, gamma.to_radians());
        let (found, error) = (table.plane(0)[place], measured.std_errors[[0, place]]);
        assert!(
            (found - expected).abs() < 4.5 * error + 3e-3 * far,
            "{gamma}: {found} {expected} {error}"
        );
    }
    // What is expected on the axis is that of the far field over 1 + (r/d)².
    let axis = disk_on_sphere(luminance, disk, sphere, 0.0) / (far / 1.16);
    assert!((axis - 1.0).abs() < 1e-4, "{axis}");
}
