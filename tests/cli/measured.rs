//! A report beside a measured file.

use crate::*;
use std::fmt::Write;

/// A report with a finer map, 8 by 8 cells, and a goniometer with a luminaire file.
fn with_report() -> Place {
    let place = Place::with("");
    let scene = fs::read_to_string(place.path("rod.toml")).unwrap();
    let scene = scene.replace("cells = [4, 4]", "cells = [8, 8]");
    fs::write(place.path("rod.toml"), scene).unwrap();
    place.good("run rod.toml -q -o a --ies far.ies");
    place
}

/// The map of the report as columns, moved and scaled.
fn moved(place: &Place, shift_mm: f64, scale: f64) -> String {
    let mut table = csv::Reader::from_path(place.path("a/exit.illuminance.csv")).unwrap();
    let mut text = "x_mm,y_mm,e_lx\n".to_owned();
    for row in table.records().map(Result::unwrap) {
        let [x, y, value] = [0, 1, 2].map(|at| row[at].parse::<f64>().unwrap());
        _ = writeln!(text, "{},{y},{}", x + shift_mm, scale * value);
    }
    text
}

#[test]
fn a_map_beside_its_own_table_is_equal_in_every_form() {
    let place = with_report();
    for file in ["a/exit.illuminance.csv", "a/exit.illuminance.matrix.csv"] {
        let said = place.good(&format!("diff a {file} --max-difference 0.1%"));
        for words in [
            "measured values are 1.000 ± ",
            "rms difference 0.00 % of the maximum",
            "within the limit of 0.10 %",
            "uniformity min/mean: computed",
        ] {
            assert!(said.contains(words), "no {words} in {said}");
        }
    }
    for file in ["a/far.intensity.csv", "a/far.intensity.matrix.csv"] {
        let said = place.good(&format!("diff a {file} --max-difference 0.1%"));
        for words in ["measured values are 1.0", "rms difference 0.00 %", "flux: computed"] {
            assert!(said.contains(words), "no {words} in {said}");
        }
    }
    fs::write(place.path("m.csv"), moved(&place, 0.0, 0.8)).unwrap();
    let said = place.good("diff a m.csv -o d --junit d.xml");
    assert!(said.contains("measured values are 0.80"), "{said}");
    assert!(said.contains("no limit was given") && said.contains("report: d/diff.html"), "{said}");
    assert_eq!(
        names(&place.path("d")),
        [
            "diff.csv",
            "diff.html",
            "diff.md",
            "exit.illuminance.cells.csv",
            "exit.illuminance.computed.png",
            "exit.illuminance.difference.png",
            "exit.illuminance.difference_before.png",
            "exit.illuminance.measured.png",
            "exit.illuminance.section_a.png",
            "exit.illuminance.section_b.png",
            "manifest.json"
        ]
    );
    assert!(fs::read_to_string(place.path("d.xml")).unwrap().contains("no limit was given"));
    let page = fs::read_to_string(place.path("d/diff.html")).unwrap();
    assert!(page.contains("scale: the measured values are 0.8") && page.contains("alignment: "));
    // The same comparison gives the same bytes; another needs --overwrite.
    place.good("diff a m.csv -q -o d");
    assert!(place.bad(2, "diff a m.csv --no-scale -o d").contains("--overwrite"));
    place.good("diff a m.csv -q --no-scale -o d --overwrite");
    // A scale that is not applied is a difference.
    let output = place.run("diff a m.csv --no-scale --no-align --max-difference 5% --junit d.xml");
    let said = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(code(&output), 1, "{said}");
    for words in ["alignment: none applied", "scale: not applied", "beyond the limit of 5.00 %"] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    assert!(fs::read_to_string(place.path("d.xml")).unwrap().contains("type=\"beyond\""));
}

#[test]
fn a_luminaire_file_of_the_report_is_equal_within_its_errors() {
    let place = with_report();
    let said = place.good("diff a far.ies --sensor far --max-difference 5%");
    assert!(
        said.contains("alignment: ")
            && said.contains("flux: computed")
            && said.contains("beam angle C0-C180"),
        "{said}"
    );
}

