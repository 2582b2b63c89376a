//! Measured intensities from files.

use crate::measured::tests::{beam, goniometer, report};
use crate::measured::*;
use std::fmt::Write;

/// The list and the matrix of the goniometer in a report.
fn own_files() -> [String; 2] {
    let own = goniometer();
    let [c, gamma] = own.edges();
    let line = |numbers: &[f64]| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let mut list =
        "c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg,intensity_cd,std_error_cd\n".to_owned();
    for ((row, column), value) in own.cells.values.indexed_iter() {
        let ends = [c[column], c[column + 1], gamma[row], gamma[row + 1]];
        _ = writeln!(list, "{},{value},1", line(&ends));
    }
    let mut matrix = format!(
        "\u{feff}intensity in cd,c from in deg,{}\n,c to in deg,{}\ngamma from in deg,gamma to in deg{}\n",
        line(&c[..36]),
        line(&c[1..]),
        ",".repeat(36)
    );
    for (row, values) in own.cells.values.rows().into_iter().enumerate() {
        _ = writeln!(matrix, "{},{}", line(&gamma[row..row + 2]), line(&values.to_vec()));
    }
    [list, matrix]
}

/// The goniometer beside a measured file.
fn compare(text: &str) -> Result<MeasuredDiff> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("far.csv");
    std::fs::write(&path, text).unwrap();
    let tables = [MapTable::parse("far.intensity", &own_files()[0]).unwrap().unwrap()];
    let (options, mut remarks) = (MeasuredOptions::default(), Vec::new());
    let (computed, grid) = read_map(&path, &tables, &options, &mut remarks)?;
    compared(&report(), computed, &grid, "far.csv", &options, remarks)
}

/// A beam in directions; at the nadir in the first plane only.
fn directions(turned: f64, planes: impl Iterator<Item = u32>) -> String {
    let mut text = "c_deg,gamma_deg,intensity_cd\n".to_owned();
    let beam = beam(turned);
    for (place, c) in planes.map(f64::from).enumerate() {
        for gamma in (0..=36).map(|n| 5.0 * f64::from(n)).skip(usize::from(place > 0)) {
            _ = writeln!(text, "{c},{gamma},{}", beam.at(c, gamma));
        }
    }
    text
}

fn tens(to: u32) -> impl Iterator<Item = u32> {
    (0..=to / 10).map(|n| 10 * n)
}

#[test]
fn the_intensities_of_a_report_equal_themselves() {
    for text in own_files() {
        let same = compare(&text).unwrap();
        assert!(same.before.rms < 1e-9, "{:?}", same.before);
        assert!(same.shift.value[0].abs() < 1e-6 && same.after.rms_of_max < 1e-9);
        assert!((same.scale.unwrap().value - 1.0).abs() < 1e-9);
        assert!(same.remarks.is_empty(), "{:?}", same.remarks);
    }
}

#[test]
fn finer_cells_keep_their_flux_and_lists_that_end_early_are_remarked() {
    // Rings and sectors of 1°, from C = -90°.
    let mut text = "c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg,intensity_cd\n".to_owned();
    let beam = beam(0.0);
    for (gamma, c) in (0..180).flat_map(|gamma| (-90..270).map(move |c| (gamma, c))) {
        let value = beam.at(f64::from(c) + 0.5, f64::from(gamma) + 0.5);
        _ = writeln!(text, "{c},{},{gamma},{},{value}", c + 1, gamma + 1);
    }
    let found = compare(&text).unwrap();
    let [own, measured] = found.sides.map(|side| side.flux_lm.unwrap());
    assert!((measured / own - 1.0).abs() < 1e-3, "{measured} {own}");
    assert!(found.before.rms_of_max < 1e-3, "{:?}", found.before);
    let [list, matrix] = own_files();
    let short = |text: &str, lines: usize| text.lines().take(lines).collect::<Vec<_>>().join("\n");
    let said = compare(&short(&list, 1 + 30 * 36 + 10)).unwrap().remarks.join("\n");
    assert!(said.contains("206 of 1296 cells of far.intensity have no measured"), "{said}");
    let said = compare(&short(&matrix, 3 + 30)).unwrap().remarks.join("\n");
    assert!(said.contains("216 of 1296 cells"), "{said}");
}

