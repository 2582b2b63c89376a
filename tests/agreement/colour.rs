//! Light with spectra: each estimator draws wavelengths in its own way and finds the same flux and the same colour.

use crate::sources::rod;
use crate::trial::{Gathering, Way, agree, measures, measures_of_paths};
use std::f64::consts::PI;

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

/// Photons meet only the records of their own band.
const WINDOW: Gathering = Gathering { records: 4000, photons: 8000, ..Gathering::to_depth(1) };

fn all_agree(what: &str, text: &str) {
    let merged = Gathering { records: 2000, photons: 4000, ..WINDOW };
    let gathered = [Way::Gather(WINDOW), Way::Merged(merged)];
    agree(what, text, &[&[Way::Forward, Way::Backward, Way::Mixed][..], &gathered].concat());
}

#[test]
fn a_lamp_before_a_rod_that_disperses_light() {
    let lamp = format!(
        "[sources.lamp.disk]\nradius_mm = 2\nflux_lm = 10\n{COLD}\nat = {{ position_mm = [0, 0, -1] }}"
    );
    all_agree("lamp with a spectrum", &coloured_rod(&lamp));
}

/// Each path meets layers at its own wavelength.
#[test]
fn a_lamp_before_a_dichroic_rod() {
    let lamp = format!(
        "[sources.lamp.disk]\nradius_mm = 2\nflux_lm = 10\n{COLD}\nat = {{ position_mm = [0, 0, -1] }}"
    );
    let pair = "{ index = { cauchy = [2.2, 0.03, 0.0] }, thickness_nm = 48 }, { index = 1.46, thickness_nm = 77 }";
    let filter = format!(
        "faces = {{ entry = \"filter\", exit = \"filter\" }}\n[finishes.filter.stack]\nlayers = [{pair}, {pair}, {pair}]\n[finishes.mirror]"
    );
    let bare = coloured_rod(&lamp);
    let text = bare.replace("[finishes.mirror]", &filter);
    assert_ne!(text, bare);
    all_agree("dichroic rod", &text);
}

/// The sheets behind and before a rod reflect and transmit by wavelength.
#[test]
fn a_lamp_before_coloured_sheets() {
    let lamp = format!(
        "[sources.lamp.disk]\nradius_mm = 2\nflux_lm = 10\n{COLD}\nat = {{ position_mm = [0, 0, -1] }}"
    );
    let warm = "{ by_nm = [[420, 0.1], [500, 0.3], [600, 0.8]] }";
    let blue = "{ by_nm = [[430, 0.5], [520, 0.2], [600, 0.0]] }";
    for scatter in [
        format!("specular = {{ reflectance = {warm} }}"),
        format!("lambertian = {{ reflectance = {warm}, transmittance = {blue} }}"),
        format!("gaussian = {{ sigma_deg = 20, reflectance = {blue}, transmittance = 0.3 }}"),
    ] {
        let grey = coloured_rod(&lamp);
        let text = grey.replace("specular = { reflectance = 0.9 }", &scatter);
        assert_ne!(text, grey);
        let sheet = "[sheets.front.disk]\nradius_mm = 6\nfinish = \"mirror\"\nat = { position_mm = [0, 0, 13] }\n[sensors]";
        all_agree(&scatter, &text.replace("[sensors]", sheet));
    }
}

