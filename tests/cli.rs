//! The program as a user runs it: files, exit codes, and what is said. Runs are short; their numbers are judged
//! elsewhere.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

/// A short rod, so that little is traced, with a sensor of each kind that has pictures.
const SCENE: &str = r#"
lumiduct = 1
title = "Short rod"
[media.acrylic]
index = 1.49
[solids.rod.cylinder]
radius_mm = 2
length_mm = 10
medium = "acrylic"
[sources.led.disk]
radius_mm = 0.5
at = { face = "rod.entry", gap_mm = 0.1 }
flux_lm = 10
[sensors]
exit = { plane = { cells = [4, 4] }, on = "rod.exit", counts = "leaving" }
far = { goniometer = { c_step_deg = 90, gamma_step_deg = 10 }, at = { face = "rod.exit" } }
[run]
paths = 20_000
"#;

/// A scene in a folder of its own, where the program runs.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self::with("")
    }

    /// The scene with more lines at its end.
    fn with(lines: &str) -> Self {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("rod.toml"), format!("{SCENE}{lines}")).unwrap();
        Self(dir)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs the program here with arguments that are separated by spaces.
    fn run(&self, arguments: &str) -> Output {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lumiduct"));
        command.current_dir(self.0.path()).args(arguments.split_whitespace()).output().unwrap()
    }

    /// Standard output of a run that must end well.
    fn good(&self, arguments: &str) -> String {
        let output = self.run(arguments);
        assert_eq!(code(&output), 0, "{arguments}: {}", errors(&output));
        String::from_utf8(output.stdout).unwrap()
    }

    /// What is said about a run that must end with this exit code and print nothing else.
    fn bad(&self, expected: i32, arguments: &str) -> String {
        let output = self.run(arguments);
        assert_eq!(code(&output), expected, "{arguments}: {}", errors(&output));
        assert!(output.stdout.is_empty(), "{arguments}");
        errors(&output)
    }

    /// Names of everything in the folder.
    fn names(&self) -> Vec<String> {
        names(self.0.path())
    }

    fn summary(&self, report: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(report).join("summary.json")).unwrap()).unwrap()
    }
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn errors(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The reproducible files of a report.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let names = names(folder).into_iter().filter(|name| name != "timing.csv");
    names.map(|name| (name.clone(), fs::read(folder.join(name)).unwrap())).collect()
}

fn flux(summary: &Value) -> f64 {
    summary["measures"]["exit.flux"]["value"].as_f64().unwrap()
}

#[test]
fn a_run_writes_every_file_of_its_report() {
    let place = Place::new();
    let said = place.good("run rod.toml");
    assert!(said.contains("efficiency") && said.contains("reports/rod/report.md"), "{said}");
    let expected = [
        "balance.png",
        "exit.bounces.csv",
        "exit.bounces.png",
        "exit.illuminance.csv",
        "exit.illuminance.png",
        "far.bounces.csv",
        "far.bounces.png",
        "far.intensity.csv",
        "far.intensity.png",
        "measures.csv",
        "report.md",
        "rod.toml",
        "summary.json",
        "timing.csv",
    ];
    let report = place.path("reports/rod");
    assert_eq!(names(&report), expected);
    assert_eq!(
        fs::read(report.join("rod.toml")).unwrap(),
        fs::read(place.path("rod.toml")).unwrap()
    );
    let page = fs::read_to_string(report.join("report.md")).unwrap();
    for picture in expected.iter().filter(|name| name.ends_with(".png")) {
        assert!(page.contains(&format!("({picture})")), "{picture} is not on the page");
        assert!(fs::read(report.join(picture)).unwrap().starts_with(b"\x89PNG"), "{picture}");
    }
    let listed = &place.summary("reports/rod")["files"];
    for name in listed.as_array().unwrap() {
        assert!(expected.contains(&name.as_str().unwrap()), "{name} is named but not there");
    }
}

#[test]
fn numbers_in_summary_and_balance_make_sense() {
    let place = Place::new();
    place.good("run rod.toml -o out -q");
    let summary = place.summary("out");
    let measure = |name: &str| summary["measures"][name]["value"].as_f64().unwrap();
    // Fresnel losses of two faces take some 15 % of the flux, and nothing can be gained.
    assert!((7.0..9.0).contains(&flux(&summary)), "{}", flux(&summary));
    assert!((measure("exit.efficiency") - flux(&summary) / 10.0).abs() < 1e-12);
    assert!(measure("balance.residual").abs() < 1e-9 * 10.0 && measure("balance.leaked") == 0.0);
    assert_eq!(summary["measures"]["exit.flux"]["unit"], "lm");
}

