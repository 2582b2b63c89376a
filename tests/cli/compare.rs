//! Comparing estimators.

use crate::*;

const ALL: &str = "forward,backward,sppm,whitted,metropolis,gather,mis";

#[test]
fn a_comparison_writes_a_page_a_table_a_plot_and_its_truth() {
    let place = Place::new();
    let all = format!(
        "compare rod.toml --sensor exit --estimators {ALL} --time 0.2s --runs 2 --truth-time 0.5s --seed 3 \
         --photons 2k --records 1k -o out"
    );
    let said = place.good(&all);
    for name in ALL.split(',').chain(["exit.flux"]) {
        assert!(said.contains(name), "no {name} in {said}");
    }
    assert_eq!(
        names(&place.path("out")),
        ["compare.csv", "compare.md", "compare.png", "manifest.json", "truth.csv"]
    );
    let page = fs::read_to_string(place.path("out/compare.md")).unwrap();
    assert!(page.contains("not one of the reproducible reports"), "{page}");
    assert!(page.contains("2 independent runs of 0.1 s"), "{page}");
    let table = fs::read_to_string(place.path("out/compare.csv")).unwrap();
    for name in ALL.split(',') {
        assert!(table.lines().any(|line| line.starts_with(&format!("{name},"))), "{table}");
    }
    // The sensor has 16 cells.
    assert!(page.contains("| error per cell | cost of cells |"), "{page}");
    assert!(page.contains("* 16 cells"), "{page}");
    let cell_error = |line: &str| -> f64 { line.rsplit(',').next().unwrap().parse().unwrap() };
    assert!(table.lines().next().unwrap().ends_with(",error_per_cell"), "{table}");
    assert!(
        table.lines().skip(1).map(cell_error).all(|error| 0.0 < error && error < 3.0),
        "{table}"
    );
    let truth = fs::read_to_string(place.path("out/truth.csv")).unwrap();
    assert_eq!(truth.lines().filter(|line| line.starts_with("exit.cell_flux.")).count(), 16);

    // The truth found can be reused, and existing results are kept.
    let again = "compare rod.toml --sensor exit --estimators forward --time 0.1s --runs 2 --truth-file out/truth.csv";
    assert!(place.bad(2, &format!("{again} -o out")).contains("--overwrite"));
    place.good(&format!("{again} -q"));
    let page = fs::read_to_string(place.path("reports/rod-compare/compare.md")).unwrap();
    assert!(page.contains("from `out/truth.csv`"), "{page}");
    assert!(page.contains("| error per cell | cost of cells |"), "{page}");
    let kept = fs::read_to_string(place.path("reports/rod-compare/truth.csv")).unwrap();
    assert_eq!(kept, truth);
}

#[test]
fn a_truth_without_cells_gives_no_errors_per_cell_and_the_page_says_so() {
    let place = Place::new();
    let flux = "measure,value,std_error,unit\nexit.flux,8,0.1,lm\n";
    fs::write(place.path("flux.csv"), flux).unwrap();
    for truth in ["--truth 8", "--truth-file flux.csv"] {
        let arguments = "compare rod.toml --sensor exit --estimators forward --time 0.1s --runs 2";
        let said = place.good(&format!("{arguments} {truth} -o out --overwrite"));
        assert!(said.contains("Errors per cell are not known"), "{said}");
        assert!(!said.contains("cost of cells"), "{said}");
        let table = fs::read_to_string(place.path("out/compare.csv")).unwrap();
        assert!(table.lines().skip(1).all(|line| line.ends_with(',')), "{table}");
    }
}

