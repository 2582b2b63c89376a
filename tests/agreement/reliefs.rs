//! Reliefs on walls of solids agree forward and backward.

use crate::trial::all_agree;

/// A plate with a relief below, lit from one end; the wall with the relief is a sensor, and one before it is aimed at it.
fn plate(relief: &str) -> String {
    format!(
        r#"
[media.glass]
index = 1.49
absorption_per_mm = 0.01
[solids.plate.box]
size_mm = [10, 3, 16]
medium = "glass"
[reliefs.relief]
on = "plate.wall_minus_y"
{relief}
[sources.lamp.rectangle]
width_mm = 8
height_mm = 2
flux_lm = 10
at = {{ face = "plate.entry", gap_mm = 0.2 }}
[sensors]
top = {{ plane = {{ cells = [1, 2] }}, on = "plate.wall_plus_y", counts = "leaving" }}
bottom = {{ plane = {{ cells = [1, 2] }}, on = "plate.wall_minus_y", counts = "leaving" }}
below = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 6 }} }}, at = {{ position_mm = [0, -9, 8], axis = [0, 1, 0] }}, aim = ["plate.wall_minus_y", "plate.relief"] }}
"#
    )
}

#[test]
fn grooves_that_grow_along_a_plate() {
    all_agree(
        "grooves",
        &plate(
            r#"element = { groove = { depth_mm = { from_mm = 0.1, to_mm = 0.8 }, angle_deg = 80 } }
layout = { row = { pitch_mm = 2 } }"#,
        ),
    );
}

#[test]
fn dimples_with_paint_and_bumps_without() {
    all_agree(
        "painted dimples",
        &plate(
            r#"element = { dimple = { diameter_mm = 1.2, depth_mm = 0.4 } }
layout = { staggered = { across_pitch_mm = 2, pitch_mm = 2 } }
finish = { lambertian = { reflectance = 0.9 } }"#,
        ),
    );
    all_agree(
        "bumps",
        &plate(
            r#"element = { bump = { radius_mm = 0.7, height_mm = 0.6 } }
layout = { grid = { across_pitch_mm = 2.5, pitch_mm = 2.5 } }"#,
        ),
    );
}

#[test]
fn a_rod_with_dimples_and_rings() {
    all_agree(
        "rod",
        r#"
[media.glass]
index = 1.49
[solids.rod.cylinder]
radius_mm = 3
length_mm = 16
medium = "glass"
[reliefs.dimples]
on = "rod.wall"
element = { dimple = { radius_mm = 1, depth_mm = 0.7 } }
layout = { row = { positions_mm = [2, 5, 8], around_deg = -90 } }
[reliefs.rings]
on = "rod.wall"
element = { groove = { depth_mm = 0.6, angle_deg = 90, course = "ring" } }
layout = { row = { positions_mm = [11, 13] } }
[sources.lamp.disk]
radius_mm = 2
flux_lm = 10
at = { face = "rod.entry", gap_mm = 0.2 }
[sensors]
exit = { plane = { cells = [2, 1] }, on = "rod.exit", counts = "leaving" }
wall = { plane = { cells = [1, 2] }, on = "rod.wall", counts = "leaving" }
beside = { plane = { rectangle = { width_mm = 8, height_mm = 8 } }, at = { position_mm = [0, 9, 7], axis = [0, -1, 0] } }
"#,
    );
}
