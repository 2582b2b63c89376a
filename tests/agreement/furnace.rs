//! Fields that are known exactly: inside a furnace luminance is the same everywhere, whatever is in
//! it, and a glass plate before a wide lamp has closed forms.

use crate::trial::{Comparison, Gathering, Way, measures};
use std::f64::consts::PI;

/// Luminance of the walls, cd/m².
const WALLS: f64 = 1000.0;
/// Edge of the furnace, mm.
const EDGE_MM: f64 = 20.0;
const INDEX: f64 = 1.49;

/// A cube of glowing walls around things that absorb no light: L is that of the walls everywhere,
/// and n² times as much in glass, where light from outside reaches.
const FURNACE: &str = r#"
[media.glass]
index = 1.49
[finishes]
white = { lambertian = { reflectance = 0.7, transmittance = 0.3 } }
mirror = { specular = { reflectance = 1 } }
half = { specular = { reflectance = 0.5, transmittance = 0.5 } }
[solids]
room = { box = { size_mm = [20, 20, 20], medium = "air", at = { position_mm = [0, 0, -10] } } }
slab = { box = { size_mm = [3, 3, 1], medium = "glass", priority = 1, at = { position_mm = [-2, -2, -4] } } }
ball = { sphere = { radius_mm = 1.5, medium = "glass", priority = 1, at = { position_mm = [3, 3, 2] } } }
[sheets]
white = { disk = { radius_mm = 2, finish = "white", at = { position_mm = [3, -3, 0], axis = [1, 1, 1] } } }
mirror = { disk = { radius_mm = 2, finish = "mirror", at = { position_mm = [-3, 3, 0], axis = [1, -1, 0.5] } } }
half = { disk = { radius_mm = 2, finish = "half", at = { position_mm = [0, 0, 4], axis = [0.2, 0, 1] } } }
[sources]
below = { face = { of = "room.entry", side = "back", luminance_cd_m2 = 1000 } }
above = { face = { of = "room.exit", side = "back", luminance_cd_m2 = 1000 } }
walls = { face = { of = "room.wall", side = "back", luminance_cd_m2 = 1000 } }
[sensors]
up = { plane = { rectangle = { width_mm = 6, height_mm = 6 } }, at = { position_mm = [0, 0, -2] } }
down = { plane = { rectangle = { width_mm = 6, height_mm = 6 } }, at = { position_mm = [0, 0, 0.3], axis = [0, 0, -1] } }
eye = { luminance = { rectangle = { width_mm = 2, height_mm = 2 }, cells = [1, 1], acceptance_half_angle_deg = 2.5, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 60, phi_deg = 45 }, { theta_deg = 85, phi_deg = 200 }] }, at = { position_mm = [-2, -2, 0], axis = [0, 0, -1] } }
inside = { luminance = { rectangle = { width_mm = 2, height_mm = 2 }, cells = [1, 1], acceptance_half_angle_deg = 3, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 30, phi_deg = 90 }] }, at = { position_mm = [-2, -2, -3.5], axis = [0, 0, 1] } }
near = { goniometer = { c_step_deg = 120, gamma_step_deg = 60, radius_mm = 7 } }
far = { goniometer = { c_step_deg = 360, gamma_step_deg = 180 } }
"#;

#[test]
fn luminance_in_a_furnace_is_that_of_its_walls() {
    assert_even("furnace", FURNACE);
}

#[test]
fn luminance_in_a_furnace_is_the_same_where_glass_scatters() {
    let clear = "index = 1.49\n";
    let turbid = "index = 1.49\nscattering = { per_mm = 0.8, anisotropy = 0.6 }\n";
    assert_even("turbid furnace", &FURNACE.replace(clear, turbid));
}

fn assert_even(what: &str, furnace: &str) {
    let mm2 = 1e-6;
    let lit = PI * WALLS;
    let mut expected = vec![
        ("up.illuminance_avg".to_owned(), lit),
        ("down.illuminance_avg".to_owned(), lit),
        ("near.flux".to_owned(), lit * 4.0 * PI * 49.0 * mm2),
        // Mean projected area of a convex body: a quarter of its surface (Cauchy).
        ("far.ring.0".to_owned(), WALLS * 1.5 * EDGE_MM * EDGE_MM * mm2),
    ];
    expected.extend((0..3).map(|view| (format!("eye.luminance_avg.{view}"), WALLS)));
    expected
        .extend((0..2).map(|view| (format!("inside.luminance_avg.{view}"), INDEX * INDEX * WALLS)));
    expected.extend((0..3).map(|ring| (format!("near.ring.{ring}"), lit * 49.0 * mm2)));
    // A uniform field has no bias in any window.
    let gather = |depth| {
        Way::Gather(Gathering { radius_mm: 0.9, angle_deg: 25.0, ..Gathering::to_depth(depth) })
    };
    let mut comparison = Comparison::default();
    for way in [Way::Forward, Way::Backward, gather(0), gather(2), gather(8)] {
        let found = measures(furnace, way);
        for (name, expected) in &expected {
            // Hardly any photon hits the narrow cones.
            if matches!(way, Way::Forward) && name.contains("luminance") {
                continue;
            }
            let what = format!("{what}, {}, {name}", way.name());
            comparison.add(&what, &found.values[name.as_str()], *expected, 1e-9 * expected);
        }
    }
    comparison.assert(what, 50);
}

/// A lamp wide enough to fill the view along the axis through a plate.
const PLATE: &str = r#"
[media.glass]
index = 1.49
[solids.plate.cylinder]
radius_mm = 30
length_mm = 2
medium = "glass"
at = { position_mm = [0, 0, 3] }
[sources.lamp.disk]
radius_mm = 20
luminance_cd_m2 = 1000
[sensors]
eye = { luminance = { disk = { radius_mm = 2 }, cells = [1, 1], acceptance_half_angle_deg = 3, directions = [{ theta_deg = 0, phi_deg = 0 }] }, at = { position_mm = [0, 0, 8], axis = [0, 0, -1] } }
inside = { luminance = { disk = { radius_mm = 2 }, cells = [1, 1], acceptance_half_angle_deg = 3, directions = [{ theta_deg = 0, phi_deg = 0 }] }, at = { position_mm = [0, 0, 4], axis = [0, 0, -1] } }
"#;

#[test]
fn luminance_behind_and_inside_a_plate_is_what_fresnel_says() {
    // Reflected at one face, at normal incidence; within 3 deg it is the same to 1e-6.
    let once = ((INDEX - 1.0) / (INDEX + 1.0)).powi(2);
    let behind = WALLS * (1.0 - once) / (1.0 + once);
    // Upward light: transmitted by the lower face, and reflected back from both faces.
    let inside = WALLS * INDEX * INDEX / (1.0 + once);
    let gather = |depth| {
        Way::Gather(Gathering { radius_mm: 1.0, angle_deg: 6.0, ..Gathering::to_depth(depth) })
    };
    let mut comparison = Comparison::default();
    for way in [Way::Forward, Way::Backward, gather(0), gather(2), gather(8)] {
        let found = measures(PLATE, way);
        for (name, expected) in
            [("eye.luminance_avg.0", behind), ("inside.luminance_avg.0", inside)]
        {
            let what = format!("plate, {}, {name}", way.name());
            comparison.add(&what, &found.values[name], expected, 1e-5 * expected);
        }
    }
    comparison.assert("plate", 10);
}
