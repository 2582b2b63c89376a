//! Guides of every kind: rods, bends, tapers, corners, meshes with interpolated normals, and solids that overlap.

use crate::trial::{Gathering, Way, agree};

/// All ways; windows fit guides of a millimetre or two.
fn all_agree(what: &str, text: &str) {
    let gather = [0, 2, 8].map(|depth| {
        Way::Gather(Gathering { radius_mm: 0.4, angle_deg: 5.0, ..Gathering::to_depth(depth) })
    });
    let [shallow, middle, deep] = gather;
    agree(what, text, &[Way::Forward, Way::Backward, Way::Mixed, shallow, middle, deep]);
}

fn guide(solid: &str) -> String {
    format!(
        r#"
[media.acrylic]
index = 1.49
absorption_per_mm = 0.002
{solid}
[sources.led.disk]
radius_mm = 1
flux_lm = 10
at = {{ face = "pipe.entry", gap_mm = 0.2 }}
[sensors]
exit = {{ plane = {{ cells = [2, 1] }}, on = "pipe.exit", counts = "leaving" }}
cell = {{ plane = {{ rectangle = {{ width_mm = 3, height_mm = 3 }} }}, at = {{ face = "pipe.exit", gap_mm = 4, offset_mm = [1, 0] }}, aim = ["pipe.exit"] }}
"#
    )
}

#[test]
fn rods() {
    all_agree(
        "rod",
        &guide("[solids.pipe.cylinder]\nradius_mm = 1.5\nlength_mm = 10\nmedium = \"acrylic\""),
    );
    all_agree(
        "square rod",
        &guide(
            "[solids.pipe.sweep]\nprofile = { rectangle = { width_mm = 3, height_mm = 2.5 } }\npath = [{ straight_mm = 10 }]\nmedium = \"acrylic\"",
        ),
    );
    all_agree(
        "taper",
        &guide(
            "[solids.pipe.cylinder]\nradius_mm = 1.5\nend_radius_mm = 2.2\nlength_mm = 10\nmedium = \"acrylic\"",
        ),
    );
}

#[test]
fn bends() {
    all_agree(
        "bend",
        &guide(
            "[solids.pipe.sweep]\nprofile = { circle = { radius_mm = 1.5 } }\npath = [{ straight_mm = 3 }, { bend_deg = 90, radius_mm = 6 }, { straight_mm = 3 }]\nmedium = \"acrylic\"",
        ),
    );
    all_agree(
        "mitred corner",
        &guide(
            "[solids.pipe.sweep]\nprofile = { rectangle = { width_mm = 3, height_mm = 3 } }\npath = [{ straight_mm = 3 }, { corner_deg = 60, fold_mirror = true }, { straight_mm = 3 }]\nmedium = \"acrylic\"",
        ),
    );
}

#[test]
fn overlapping_solids() {
    all_agree(
        "dome on a rod",
        &guide(
            r#"
[media.glue]
index = 1.41
[solids.pipe.cylinder]
radius_mm = 1.5
length_mm = 8
medium = "acrylic"
priority = 1
[solids.dome.sphere]
radius_mm = 1.5
medium = "glue"
at = { position_mm = [0, 0, 8] }
[solids.bubble.sphere]
radius_mm = 0.5
medium = "air"
priority = 2
at = { position_mm = [0.4, 0, 4] }
"#,
        )
        .replace("pipe.exit\", counts", "dome.surface\", counts")
        .replace("aim = [\"pipe.exit\"]", "aim = [\"dome.surface\"]"),
    );
}

#[test]
fn meshes() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/meshes/lightguide.glb");
    all_agree(
        "mesh",
        &guide(&format!("[solids.pipe.mesh]\nfile = '{file}'\nunit = \"m\"\nmedium = \"acrylic\"")),
    );
}

/// Bubbles in a plate: copies of one mesh, with a sensor on all of them.
#[test]
fn copies_of_a_mesh() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/meshes/bubbles.glb");
    let plate = format!(
        r#"
[media.acrylic]
index = 1.49
absorption_per_mm = 0.002
[solids.plate.box]
size_mm = [40, 4, 60]
medium = "acrylic"
at = {{ position_mm = [0, 0, 2], axis = [1, 0, 0], x_axis = [0, 1, 0] }}
[solids.bubbles.mesh]
file = '{file}'
unit = "m"
medium = "air"
priority = 1
[sources.led.rectangle]
width_mm = 30
height_mm = 3
flux_lm = 10
at = {{ face = "plate.entry", gap_mm = 0.2 }}
[sensors]
front = {{ plane = {{ cells = [2, 1] }}, on = "plate.wall_plus_y", counts = "leaving" }}
met = {{ plane = {{}}, on = "bubbles.bubble", counts = "incident", side = "front" }}
"#
    );
    let few = Gathering { radius_mm: 0.1, angle_deg: 10.0, ..Gathering::to_depth(1) };
    agree("bubbles", &plate, &[Way::Forward, Way::Backward, Way::Mixed, Way::Gather(few)]);
}
