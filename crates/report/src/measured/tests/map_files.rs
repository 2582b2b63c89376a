//! Measured maps from files.

use crate::measured::tests::{computed, field, grid, outcome};
use crate::measured::*;
use lumiduct_files::measured::FirstRow;
use std::fmt::Write;

/// The cells of a file with this text.
fn cells(text: &str, place: MatrixPlace) -> Result<MeasuredGrid> {
    let refuse = |error| refused(Path::new("m.csv"), error);
    let map = measured::parse(text.as_bytes()).map_err(refuse)?;
    expect_place(&map.values, place).map_err(refuse)?;
    match map.values {
        MeasuredValues::Matrix(matrix) => placed(matrix, place).map_err(refuse),
        MeasuredValues::Surface(grid)
        | MeasuredValues::Image(grid)
        | MeasuredValues::Sphere(grid) => Ok(grid),
        MeasuredValues::Directions(_) => panic!("no cells"),
    }
}

#[test]
fn a_matrix_has_the_size_and_first_row_of_the_file_or_of_the_options() {
    let sized = "# width_mm = 2\n# height_mm = 4\n3 4\n1 2,5\n";
    let plain = "3 4\n1 2,5\n";
    let size = MatrixPlace { width_mm: Some(2.0), height_mm: Some(4.0), first_row: None };
    let bottom = MatrixPlace { first_row: Some(FirstRow::Bottom), ..Default::default() };
    let upward = sized.replace("3 4\n1 2,5", "# rows = bottom\n1;2,5\n3;4");
    for (text, place) in [
        (sized, MatrixPlace::default()),
        (plain, size),
        (sized, size),
        (&upward, MatrixPlace::default()),
        (&upward, bottom),
        (&sized.replace("3 4\n1 2,5", "1 2.5\n3 4"), bottom),
    ] {
        let grid = cells(text, place).unwrap();
        assert_eq!((&grid.x[..], &grid.y[..]), (&[-1.0, 0.0, 1.0][..], &[-2.0, 0.0, 2.0][..]));
        assert_eq!(grid.values, ndarray::array![[1.0, 2.5], [3.0, 4.0]], "{text}");
    }
    let top = MatrixPlace { first_row: Some(FirstRow::Top), ..Default::default() };
    let wider = MatrixPlace { width_mm: Some(3.0), ..Default::default() };
    let places = "x_mm,y_mm,e_lx\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n";
    for (text, place, words) in [
        (plain, MatrixPlace::default(), "m.csv: a matrix of numbers without its size"),
        (plain, wider, "m.csv: a matrix of numbers without its size; add the line `# height_mm"),
        ("# width_mm = 1\n1 2\n3 4\n", MatrixPlace::default(), "or use --height-mm"),
        (sized, wider, "m.csv:1: width_mm is 2 here, but 3 in --width-mm"),
        (&upward, top, "m.csv:3: `# rows = ...` of the file and --rows differ"),
        (places, top, "m.csv: the file gives its own places"),
        ("# width_mm = 1\n# height_mm = 1\n1 2\n3 x\n", wider, "m.csv:4: `x` is not"),
    ] {
        let said = cells(text, place).unwrap_err().to_string();
        assert!(said.starts_with(words) || said.ends_with(words), "{text:?}: {said}");
    }
}

#[test]
fn units_and_places_that_do_not_fit_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let table = |name: &str| {
        let mut text = "u_mm,v_mm,illuminance_lx,std_error_lx\n".to_owned();
        for (x, y) in (0..36).map(|n| (f64::from(n % 6), f64::from(n / 6))) {
            _ = writeln!(text, "{x},{y},{},1", field(x, y));
        }
        MapTable::parse(name, &text).unwrap().unwrap()
    };
    let tables = [table("exit.illuminance"), table("exit.illuminance.from_red")];
    let said = |text: &str, options: &MeasuredOptions| -> String {
        let path = dir.path().join("m.csv");
        std::fs::write(&path, text).unwrap();
        let read = read_map(&path, &tables, options, &mut Vec::new());
        read.map_or_else(|error| error.to_string(), |(computed, _)| computed.name)
    };
    let measured = "x_mm,y_mm,e_lx\n0,0,1\n1,1,2\n0,1,3\n1,0,3\n";
    let none = MeasuredOptions::default();
    let sensor =
        |name: &str| MeasuredOptions { sensor: Some(name.to_owned()), ..Default::default() };
    assert_eq!(said(measured, &none), "exit.illuminance");
    let red = sensor("exit.illuminance.from_red");
    assert_eq!(said(measured, &red), "exit.illuminance.from_red");
    assert!(said(measured, &sensor("exi")).contains("--sensor exi"));
    assert!(said(&measured.replace("e_lx", "l_cd/m2"), &none).contains("are in `cd/m2`"));
    let luminance = said(&measured.replace("e_lx", "luminance_cd_m2"), &none);
    assert!(luminance.contains("m.csv:1: the values are in `cd/m²`, but exit"), "{luminance}");
    let commented = said(&format!("# a\n# unit = cd\n{measured}"), &none);
    assert!(commented.contains("m.csv:2: the values are in `cd`"), "{commented}");
    assert!(
        said(&measured.replace("x_mm,y_mm", "u_deg,v_deg"), &none)
            .contains("no map with places in degrees")
    );
    let place = MatrixPlace { width_mm: Some(1.0), ..Default::default() };
    assert!(said(measured, &MeasuredOptions { place, ..none }).contains("own places"));
    let bad = said(&measured.replace("1,1,2", "1,1,x"), &MeasuredOptions::default());
    assert!(bad.ends_with("m.csv:3: `x` is not a finite number"), "{bad}");
    std::fs::remove_file(dir.path().join("m.csv")).unwrap();
    let gone = dir.path().join("m.csv");
    let gone = read_map(&gone, &tables, &MeasuredOptions::default(), &mut Vec::new());
    assert!(gone.err().unwrap().to_string().contains("m.csv: the file cannot be read"));
}

#[test]
fn missing_values_and_a_file_cut_short_are_remarked() {
    let whole = grid([8.0, 6.0], field);
    let row = |((row, column), value): ((usize, usize), &f64)| {
        format!("{},{},{value}", whole.x[column] + 0.5, whole.y[row] + 0.5)
    };
    let rows: Vec<String> = whole.values.indexed_iter().map(row).collect();
    let remarks = |rows: &[String]| {
        let text = format!("x_mm,y_mm,e_lx\n{}\n", rows.join("\n"));
        let measured = cells(&text, MatrixPlace::default()).unwrap();
        let options = MeasuredOptions { no_align: true, ..Default::default() };
        outcome(computed([8.0, 6.0], field, 2.0), &measured, &options).remarks.join("\n")
    };
    assert_eq!(remarks(&rows), "");
    let said = remarks(&rows[..150]);
    assert!(said.starts_with("42 of 192 cells of exit.illuminance have no measured"), "{said}");
    let said = remarks(&rows[..144]);
    assert!(said.starts_with("48 of 192 cells"), "whole rows: {said}");
    let mut holes = rows.clone();
    for (at, nothing) in [(5, "nan"), (50, ""), (100, "NaN")] {
        let (place, _) = rows[at].rsplit_once(',').unwrap();
        holes[at] = format!("{place},{nothing}");
    }
    let said = remarks(&holes);
    assert!(said.starts_with("3 of 192 cells") && said.ends_with("are left out"), "{said}");
    holes[5].clone_from(&rows[5]);
    holes[50].clone_from(&rows[50]);
    let said = remarks(&holes);
    assert!(said.starts_with("1 of 192 cells of exit.illuminance has no measured"), "{said}");
}
