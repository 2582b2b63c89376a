//! Spectra: what is refused, what is remarked, and what is reported.

use crate::{Place, errors};
use std::fs;

/// The rod with a spectrum on its lamp, and further lines.
fn lit_by(spectrum: &str, lines: &str) -> Place {
    let place = Place::with(lines);
    let scene = fs::read_to_string(place.path("rod.toml")).unwrap();
    let lit = scene.replace("flux_lm = 10", &format!("flux_lm = 10\nspectrum = {spectrum}"));
    fs::write(place.path("rod.toml"), lit).unwrap();
    place
}

#[test]
fn comparisons_are_refused_where_light_has_a_spectrum() {
    let place = lit_by("\"cie_a\"", "");
    let said = place
        .bad(2, "compare rod.toml --estimators forward,backward --sensor exit --time 1s -o out");
    assert!(said.contains("methods are compared without spectra"), "{said}");
    assert!(!place.names().contains(&"out".to_owned()));
    place.good("run rod.toml --estimator auto --paths 20k -o auto -q");
}

#[test]
fn records_of_broad_spectra_are_remarked() {
    for (spectrum, is_broad) in [("\"cie_a\"", true), ("{ line_nm = 600 }", false)] {
        let place = lit_by(spectrum, "");
        for estimator in ["gather", "mis"] {
            let command =
                format!("run rod.toml --estimator {estimator} --paths 20k -o {estimator}");
            let said = errors(&place.run(&command));
            let own = said.contains(&format!("`{estimator}` follows few wavelengths in a pass"));
            assert_eq!(own, is_broad, "{said}");
        }
    }
}

#[test]
fn only_photon_paths_compute_fluorescence_and_its_gain_is_remarked() {
    let place = Place::new();
    let scene = r#"
lumiduct = 1
title = "A dye"
[media.dye]
index = 1
fluorescence = { absorption_per_mm = { by_nm = [[440, 1], [470, 0]] }, emission = { line_nm = 560 }, quantum_yield = 0.9 }
[solids.ball.sphere]
radius_mm = 10
medium = "dye"
[sources.lamp.disk]
radius_mm = 1
at = { position_mm = [0, 0, -20] }
emission = "collimated"
flux_w = 1
spectrum = { line_nm = 440 }
[sensors]
out = { plane = {}, on = "ball.surface", counts = "leaving" }
"#;
    fs::write(place.path("dye.toml"), scene).unwrap();
    for estimator in ["backward", "mix"] {
        let said = place.bad(2, &format!("run dye.toml --estimator {estimator} -o out"));
        assert!(said.contains("cannot compute light that changes its wavelength"), "{said}");
    }
    assert!(!place.names().contains(&"out".to_owned()));
    place.good("run dye.toml --estimator auto --paths 20k -o out -q");
    let report = fs::read_to_string(place.path("out/report.md")).unwrap();
    assert!(report.contains("fluorescence emits more of them than it absorbs"), "{report}");
    assert!(report.contains("quantum yield 0.9"), "{report}");
}

#[test]
fn the_colour_and_the_spectrum_are_reported_and_a_red_has_no_colour_temperature() {
    let place = lit_by("{ csv = \"red.csv\" }", "");
    fs::write(place.path("red.csv"), "nm,relative\n610,0\n630,1\n650,0\n").unwrap();
    place.good("run rod.toml -o out -q");
    let values = fs::read_to_string(place.path("out/measures.csv")).unwrap();
    let line = |name: &str| values.lines().find(|line| line.starts_with(name)).unwrap().to_owned();
    assert!(line("exit.colour_temperature,").contains(",K,undefined,"), "{values}");
    assert!(line("exit.dominant_wavelength,").contains(",nm,ok,"), "{values}");
    let spectrum = fs::read_to_string(place.path("out/exit.spectrum.csv")).unwrap();
    let rows: Vec<Vec<f64>> = spectrum
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(|cell| cell.trim().parse().unwrap()).collect())
        .collect();
    assert_eq!((rows.len(), rows[0][0], rows[80][0]), (81, 380.0, 780.0));
    let watts: f64 = rows.iter().map(|row| 5.0 * row[1]).sum();
    let radiant: f64 = line("exit.radiant_flux,").split(',').nth(1).unwrap().parse().unwrap();
    assert!((watts / radiant - 1.0).abs() < 1e-9, "{watts} {radiant}");
    // Bands without light of the lamp are exactly dark.
    let is_lit = |row: &Vec<f64>| (607.5..652.5).contains(&row[0]);
    assert!(rows.iter().all(|row| [row[1] > 0.0, row[2] > 0.0] == [is_lit(row); 2]), "{rows:?}");
    assert!(fs::read(place.path("out/exit.spectrum.png")).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn what_a_table_or_the_library_leaves_open_is_a_remark() {
    let check = |spectrum: &str, index: &str| {
        let place = lit_by(spectrum, "");
        let output = place.run(&format!("check rod.toml -D media.acrylic.index={index}"));
        assert_eq!(crate::code(&output), 0, "{}", crate::errors(&output));
        crate::errors(&output)
    };
    for (spectrum, index, words) in [
        ("\"cie_d65\"", "{by_nm=[[450,1.50],[700,1.48]]}", "is outside of 450 to 700 nm"),
        ("{blackbody_k=3000}", "{library=\"pmma\"}", "where the index of `pmma` was measured"),
        ("{by_nm=[[300,1],[900,1]]}", "1.49", "32.50 % of its radiant flux is not visible"),
    ] {
        let said = check(spectrum, index);
        assert!(said.contains(words), "{words}: {said}");
    }
    assert_eq!(check("\"equal_energy\"", "1.49"), "");
    let place = Place::new();
    let dispersive = "check rod.toml -D media.acrylic.index={by_nm=[[400,1.50],[700,1.48]]}";
    let said = crate::errors(&place.run(dispersive));
    assert!(said.contains("no source has a spectrum: its value at 555 nm applies"), "{said}");
    let in_micrometres = "check rod.toml -D media.acrylic.index={by_nm=[[0.4,1.50],[0.7,1.48]]}";
    assert!(place.bad(2, in_micrometres).contains("0.4 to 0.7 nm does not include 555 nm"));
}

#[test]
fn luminaire_files_carry_the_colour_of_the_light() {
    let place = lit_by("\"cie_a\"", "");
    let text = |file: &str| {
        place.good(&format!("run rod.toml -o out --overwrite -q --ies {file}"));
        fs::read_to_string(place.path(file)).unwrap()
    };
    let ldt = text("a.ldt");
    let kelvin: f64 = ldt.lines().nth(29).unwrap().parse().unwrap();
    assert!((kelvin - 2856.0).abs() < 2.0, "{ldt}");
    assert_eq!(ldt.lines().nth(30), Some("100"));
    assert!(place.good("convert a.ldt").contains("colour rendering: 100"));
    assert!(text("a.ies").contains("[OTHER] colour temperature: 285"));
    let values = fs::read_to_string(place.path("out/measures.csv")).unwrap();
    for name in ["far.colour_rendering_ra,", "far.colour_rendering_r9,"] {
        let line = values.lines().find(|line| line.starts_with(name)).unwrap();
        let [index, error] =
            [1, 2].map(|at| line.split(',').nth(at).unwrap().parse::<f64>().unwrap());
        assert!((index - 100.0).abs() < 0.1 + 4.0 * error && error < 1.0, "{line}");
    }
}
