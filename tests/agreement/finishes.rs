//! Every finish: adjoint factors are right, and all light is counted exactly once.

use crate::trial::{all_agree, shallow_agree};

/// A tube of a finish, lit by a disk, seen at the exit and by a remote cell.
pub(crate) fn tube(finish: &str) -> String {
    format!(
        r#"
[finishes]
tested = {finish}
[sheets.tube.tube]
profile = {{ circle = {{ radius_mm = 5 }} }}
path = [{{ straight_mm = 15 }}]
finish = "tested"
[sources.lamp.disk]
radius_mm = 4
flux_lm = 10
at = {{ position_mm = [0.5, 0, 0.1] }}
[sensors]
exit = {{ plane = {{ cells = [2, 2] }}, on = "tube.exit", counts = "incident" }}
cell = {{ plane = {{ rectangle = {{ width_mm = 4, height_mm = 4 }} }}, at = {{ position_mm = [4, 1, 25], axis = [0, 0, -1] }}, aim = ["tube.exit"] }}
"#
    )
}

/// A window with a finish, tilted, between the lamp and a cell behind it; another cell sees the
/// returning light.
pub(crate) fn window(finish: &str, back: &str) -> String {
    format!(
        r#"
[finishes]
tested = {finish}
behind = {back}
mirror = {{ specular = {{ reflectance = 0.9 }} }}
[sheets.window.disk]
radius_mm = 6
finish = "behind"
back = "tested"
at = {{ position_mm = [0, 0, 8], axis = [0.3, 0, 1] }}
[sheets.plate.rectangle]
width_mm = 14
height_mm = 14
finish = "mirror"
at = {{ position_mm = [0, 0, 20], axis = [-0.1, 0, 1] }}
[sources.lamp.disk]
radius_mm = 3
flux_lm = 10
[sensors]
beyond = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 6 }}, cells = [2, 1] }}, at = {{ position_mm = [1, 0, 16], axis = [0, 0, -1] }}, side = "both" }}
before = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 6 }} }}, at = {{ position_mm = [-8, 0, 2], axis = [0.3, 0, 1] }}, aim = ["window.surface"] }}
"#
    )
}

/// A block of glass with a finish on all its faces, lit from below, seen inside and outside.
fn block(finish: &str) -> String {
    format!(
        r#"
[finishes]
tested = {finish}
[media.glass]
index = 1.49
absorption_per_mm = 0.03
[solids.block.box]
size_mm = [8, 8, 6]
medium = "glass"
faces = {{ entry = "tested", exit = "tested", wall = "tested" }}
[sources.lamp.disk]
radius_mm = 3
flux_lm = 10
at = {{ position_mm = [0, 0, -1] }}
[sensors]
out = {{ plane = {{ cells = [2, 1] }}, on = "block.exit", counts = "leaving" }}
inside = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 6 }} }}, at = {{ position_mm = [0, 0, 3], axis = [0, 0, -1] }} }}
above = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 6 }} }}, at = {{ position_mm = [2, 0, 12], axis = [0, 0, -1] }}, aim = ["block.exit"] }}
"#
    )
}

#[test]
fn mirrors_and_metals() {
    all_agree("mirror tube", &tube("{ specular = { reflectance = 0.9 } }"));
    all_agree("metal tube", &tube("{ metal = { n = 0.79, k = 5.85 } }"));
    all_agree(
        "half mirror tube",
        &tube("{ specular = { reflectance = 0.6, transmittance = 0.3 } }"),
    );
    all_agree("black tube", &tube("{ absorber = {} }"));
}

#[test]
fn walls_that_scatter() {
    all_agree("narrow scatter", &tube("{ gaussian = { sigma_deg = 1, reflectance = 0.9 } }"));
    all_agree("broad scatter", &tube("{ gaussian = { sigma_deg = 15, reflectance = 0.9 } }"));
    all_agree("white tube", &tube("{ lambertian = { reflectance = 0.8 } }"));
    all_agree(
        "white tube that lets light out",
        &tube("{ lambertian = { reflectance = 0.6, transmittance = 0.3 } }"),
    );
}