/// Of a line as much is reflected and transmitted as the tables say at its wavelength.
#[test]
fn lines_meet_the_shares_of_their_wavelengths() {
    let beam = |nm: f64| {
        format!(
            "[sources.line_{nm}.disk]\nradius_mm = 1\nflux_lm = 1\nemission = \"collimated\"\nspectrum = {{ line_nm = {nm} }}\n"
        )
    };
    let text = [450.0, 600.0].map(beam).concat()
        + r#"
[finishes.filter.specular]
reflectance = { by_nm = [[400, 0.8], [500, 0.4], [700, 0.0]] }
transmittance = { by_nm = [[400, 0.1], [700, 0.7]] }
[sheets.filter.disk]
radius_mm = 3
finish = "filter"
at = { position_mm = [0, 0, 2] }
[sensors]
beyond = { plane = { disk = { radius_mm = 3 } }, at = { position_mm = [0, 0, 4], axis = [0, 0, -1] } }
before = { plane = { disk = { radius_mm = 3 } }, at = { position_mm = [0, 0, -1], axis = [0, 0, 1] } }
"#;
    let found = measures(&text, Way::Forward);
    for (nm, reflected, transmitted) in [(450, 0.6, 0.2), (600, 0.2, 0.5)] {
        for (sensor, expected) in [("before", reflected), ("beyond", transmitted)] {
            let own = &found.values[&format!("{sensor}.efficiency.from.line_{nm}")];
            // A line is 0.01 nm wide.
            let error = 4.0 * own.std_error + 1e-4;
            let off = (own.value - expected).abs();
            assert!(off < error && error < 0.02, "{sensor} {nm}: {own:?}, {expected}");
        }
    }
}

