//! Fluxes adjusted by the surprises of choices: less noise, honest errors, and parts that still add up.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod traced;

use lumiduct_core::measure::{MapAxes, Measures};
use lumiduct_core::plan::Request;
use lumiduct_core::tally::Tally;
use lumiduct_input::{self as input, Settings};
use std::path::Path;

/// A small and a large source in front of a rod.
const ROD: &str = r#"
[media.pmma]
index = 1.49
absorption_per_mm = 0.004
[solids.rod.cylinder]
radius_mm = 1.5
length_mm = 20
medium = "pmma"
[sources.die.disk]
radius_mm = 0.5
at = { face = "rod.entry", gap_mm = 0.2 }
flux_lm = 2
[sources.lamp.disk]
radius_mm = 1.4
at = { face = "rod.entry", gap_mm = 0.3 }
flux_lm = 5
group = "lit"
[sensors]
exit = { plane = { cells = [5, 5] }, on = "rod.exit", counts = "leaving", entering = "rod.entry" }
far = { goniometer = { c_step_deg = 90, gamma_step_deg = 15 }, at = { face = "rod.exit" }, aim = ["rod.exit"] }
"#;

/// The same rod, with colours.
const COLOURED: &str = r#"
[media.pmma]
index = { sellmeier = [[1.03961212, 0.00600069867], [0.231792344, 0.0200179144], [1.01046945, 103.560653]] }
[solids.rod.cylinder]
radius_mm = 1.5
length_mm = 20
medium = "pmma"
[sources.die.disk]
radius_mm = 0.5
at = { face = "rod.entry", gap_mm = 0.2 }
flux_lm = 2
spectrum = "cie_d65"
[sensors]
exit = { plane = { cells = [2, 2] }, on = "rod.exit", counts = "leaving" }
"#;

fn measures(text: &str, (seed, paths): (u64, u64)) -> Measures {
    let settings = Settings {
        paths: Some(paths),
        estimator: Some(Request::Forward),
        seed: Some(seed),
        ..Settings::default()
    };
    traced::measures(&traced::load(text, &settings))
}

#[test]
fn errors_of_totals_are_those_found_over_seeds() {
    const SEEDS: u64 = 100;
    for (text, names) in [
        (
            ROD,
            &[
                "exit.flux",
                "exit.flux.from.lamp",
                "exit.transmission",
                "exit.bounces_mean",
                "far.flux",
            ][..],
        ),
        (COLOURED, &["exit.flux", "exit.colour_x", "exit.radiant_flux"][..]),
    ] {
        let runs: Vec<Measures> = (0..SEEDS).map(|seed| measures(text, (seed, 60_000))).collect();
        let spreads = names.iter().map(|name| {
            let own = runs.iter().map(|run| &run.values[*name]);
            let mean = Tally::of(own.clone().map(|own| own.value)).mean();
            let squares = own.map(|own| ((own.value - mean) / own.std_error).powi(2));
            (*name, (squares.sum::<f64>() / (SEEDS - 1) as f64).sqrt())
        });
        for (name, spread) in spreads {
            // The spread of a hundred is itself known to 7 %.
            assert!((0.8..1.2).contains(&spread), "{name}: {spread}");
        }
    }
}

#[test]
fn most_of_the_noise_of_choices_is_gone() {
    // B2 of the validation; as counted the error of a million paths is 7e-5.
    let settings = Settings {
        paths: Some(1_000_000),
        estimator: Some(Request::Forward),
        ..Settings::default()
    };
    let job = input::load(Path::new("scenes/validation/b2_l60.toml"), &settings).unwrap();
    let found = traced::measures(&job);
    let flux = &found.values["exit.flux"];
    assert!(flux.std_error < 3e-5, "{flux:?}");
    assert!((flux.value - 0.84190538).abs() < 4.0 * flux.std_error, "{flux:?}");
}

#[test]
fn cells_add_up_to_the_flux_and_maps_of_parts_to_the_map_of_all() {
    let found = measures(ROD, (1, 200_000));
    let [all, part] = [None, Some("lit")]
        .map(|light| found.maps.iter().find(|map| map.light.as_deref() == light).unwrap());
    let MapAxes::Cartesian { u_mm, v_mm } = &all.axes else { panic!("{:?}", all.axes) };
    let area = (u_mm[1] - u_mm[0]) * (v_mm[1] - v_mm[0]);
    let lit = all.values.iter().zip(&all.on_sensor).filter(|(_, on)| **on > 0.0);
    let of_cells: f64 = lit.map(|(value, on)| 1e-6 * value * on * area).sum();
    let flux = found.values["exit.flux"].value;
    assert!((of_cells / flux - 1.0).abs() < 1e-9, "{of_cells}, {flux}");
    let others = all.values.iter().zip(&part.values).filter(|(all, _)| **all > 0.0);
    assert!(others.clone().count() > 15);
    others.for_each(|(all, part)| assert!(part < all && *part > 0.3 * all, "{part}, {all}"));
    let parts = ["die", "lamp"].map(|own| found.values[&format!("exit.flux.from.{own}")].value);
    assert!((parts.iter().sum::<f64>() / flux - 1.0).abs() < 1e-12, "{parts:?}");
}

#[test]
fn colours_belong_to_the_flux() {
    let found = measures(COLOURED, (1, 400_000));
    let spectrum: f64 = 5.0 * found.spectra[0].values.iter().sum::<f64>();
    let radiant = found.values["exit.radiant_flux"].value;
    assert!((spectrum / radiant - 1.0).abs() < 1e-9, "{spectrum}, {radiant}");
}