#[test]
fn prism_films() {
    let film = "{ prism_film = { index = 1.5, pitch_mm = 0.2, base_mm = 0.05, absorption_per_mm = 0.1, rounded_share = 0.02 } }";
    all_agree("duct of film", &tube(film));
    all_agree(
        "duct of film with prisms inside and around",
        &tube(
            "{ prism_film = { index = 1.6, pitch_mm = 0.2, base_mm = 0.05, prism_angle_deg = 70, prisms = \"before\", run = \"around\" } }",
        ),
    );
    all_agree(
        "film and mirror",
        &tube(
            "{ mixture = [{ weight = 2, finish = { prism_film = { index = 1.5, pitch_mm = 0.2, base_mm = 0.05 } } }, { weight = 1, finish = { specular = { reflectance = 0.95 } } }] }",
        ),
    );
}

#[test]
fn walls_of_mixtures() {
    all_agree(
        "mirror and white",
        &tube(
            "{ mixture = [{ weight = 2, finish = { specular = { reflectance = 0.95 } } }, { weight = 1, finish = { lambertian = { reflectance = 0.8 } } }] }",
        ),
    );
    all_agree(
        "mirror, narrow and broad scatter",
        &tube(
            "{ mixture = [{ weight = 2, finish = { specular = { reflectance = 0.95 } } }, { weight = 1, finish = { gaussian = { sigma_deg = 2, reflectance = 0.9 } } }, { weight = 1, finish = { gaussian = { sigma_deg = 20, reflectance = 0.9 } } }] }",
        ),
    );
    all_agree(
        "mirror and narrow scatter",
        &tube(
            "{ mixture = [{ weight = 2, finish = { specular = { reflectance = 0.95 } } }, { weight = 1, finish = { gaussian = { sigma_deg = 2, reflectance = 0.9 } } }] }",
        ),
    );
}

#[test]
fn windows() {
    for (what, finish) in [
        ("open window", "{ open = {} }"),
        ("half mirror", "{ specular = { reflectance = 0.4, transmittance = 0.5 } }"),
        ("diffuser", "{ lambertian = { reflectance = 0.3, transmittance = 0.6 } }"),
        (
            "narrow scatter",
            "{ gaussian = { sigma_deg = 1, reflectance = 0.4, transmittance = 0.5 } }",
        ),
        (
            "broad scatter",
            "{ gaussian = { sigma_deg = 15, reflectance = 0.4, transmittance = 0.5 } }",
        ),
    ] {
        shallow_agree(what, &window(finish, finish));
    }
}

#[test]
fn windows_with_two_sides() {
    for (what, front, back) in [
        (
            "half mirror before a diffuser",
            "{ specular = { reflectance = 0.2, transmittance = 0.7 } }",
            "{ lambertian = { reflectance = 0.5, transmittance = 0.4 } }",
        ),
        (
            "diffuser before narrow scatter",
            "{ lambertian = { reflectance = 0.3, transmittance = 0.5 } }",
            "{ gaussian = { sigma_deg = 2, reflectance = 0.5, transmittance = 0.3 } }",
        ),
        (
            "mixture before broad scatter",
            "{ mixture = [{ weight = 1, finish = { open = {} } }, { weight = 1, finish = { lambertian = { reflectance = 0.3, transmittance = 0.6 } } }] }",
            "{ gaussian = { sigma_deg = 12, reflectance = 0.5, transmittance = 0.3 } }",
        ),
        (
            "half mirror, black behind",
            "{ specular = { reflectance = 0.2, transmittance = 0.3 } }",
            "{ absorber = {} }",
        ),
    ] {
        shallow_agree(what, &window(front, back));
    }
}

