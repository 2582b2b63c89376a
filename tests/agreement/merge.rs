//! Forward, backward and gather merged: the same values as each alone, in guides, with every finish that does not scatter,
//! every source and every sensor.

use crate::finishes::{tube, window};
use crate::sensors::scene;
use crate::sources::rod;
use crate::trial::{Gathering, Way, agree};

/// Forward, backward, and merged at depths 0, 2 and 8.
fn all_agree(what: &str, text: &str) {
    let [shallow, middle, deep] = [0, 2, 8]
        .map(|depth| Way::Merged(Gathering { radius_mm: 0.4, ..Gathering::to_depth(depth) }));
    agree(what, text, &[Way::Forward, Way::Backward, shallow, middle, deep]);
}

/// Forward, and merged at depths 0 and 2.
fn shallow_agree(what: &str, text: &str) {
    let [shallow, middle] = [0, 2].map(|depth| Way::Merged(Gathering::to_depth(depth)));
    agree(what, text, &[Way::Forward, shallow, middle]);
}

/// A guide with a lamp before its entry, a sensor on its exit and one behind.
fn guide(guide: &str, counts: &str) -> String {
    format!(
        r#"
[media.acrylic]
index = 1.49
absorption_per_mm = 0.002
[finishes.mirror]
specular = {{ reflectance = 0.9 }}
{guide}
[sources.led.disk]
radius_mm = 1
flux_lm = 10
at = {{ face = "pipe.entry", gap_mm = 0.2 }}
[sensors]
exit = {{ plane = {{ cells = [2, 1] }}, on = "pipe.exit", counts = "{counts}" }}
cell = {{ plane = {{ rectangle = {{ width_mm = 3, height_mm = 3 }} }}, at = {{ face = "pipe.exit", gap_mm = 4, offset_mm = [1, 0] }}, aim = ["pipe.exit"] }}
"#
    )
}

#[test]
fn guides() {
    let tube = "[sheets.pipe.tube]\nprofile = { circle = { radius_mm = 1.5 } }\npath = [{ straight_mm = 10 }]\nfinish = \"mirror\"";
    all_agree("mirror tube", &guide(tube, "incident"));
    let rod = "[solids.pipe.cylinder]\nradius_mm = 1.5\nlength_mm = 10\nmedium = \"acrylic\"";
    all_agree("rod", &guide(rod, "leaving"));
    let bend = "[solids.pipe.sweep]\nprofile = { circle = { radius_mm = 1.5 } }\npath = [{ straight_mm = 3 }, { bend_deg = 90, radius_mm = 6 }, { straight_mm = 3 }]\nmedium = \"acrylic\"";
    all_agree("bend", &guide(bend, "leaving"));
    let corner = "[solids.pipe.sweep]\nprofile = { rectangle = { width_mm = 3, height_mm = 3 } }\npath = [{ straight_mm = 3 }, { corner_deg = 90, mitred = true }, { straight_mm = 3 }]\nmedium = \"acrylic\"";
    all_agree("right angle", &guide(corner, "leaving"));
}

#[test]
fn meshes_with_interpolated_normals() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/meshes/lightguide.glb");
    let mesh = format!("[solids.pipe.mesh]\nfile = '{file}'\nunit = \"m\"\nmedium = \"acrylic\"");
    // Triangles are asked one by one how much of a window they hold: few records.
    let few = Gathering { radius_mm: 0.4, records: 200, photons: 4000, ..Gathering::to_depth(1) };
    agree("mesh", &guide(&mesh, "leaving"), &[Way::Forward, Way::Merged(few)]);
}

#[test]
fn finishes() {
    shallow_agree("bare metal", &tube("{ metal = { n = 0.79, k = 5.85 } }"));
    let mixed = "{ mixture = [{ weight = 2, finish = { specular = { reflectance = 0.9 } } }, { weight = 1, finish = { specular = { reflectance = 0.3 } } }, { weight = 1, finish = { absorber = {} } }] }";
    shallow_agree("mixture", &tube(mixed));
    let (clear, dim) = (
        "{ specular = { reflectance = 0.2, transmittance = 0.7 } }",
        "{ specular = { reflectance = 0.5, transmittance = 0.2 } }",
    );
    shallow_agree("splitter", &window(clear, clear));
    shallow_agree("two sides of a splitter", &window(clear, dim));
}

