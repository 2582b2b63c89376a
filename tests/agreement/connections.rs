//! Light that is joined to sensors and sources: exact fields behind one diffuse face.

use crate::calibration::assert_calibrated;
use crate::traced;
use crate::trial::{Comparison, Gathering, Way, measures};
use lumiduct_core::plan::Request;
use lumiduct_input::{self as input, Job, Settings};
use std::f64::consts::PI;
use std::path::Path;

/// Largest relative standard error of a joined value, 1: forward would need some
/// 10^7 photons for it.
const MOST_NOISE: f64 = 0.005;

/// Compares the mixed and the merged estimates of some measures with exact values.
fn assert_exact(what: &str, text: &str, expected: &[(&str, f64)]) {
    let mut comparison = Comparison::default();
    let gathering =
        Gathering { depth: 1, radius_mm: 0.5, angle_deg: 5.0, records: 1000, photons: 1000 };
    // Pairs have the noise of the fourth order, which the merged value includes.
    for (way, most_noise) in [(Way::Mixed, MOST_NOISE), (Way::Merged(gathering), 2.0 * MOST_NOISE)]
    {
        let found = measures(text, way);
        for &(name, expected) in expected {
            let measure = &found.values[name];
            let what = format!("{what}, {}, {name}", way.name());
            comparison.add(&what, measure, expected, 0.0);
            let noise = measure.std_error / measure.value;
            assert!(noise < most_noise, "{what}: noise of {noise}");
        }
    }
    comparison.assert(what, 2 * expected.len());
}

/// A beam fills a diffuse disc, before which lies a smaller one.
pub(crate) const LIT_DISC: &str = r#"
[finishes.white.lambertian]
reflectance = 0.8
[sheets.plate.disk]
radius_mm = 5
finish = "white"
[sources.beam.disk]
radius_mm = 4.999999
at = { position_mm = [0, 0, 50], axis = [0, 0, -1] }
emission = "collimated"
flux_lm = 10
[sensors.cell]
plane = { disk = { radius_mm = 2 } }
at = { position_mm = [0, 0, 10], axis = [0, 0, -1] }
"#;

/// Flux on the smaller disc by its configuration factor (Howell, A catalog of radiation heat transfer configuration
/// factors, C-41), lm.
pub(crate) fn flux_of_lit_disc() -> f64 {
    let [lit, seeing]: [f64; 2] = [5.0 / 10.0, 2.0 / 10.0];
    let x = 1.0 + (1.0 + seeing * seeing) / (lit * lit);
    10.0 * 0.8 * 0.5 * (x - (x * x - 4.0 * (seeing / lit).powi(2)).sqrt())
}

#[test]
fn a_disc_sees_a_lit_disc_by_their_configuration_factor() {
    assert_exact("disc to disc", LIT_DISC, &[("cell.flux", flux_of_lit_disc())]);
}

#[test]
fn errors_of_joined_light_are_calibrated() {
    /// Photons and gather paths of one of 128 batches, about.
    const BATCH_PATHS: u64 = 60;
    let disc: fn(&Settings) -> Job = |settings| traced::load(LIT_DISC, settings);
    let sphere: fn(&Settings) -> Job = |settings| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/integrating_sphere.toml");
        input::load(&path, settings).unwrap()
    };
    // The scene of the sphere has its exact flux as a check.
    for (what, load, expected) in
        [("disc", disc, flux_of_lit_disc()), ("sphere", sphere, 0.1394258)]
    {
        assert_calibrated(what, 1.0, |seed| {
            let (estimator, paths) = (Some(Request::Mix), Some(1280));
            let settings = Settings { estimator, seed: Some(seed), paths, ..Settings::default() };
            let mut job = load(&settings);
            job.run.batch_paths = Some(BATCH_PATHS);
            let flux = &traced::measures(&job).values["cell.flux"];
            (flux.value - expected) / flux.std_error
        });
    }
}

/// Illuminance on the axis below a diffusing sheet under a point: ∫ τ E(r) cos⁴/(π b²) dA with
/// E(r) = I a/(a² + r²)^(3/2).
#[test]
fn a_cell_below_a_sheet_under_a_point_has_the_light_of_the_integral() {
    let text = r#"
[finishes.opal.lambertian]
reflectance = 0.2
transmittance = 0.6
[sheets.sheet.disk]
radius_mm = 20
finish = "opal"
[sources.lamp.point]
at = { position_mm = [0, 0, 10] }
emission = "isotropic"
flux_lm = 100
[sensors.cell]
plane = { disk = { radius_mm = 0.05 } }
at = { position_mm = [0, 0, -15], axis = [0, 0, 1] }
"#;
    let (above, below, radius, transmittance): (f64, f64, f64, f64) = (10.0, 15.0, 20.0, 0.6);
    let intensity = 100.0 / (4.0 * PI);
    let steps = 200_000;
    let ring = |k: i32| {
        let dr = radius / f64::from(steps);
        let r = (f64::from(k) + 0.5) * dr;
        let lit = intensity * above / (above * above + r * r).powf(1.5);
        let seen = below * below / (PI * (below * below + r * r).powi(2));
        transmittance * lit * seen * 2.0 * PI * r * dr
    };
    // Per mm² to lx.
    let illuminance = 1e6 * (0..steps).map(ring).sum::<f64>();
    assert_exact("sheet under a point", text, &[("cell.illuminance_avg", illuminance)]);
}

