//! Media that scatter: published values, invariances that hold for any amount of scattering, and
//! agreement of all estimators.

use crate::trial::{Comparison, Gathering, Way, agree, measures, shallow_agree};

/// A beam of a radius on a wide slab of a medium, at a height above its lower face; counts transmitted and reflected light.
fn slab([thickness_mm, index, anisotropy]: [f64; 3], [radius_mm, height_mm]: [f64; 2]) -> String {
    let z_mm = 1.0 + height_mm;
    format!(
        r#"
[media.turbid]
index = {index}
absorption_per_mm = 1
scattering = {{ per_mm = 9, anisotropy = {anisotropy} }}
[solids.slab.box]
size_mm = [400, 400, {thickness_mm}]
medium = "turbid"
at = {{ position_mm = [0, 0, 1] }}
[sources.laser.disk]
radius_mm = {radius_mm}
flux_lm = 1
emission = "collimated"
at = {{ position_mm = [0, 0, {z_mm}] }}
[sensors]
up = {{ plane = {{}}, on = "slab.exit", counts = "leaving" }}
back = {{ plane = {{}}, on = "slab.entry", counts = "leaving" }}
"#
    )
}

#[test]
fn a_slab_lets_through_and_sends_back_what_is_published() {
    let mut comparison = Comparison::default();
    // van de Hulst, Multiple Light Scattering (1980), table 35, as in Wang, Jacques & Zheng, Comput. Methods Programs
    // Biomed. 47 (1995) 131, table 1: optical thickness 2, albedo 0.9, anisotropy 0.75, equal indices. Five digits.
    let gathering =
        Gathering { depth: 1, radius_mm: 0.02, angle_deg: 5.0, records: 2000, photons: 2000 };
    // A thin beam from outside by photons; a wide one that starts within, so that gather paths are joined to it.
    for (way, beam) in [
        (Way::Forward, [0.1, -0.5]),
        (Way::Mixed, [190.0, 1e-9]),
        (Way::Merged(gathering), [190.0, 1e-9]),
    ] {
        let found = measures(&slab([0.2, 1.0, 0.75], beam), way);
        comparison.add(
            &format!("slab, {}, up", way.name()),
            &found.values["up.flux"],
            0.66096,
            5e-6,
        );
        comparison.add(
            &format!("slab, {}, back", way.name()),
            &found.values["back.flux"],
            0.09739,
            5e-6,
        );
    }
    // Giovanelli, Opt. Acta 2 (1955) 153, as in table 2 there: half space of index 1.5, albedo 0.9,
    // isotropic, including the reflection of the surface itself. Four digits.
    let found = measures(&slab([200.0, 1.5, 0.0], [0.1, -0.5]), Way::Forward);
    comparison.add("half space, back", &found.values["back.flux"], 0.2600, 5e-5);
    comparison.assert("slab", 7);
}

#[test]
fn light_from_all_sides_stays_as_long_in_a_body_that_scatters_as_in_a_clear_one() {
    // Blanco & Fournier, Europhys. Lett. 61 (2003) 168: the mean path length is 4 V/S, for any
    // amount of scattering. A weak absorption α takes the share α 4 V/S of the light; the next term
    // is of the order of α times the edge.
    const EDGE_MM: f64 = 10.0;
    const ABSORPTION: f64 = 1e-6;
    let mut comparison = Comparison::default();
    for scattering in [
        "",
        "scattering = { per_mm = 0.1 }",
        "scattering = { per_mm = 0.5, anisotropy = -0.4 }",
        "scattering = { per_mm = 2, anisotropy = 0.9 }",
    ] {
        let text = format!(
            r#"
[media.fog]
index = 1
absorption_per_mm = {ABSORPTION}
{scattering}
[solids.cube.box]
size_mm = [{EDGE_MM}, {EDGE_MM}, {EDGE_MM}]
medium = "fog"
[sources]
below = {{ face = {{ of = "cube.entry", side = "back", luminance_cd_m2 = 1000 }} }}
above = {{ face = {{ of = "cube.exit", side = "back", luminance_cd_m2 = 1000 }} }}
around = {{ face = {{ of = "cube.wall", side = "back", luminance_cd_m2 = 1000 }} }}
"#
        );
        let found = measures(&text, Way::Forward);
        let emitted = found.values["balance.emitted"].value;
        let expected = emitted * ABSORPTION * 4.0 * EDGE_MM / 6.0;
        let absorbed = &found.values["balance.absorbed_medium.fog"];
        comparison.add(scattering, absorbed, expected, 1e-4 * expected);
    }
    comparison.assert("mean path", 4);
}