#[test]
fn sources() {
    for (what, source) in [
        ("optical contact", "lamp.disk]\nradius_mm = 2\nat = { face = \"rod.entry\" }"),
        ("air", "lamp.disk]\nradius_mm = 2\ncontact = \"air\"\nat = { face = \"rod.entry\" }"),
        ("shining out", "lamp.face]\nof = \"rod.exit\""),
        (
            "shining in with air",
            "lamp.face]\nof = \"rod.wall\"\nside = \"back\"\ncontact = \"air\"",
        ),
        ("glowing solid", "lamp.volume]\nof = \"rod\""),
        (
            "cylinder",
            "lamp.cylinder]\nradius_mm = 1\nlength_mm = 2\nat = { position_mm = [0.5, 0, -2.5] }",
        ),
        ("sphere in the rod", "lamp.sphere]\nradius_mm = 1\nat = { position_mm = [0.5, 0, 3] }"),
        (
            "cone",
            "lamp.disk]\nradius_mm = 2\nemission = { cone_half_angle_deg = 25 }\ntilt_deg = 15\nat = { position_mm = [0, 0, -1] }",
        ),
        (
            "two overlapping lamps",
            "lamp.disk]\nradius_mm = 2\nat = { position_mm = [0, 0, -1] }\n[sources.wide.disk]\nradius_mm = 4\nflux_lm = 20\nemission = { cosine_power = 6 }\nat = { position_mm = [0.5, 0, -1] }",
        ),
    ] {
        let source = source.replacen("]\n", "]\nflux_lm = 10\n", 1);
        shallow_agree(what, &rod(&format!("[sources.{source}")));
    }
}

/// The scene of sensors with a splitter instead of a diffuser.
fn specular_scene(sensors: &str) -> String {
    let white = "white = { lambertian = { reflectance = 0.4, transmittance = 0.4 } }";
    let text = scene(sensors);
    assert!(text.contains(white));
    text.replace(white, "white = { specular = { reflectance = 0.4, transmittance = 0.4 } }")
}

#[test]
fn sensors() {
    shallow_agree(
        "planes",
        &specular_scene(
            r#"
cells = { plane = { rectangle = { width_mm = 8, height_mm = 8 }, cells = [2, 2] }, at = { position_mm = [0, 0, 20], axis = [0, 0, -1] } }
both = { plane = { disk = { radius_mm = 4 } }, at = { position_mm = [0, 0, 3], axis = [0, 0, -1] }, side = "both" }
inside = { plane = { rectangle = { width_mm = 12, height_mm = 6 } }, at = { position_mm = [0, 0, 14], axis = [0.2, 0, -1] } }
splitter = { plane = { cells = [2, 1] }, on = "pane.surface", counts = "leaving", side = "both" }
side = { plane = { cells = [2, 1] }, on = "tube.wall", counts = "incident", side = "front" }
in = { plane = {}, on = "block.entry", counts = "leaving", side = "back" }
"#,
        ),
    );
    shallow_agree(
        "directions",
        &specular_scene(
            r#"
far = { goniometer = { c_step_deg = 180, gamma_step_deg = 30 } }
aimed = { goniometer = { c_step_deg = 180, gamma_step_deg = 30 }, aim = ["tube.exit"] }
near = { goniometer = { c_step_deg = 180, gamma_step_deg = 30, radius_mm = 40 } }
near_aimed = { goniometer = { c_step_deg = 180, gamma_step_deg = 30, radius_mm = 40 }, aim = ["block.exit"] }
view = { luminance = { rectangle = { width_mm = 4, height_mm = 4 }, cells = [2, 1], acceptance_half_angle_deg = 12, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 10, phi_deg = 180 }] }, at = { position_mm = [0, 0, 20], axis = [0, 0, -1] } }
face = { luminance = { cells = [1, 1], acceptance_half_angle_deg = 12, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 40, phi_deg = 90 }] }, on = "block.exit", counts = "leaving" }
image = { image = { disk = { radius_mm = 3 }, pixels = [4, 3], pixel_deg = 8 }, at = { position_mm = [0, 0, 22], axis = [0, 0, -1] } }
"#,
        ),
    );
}
