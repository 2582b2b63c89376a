//! Tables that spreadsheets open, and tables that spreadsheets have saved.

use crate::*;
use lumiduct_report::{Existing, Folder, FolderLock, OutputFile};

/// UTF-8 byte-order mark.
const MARK: &str = "\u{feff}";

const RINGS: &str = "rings = { plane = { rings = 3, sectors = 4 }, on = \"rod.entry\", counts = \"incident\" }\n\
                     total = { plane = { cells = [1, 1] }, on = \"rod.entry\", counts = \"incident\" }\n[run]";

fn place() -> Place {
    let place = Place::new();
    let scene = SCENE.replace("[run]", RINGS);
    fs::write(place.path("rod.toml"), scene).unwrap();
    place
}

/// The cells of a table.
fn cells(place: &Place, name: &str) -> Vec<Vec<String>> {
    let reader = csv::ReaderBuilder::new().has_headers(false).from_path(place.path(name));
    let rows = reader.unwrap().into_records().map(Result::unwrap);
    rows.map(|row| row.iter().map(str::to_owned).collect()).collect()
}

fn numbers(cells: &[String]) -> Vec<f64> {
    cells.iter().map(|cell| cell.parse().unwrap()).collect()
}

#[test]
fn every_map_has_a_matrix_with_its_edges_and_measures_have_their_status() {
    let place = place();
    place.good("run rod.toml -q -o out");
    for (name, bytes) in contents(&place.path("out")) {
        let is_marked = bytes.starts_with(MARK.as_bytes());
        let is_for_spreadsheets = name == "measures.csv" || name.ends_with(".matrix.csv");
        assert_eq!(is_marked, is_for_spreadsheets, "{name}");
    }
    let matrices: Vec<String> =
        names(&place.path("out")).into_iter().filter(|name| name.contains(".matrix.")).collect();
    // A map of a single cell has no matrix.
    let expected = ["exit.illuminance", "far.intensity", "rings.illuminance"];
    assert_eq!(matrices, expected.map(|name| format!("{name}.matrix.csv")));

    let matrix = cells(&place, "out/exit.illuminance.matrix.csv");
    assert_eq!(matrix[0][..2], ["illuminance in lx", "u from in mm"]);
    assert_eq!(matrix[1][..2], ["", "u to in mm"]);
    assert_eq!(matrix[2][..2], ["v from in mm", "v to in mm"]);
    assert_eq!(numbers(&matrix[0][2..]), [-2.0, -1.0, 0.0, 1.0]);
    assert_eq!(numbers(&matrix[1][2..]), [-1.0, 0.0, 1.0, 2.0]);
    // The top row is that of the picture. The list counts from below.
    let list = cells(&place, "out/exit.illuminance.csv");
    for (row, line) in matrix[3..].iter().enumerate() {
        assert_eq!(numbers(&line[..2]), [1.0 - row as f64, 2.0 - row as f64]);
        let of_list = list[1..].chunks(4).rev().nth(row).unwrap();
        let values: Vec<&String> = of_list.iter().map(|cell| &cell[2]).collect();
        assert_eq!(line[2..].iter().collect::<Vec<_>>(), values);
    }
    let rings = cells(&place, "out/rings.illuminance.matrix.csv");
    assert_eq!([rings[0][1].as_str(), &rings[2][0]], ["sector from in deg", "radius from in mm"]);
    assert_eq!((rings.len(), rings[0].len()), (3 + 3, 2 + 4));
    assert_eq!(numbers(&rings[3][..1]), [0.0], "the innermost ring is on top");

    let measures = cells(&place, "out/measures.csv");
    assert_eq!(measures[0][4..], ["unit", "status", "estimator"]);
    let summary = place.summary("out");
    for row in &measures[1..] {
        let measure = &summary["measures"][&row[0]];
        assert_eq!([&measure["status"], &measure["estimator"]], [&row[5], &row[6]], "{row:?}");
    }
}

/// Writes a report again with a mark before one of its tables.
fn mark(report: &Path, table: &str) {
    let mut files = contents(report);
    files.remove("manifest.json").unwrap();
    let bytes = files.get_mut(table).unwrap();
    bytes.splice(..0, MARK.bytes());
    let files = files.into_iter().map(|(name, bytes)| OutputFile { name, bytes });
    let folder = Folder::open(FolderLock::take(report).unwrap(), Existing::Replace, None).unwrap();
    folder.write(&files.collect::<Vec<_>>()).unwrap();
}

#[test]
fn tables_that_begin_with_a_byte_order_mark_are_read_as_all_others() {
    let place = place();
    place.good("run rod.toml -q -o a");
    place.good("run rod.toml -q -o b --seed 2");
    let plain = place.good("diff a b --all");
    mark(&place.path("a"), "exit.illuminance.csv");
    let marked = place.good("diff a b --all");
    assert!(plain.contains("map exit.illuminance: rms z"), "{plain}");
    assert_eq!(marked, plain);

    place.good(
        "compare rod.toml --sensor exit --estimators forward --time 0.1s --runs 2 --truth-file a/measures.csv -o c -q",
    );
    let page = fs::read_to_string(place.path("c/compare.md")).unwrap();
    assert!(page.contains("from `a/measures.csv`"), "{page}");

    let study = "lumiduct_study = 1\ntitle = \"Lengths\"\nscene = \"rod.toml\"\nmeasures = [\"exit.efficiency\"]\n\
                 plan = { list = { file = \"designs.csv\" } }\n[parameters.length]\n\
                 keys = [\"solids.rod.cylinder.length_mm\"]\nunit = \"mm\"\n[run]\npaths = 2_000\n";
    fs::write(place.path("study.toml"), study).unwrap();
    fs::write(place.path("designs.csv"), format!("{MARK}length\n5\n20\n")).unwrap();
    place.good("batch study.toml -q -o lengths");
    let designs = cells(&place, "lengths/study.csv");
    assert_eq!([&designs[1][1], &designs[2][1]], ["5", "20"]);
}
