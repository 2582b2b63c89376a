//! Patterns on faces: holes with and without a wall, and dots, agree forward and backward.

use crate::trial::all_agree;

/// A mirror tube with holes in its side; a cell before them, and one at the exit.
fn perforated(layout: &str, more: &str) -> String {
    format!(
        r#"
[finishes.mirror]
specular = {{ reflectance = 0.9 }}
[sheets.tube.tube]
profile = {{ circle = {{ radius_mm = 5 }} }}
path = [{{ straight_mm = 15 }}]
finish = "mirror"
[patterns.holes]
on = "tube.wall"
{layout}
{more}
[sources.lamp.disk]
radius_mm = 4
flux_lm = 10
at = {{ position_mm = [0.5, 0, 0.1] }}
[sensors]
exit = {{ plane = {{}}, on = "tube.exit", counts = "incident" }}
beside = {{ plane = {{ rectangle = {{ width_mm = 8, height_mm = 8 }}, cells = [1, 2] }}, at = {{ position_mm = [9, 0, 7], axis = [-1, 0, 0] }} }}
"#
    )
}

#[test]
fn holes_with_and_without_a_wall() {
    let row = r#"element = { circle = { diameter_mm = 3 } }
layout = { row = { positions_mm = [3, 7, 11.5], around_deg = 10 } }
finish = "open""#;
    all_agree("holes", &perforated(row, ""));
    all_agree("holes through a wall", &perforated(row, "wall_mm = 1.2"));
    all_agree("holes through a thick wall", &perforated(row, "wall_mm = 3"));
}

#[test]
fn slots_with_scatter() {
    let slots = r#"element = { rectangle = { width_mm = 2, length_mm = 1 } }
layout = { staggered = { across_pitch_mm = 3.14159265358979, pitch_mm = 1.5 } }
finish = { lambertian = { reflectance = 0.3, transmittance = 0.5 } }"#;
    all_agree("white slots", &perforated(slots, ""));
}

#[test]
fn dots_on_a_plate() {
    all_agree(
        "dots on a plate",
        r#"
[media.glass]
index = 1.49
absorption_per_mm = 0.01
[solids.plate.box]
size_mm = [10, 3, 16]
medium = "glass"
[patterns.dots]
on = "plate.wall_minus_y"
finish = { lambertian = { reflectance = 0.9 } }
element = { circle = { diameter_mm = [[0, 0.5], [16, 1.2]] } }
layout = { hexagonal = { pitch_mm = 1.3 } }
[sources.lamp.rectangle]
width_mm = 8
height_mm = 2
flux_lm = 10
at = { face = "plate.entry", gap_mm = 0.2 }
[sensors]
top = { plane = { cells = [1, 2] }, on = "plate.wall_plus_y", counts = "leaving" }
above = { plane = { rectangle = { width_mm = 6, height_mm = 6 } }, at = { position_mm = [0, 9, 8], axis = [0, -1, 0] }, aim = ["plate.wall_plus_y"] }
"#,
    );
}
