//! What sensors count of light that comes from, passes by, or is absorbed at special places.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

use lumiduct::input::{self, Settings};
use lumiduct::measure::{self, Measures};
use lumiduct::transport::Run;

fn measures(text: &str) -> Measures {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("scene.toml");
    std::fs::write(&path, format!("lumiduct = 1\ntitle = \"Sensors\"\n{text}")).unwrap();
    let job = match input::load(&path, &Settings { paths: Some(20_000), ..Settings::default() }) {
        Ok(job) => job,
        Err(error) => panic!("{error}"),
    };
    let mut run = Run::new(&job.scene, &job.run);
    while !run.is_complete() {
        run.next_wave();
    }
    measure::measure(&job.scene, &run.findings())
}

fn value(measures: &Measures, name: &str) -> f64 {
    measures.values[name].value
}

const TUBE: &str = r#"
[finishes.mirror]
specular = { reflectance = 0.9 }
[sheets.tube.tube]
profile = { circle = { radius_mm = 5 } }
path = [{ straight_mm = 20 }]
finish = "mirror"
"#;

#[test]
fn light_of_a_source_in_the_plane_of_a_port_enters_by_it() {
    let found = measures(&format!(
        r#"{TUBE}
        [sources.sky.disk]
        radius_mm = 5
        at = {{ face = "tube.entry" }}
        flux_lm = 2
        [sensors.entry]
        on = "tube.entry"
        counts = "incident"
        plane = {{}}
        [sensors.exit]
        on = "tube.exit"
        counts = "incident"
        plane = {{}}
        entering = "tube.entry""#
    ));
    assert!((value(&found, "entry.flux") - 2.0).abs() < 1e-9, "{}", found.values["entry.flux"]);
    assert!((value(&found, "exit.entering_flux") - 2.0).abs() < 1e-9);
    let transmission = value(&found, "exit.transmission");
    assert!((transmission - value(&found, "exit.efficiency")).abs() < 1e-12, "{transmission}");
}

#[test]
fn an_aimed_goniometer_sees_the_light_of_its_face_and_tells_the_rest() {
    let found = measures(concat!(
        include_str!("rod.toml"),
        r#"
        [sensors]
        exit = { plane = {}, on = "rod.exit", counts = "leaving" }
        all = { goniometer = { c_step_deg = 90, gamma_step_deg = 10 } }
        far = { goniometer = { c_step_deg = 90, gamma_step_deg = 10 }, aim = ["rod.exit"] }
        near = { goniometer = { c_step_deg = 90, gamma_step_deg = 10, radius_mm = 500 }, aim = ["rod.exit"] }
        "#
    ));
    let (all, exit) = (value(&found, "all.flux"), value(&found, "exit.flux"));
    assert!(exit < 0.95 * all, "{exit} of {all}: some light goes elsewhere");
    for sensor in ["far", "near"] {
        let flux = value(&found, &format!("{sensor}.flux"));
        let outside = value(&found, &format!("{sensor}.flux_outside_aim"));
        assert!((flux - exit).abs() < 1e-8, "{sensor}: {flux}, not {exit}");
        assert!((flux + outside - all).abs() < 1e-8, "{sensor}: {outside} outside");
    }
}

#[test]
fn a_sphere_in_a_medium_that_absorbs_gets_what_comes_so_far() {
    let found = measures(
        r#"
        surroundings = "fog"
        [media.fog]
        index = 1
        absorption_per_mm = 0.01
        [sources.lamp.point]
        flux_lm = 1
        emission = "isotropic"
        [sensors.sphere]
        goniometer = { c_step_deg = 360, gamma_step_deg = 90, radius_mm = 100 }
        "#,
    );
    // Beer-Lambert over 100 mm at 0.01/mm.
    assert!((value(&found, "sphere.flux") - (-1.0f64).exp()).abs() < 1e-9);
}