#[test]
fn what_does_not_fit_is_refused_with_a_hint() {
    let place = with_report();
    fs::write(place.path("numbers.csv"), "1 2\n3 4\n").unwrap();
    fs::write(place.path("narrow.csv"), "x_mm,y_mm,e_lx\n0,0,1\n0.1,0,1\n0,0.1,1\n").unwrap();
    fs::write(place.path("words.csv"), "x_mm,y_mm,e_lx\n0,0,much\n").unwrap();
    fs::write(place.path("candela.csv"), "x_mm,y_mm,l_cd/m2\n0,0,1\n1,0,1\n0,1,1\n").unwrap();
    fs::write(place.path("broken.ies"), "IESNA:LM-63-2002\n").unwrap();
    for (arguments, words) in [
        ("diff a nowhere.csv", "nowhere.csv: the file cannot be read"),
        ("diff a nowhere.ies", "nowhere.ies"),
        ("diff numbers.csv a", "is not a folder"),
        (
            "diff a numbers.csv",
            "without its size; add the line `# width_mm = ...`, or use --width-mm",
        ),
        ("diff a numbers.csv --width-mm 0 --height-mm 2", "above 0"),
        ("diff a narrow.csv", "check its size and places"),
        ("diff a words.csv", "words.csv:2: `much` is not a finite number"),
        ("diff a candela.csv", "values are in `cd/m2`, but exit.illuminance is in lx"),
        ("diff a broken.ies", "broken.ies"),
        ("diff a far.ies --sensor exit", "--sensor exit: the report has no such intensities"),
        ("diff a far.ies --width-mm 3", "not for a luminaire"),
        ("diff a far.ies --sigmas 3", "--sigmas is for two reports"),
        ("diff a far.ies --maps", "--maps is for two reports"),
        ("diff a far.ies --all", "--all is for two reports"),
        ("diff a far.ies --only far", "--only is for two reports"),
        ("diff a a --sensor far", "--sensor is for a measured file"),
        ("diff a a --max-difference 3%", "--max-difference is for a measured file"),
        ("diff a a --no-align", "--no-align is for a measured file"),
        ("diff a far.ies -o a", "is one of the reports"),
        ("diff a far.ies --max-difference 3", "percentage"),
    ] {
        let said = place.bad(2, arguments);
        assert!(said.contains(words), "{arguments}: {said}");
    }
    for (text, words) in [
        (&b"c_from_deg,c_to_deg\n0,1\n"[..], "m.csv:1: not a map"),
        (b"sector_deg,radius_mm,e_lx\n0,1,2\n", "m.csv:1: a map of rings"),
        (
            b"x_mm,y_mm,luminance_cd_m2\n0,0,1\n1,0,1\n0,1,1\n",
            "m.csv:1: the values are in `cd/m\u{b2}`, but exit",
        ),
        (
            b"c_deg,gamma_deg,i_cd\n0,0,1\n0,181,1\n",
            "m.csv:3: \u{3b3} is 181 deg, expected 0 to 180 deg",
        ),
        (b"x_mm,y_mm,e_lx\n0,0,1\n1,1,2\n2,2,3\n", "m.csv:2: the 3 points"),
        (b"1 2 3\n", "m.csv:1: the values from here on make 3 columns and 1 row"),
        (b"1\n2\n", "m.csv:1: the values from here on make 1 column and 2 rows"),
        (b"x_mm,y_mm,e_lx\n0,0,-5\n", "m.csv:2: the value `-5` is below 0; set readings"),
        (b"x_mm,y_mm,e_lx\n0,0,\xb5\n", "m.csv:2: not UTF-8 text; save the file"),
    ] {
        fs::write(place.path("m.csv"), text).unwrap();
        let said = place.bad(2, "diff a m.csv");
        assert!(said.contains(words), "{said}");
    }
    // The end is missing.
    let whole = moved(&place, 0.0, 1.0);
    let cells = whole.lines().count() - 1;
    let short: Vec<&str> = whole.lines().take(1 + cells - 13).collect();
    fs::write(place.path("m.csv"), short.join("\n")).unwrap();
    let said = place.good("diff a m.csv");
    let remark = format!("remark: 13 of {cells} cells of exit.illuminance have no measured value");
    assert!(said.contains(&remark), "{said}");
}
