//! First passages: photons and gather paths count a path once, on ports and on faces, whichever way
//! it returns.

use crate::trial::{Way, agree, measures};

/// A mirror duct that returns its light through its own entry and exit, with an exit sensor.
fn open_bend(reflectance: f64, passage: &str) -> String {
    format!(
        r#"
[finishes.mirror]
specular = {{ reflectance = {reflectance} }}
[sheets.duct.tube]
profile = {{ rectangle = {{ width_mm = 10, height_mm = 10 }} }}
path = [{{ bend_deg = 270, radius_mm = 10 }}]
finish = "mirror"
[sources.led.face]
of = "duct.entry"
side = "back"
flux_lm = 1
[sensors.exit]
plane = {{}}
on = "duct.exit"
counts = "leaving"
entering = "duct.entry"
passage = "{passage}"
"#
    )
}

/// A white box with a lamp under its lid; its walls and a plane within it count as the keys say.
fn white_box(keys: &str) -> String {
    format!(
        r#"
[finishes.white]
lambertian = {{ reflectance = 0.8 }}
[solids.room.box]
size_mm = [10, 10, 10]
medium = "air"
faces = {{ entry = "white", exit = "white", wall = "white" }}
[sources.lamp.disk]
radius_mm = 2
flux_lm = 1
at = {{ position_mm = [0, 0, 8], axis = [0, 0, -1] }}
[sensors]
floor = {{ plane = {{}}, on = "room.entry", {keys} }}
level = {{ plane = {{ disk = {{ radius_mm = 3 }} }}, at = {{ position_mm = [1, 0, 3] }}, side = "both", passage = "first" }}
"#
    )
}

#[test]
fn a_lossless_duct_that_leads_back_into_itself_gives_each_path_once() {
    for way in [Way::Forward, Way::Backward, Way::Mixed] {
        let first = measures(&open_bend(1.0, "first"), way);
        for name in ["exit.flux", "exit.efficiency", "exit.transmission"] {
            let found = &first.values[name];
            let off = (found.value - 1.0).abs();
            assert!(off < 1e-9 + 4.0 * found.std_error, "{}: {name} = {found}", way.name());
        }
    }
    let every = measures(&open_bend(1.0, "every"), Way::Forward);
    assert!(every.values["exit.flux"].value > 1.05, "{}", every.values["exit.flux"]);
}

#[test]
fn first_passages_are_the_same_to_photons_and_gather_paths() {
    let ways = [Way::Forward, Way::Backward, Way::Mixed];
    agree("port of an open bend", &open_bend(0.9, "first"), &ways);
    let leaving = r#"counts = "leaving", side = "back", passage = "first""#;
    agree("light that leaves a white face", &white_box(leaving), &ways);
    let incident = r#"counts = "incident", side = "back", passage = "first""#;
    agree("light that arrives at a white face", &white_box(incident), &ways);
    let first = measures(&white_box(incident), Way::Forward).values["floor.flux"].value;
    let every = incident.replace("first", "every");
    let every = measures(&white_box(&every), Way::Forward).values["floor.flux"].value;
    assert!(first < 1.0 && every > 1.3 * first, "{first} of {every}");
}
