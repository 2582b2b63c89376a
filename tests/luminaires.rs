//! Luminaires from files as sources, and as files of goniometers.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod traced;

use glam::DVec3;
use lumiduct_base::error::DiagnosticKind;
use lumiduct_core::measure::Measures;
use lumiduct_core::plan::Request;
use lumiduct_files::luminaire::{LampFlux, LuminaireFormat};
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
            // The mean of the intensities over the solid angle of the cell.
            let steps = 40;
            let part = |n: usize, of: f64| (n as f64 + 0.5) * of / steps as f64;
            let (mut sum, mut weight) = (0.0, 0.0);
            for (c, g) in (0..steps * steps).map(|n| (part(n / steps, 30.0), part(n % steps, 15.0)))
            {
                let (c, g) = (30.0 * sector as f64 + c, 15.0 * ring as f64 + g);
                let solid = g.to_radians().sin();
                (sum, weight) = (sum + solid * file.intensities.at(c, g), weight + solid);
            }
            let (expected, error) = (sum / weight, table.std_errors[(ring, sector)]);
            assert!(
                (found - expected).abs() <= 4.5 * error + 2e-4 * expected,
                "{extent} {ring} {sector}: {found} {expected} {error}"
            );
            checked += usize::from(expected > 0.0);
        }
        assert_eq!(checked, 60, "{extent}: cells with light");
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
    // On the axis it is that of the far field, over 1 + (r/d)².
    let axis = table.plane(0)[0] / (far / 1.16);
    assert!((axis - 1.0).abs() < 0.03, "{axis}");
}