#[test]
fn directions_are_read_like_those_of_a_luminaire_file() {
    // The plane at 360° may repeat the first.
    for last in [350, 360] {
        let found = compare(&directions(23.4, tens(last))).unwrap();
        assert!((found.shift.value[0] - 23.4).abs() < 0.05, "{:?}", found.shift);
        assert!((found.scale.unwrap().value - 1.0).abs() < 1e-3);
        assert!(found.remarks.is_empty(), "{:?}", found.remarks);
    }
    let whole = directions(0.0, tens(350));
    assert!(compare(&whole).unwrap().before.rms_of_max < 1e-9);
    let hole = whole.replace("\n100,50,", "\n100,50,nan\n100,50.0000001,");
    assert!(compare(&hole).err().unwrap().to_string().contains("a second value"));
    let hole: Vec<&str> = whole.lines().filter(|line| !line.starts_with("100,50,")).collect();
    let said = compare(&hole.join("\n")).unwrap().remarks.join("\n");
    assert!(said.contains("4 of 1296 cells"), "{said}");
    // Beyond the last angle nothing was measured.
    let upper = |line: &&str| {
        line.split(',').nth(1).and_then(|gamma| gamma.parse().ok()).is_none_or(|g: f64| g < 96.0)
    };
    let half: Vec<&str> = whole.lines().filter(upper).collect();
    let said = compare(&half.join("\n")).unwrap().remarks.join("\n");
    assert!(said.contains("612 of 1296 cells"), "{said}");
}

#[test]
fn directions_at_the_middles_of_cells_cover_the_poles() {
    let own = goniometer();
    let [c, gamma] = own.edges();
    let mut text = "c_deg,gamma_deg,intensity_cd\n".to_owned();
    for ((row, column), value) in own.cells.values.indexed_iter() {
        _ = writeln!(text, "{},{},{value}", c[column] + 5.0, gamma[row] + 2.5);
    }
    let found = compare(&text).unwrap();
    assert!(found.before.rms_of_max < 0.01, "{:?}", found.before);
    assert_eq!(found.before.cells, 1296);
}

#[test]
fn planes_of_a_symmetry_are_remarked_and_others_refused() {
    for (last, words) in [(0, "rotational"), (90, "four equal quadrants"), (180, "plane C0-C180")] {
        let said = compare(&directions(0.0, tens(last))).unwrap().remarks.join("\n");
        assert!(said.contains(words), "{last}: {said}");
    }
    let head = "c_from_deg,c_to_deg,gamma_from_deg,gamma_to_deg,intensity_cd\n";
    for (text, words) in [
        (directions(0.0, tens(40)), "far.csv:147: planes C from 0 to 40 deg are no circle"),
        (directions(0.0, tens(390)), "are more than a circle; give each plane once"),
        (
            "c_deg,gamma_deg,intensity_cd\n0,0,1\n0,90,-3\n".to_owned(),
            "far.csv:3: the value `-3` is below 0",
        ),
        (
            "c_deg,gamma_deg,intensity_cd\n0,0,1\n0,190,3\n".to_owned(),
            "far.csv:3: γ is 190 deg, expected 0 to 180 deg",
        ),
        ("c_deg,gamma_deg,intensity_W/sr\n0,0,1\n0,90,3\n".to_owned(), "far.intensity is in cd"),
        (format!("{head}0,180,0,9,1\n0,360,9,90,1\n"), "far.csv:3: the cell is not one step"),
        (format!("{head}0,360,0,9,1\n0,360,0,9,1\n0,360,9,90,1\n"), "far.csv:3: a second value"),
        (format!("{head}0,360,0,9,1\n0,360,9,190,1\n"), "far.csv:3: γ is 190 deg"),
        (format!("{head}0,360,0,9\n"), "far.csv:2: fewer than five cells"),
    ] {
        let said = compare(&text).err().unwrap().to_string();
        assert!(said.contains(words), "{text}: {said}");
    }
}