/// A film in air transmits 1/(1 + F sin²(2π n d/λ)) of a normal beam, F = ((n² - 1)/(2n))² (Born & Wolf, 7th ed., 7.6.1).
#[test]
fn lines_pass_a_film_by_their_wavelengths() {
    let lines = [450.0, 600.0];
    let beam = |nm: f64| {
        format!(
            "[sources.line_{nm}.disk]\nradius_mm = 1\nflux_lm = 1\nemission = \"collimated\"\nspectrum = {{ line_nm = {nm} }}\n"
        )
    };
    let text = lines.map(beam).concat()
        + r#"
[finishes.film.stack]
layers = [{ index = 2.3, thickness_nm = 300 }]
[sheets.film.disk]
radius_mm = 3
finish = "film"
at = { position_mm = [0, 0, 2] }
[sensors]
beyond = { plane = { disk = { radius_mm = 3 } }, at = { position_mm = [0, 0, 4], axis = [0, 0, -1] } }
"#;
    let found = measures(&text, Way::Forward);
    for nm in lines {
        let phase = 2.0 * PI * 2.3 * 300.0 / nm;
        let expected = 1.0 / (1.0 + (4.29f64 / 4.6).powi(2) * phase.sin().powi(2));
        let own = &found.values[&format!("beyond.efficiency.from.line_{nm}")];
        let error = 4.0 * own.std_error + 1e-4;
        assert!((own.value - expected).abs() < error && error < 0.02, "{nm}: {own:?}, {expected}");
    }
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
    let ways = [Way::Forward, Way::Mixed, Way::Merged(WINDOW)];
    agree("lamps in a white box", &text, &ways);
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

/// u' and v' of 546.1 and 589.3 nm, from the colour matching functions of CIE 1931 (CIE 018:2019, table 6), linear in between.
const GREEN_UV: [f64; 2] = [0.098_966, 0.583_708];
const SODIUM_UV: [f64; 2] = [0.326_388, 0.550_879];
const SODIUM: &str = "spectrum = { line_nm = 589.3 }";

/// Two beams, each on a cell of its own: the cells have exactly the colours of the beams, and the mean lies between.
#[test]
fn cells_have_the_colours_of_their_beams() {
    let beam = |name: &str, x: f64, flux: f64, spectrum: &str| {
        format!(
            "[sources.{name}.disk]\nradius_mm = 1\nflux_lm = {flux}\n{spectrum}\nemission = {{ cone_half_angle_deg = 10 }}\nat = {{ position_mm = [{x}, 0, 0] }}\n"
        )
    };
    let text = beam("green", -2.0, 3.0, LINE)
        + &beam("sodium", 2.0, 1.0, SODIUM)
        + "[sensors]\nwall = { plane = { rectangle = { width_mm = 8, height_mm = 8 }, cells = [2, 1] }, at = { position_mm = [0, 0, 5], axis = [0, 0, -1], x_axis = [1, 0, 0] } }\n\
           far = { goniometer = { c_step_deg = 90, gamma_step_deg = 30 } }\n";
    // So many that over a thousand gather paths meet each beam: fewer do not exclude some light of the other colour.
    const PATHS: u64 = 8_000_000;
    for (way, paths) in [(Way::Forward, 150_000), (Way::Backward, PATHS), (Way::Mixed, PATHS)] {
        let found = measures_of_paths(&text, way, paths);
        let colours = found.maps[0].colours.as_ref().unwrap();
        let of = |cell: usize| [colours.u[[0, cell]], colours.v[[0, cell]]];
        for (cell, expected) in [GREEN_UV, SODIUM_UV].into_iter().enumerate() {
            for (own, expected) in of(cell).into_iter().zip(expected) {
                assert!((own - expected).abs() < 1e-5, "{} {cell}: {own}", way.name());
            }
            // A line is 0.01 nm wide.
            let error = colours.u_std_errors[[0, cell]];
            assert!(error < 1e-5, "{}: {error}", way.name());
        }
        // The colours are 0.229 779 apart, and the first has 0.738 990 of X + 15Y + 3Z.
        for (end, expected) in [("", 0.169_805), ("_rms", 0.100_916)] {
            let own = &found.values[&format!("wall.colour_nonuniformity{end}")];
            let error = 4.0 * own.std_error + 1e-5;
            assert!(
                (own.value - expected).abs() < error && error < 0.03,
                "{}: {own:?}",
                way.name()
            );
        }
    }
}

/// Illuminance from a Lambertian point at one end of a square tube of perfect mirrors, 6 mm wide and 3 mm long, in 4 x 4 cells of the other: the
/// sum of I cos θ / d² = Φ L² / (π (L² + r²)²) over the images, per lm, as shares of the light.
fn kaleidoscope([x, y]: [f64; 2]) -> Vec<f64> {
    const PARTS: i32 = 24;
    let image = |own: f64, m: i32| 6.0 * f64::from(m) + if m % 2 == 0 { own } else { -own };
    let mut cells = vec![0.0; 16];
    for (row, column) in (0..PARTS).flat_map(|row| (0..PARTS).map(move |column| (row, column))) {
        let [u, v] = [column, row].map(|at| 6.0 * (f64::from(at) + 0.5) / f64::from(PARTS) - 3.0);
        let images = (-40..=40).flat_map(|m| (-40..=40).map(move |n| (m, n)));
        let sum: f64 = images
            .map(|(m, n)| {
                let square: f64 = (image(x, m) - u).powi(2) + (image(y, n) - v).powi(2);
                9.0 / (PI * (9.0 + square).powi(2))
            })
            .sum();
        cells[(row / 6 * 4 + column / 6) as usize] += sum * 36.0 / f64::from(PARTS * PARTS);
    }
    // Farther images light all cells alike.
    let rest = (1.0 - cells.iter().sum::<f64>()) / 16.0;
    cells.into_iter().map(|own| own + rest).collect()
}

#[test]
fn a_mirrored_tube_mixes_colours_as_its_images_do() {
    let point = |name: &str, [x, y]: [f64; 2], spectrum: &str| {
        format!(
            "[sources.{name}.point]\nflux_lm = 1\n{spectrum}\nemission = \"lambertian\"\nat = {{ position_mm = [{x}, {y}, 0] }}\n"
        )
    };
    let places = [[-1.5, 0.5], [2.0, -1.0]];
    let text = "[finishes.mirror]\nspecular = { reflectance = 1 }\n[sheets.tube.tube]\nprofile = { rectangle = { width_mm = 6, height_mm = 6 } }\n\
        path = [{ straight_mm = 3 }]\nfinish = \"mirror\"\n"
        .to_owned()
        + &point("green", places[0], LINE)
        + &point("sodium", places[1], SODIUM)
        + "[sensors]\nexit = { plane = { cells = [4, 4] }, on = \"tube.exit\", counts = \"leaving\" }\n";
    let lights = places.map(kaleidoscope);
    let sums = [GREEN_UV, SODIUM_UV].map(|[_, v]| 9.0 / v);
    // The colour of a mixture by X + 15Y + 3Z, 9Y/v' of each light.
    let mixed = |shares: [f64; 2]| -> [f64; 2] {
        let [a, b] = [shares[0] * sums[0], shares[1] * sums[1]];
        [0, 1].map(|place| (a * GREEN_UV[place] + b * SODIUM_UV[place]) / (a + b))
    };
    let expected: Vec<[f64; 2]> =
        (0..16).map(|cell| mixed([lights[0][cell], lights[1][cell]])).collect();
    let weight = |cell: usize| lights[0][cell] * sums[0] + lights[1][cell] * sums[1];
    let mean = mixed([1.0, 1.0]);
    let square = |cell: usize| -> f64 {
        expected[cell].iter().zip(mean).map(|(own, mean)| (own - mean).powi(2)).sum()
    };
    let largest = (0..16).map(square).fold(0.0, f64::max).sqrt();
    let rms = ((0..16).map(|cell| weight(cell) * square(cell)).sum::<f64>()
        / (0..16).map(weight).sum::<f64>())
    .sqrt();
    // A path from a sensor cannot meet a point.
    for way in [Way::Forward, Way::Mixed] {
        let found = measures(&text, way);
        let colours = found.maps[0].colours.as_ref().unwrap();
        let both = [(&colours.u, &colours.u_std_errors), (&colours.v, &colours.v_std_errors)];
        let scores = both.into_iter().enumerate().flat_map(|(place, (values, errors))| {
            let cells = values.iter().zip(errors).zip(&expected);
            cells.map(move |((value, error), expected)| (value - expected[place]) / error)
        });
        let scores: Vec<f64> = scores.collect();
        let rms_score = (scores.iter().map(|z| z * z).sum::<f64>() / 32.0).sqrt();
        let worst = scores.iter().fold(0.0f64, |worst, z| worst.max(z.abs()));
        // u' and v' of mixtures of two lights move together: 16 independent scores, whose mean square has a deviation of 0.35.
        assert!(worst < 4.0 && (0.3..1.6).contains(&rms_score), "{}: {scores:?}", way.name());
        for (end, expected) in [("", largest), ("_rms", rms)] {
            let own = &found.values[&format!("exit.colour_nonuniformity{end}")];
            let score = (own.value - expected) / own.total_error();
            assert!(
                score.abs() < 4.0 && own.total_error() < 0.03 * expected,
                "{expected}: {own:?}"
            );
        }
    }
}

#[test]
fn estimators_find_the_same_colours_in_cells() {
    let lamp = |name: &str, x: f64, spectrum: &str| {
        format!(
            "[sources.{name}.disk]\nradius_mm = 0.8\nflux_lm = 4\n{spectrum}\nat = {{ position_mm = [{x}, 0, -1] }}\n"
        )
    };
    let text = coloured_rod(&(lamp("cold", -1.5, COLD) + &lamp("red", 1.5, RED)))
        .replace("cells = [2, 1]", "cells = [6, 5]");
    let ways = [Way::Forward, Way::Backward, Way::Mixed, Way::Gather(WINDOW)];
    let all = ways.map(|way| measures(&text, way));
    let [forward, others @ ..] = &all;
    let expected = forward.maps[0].colours.as_ref().unwrap();
    for found in others {
        let own = found.maps[0].colours.as_ref().unwrap();
        let pairs = [
            ((&own.u, &own.u_std_errors), (&expected.u, &expected.u_std_errors)),
            ((&own.v, &own.v_std_errors), (&expected.v, &expected.v_std_errors)),
        ];
        for ((values, errors), (reference, their_errors)) in pairs {
            let scores: Vec<f64> = (values.iter().zip(errors))
                .zip(reference.iter().zip(their_errors))
                .filter(|((value, _), _)| value.is_finite())
                .map(|((value, error), (other, their))| (value - other) / error.hypot(*their))
                .collect();
            let rms = (scores.iter().map(|z| z * z).sum::<f64>() / scores.len() as f64).sqrt();
            let worst = scores.iter().fold(0.0f64, |worst, z| worst.max(z.abs()));
            // Both coordinates of up to 30 cells: a mean square is known to a quarter.
            assert!(scores.len() > 20 && worst < 4.0 && rms < 1.5, "rms {rms}, worst {worst}");
        }
    }
}
