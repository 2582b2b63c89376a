//! Windows at rims, in corners and at grazing incidence.

use crate::trial::{Gathering, Way, agree};

/// All ways, with windows as wide as the faces they lie on.
fn all_agree(what: &str, text: &str) {
    let gather = [0, 2].map(|depth| {
        Way::Gather(Gathering { radius_mm: 1.0, angle_deg: 6.0, ..Gathering::to_depth(depth) })
    });
    let [shallow, deep] = gather;
    agree(what, text, &[Way::Forward, Way::Backward, Way::Mixed, shallow, deep]);
}

#[test]
fn rims_of_mirrors_and_diffusers() {
    for (what, finish) in [
        ("rim of a mirror", "{ specular = { reflectance = 0.9 } }"),
        ("rim of a diffuser", "{ lambertian = { reflectance = 0.8 } }"),
    ] {
        let text = format!(
            r#"
[sheets]
plate = {{ disk = {{ radius_mm = 2, finish = {finish} }} }}
[sources.lamp.rectangle]
width_mm = 12
height_mm = 12
flux_lm = 10
at = {{ position_mm = [-6, 0, 6], axis = [1, 0, -1] }}
[sensors]
cell = {{ plane = {{ rectangle = {{ width_mm = 3, height_mm = 3 }} }}, at = {{ position_mm = [6, 0, 6], axis = [-1, 0, -1] }}, aim = ["plate.surface"] }}
map = {{ plane = {{ rings = 4 }}, on = "plate.surface", counts = "leaving", side = "both" }}
"#
        );
        all_agree(what, &text);
    }
}

#[test]
fn corners() {
    for (what, finish) in [
        ("corner of mirrors", "{ specular = { reflectance = 0.9 } }"),
        ("white corner", "{ lambertian = { reflectance = 0.8 } }"),
    ] {
        let text = format!(
            r#"
[finishes]
tested = {finish}
[sheets.duct.tube]
profile = {{ rectangle = {{ width_mm = 4, height_mm = 4 }} }}
path = [{{ straight_mm = 6 }}]
finish = "tested"
[sources.lamp.rectangle]
width_mm = 4
height_mm = 4
flux_lm = 10
[sensors]
corner = {{ plane = {{ rectangle = {{ width_mm = 0.8, height_mm = 0.8 }} }}, at = {{ position_mm = [1.6, 1.6, 6], axis = [0, 0, -1] }}, side = "front" }}
"#
        );
        all_agree(what, &text);
    }
}

#[test]
fn grazing_light() {
    let text = r#"
[media.glass]
index = 1.49
[solids.plate.box]
size_mm = [10, 10, 2]
medium = "glass"
at = { position_mm = [0, 0, -2] }
[sources.lamp.rectangle]
width_mm = 8
height_mm = 2
flux_lm = 10
at = { position_mm = [-9, 0, 1.2], axis = [1, 0, 0], x_axis = [0, 1, 0] }
[sensors]
cell = { plane = { rectangle = { width_mm = 8, height_mm = 2 } }, at = { position_mm = [9, 0, 1.2], axis = [-1, 0, 0], x_axis = [0, 1, 0] }, aim = ["plate.exit"] }
view = { luminance = { rectangle = { width_mm = 6, height_mm = 6 }, cells = [1, 1], acceptance_half_angle_deg = 8, directions = [{ theta_deg = 82, phi_deg = 180 }] }, at = { position_mm = [0, 0, -1], axis = [0, 0, 1] } }
"#;
    all_agree("grazing light", text);
}