#[test]
fn a_missed_check_ends_with_1_and_a_met_one_with_0() {
    let check = |demand: &str| format!("[[check]]\nmeasure = \"exit.efficiency\"\n{demand}\n");
    assert!(Place::with(&check("min = 0.5")).good("run rod.toml").contains("passed"));
    let missed = Place::with(&check("min = 0.99"));
    let output = missed.run("run rod.toml");
    assert_eq!(code(&output), 1);
    assert!(String::from_utf8_lossy(&output.stdout).contains("FAILED"));
    assert!(missed.path("reports/rod/report.md").is_file(), "the report tells what was missed");
    // The standard error of 20,000 paths is some 1e-3.
    let open = Place::with(&check("equals = 0.85\nsigmas = 4\nmax_std_error = 1e-6"));
    assert_eq!(code(&open.run("run rod.toml -q")), 1, "undecided counts as missed");
}

#[test]
fn a_run_off_its_target_ends_with_1_where_there_are_checks() {
    let check = "[[check]]\nmeasure = \"exit.flux\"\nmin = 1\n";
    let place = Place::with(check);
    assert_eq!(code(&place.run("run rod.toml --target 0.0001% --paths 20k -q -o a")), 1);
    assert_eq!(code(&place.run("run rod.toml --target 10% --paths 1M -q -o b")), 0);
    assert_eq!(place.summary("b")["run"]["stopped"], "the target error was reached");
}

#[test]
fn bad_input_ends_with_2_and_writes_nothing() {
    let place = Place::with("[media.glass]\nindx = 1.5\n");
    let said = place.bad(2, "run rod.toml");
    for words in ["rod.toml:20", "indx", "index"] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    place.bad(2, "check rod.toml");
    assert!(place.bad(2, "run missing.toml").contains("missing.toml"));
    let unknown = Place::with("[[check]]\nmeasure = \"exit.fluxx\"\nmin = 1\n");
    assert!(unknown.bad(2, "run rod.toml").contains("exit.flux"));
    assert_eq!(
        (place.names(), unknown.names()),
        (vec!["rod.toml".into()], vec!["rod.toml".into()])
    );
}

#[test]
fn a_bad_command_line_ends_with_2_and_writes_nothing() {
    let place = Place::new();
    for arguments in [
        "",
        "walk rod.toml",
        "run",
        "run rod.toml --pahts 2M",
        "run rod.toml --paths 0",
        "run rod.toml --paths many",
        "run rod.toml --time -1s",
        "run rod.toml --target 0%",
        "run rod.toml --threads 0",
        "run rod.toml --estimator psychic",
        "run rod.toml -D solids.rod.cylinder.length_mm",
        "run rod.toml -D solids.rod.cylinder.lenght_mm=3",
        "run rod.toml -D solids.rod.cylinder.length_mm=-3",
        "completions cobol",
    ] {
        assert!(!place.bad(2, arguments).is_empty(), "{arguments}");
    }
    assert_eq!(place.names(), ["rod.toml"]);
    let help = place.good("run --help");
    assert!(help.contains("--overwrite") && place.good("--help").contains("Exit codes"));
}

#[test]
fn a_report_is_kept_unless_it_may_be_replaced() {
    let place = Place::new();
    place.good("run rod.toml -o out -q --seed 1");
    let first = contents(&place.path("out"));
    assert!(place.bad(2, "run rod.toml -o out -q --seed 2").contains("--overwrite"));
    assert!(place.bad(2, "run rod.toml -o out -q --time 1s").contains("--overwrite"));
    assert_eq!(contents(&place.path("out")), first);
    place.good("run rod.toml -o out -q --seed 2 --overwrite");
    assert_ne!(contents(&place.path("out"))["summary.json"], first["summary.json"]);
    fs::create_dir(place.path("notes")).unwrap();
    fs::write(place.path("notes/mine.txt"), "mine").unwrap();
    place.bad(2, "run rod.toml -o notes -q");
    assert_eq!(names(&place.path("notes")), ["mine.txt"]);
}