#[test]
fn light_that_is_not_scattered_falls_off_by_both_coefficients() {
    // Far ahead a disk as wide as the beam sees only the beam: less than 1e-7 of the scattered
    // light.
    let text = slab([0.3, 1.0, 0.0], [0.1, -0.5]).replace(
        "[sensors]",
        "[sensors]\nahead = { plane = { disk = { radius_mm = 0.11 } }, at = { position_mm = [0, 0, 500], axis = [0, 0, -1] } }",
    );
    let found = measures(&text, Way::Forward);
    let mut comparison = Comparison::default();
    comparison.add("ahead", &found.values["ahead.flux"], (-3.0f64).exp(), 1e-6);
    comparison.assert("straight ahead", 1);
}

/// A block of a medium, a clear bubble and a white disk in it, lit from below and from inside.
pub(crate) fn block(scattering: &str) -> String {
    format!(
        r#"
[media.turbid]
index = 1.49
absorption_per_mm = 0.02
scattering = {scattering}
[finishes.white]
lambertian = {{ reflectance = 0.8 }}
[solids.block.box]
size_mm = [8, 8, 6]
medium = "turbid"
[solids.bubble.sphere]
radius_mm = 1
medium = "air"
priority = 1
at = {{ position_mm = [2, 2, 3] }}
[sheets.white.disk]
radius_mm = 1
finish = "white"
at = {{ position_mm = [-2, -2, 2.5] }}
[sources.lamp.disk]
radius_mm = 3
flux_lm = 10
at = {{ position_mm = [0, 0, -1] }}
[sources.chip.disk]
radius_mm = 0.8
flux_lm = 3
at = {{ position_mm = [1, -2, 1], axis = [0.4, 0, 1] }}
[sensors]
out = {{ plane = {{ cells = [2, 1] }}, on = "block.exit", counts = "leaving" }}
inside = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 6 }} }}, at = {{ position_mm = [0, 0, 4], axis = [0, 0, -1] }} }}
above = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 6 }} }}, at = {{ position_mm = [2, 0, 12], axis = [0, 0, -1] }}, aim = ["block.exit"] }}
"#
    )
}

#[test]
fn all_estimators_agree_in_media_that_scatter() {
    shallow_agree("isotropic", &block("{ per_mm = 0.2 }"));
    shallow_agree("forward scattering", &block("{ per_mm = 0.6, anisotropy = 0.85 }"));
}

#[test]
fn a_medium_that_scatters_glows_as_a_volume() {
    // Glow and scattering share the segments of a path; the solid itself is the source.
    let text = r#"
[media.turbid]
index = 1.3
absorption_per_mm = 0.05
scattering = { per_mm = 0.3, anisotropy = 0.4 }
[solids.body.box]
size_mm = [6, 6, 6]
medium = "turbid"
[sources.glow.volume]
of = "body"
flux_lm = 10
[sensors]
out = { plane = { cells = [2, 2] }, on = "body.exit", counts = "leaving" }
above = { plane = { rectangle = { width_mm = 6, height_mm = 6 } }, at = { position_mm = [2, 0, 12], axis = [0, 0, -1] }, aim = ["body.exit"] }
"#;
    let gather = Way::Gather(Gathering::to_depth(2));
    agree("glow", text, &[Way::Forward, Way::Backward, Way::Mixed, gather]);
}