#[test]
fn faces_of_glass() {
    for (what, finish) in [
        ("glass", "{ smooth = {} }"),
        ("glass, 1 deg rough", "{ gaussian = { sigma_deg = 1 } }"),
        ("glass, 15 deg rough", "{ gaussian = { sigma_deg = 15 } }"),
    ] {
        all_agree(what, &block(finish));
    }
}

#[test]
fn faces_of_glass_with_films() {
    for (what, finish) in [
        (
            "glass with a diffusing film",
            "{ lambertian = { reflectance = 0.4, transmittance = 0.5 } }",
        ),
        (
            "glass, rough in parts",
            "{ mixture = [{ weight = 2, finish = \"polished\" }, { weight = 1, finish = { gaussian = { sigma_deg = 12 } } }, { weight = 1, finish = { lambertian = { reflectance = 0.5, transmittance = 0.4 } } }] }",
        ),
        (
            "glass, rough in narrow parts",
            "{ mixture = [{ weight = 2, finish = \"polished\" }, { weight = 1, finish = { gaussian = { sigma_deg = 2 } } }] }",
        ),
    ] {
        all_agree(what, &block(finish));
    }
}

/// An anti-reflection coating, as a table.
const COATING: &str =
    "{ coated = { angles_deg = [0, 40, 60, 80, 90], reflectance = [0.005, 0.01, 0.04, 0.3, 1] } }";

#[test]
fn shares_by_the_angle() {
    all_agree(
        "mirror tube by a table",
        &tube("{ tabulated = { angles_deg = [0, 60, 90], reflectance = [0.85, 0.9, 1] } }"),
    );
    shallow_agree(
        "window by a table",
        &window(
            "{ tabulated = { angles_deg = [0, 90], reflectance = [0.2, 0.9], transmittance = [0.7, 0] } }",
            "{ tabulated = { angles_deg = [0, 90], reflectance = [0.1, 0.9], transmittance = [0.8, 0.1] } }",
        ),
    );
    all_agree("coated glass", &block(COATING));
}

/// High and low index, and a thin metal.
const STACK: &str = "{ stack = { layers = [{ index = 2.3, thickness_nm = 60 }, { index = 1.46, thickness_nm = 120 }, { index = 0.96, extinction = 6.7, thickness_nm = 8 }], wavelength_nm = 550 } }";

#[test]
fn stacks_of_layers() {
    all_agree("glass with layers", &block(STACK));
    all_agree("tube of layers", &tube(STACK));
    all_agree(
        "antireflective glass",
        &block(
            "{ stack = { layers = [{ index = 1.38, thickness_nm = 100 }], wavelength_nm = 550 } }",
        ),
    );
}

#[test]
fn small_facets() {
    all_agree("glass of fine facets", &block("{ ggx = { roughness = 0.02 } }"));
    all_agree("glass of coarse facets", &block("{ ggx = { roughness = 0.3 } }"));
    all_agree("rough mirror", &tube("{ ggx = { roughness = 0.2, reflectance = 0.9 } }"));
    all_agree(
        "rough metal",
        &tube("{ ggx = { roughness = 0.03, metal = { n = 0.79, k = 5.85 } } }"),
    );
}

#[test]
fn haze() {
    all_agree("hazy glass", &block("{ abg = { a = 0.01, b = 0.02, g = 2 } }"));
    all_agree(
        "hazy mirror",
        &tube("{ harvey = { b0 = 1, l = 0.05, s = -1.5, reflectance = 0.9 } }"),
    );
    let window_finish = "{ abg = { a = 0.01, b = 0.02, g = 2, reflectance = 0.08, transmittance = 0.9, scatters = \"transmitted\" } }";
    shallow_agree("hazy window", &window(window_finish, window_finish));
    shallow_agree(
        "hazy window, coated on one side",
        &window(
            "{ abg = { a = 0.01, b = 0.02, g = 2, reflectance = 0.4, transmittance = 0.5 } }",
            "{ tabulated = { angles_deg = [0, 90], reflectance = [0.1, 0.9], transmittance = [0.8, 0.1] } }",
        ),
    );
}
