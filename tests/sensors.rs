//! Sensor counts of light that starts at, passes, or is absorbed at special places.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod traced;

use lumiduct_core::measure::{MapAxes, Measures};
use lumiduct_core::plan::Request;
use lumiduct_input::Settings;
use std::f64::consts::PI;
use std::path::Path;

fn measures(text: &str) -> Measures {
    measures_by(Request::Forward, 20_000, text)
}

fn measures_by(estimator: Request, paths: u64, text: &str) -> Measures {
    let settings =
        Settings { paths: Some(paths), estimator: Some(estimator), ..Settings::default() };
    traced::measures(&traced::load(text, &settings))
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

/// A glowing wall of radius 100 mm: 1000 lm over π² r² make L = 10132.1 cd/m².
const GLOWING_WALL: &str = r#"
[sources.wall.disk]
radius_mm = 100
flux_lm = 1000
emission = "lambertian"
"#;
const WALL_LUMINANCE: f64 = 1000.0 / (PI * PI * 0.01);

#[test]
fn an_image_of_a_glowing_wall_is_flat_and_has_its_luminance() {
    let text = format!(
        r#"{GLOWING_WALL}
        [sensors.camera]
        image = {{ disk = {{ radius_mm = 15 }}, pixels = [5, 4], pixel_deg = 10 }}
        at = {{ position_mm = [0, 0, 50], axis = [0.2, 0, -1] }}"#
    );
    for (estimator, paths) in [(Request::Forward, 3_000_000), (Request::Backward, 100_000)] {
        let found = measures_by(estimator, paths, &text);
        let average = &found.values["camera.luminance_avg"];
        assert!(average.std_error < 0.01 * WALL_LUMINANCE);
        assert!((average.value - WALL_LUMINANCE).abs() < 4.0 * average.std_error, "{average}");
        assert_eq!(average.unit, "cd/m²");
        for column in 0..5 {
            for row in 0..4 {
                let pixel = &found.values[&format!("camera.cell.{column}.{row}")];
                assert!(pixel.std_error < 0.06 * WALL_LUMINANCE, "{estimator:?}: {pixel}");
                let off = (pixel.value - WALL_LUMINANCE).abs();
                assert!(off < 4.0 * pixel.std_error, "{estimator:?} {column}.{row}: {pixel}");
            }
        }
        assert!(found.values["camera.cv"].value < 0.03, "{}", found.values["camera.cv"]);
        let MapAxes::Angular { u_deg, v_deg } = &found.maps[0].axes else { panic!("no image") };
        assert_eq!((u_deg.len(), v_deg.len()), (6, 5));
        // Two pixels of the tangent of 10 deg about the middle.
        assert!((v_deg[3] - (2.0 * 5f64.to_radians().tan()).atan().to_degrees()).abs() < 1e-12);
    }
}

#[test]
fn an_image_shows_the_rim_of_a_wall_where_the_eye_sees_it() {
    // The wall ends at x = 100 mm. Looking along -z with +y up, +x is on the right.
    let text = format!(
        r#"{GLOWING_WALL}
        [sensors.camera]
        image = {{ disk = {{ radius_mm = 10 }}, pixels = [2, 1], pixel_deg = 20 }}
        at = {{ position_mm = [100, 0, 150], axis = [0, 0, -1], x_axis = [-1, 0, 0] }}
        aim = ["window.surface"]
        [finishes.clear]
        open = {{}}
        [sheets.window.disk]
        radius_mm = 150
        finish = "clear"
        at = {{ position_mm = [0, 0, 10] }}"#
    );
    for (estimator, paths) in [(Request::Forward, 2_000_000), (Request::Backward, 100_000)] {
        let found = measures_by(estimator, paths, &text);
        let (left, right) = (&found.values["camera.cell.0.0"], &found.values["camera.cell.1.0"]);
        // The rim deviates from the line between the pixels, by 3.6 of 53 mm at the edge of the
        // field, and points of the aperture see it shifted by up to 10 mm.
        assert!(left.value > 0.85 * WALL_LUMINANCE, "{estimator:?}: {left}");
        assert!(right.value < 0.15 * WALL_LUMINANCE, "{estimator:?}: {right}");
    }
}

/// A mirror that every gather path of the cell meets, where a bounce limit of one interface ends
/// it.
#[test]
fn what_the_bounce_limit_cuts_of_gather_paths_is_told() {
    let text = r#"
        [finishes.mirror]
        specular = { reflectance = 0.7 }
        [sheets.mirror.disk]
        radius_mm = 5
        finish = "mirror"
        [sources.lamp.disk]
        radius_mm = 1
        flux_lm = 2
        at = { position_mm = [0, 8, 9], axis = [0, 0, -1] }
        [sensors.cell]
        plane = { rectangle = { width_mm = 1, height_mm = 1 } }
        at = { position_mm = [0, 0, 10], axis = [0, 0, -1] }
        aim = ["mirror.surface"]
        [run]
        bounce_limit = LIMIT"#;
    for estimator in [Request::Backward, Request::Mix] {
        let cut = measures_by(estimator, 20_000, &text.replace("LIMIT", "1"));
        let lost = cut.sensor_paths[0].lost.unwrap();
        assert!((lost.cut - 0.7).abs() < 1e-12 && lost.leaked == 0.0, "{lost:?}");
        let whole = measures_by(estimator, 20_000, &text.replace("LIMIT", "2"));
        assert!(whole.sensor_paths[0].lost.is_none(), "{:?}", whole.sensor_paths[0].lost);
        assert!(value(&whole, "cell.flux") > 0.0);
    }
}

/// Light that a photon carries across one interface, the sensor's own, is within a limit of one.
#[test]
fn gather_paths_of_leaving_light_reach_as_far_as_photons() {
    let text = r#"
        [finishes.paper]
        lambertian = { reflectance = 0.8 }
        [sheets.screen.disk]
        radius_mm = 5
        finish = "paper"
        [sources.lamp.disk]
        radius_mm = 1
        flux_lm = 2
        at = { position_mm = [0, 0, 3], axis = [0, 0, -1] }
        [sensors.paper_seen]
        on = "screen.surface"
        counts = "leaving"
        plane = {}
        [run]
        bounce_limit = 1"#;
    let [forward, backward, mix] = [Request::Forward, Request::Backward, Request::Mix]
        .map(|estimator| measures_by(estimator, 50_000, text).values["paper_seen.flux"].clone());
    assert!(forward.value > 1.0, "{forward}");
    for other in [backward, mix] {
        let error = other.std_error.hypot(forward.std_error);
        assert!((other.value - forward.value).abs() < 4.0 * error, "{other}, not {forward}");
    }
}

/// A block of glass whose sides are one face of its mesh.
const BLOCK: &str = "\
v 0 0 0\nv 4 0 0\nv 0 3 0\nv 4 3 0\nv 0 0 5\nv 4 0 5\nv 0 3 5\nv 4 3 5
f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

#[test]
fn a_sensor_of_one_cell_stands_on_any_face_of_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let block = folder.path().join("block.obj");
    std::fs::write(&block, BLOCK).unwrap();
    let rod = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/meshes/bent_rod.glb");
    let scene = format!(
        r#"
[media.glass]
index = 1.49
absorption_per_mm = 0.02
[solids.rod.mesh]
file = {rod:?}
unit = "m"
medium = "glass"
[solids.block.mesh]
file = {block:?}
unit = "mm"
medium = "glass"
at = {{ position_mm = [-2, -1.5, -9] }}
[sources.led.disk]
radius_mm = 3
at = {{ position_mm = [0, 5, 5], axis = [0, -1, 0] }}
flux_lm = 10
[sources.lamp.disk]
radius_mm = 1
at = {{ position_mm = [0, 0, -3.9], axis = [0, 0, -1] }}
flux_lm = 5
[sensors]
wall = {{ plane = {{}}, on = "rod.wall", counts = "leaving" }}
all = {{ plane = {{ cells = [1, 1] }}, on = "block.surface", counts = "leaving" }}
far = {{ goniometer = {{ c_step_deg = 360, gamma_step_deg = 180 }}, aim = ["block.surface"] }}
"#
    );
    let by = |estimator| measures_by(estimator, 20_000, &scene);
    let (forward, backward) = (by(Request::Forward), by(Request::Backward));
    for name in ["wall.flux", "all.flux", "far.flux"] {
        let [one, other] = [&forward, &backward].map(|found| &found.values[name]);
        let error = one.std_error.hypot(other.std_error);
        assert!(one.value > 0.3 && error < 0.1 * one.value, "{name}: {one} and {other}");
        assert!((one.value - other.value).abs() < 4.0 * error, "{name}: {one} and {other}");
    }
    // The mean over a curved face is taken over its area.
    let mean = value(&forward, "wall.illuminance_avg") / value(&forward, "wall.flux");
    assert!((mean * 306.8e-6 - 1.0).abs() < 1e-3, "{mean}");
}