/// A tilted beam that fills a square mirror duct lights an opal pane at its end evenly: unfolded, the light of each direction
/// covers the pane once. A small cell on the axis below sees it by the configuration factor of a rectangle (Howell, A catalog of
/// radiation heat transfer configuration factors, B-4), four times that of its quarter.
#[test]
fn a_cell_below_an_opal_pane_at_the_end_of_a_duct_has_the_light_of_its_configuration_factor() {
    let text = r#"
[finishes]
opal = { lambertian = { reflectance = 0.2, transmittance = 0.6 } }
mirror = { specular = { reflectance = 1 } }
[sheets.duct.tube]
profile = { rectangle = { width_mm = 10, height_mm = 10 } }
path = [{ straight_mm = 30 }]
finish = "mirror"
[sheets.pane.rectangle]
width_mm = 10
height_mm = 10
finish = "opal"
at = { position_mm = [0, 0, 30] }
[sources.beam.rectangle]
width_mm = 9.999999
height_mm = 9.999999
at = { position_mm = [0, 0, 0.000001] }
emission = "collimated"
tilt_deg = 25
flux_lm = 10
[sensors.cell]
plane = { disk = { radius_mm = 0.02 } }
at = { position_mm = [0, 0, 38], axis = [0, 0, -1] }
"#;
    let half: f64 = 5.0 / 8.0;
    let root = (1.0 + half * half).sqrt();
    let factor = 4.0 * 2.0 * half / root * (half / root).atan() / (2.0 * PI);
    assert_exact("pane", text, &[("cell.illuminance_avg", 1e6 * 0.6 * 10.0 / 100.0 * factor)]);
}

/// A diffuse face has the luminance τE/π in all directions.
#[test]
fn a_lit_sheet_has_the_same_luminance_in_all_directions() {
    let text = r#"
[finishes.opal.lambertian]
reflectance = 0.2
transmittance = 0.6
[sheets.sheet.disk]
radius_mm = 20
finish = "opal"
[sources.beam.disk]
radius_mm = 19.999999
at = { position_mm = [0, 0, -30] }
emission = "collimated"
flux_lm = 10
[sensors.eye]
luminance = { cells = [1, 1], acceptance_half_angle_deg = 0.5, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 70, phi_deg = 30 }] }
on = "sheet.surface"
counts = "leaving"
"#;
    let luminance = 1e6 * 0.6 * 10.0 / (PI * 20.0 * 20.0) / PI;
    let names = ["eye.luminance_avg.0", "eye.luminance_avg.1"];
    assert_exact("lit sheet", text, &names.map(|name| (name, luminance)));
}

/// A cell before the hole of a white box (`scenes/white_box.toml`, its lamp at half the height): hardly any gather path
/// meets the lamp, so the light of `backward` is that of their connections.
#[test]
fn gather_paths_joined_to_a_lamp_find_as_much_light_as_photons_do() {
    let text = r#"
[finishes.white.lambertian]
reflectance = 0.9
[sheets.box.tube]
profile = { rectangle = { width_mm = 40, height_mm = 40 } }
path = [{ straight_mm = 40 }]
finish = "white"
[sheets.floor.rectangle]
width_mm = 40
height_mm = 40
finish = "white"
[sheets.lid.annulus]
inner_radius_mm = 4
outer_radius_mm = 28.3
finish = "white"
at = { position_mm = [0, 0, 40] }
[sources.led.disk]
radius_mm = 0.5
at = { position_mm = [15, 10, 20], axis = [0, 0, -1] }
flux_lm = 100
[sensors.cell]
plane = { rectangle = { width_mm = 2, height_mm = 2 } }
at = { position_mm = [0, 0, 41], axis = [0, 0, -1] }
"#;
    let flux = &measures(text, Way::Backward).values["cell.flux"];
    let mut comparison = Comparison::default();
    // This text as scene.toml, `lumiduct run scene.toml --estimator forward --paths 8M --seed 20403`.
    comparison.add("joined to a lamp", flux, 0.3454, 0.0014);
    let noise = flux.std_error / flux.value;
    assert!(noise < 2.0 * MOST_NOISE, "noise of {noise}");
    comparison.assert("joined to a lamp", 1);
}