#[test]
fn a_run_over_its_own_report_leaves_it_alone_and_finds_what_was_changed() {
    let place = Place::new();
    place.good("run rod.toml -o out -q");
    let (first, timing) = (contents(&place.path("out")), place.path("out/timing.csv"));
    let seconds = fs::read(&timing).unwrap();
    assert!(place.good("run rod.toml -o out").contains("the same to the byte"));
    assert_eq!((contents(&place.path("out")), fs::read(&timing).unwrap()), (first, seconds));
    fs::write(place.path("out/measures.csv"), "changed").unwrap();
    assert!(place.bad(3, "run rod.toml -o out -q").contains("measures.csv"));
    assert_eq!(fs::read(place.path("out/measures.csv")).unwrap(), b"changed");
}

#[test]
fn an_override_changes_the_result_and_is_named_in_the_report() {
    let place = Place::new();
    place.good("run rod.toml -o a -q");
    place.good("run rod.toml -o b -q -D sources.led.disk.flux_lm=20 -D title=Twice");
    let (one, two) = (place.summary("a"), place.summary("b"));
    assert!((flux(&two) / flux(&one) - 2.0).abs() < 1e-12, "the same paths with twice the flux");
    assert_eq!(two["scene"]["overrides"][0], "sources.led.disk.flux_lm=20");
    assert_ne!(one["scene"]["hash"], two["scene"]["hash"]);
    let page = fs::read_to_string(place.path("b/report.md")).unwrap();
    assert!(page.starts_with("# Twice") && page.contains("sources.led.disk.flux_lm=20"));
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let place = Place::new();
    place.good("run rod.toml -o a -q --seed 7 --threads 1");
    place.good("run rod.toml -o b -q --seed 7 --threads 2");
    place.good("run rod.toml -o c -q --seed 8 --threads 2");
    let (one, two, other) =
        (contents(&place.path("a")), contents(&place.path("b")), contents(&place.path("c")));
    assert_eq!(one, two);
    assert_ne!(one["exit.illuminance.csv"], other["exit.illuminance.csv"]);
}

#[test]
fn a_check_lists_the_scene_and_draws_it() {
    let place = Place::new();
    let said = place.good("check rod.toml");
    for words in ["Short rod", "rod.exit", "12.57 mm²", "etendue", "rod.check.png"] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    assert!(fs::read(place.path("rod.check.png")).unwrap().starts_with(b"\x89PNG"));
    place.good("check rod.toml");
    let changed = "check rod.toml -D solids.rod.cylinder.length_mm=20";
    assert!(place.bad(2, changed).contains("--overwrite"));
    place.good(&format!("{changed} --overwrite"));
    place.good(&format!("{changed} -o pictures/long.png"));
    assert!(place.path("pictures/long.png").is_file());
}

#[test]
fn the_schema_is_json_with_a_title() {
    let schema: Value = serde_json::from_str(&Place::new().good("schema")).unwrap();
    assert!(!schema["title"].as_str().unwrap().is_empty());
    assert!(schema["properties"]["solids"].is_object());
}

#[test]
fn completions_and_the_manual_page_know_the_commands() {
    let place = Place::new();
    for arguments in ["completions bash", "completions zsh", "completions fish", "man"] {
        let text = place.good(arguments);
        assert!(text.contains("lumiduct") && text.contains("check"), "{arguments}");
    }
}

#[test]
fn a_list_finds_scenes_and_sensor_files_and_no_reports() {
    let place = Place::new();
    fs::write(place.path("cell.toml"), "plane = { cells = [1, 1] }\n").unwrap();
    place.good("run rod.toml -q");
    let said = place.good("list");
    assert!(said.contains("rod.toml") && said.contains("Short rod"), "{said}");
    assert!(said.contains("cell.toml") && said.contains("sensor file: plane"), "{said}");
    assert_eq!(said.lines().count(), 2, "{said}");
    assert_eq!(code(&place.run("list nowhere")), 3);
}

#[test]
fn a_quiet_run_says_nothing() {
    let output = Place::new().run("run rod.toml -q");
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}

/// Sends Ctrl-C's signal by the system's own tool: the code of this package is free of `unsafe`.
#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_partial_report_and_ends_with_130() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};

    let place = Place::new();
    let mut child = Command::new(env!("CARGO_BIN_EXE_lumiduct"))
        .current_dir(place.0.path())
        .args(["run", "rod.toml", "-o", "out", "--paths", "1G"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    // The folder is made when the scene has been read, which is after the handler is set.
    let start = Instant::now();
    while !place.path("out").is_dir() {
        assert!(start.elapsed() < Duration::from_secs(20), "the run has not begun");
        std::thread::sleep(Duration::from_millis(10));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(place.summary("out")["run"]["partial"], true);
    let page = fs::read_to_string(place.path("out/report.md")).unwrap();
    assert!(page.contains("partial"), "the page does not say so");
}