#[test]
fn rings_see_a_hot_spot_as_bright_as_squares_do() {
    // 1 lm on 3.14 mm² in the middle, and 10 lm on all of the disk.
    let found = measures_by(
        Request::Forward,
        300_000,
        r#"
        [sources.spot.disk]
        radius_mm = 1
        emission = "collimated"
        flux_lm = 1
        [sources.back.disk]
        radius_mm = 10
        emission = "collimated"
        flux_lm = 10
        [sensors.polar]
        plane = { disk = { radius_mm = 10 }, rings = 20 }
        at = { position_mm = [0, 0, 5], axis = [0, 0, -1] }
        [sensors.grid]
        plane = { disk = { radius_mm = 10 }, cells = [40, 40] }
        at = { position_mm = [0, 0, 6], axis = [0, 0, -1] }
        "#,
    );
    let spot = 1e6 / PI + 1e7 / (PI * 100.0);
    for sensor in ["polar", "grid"] {
        let found = &found.values[&format!("{sensor}.illuminance_max")];
        assert!((found.value / spot - 1.0).abs() < 0.15, "{sensor}: {found}, not {spot}");
    }
}

#[test]
fn a_lamp_at_40_degrees_is_the_brightest_in_an_image() {
    let found = measures_by(
        Request::Backward,
        40_000,
        r#"
        [sources.bright.disk]
        radius_mm = 20
        luminance_cd_m2 = 100000
        at = { position_mm = [83.9, 0, 100], axis = [-0.643, 0, -0.766] }
        [sources.dim.disk]
        radius_mm = 20
        luminance_cd_m2 = 1000
        at = { position_mm = [0, 0, 100], axis = [0, 0, -1] }
        [sensors.cam]
        image = { disk = { radius_mm = 1 }, pixels = [40, 40], pixel_deg = 3 }
        "#,
    );
    let found = &found.values["cam.luminance_max"];
    // 25 paths per pixel: the error of the largest of some 28 bright pixels is below a fifth.
    assert!(found.total_error() < 2e4, "{found}");
    assert!((found.value - 1e5).abs() < 3.0 * found.total_error(), "{found}");
}

#[test]
fn a_lone_point_is_seen_in_full_by_forward_and_mix() {
    let point = "[sources.lamp.point]\nflux_lm = 3\n[sensors.far]\ngoniometer = {}";
    for estimator in [Request::Forward, Request::Mix] {
        let found = measures_by(estimator, 20_000, point);
        assert!((value(&found, "far.flux") - 3.0).abs() < 1e-9, "{}", found.values["far.flux"]);
    }
}
