//! Light that media scatter by its wavelength, or absorb and emit at other wavelengths, against laws.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod traced;

use lumiduct_core::measure::Measures;
use lumiduct_core::plan::Request;
use lumiduct_input::Settings;

/// Quantum yield, and absorption of blue light over the radius of the ball, 1.
const YIELD: f64 = 0.8;
const OPTICAL_RADIUS: f64 = 1.2;
/// A photon of 600 nm has three quarters of the energy of one of 450 nm.
const ENERGY: f64 = 450.0 / 600.0;

/// A lamp of 2 W at 450 nm in the middle of a ball that absorbs only blue light and emits 600 nm.
const BALL: &str = r#"
[media.dye]
index = 1
[media.dye.fluorescence]
absorption_per_mm = { by_nm = [[440, 0.12], [460, 0.12], [470, 0]] }
emission = { line_nm = 600 }
quantum_yield = 0.8
[solids.ball.sphere]
radius_mm = 10
medium = "dye"
[sources.lamp.point]
flux_w = 2
spectrum = { line_nm = 450 }
[sensors]
out = { plane = {}, on = "ball.surface", counts = "leaving" }
far = { goniometer = { c_step_deg = 90, gamma_step_deg = 45 } }
"#;

fn measures(text: &str, paths: u64) -> Measures {
    measured_by(Request::Forward, text, paths)
}

fn measured_by(estimator: Request, text: &str, paths: u64) -> Measures {
    let settings = Settings {
        paths: Some(paths),
        estimator: Some(estimator),
        seed: Some(7),
        ..Settings::default()
    };
    traced::measures(&traced::load(text, &settings))
}

fn assert_is(found: &Measures, name: &str, expected: f64) {
    let measure = &found.values[name];
    let off = (measure.value - expected).abs();
    assert!(off <= 4.0 * measure.std_error + 1e-9 * expected, "{name}: {measure}, {expected}");
    assert!(measure.std_error < 0.01 * expected, "{name}: {measure}");
}

#[test]
fn light_of_a_ball_follows_from_photons_that_its_dye_absorbs() {
    let found = measures(BALL, 200_000);
    let absorbed = 2.0 * (1.0 - (-OPTICAL_RADIUS).exp());
    let emitted = absorbed * YIELD * ENERGY;
    assert_is(&found, "out.radiant_flux", 2.0 - absorbed + emitted);
    assert_is(&found, "balance.heat.dye", absorbed - emitted);
    assert_is(&found, "far.radiant_flux", 2.0 - absorbed + emitted);
    // CIE 1931: V(450 nm) = 0.038, V(600 nm) = 0.631; 683.002 lm/W (CIE 018:2019).
    let lumens = |watts: f64, v: f64| 683.002 * watts * v;
    let flux = lumens(2.0 - absorbed, 0.038) + lumens(emitted, 0.631);
    assert_is(&found, "out.flux", flux);
    assert_is(&found, "balance.escaped.ball.surface", flux);
    let gained = lumens(emitted, 0.631) - lumens(absorbed, 0.038);
    let converted = &found.values["balance.converted.dye"];
    assert!((converted.value + gained).abs() <= 4.0 * converted.std_error, "{converted} {gained}");
    let residual = found.values["balance.residual"].value;
    assert!(residual.abs() < 1e-9 * flux, "{residual}");
}

/// Share of the light emitted in all directions at a distance from the middle of a ball that leaves it, both in mm, where light
/// is absorbed by the coefficient, 1/mm: the mean of `exp(-s/L)` over directions.
fn escaping(from: f64, radius: f64, absorption: f64) -> f64 {
    const DIRECTIONS: u32 = 400;
    let way_out = |step: u32| {
        let cos = 2.0 * (f64::from(step) + 0.5) / f64::from(DIRECTIONS) - 1.0;
        (radius * radius - from * from * (1.0 - cos * cos)).sqrt() - from * cos
    };
    let sum: f64 = (0..DIRECTIONS).map(|step| (-absorption * way_out(step)).exp()).sum();
    sum / f64::from(DIRECTIONS)
}