#[test]
fn the_cells_of_a_truth_must_be_those_of_the_sensor() {
    let place = Place::new();
    let table = |cells: &str| format!("measure,value,std_error,unit\nexit.flux,8,0.1,lm\n{cells}");
    let dark: String = (0..16).map(|cell| format!("exit.cell_flux.{cell},0,0,lm\n")).collect();
    for (cells, words) in [
        (
            "exit.cell_flux.0,4,0.1,lm\nexit.cell_flux.1,4,0.1,lm\n",
            "2 cells of `exit`, which has 16",
        ),
        ("exit.cell_flux.1,4,0.1,lm\n", "`exit.cell_flux.1` is where `exit.cell_flux.0` belongs"),
        ("exit.cell_flux.0,much,0.1,lm\n", "`much` is not a number"),
        (dark.as_str(), "are dark"),
    ] {
        fs::write(place.path("truth.csv"), table(cells)).unwrap();
        let said = place.bad(
            2,
            "compare rod.toml --sensor exit --estimators forward --time 1s --truth-file truth.csv -o out",
        );
        assert!(said.contains("--truth-file truth.csv") && said.contains(words), "{said}");
    }
    assert_eq!(place.names(), ["rod.toml", "truth.csv"]);
}

#[test]
fn sppm_is_refused_where_a_medium_scatters() {
    let place = Place::with("[media.acrylic.scattering]\nper_mm = 0.01\n");
    let said = place.bad(2, "compare rod.toml --estimators forward,sppm --sensor exit --time 1s");
    for words in ["sppm", "the medium `acrylic` scatters"] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    assert_eq!(place.names(), ["rod.toml"]);
}

#[test]
fn a_comparison_that_makes_no_sense_is_refused_and_nothing_is_written() {
    let place =
        Place::with("[sources.spot.point]\nflux_lm = 1\nat = { position_mm = [0, 0, -1] }\n");
    fs::write(place.path("truth.csv"), "measure,value,std_error\nexit.flux,0,0\n").unwrap();
    for (arguments, words) in [
        ("", "--estimators"),
        ("--estimators psychic", "metropolis"),
        ("--estimators forward", "--sensor: exit, far"),
        ("--estimators forward --sensor eye", "exit, far"),
        (
            "--estimators forward,backward,sppm --sensor exit",
            "backward, sppm cannot meet the source `spot`",
        ),
        ("--estimators forward --sensor exit --runs 1", "2..=1000"),
        ("--estimators forward --sensor exit --time 0", "--time"),
        ("--estimators forward --sensor exit --truth 0", "must not be 0"),
        ("--estimators forward --sensor exit --truth nan", "finite"),
        ("--estimators forward --sensor exit --truth 1 --truth-error -1", "-1"),
        ("--estimators forward --sensor exit --truth-error 1", "--truth"),
        ("--estimators forward --sensor exit --truth 1 --truth-time 1s", "--truth-time"),
        ("--estimators forward --sensor exit --truth-file truth.csv", "must not be 0"),
        ("--estimators forward --sensor far --truth-file truth.csv", "far.flux"),
        ("--estimators forward --sensor far --truth-file rod.toml", "no column `measure`"),
    ] {
        let said = place.bad(2, &format!("compare rod.toml -o out {arguments}"));
        assert!(said.contains(words), "{arguments}: no {words} in {said}");
    }
    let missing =
        "compare rod.toml -o out --estimators forward --sensor exit --truth-file none.csv";
    assert!(place.bad(2, missing).contains("none.csv"));
    assert_eq!(place.names(), ["rod.toml", "truth.csv"]);
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_a_baseline_at_once_and_writes_nothing() {
    use std::io::{BufRead, BufReader};
    use std::process::{Command, Stdio};

    let place = Place::new();
    let arguments =
        "compare rod.toml --sensor exit --estimators sppm --truth 8 --time 60min -o out";
    let mut child = Command::new(env!("CARGO_BIN_EXE_lumiduct"))
        .current_dir(place.0.path())
        .args(arguments.split_whitespace())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    let begun = said.find(|line| line.starts_with("sppm: run 1 of"));
    assert!(begun.is_some(), "the baseline has not begun");
    send_ctrl_c(&child);
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(said.any(|line| line.contains("interrupted")));
    assert!(names(&place.path("out")).is_empty());
}
