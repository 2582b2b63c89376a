//! The sun and the sky: light that starts on a port, on glass, and around a body; and amounts given
//! by integrals.

use crate::trial::{Gathering, Way, agree, measures};

/// A bent tube under a roof, with a glass pane or a dome above it; with the given light, aimed at
/// the entry, the pane or the dome.
fn tube(light: &str) -> String {
    format!(
        r#"
[media.glass]
index = 1.49
absorption_per_mm = 0.01
[finishes.mirror]
specular = {{ reflectance = 0.9 }}
[sheets.duct.tube]
profile = {{ circle = {{ radius_mm = 5 }} }}
path = [{{ straight_mm = 5 }}, {{ bend_deg = 30, radius_mm = 20 }}]
finish = "mirror"
at = {{ axis = [0, 0, -1] }}
[sheets.roof.annulus]
inner_radius_mm = 5
outer_radius_mm = 9
finish = "black"
[solids.pane.cylinder]
radius_mm = 6
length_mm = 2
medium = "glass"
at = {{ position_mm = [0, 0, 0.5] }}
{light}
[sensors]
exit = {{ plane = {{ cells = [2, 1] }}, on = "duct.exit", counts = "leaving" }}
cell = {{ plane = {{ rectangle = {{ width_mm = 4, height_mm = 4 }} }}, at = {{ position_mm = [0, 1, 4], axis = [0, 0, 1] }} }}
"#
    )
}

/// Forward, backward, mixed and gathered at two depths.
fn all_agree(what: &str, text: &str) {
    let gather = [Gathering::to_depth(2), Gathering::to_depth(8)].map(Way::Gather);
    let [middle, deep] = gather;
    agree(what, text, &[Way::Forward, Way::Backward, Way::Mixed, middle, deep]);
}

#[test]
fn skies_on_a_port_and_on_glass() {
    all_agree(
        "overcast sky on the port",
        &tube(
            "[sources.sky.sky]\nmodel = \"overcast\"\nhorizontal_illuminance_lx = 1e5\naim = \"duct.entry\"",
        ),
    );
    all_agree(
        "clear sky on the glass, through the face",
        &tube(
            "[sources.sky.sky]\nmodel = \"clear\"\nelevation_deg = 40\nzenith_luminance_cd_m2 = 1e4\naim = \"pane.exit\"",
        ),
    );
}

#[test]
fn skies_from_afar() {
    all_agree(
        "uniform sky around the pane",
        &tube(
            "[sources.sky.sky]\nmodel = \"uniform\"\nzenith_luminance_cd_m2 = 1e4\naim = \"pane\"",
        ),
    );
    all_agree(
        "hazy sky around the tube, with up and north",
        &format!(
            "up = [0.3, 0, 1]\nnorth = [0, -1, 0.2]\n{}",
            tube(
                "[sources.sky.sky]\nmodel = { cie_type = 14 }\nelevation_deg = 55\nazimuth_deg = 70\nhorizontal_illuminance_lx = 1e5\naim = \"duct\""
            )
        ),
    );
}

#[test]
fn a_wide_sun_on_a_port_and_from_afar() {
    for aim in ["duct.entry", "pane.exit", "pane"] {
        let sun = format!(
            "[sources.sun.sun]\nilluminance_lx = 1e5\nelevation_deg = 65\nazimuth_deg = 120\nhalf_angle_deg = 5\naim = \"{aim}\""
        );
        all_agree(aim, &tube(&sun));
    }
}

/// A horizontal plane and a wall in the open, under a light aimed at a small plate near them.
fn open(light: &str) -> String {
    format!(
        r#"
[sheets.plate.disk]
radius_mm = 20
finish = "open"
{light}
[sensors]
level = {{ plane = {{ disk = {{ radius_mm = 10 }} }}, at = {{ axis = [0, 0, 1] }} }}
wall = {{ plane = {{ disk = {{ radius_mm = 10 }} }}, at = {{ axis = [0, 1, 0] }} }}
"#
    )
}

#[test]
fn illuminances_in_the_open_are_those_of_integrals() {
    use std::f64::consts::PI;
    // π L and half of it; 7/9 π Lz on the horizontal plane, and ∫ (1 + 2 cos Z)/3 cos θ
    // dω = π/6 + 4/9 on a wall.
    for (model, level, wall) in
        [("uniform", PI, 0.5 * PI), ("overcast", 7.0 / 9.0 * PI, PI / 6.0 + 4.0 / 9.0)]
    {
        let sky = format!(
            "[sources.sky.sky]\nmodel = \"{model}\"\nzenith_luminance_cd_m2 = 1000\naim = \"plate\""
        );
        for way in [Way::Forward, Way::Backward] {
            let found = measures(&open(&sky), way);
            for (name, expected) in [("level", level), ("wall", wall)] {
                let measure = &found.values[&format!("{name}.illuminance_avg")];
                let off = (measure.value - 1000.0 * expected).abs();
                // Backward paths under a uniform sky all carry the same: only rounding remains.
                let allowed = 4.0 * measure.std_error + 1e-6 * measure.value;
                assert!(off < allowed, "{model}, {}, {name}: {measure}", way.name());
            }
        }
    }
}

#[test]
fn the_sun_stands_where_the_clock_says() {
    // Golden, Colorado, 2003 October 17, 12:30:30 at UTC - 7: elevation 39.892 deg with refraction at sea level, azimuth
    // 194.340 deg (Reda & Andreas, NREL/TP-560-34302). On a level plane E sin(elevation), on a wall that faces south
    // E cos(elevation) cos(azimuth - 180°).
    let sun = "[sources.sun.sun]\nilluminance_lx = 1e5\naim = \"plate\"\n[sources.sun.sun.when]\ndate = \"2003-10-17\"\ntime = \"12:30:30\"\nutc_offset_h = -7\nlatitude_deg = 39.742476\nlongitude_deg = -105.1786";
    let text = open(sun).replace("axis = [0, 1, 0]", "axis = [0, -1, 0]");
    let found = measures(&text, Way::Forward);
    let (elevation, azimuth) = (39.892f64.to_radians(), 14.340f64.to_radians());
    for (name, expected) in [("level", elevation.sin()), ("wall", elevation.cos() * azimuth.cos())]
    {
        let measure = &found.values[&format!("{name}.illuminance_avg")];
        let off = (measure.value - 1e5 * expected) / measure.std_error;
        assert!(off.abs() < 4.0, "{name}: {measure}, expected {}", 1e5 * expected);
    }
}