#[test]
fn light_is_emitted_where_it_was_absorbed() {
    const STEPS: u32 = 400;
    let absorbing =
        "index = 1\nabsorption_per_mm = { by_nm = [[440, 0], [590, 0], [600, 0.15], [610, 0]] }";
    let found = measures(&BALL.replace("index = 1", absorbing), 200_000);
    let (radius, dye) = (10.0, 0.1 * OPTICAL_RADIUS);
    let leaving = |step: u32| {
        let from = radius * (f64::from(step) + 0.5) / f64::from(STEPS);
        dye * (-dye * from).exp() * escaping(from, radius, 0.15)
    };
    let converted: f64 = (0..STEPS).map(leaving).sum::<f64>() * radius / f64::from(STEPS);
    let expected = 2.0 * ((-OPTICAL_RADIUS).exp() + YIELD * ENERGY * converted);
    assert_is(&found, "out.radiant_flux", expected);
}

#[test]
fn guided_light_is_absorbed_along_a_rod() {
    // Blue light at 40 degrees to the axis of a rod with black ends, from 1 mm within: the way through is 49/cos 40 degrees.
    let text = r#"
[media.dye]
index = 1.5
[media.dye.fluorescence]
absorption_per_mm = { by_nm = [[440, 0.02], [460, 0.02], [470, 0]] }
emission = { line_nm = 600 }
quantum_yield = 0.8
[solids.rod.cylinder]
radius_mm = 2
length_mm = 50
medium = "dye"
faces = { entry = "black", exit = "black" }
[finishes]
black = { absorber = {} }
[sources.beam.disk]
radius_mm = 1
at = { position_mm = [0, 0, 1], axis = [0.6427876096865393, 0, 0.7660444431189780] }
emission = "collimated"
contact = "optical"
flux_w = 1
spectrum = { line_nm = 450 }
"#;
    let found = measures(text, 200_000);
    let way = 49.0 / 40.0_f64.to_radians().cos();
    let absorbed = 1.0 - (-0.02 * way).exp();
    // The path through the dye is longer at one edge of the tilted disk and shorter at the other; their mean differs from
    // that of its middle by less than a thousandth.
    let heat = &found.values["balance.heat.dye"];
    let expected = absorbed * (1.0 - YIELD * ENERGY);
    assert!(
        (heat.value - expected).abs() < 4.0 * heat.std_error + 2e-3 * expected,
        "{heat} {expected}"
    );
}

#[test]
fn all_power_in_a_closed_mirror_becomes_heat_if_the_dye_absorbs_its_own_light() {
    // Far red light, which the eye hardly sees, is most of what is absorbed again.
    let broad = "emission = { peak = { peak_nm = 700, fwhm_nm = 100 } }";
    for (emission, quantum_yield) in [("emission = { line_nm = 600 }", 0.5), (broad, 0.87)] {
        let text = BALL
            .replace(
                "absorption_per_mm = { by_nm = [[440, 0.12], [460, 0.12], [470, 0]] }",
                "absorption_per_mm = 0.3",
            )
            .replace("medium = \"dye\"", "medium = \"dye\"\nfaces = { surface = \"mirror\" }")
            .replace("emission = { line_nm = 600 }", emission)
            .replace("quantum_yield = 0.8", &format!("quantum_yield = {quantum_yield}"));
        let mirror = "[finishes]\nmirror = { specular = { reflectance = 1 } }\n";
        let found = measures(&format!("{mirror}{text}"), 50_000);
        assert_is(&found, "balance.heat.dye", 2.0);
    }
}

/// A slab that scatters blue light more than red, lit by a lamp of two lines.
fn slab(source: &str, sensor: &str) -> String {
    format!(
        r#"
[media.haze]
index = 1
scattering = {{ per_mm = {{ by_nm = [[450, 0.4], [650, 0.1]] }}, anisotropy = 0.3 }}
[solids.slab.cylinder]
radius_mm = 20
length_mm = 5
medium = "haze"
[sources.lamp.disk]
at = {{ position_mm = [0, 0, -1] }}
flux_w = 1
spectrum = {{ sum = [
    {{ share = 0.5, spectrum = {{ line_nm = 450 }} }},
    {{ share = 0.5, spectrum = {{ line_nm = 650 }} }},
] }}
{source}
[sensors]
{sensor}
"#
    )
}

