//! Light with spectra: each estimator draws wavelengths in its own way and finds the same flux and the same colour.

use crate::sources::rod;
use crate::trial::{Way, agree, measures};

/// A rod that disperses and absorbs by wavelength, with a mirror around it and the given lamps.
fn coloured_rod(sources: &str) -> String {
    rod(sources).replace(
        "index = 1.49\nabsorption_per_mm = 0.02",
        "index = { cauchy = [1.46, 0.01, 0.001] }\nabsorption_per_mm = { by_nm = [[400, 0.2], [500, 0.02], [600, 0.0], [700, 0.05]] }",
    )
}

const COLD: &str = r#"spectrum = { sum = [{ share = 1, spectrum = { peak = { peak_nm = 455, fwhm_nm = 20 } } }, { share = 2, spectrum = "cie_d65" }] }"#;
const RED: &str = "spectrum = { peak = { peak_nm = 630, fwhm_nm = 18 } }";
const LINE: &str = "spectrum = { line_nm = 546.1 }";

fn all_agree(what: &str, text: &str) {
    agree(what, text, &[Way::Forward, Way::Backward, Way::Mixed]);
}

#[test]
fn a_lamp_before_a_rod_that_disperses_light() {
    let lamp = format!(
        "[sources.lamp.disk]\nradius_mm = 2\nflux_lm = 10\n{COLD}\nat = {{ position_mm = [0, 0, -1] }}"
    );
    all_agree("lamp with a spectrum", &coloured_rod(&lamp));
}

/// Their spectra hardly overlap, and one is a line: a gather path of some wavelength sees few of them.
#[test]
fn lamps_of_several_colours() {
    let lamp = |name: &str, x: f64, amount: &str, spectrum: &str| {
        format!(
            "[sources.{name}.disk]\nradius_mm = 0.8\n{amount}\n{spectrum}\nat = {{ position_mm = [{x}, 0, -1] }}\n"
        )
    };
    let lamps = lamp("cold", -1.5, "flux_lm = 8", COLD)
        + &lamp("red", 0.0, "flux_w = 0.01", RED)
        + &lamp("green", 1.5, "flux_lm = 1", LINE);
    all_agree("lamps of several colours", &coloured_rod(&lamps));
}

/// Joins of vertices to lamps and sensors, and lamps that no ray can meet.
#[test]
fn lamps_in_a_white_box() {
    let text = format!(
        r#"
[media.water]
index = {{ cauchy = [1.32, 0.003, 0.0] }}
absorption_per_mm = {{ by_nm = [[400, 0.0], [700, 0.02]] }}
scattering = {{ per_mm = 0.02, anisotropy = 0.3 }}
[finishes.white]
lambertian = {{ reflectance = 0.7 }}
[solids.tank.box]
size_mm = [10, 10, 10]
medium = "water"
[sheets.paper.rectangle]
width_mm = 30
height_mm = 30
finish = "white"
at = {{ position_mm = [0, 0, 15] }}
[sources.lamp.point]
flux_lm = 5
{RED}
at = {{ position_mm = [6, 0, -3] }}
[sources.glow.volume]
of = "tank"
flux_lm = 5
{COLD}
[sensors]
floor = {{ plane = {{ cells = [2, 1] }}, on = "paper.surface", counts = "incident" }}
"#
    );
    agree("lamps in a white box", &text, &[Way::Forward, Way::Mixed]);
}

/// A gather path of most wavelengths crosses a glow that is dark there.
#[test]
fn a_glow_of_one_wavelength_beside_white_light() {
    let text = format!(
        r#"
[media.pool]
index = {{ library = "water" }}
absorption_per_mm = 0.02
[solids.tank.box]
size_mm = [10, 10, 10]
medium = "pool"
[sources.lamp.disk]
radius_mm = 4
flux_lm = 5
spectrum = "cie_d65"
at = {{ position_mm = [0, 0, -3] }}
[sources.glow.volume]
of = "tank"
flux_lm = 5
{LINE}
[sensors]
cell = {{ plane = {{ rectangle = {{ width_mm = 10, height_mm = 10 }} }}, at = {{ position_mm = [0, 0, 12], axis = [0, 0, -1] }} }}
"#
    );
    all_agree("glow of one wavelength", &text);
}

#[test]
fn a_radiant_flux_has_the_lumens_of_its_spectrum() {
    let lamp = "[sources.lamp.disk]\nradius_mm = 2\nflux_w = 2\nspectrum = { line_nm = 555 }\nat = { position_mm = [0, 0, -1] }";
    let found = measures(&coloured_rod(lamp), Way::Forward);
    // V(555 nm) is 1 (CIE 018:2019).
    assert!((found.source_flux / (2.0 * 683.002) - 1.0).abs() < 1e-4, "{}", found.source_flux);
    assert!(found.balance.residual.value.abs() < 1e-9 * found.source_flux, "{:?}", found.balance);
    let efficacy = found.values["exit.luminous_efficacy"].value;
    assert!((efficacy / 683.002 - 1.0).abs() < 1e-4, "{efficacy}");
}
