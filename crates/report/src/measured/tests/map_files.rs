//! Measured maps from files.

use crate::measured::tests::{computed, field, grid, outcome};
use crate::measured::*;
use std::fmt::Write;

fn read_text(text: &str) -> Result<MeasuredMap> {
    measured_map(&TextTable::parse("m.csv".to_owned(), text)?, MatrixPlace::default())
}

#[test]
fn every_form_of_a_map_gives_the_same_cells() {
    let matrix = "# width_mm = 2\n# height_mm = 4\n# unit = lx\n3 4\n1 2,5\n";
    let forms = [
        matrix.to_owned(),
        matrix.replace("3 4\n1 2,5", "# rows = bottom\n1;2,5\n3;4"),
        "x_mm,y_mm,e_lx\n-0.5,-1,1\n0.5,-1,2.5\n-0.5,1,3\n0.5,1,4\n".to_owned(),
        "u_mm,v_mm,e_lx,std_error_lx\n0.5,1,4,9\n-0.5,1,3,9\n0.5,-1,2.5,9\n-0.5,-1,1,9\n".to_owned(),
        "\u{feff}e in lx,u from in mm,-1,0\n,u to in mm,0,1\nv from in mm,v to in mm,,\n0,2,3,4\n-2,0,1,2.5\n"
            .to_owned(),
    ];
    for text in forms {
        let map = read_text(&text).unwrap();
        let grid = cells(&map);
        assert_eq!((&grid.x[..], &grid.y[..]), (&[-1.0, 0.0, 1.0][..], &[-2.0, 0.0, 2.0][..]));
        assert_eq!(grid.values, ndarray::array![[1.0, 2.5], [3.0, 4.0]], "{text}");
        assert_eq!(map.unit.as_deref(), Some("lx"));
        assert_eq!(map.values.comparable(), Comparable::Surfaces);
    }
}

#[test]
fn what_is_no_map_is_refused_with_its_line() {
    for (text, words) in [
        ("", "no values"),
        ("1 2\n3 4\n", "without its size"),
        ("# width_mm = 1\n1 2\n3 4\n", "--height-mm"),
        ("# width_mm = -1\n# height_mm = 1\n1 2\n3 4\n", "m.csv:1: width_mm is not above 0"),
        ("# width_mm = 1\n# height_mm = 1\n1 2\n3\n", "m.csv:4: 1 cells"),
        ("# width_mm = 1\n# height_mm = 1\n1 2\n3 x\n", "m.csv:4: `x` is not"),
        ("# width_mm = 1\n# height_mm = 1\n# rows = up\n1 2\n3 4\n", "m.csv:3: rows must"),
        ("# width_mm = 1\n# height_mm = 1\n0 0\n0 0\n", "zero or missing"),
        ("# width_mm = 1\n# height_mm = 1\n1 2\n", "2 by 1 values"),
        ("a,b,c\n1,2,3\n", "m.csv:1: not a map"),
        ("sector_deg,radius_mm,e\n0,0,1\n", "rings"),
        (
            "e in lx,sector from in deg,0\n,sector to in deg,360\n,,\n0,1,5\n",
            "m.csv:1: a map of rings",
        ),
        ("c_from_deg,c_to_deg,gamma_from_deg\n0,0,1\n", "m.csv:1: not a map"),
        (
            "x_mm,y_mm,e_lx\n0,0,1\n1,0,-100000\n0,1,3\n1,1,3\n",
            "m.csv:3: the value `-100000` is below 0; set readings below the dark level to 0",
        ),
        ("# width_mm = 1\n# height_mm = 1\n1 2\n3 -4\n", "m.csv:4: the value `-4` is below 0"),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n,,,\n0,2,3,-1\n-2,0,1,2\n",
            "m.csv:4: the value `-1` is below 0",
        ),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n,,,\n3,4,3,1\n-2,0,1,2\n",
            "m.csv:4: the row does not begin where its neighbour ends",
        ),
        ("x_mm,y_mm,e_lx\n0,0,1\n1,1,2\n2,2,3\n", "no rows and columns"),
        ("x_mm,y_mm,e_lx\n0,0,1\n1,1,2\n0,1,3\n1,1,3\n", "m.csv:5: a second value"),
        ("x_mm,y_mm,e_lx\n0,0\n", "m.csv:2: fewer than three"),
        (
            "e in lx,u from in mm,-1,0\n,u to in mm,0,1\n,,,\n0,2,3\n-2,0,1,2\n",
            "do not fit together",
        ),
        ("e in lx,u from in mm\n,u to in mm\n,,\n0,2\n-2,0\n", "0 by 2 values"),
    ] {
        let said = read_text(text).err().unwrap().to_string();
        assert!(said.contains(words), "{text:?}: {said}");
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
    assert!(
        said(&measured.replace("x_mm,y_mm", "u_deg,v_deg"), &none)
            .contains("no map with places in degrees")
    );
    let place = MatrixPlace { width_mm: Some(1.0), ..Default::default() };
    assert!(said(measured, &MeasuredOptions { place, ..none }).contains("own places"));
}

/// The cells of a map.
fn cells(map: &MeasuredMap) -> &MeasuredGrid {
    match &map.values {
        MeasuredValues::Centred(grid)
        | MeasuredValues::Surface(grid)
        | MeasuredValues::Image(grid)
        | MeasuredValues::Sphere(grid) => grid,
        MeasuredValues::Directions(_) => panic!("no cells"),
    }
}

#[test]
fn missing_values_and_a_file_cut_short_are_remarked() {
    let whole = grid([8.0, 6.0], field);
    let row = |((row, column), value): ((usize, usize), &f64)| {
        format!("{},{},{value}", whole.x[column] + 0.5, whole.y[row] + 0.5)
    };
    let rows: Vec<String> = whole.values.indexed_iter().map(row).collect();
    let remarks = |rows: &[String]| {
        let map = read_text(&format!("x_mm,y_mm,e_lx\n{}\n", rows.join("\n"))).unwrap();
        let options = MeasuredOptions { no_align: true, ..Default::default() };
        outcome(computed([8.0, 6.0], field, 2.0), cells(&map), &options).remarks.join("\n")
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

#[test]
fn lines_may_end_in_cr_and_another_encoding_is_refused_with_its_line() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("m.csv");
    let text = "# unit = lx\nx_mm,y_mm,e\n0,0,1\n1,0,2\n0,1,3\n1,1,4\n";
    for end in ["\n", "\r\n", "\r"] {
        let text = text.replace('\n', end);
        let map = read_text(&text).unwrap();
        assert_eq!(cells(&map).values, ndarray::array![[1.0, 2.0], [3.0, 4.0]], "{end:?}");
        assert_eq!(map.unit.as_deref(), Some("lx"));
        let said = read_text(&text.replace('4', "x")).err().unwrap().to_string();
        assert!(said.contains("m.csv:6: `x` is not"), "{end:?}: {said}");
        std::fs::write(&path, [text.as_bytes(), b"2,0,\xb5", end.as_bytes()].concat()).unwrap();
        let said = TextTable::read(&path).err().unwrap().to_string();
        assert!(said.contains("m.csv:7: not UTF-8 text; save the file"), "{end:?}: {said}");
    }
}