#[test]
fn the_beam_through_a_turbid_slab_loses_what_it_scatters_at_each_wavelength() {
    let text = slab(
        "radius_mm = 0.2\nemission = \"collimated\"",
        "far = { plane = { disk = { radius_mm = 0.3 } }, at = { position_mm = [0, 0, 3000], axis = [0, 0, -1] } }",
    );
    let found = measures(&text, 200_000);
    let passed = [0.4, 0.1].map(|per_mm: f64| 0.5 * (-per_mm * 5.0).exp());
    assert_is(&found, "far.radiant_flux", passed[0] + passed[1]);
    // CIE 1931: V(450 nm) = 0.038, V(650 nm) = 0.107.
    assert_is(&found, "far.flux", 683.002 * (0.038 * passed[0] + 0.107 * passed[1]));
}

#[test]
fn a_file_of_scattering_means_the_same_as_its_rows() {
    let dir = tempfile::tempdir().unwrap();
    let table = dir.path().join("haze.csv");
    std::fs::write(&table, "nm,scattering_per_mm\n450,0.4\n650,0.1\n").unwrap();
    let rows = slab("radius_mm = 4", "far = { goniometer = {} }");
    let file = rows.replace(
        "{ by_nm = [[450, 0.4], [650, 0.1]] }",
        &format!("{{ csv = {:?} }}", table.to_str().unwrap()),
    );
    assert_ne!(rows, file);
    let [of_rows, of_file] = [rows, file].map(|text| measures(&text, 20_000).values);
    assert_eq!(of_rows, of_file);
}

#[test]
fn a_medium_that_scatters_by_0_is_clear() {
    let scattering =
        "scattering = { per_mm = { by_nm = [[450, 0.4], [650, 0.1]] }, anisotropy = 0.3 }\n";
    let turbid = slab("radius_mm = 4", "far = { goniometer = {} }");
    let zero = "scattering = { per_mm = 0, anisotropy = 0.3 }\n";
    let [clear, by_0] = ["", zero].map(|instead| turbid.replace(scattering, instead));
    assert!(clear != turbid && by_0 != turbid);
    let [clear, by_0] = [clear, by_0].map(|text| measures(&text, 20_000).values);
    assert_eq!(clear, by_0);
}

#[test]
fn the_error_of_a_dark_sensor_allows_for_light_that_gains_by_conversion() {
    let dark = "dark = { plane = { disk = { radius_mm = 20 } }, at = { position_mm = [0, 0, -50], axis = [0, 0, -1] }, side = \"front\" }\n";
    let with_dye = format!("{BALL}{dark}");
    let (head, rest) = with_dye.split_once("[media.dye.fluorescence]").unwrap();
    let (_, rest) = rest.split_once("[solids").unwrap();
    let clear = format!("{head}[solids{rest}");
    let [converted, plain] =
        [with_dye, clear].map(|text| measures(&text, 20_000).values["dark.flux"].std_error);
    // Where nothing was counted, the error is the flux of one path: here of a converted one. CIE 1931: V(450 nm) = 0.038,
    // V(600 nm) = 0.631.
    let gain = YIELD * ENERGY * 0.631 / 0.038;
    assert!((converted / plain - gain).abs() < 1e-3 * gain, "{converted} {plain} {gain}");
}

#[test]
fn photons_and_gather_paths_see_the_same_colour_through_a_turbid_slab() {
    let text = slab(
        "radius_mm = 4",
        "above = { plane = { disk = { radius_mm = 5 } }, at = { position_mm = [0, 0, 8], axis = [0, 0, -1] } }",
    );
    let [photons, both] =
        [Request::Forward, Request::Mix].map(|own| measured_by(own, &text, 100_000));
    for name in ["above.flux", "above.radiant_flux", "above.colour_x", "above.colour_y"] {
        let [one, other] = [&photons, &both].map(|found| &found.values[name]);
        let error = one.std_error.hypot(other.std_error);
        assert!((one.value - other.value).abs() <= 4.0 * error, "{name}: {one}, {other}");
        assert!(error < 0.01 * one.value, "{name}: {one}, {other}");
    }
}
