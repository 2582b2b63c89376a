//! The program as a user runs it: files, exit codes, and messages. Runs are short; their numbers
//! are tested elsewhere.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod batches;
mod commands;
mod compare;
mod diffs;
mod light;
mod measured;
mod optimisations;
mod pages;
mod parts;
mod rays;
mod refusals;
mod resumed_batches;
mod runs;
mod schemas;
mod seals;
#[path = "../skip/mod.rs"]
mod skip;
mod spectra;
mod spreadsheets;
mod streams;
mod texts;

use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;
use tempfile::TempDir;

/// A short rod, so that tracing is quick, with a sensor of each kind that has pictures.
const SCENE: &str = concat!(
    "lumiduct = 1\ntitle = \"Short rod\"\n",
    include_str!("../rod.toml"),
    r#"
[sensors]
exit = { plane = { cells = [4, 4] }, on = "rod.exit", counts = "leaving" }
far = { goniometer = { c_step_deg = 90, gamma_step_deg = 10 }, at = { face = "rod.exit" } }
[run]
paths = 20_000
"#
);

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

    /// The messages of a run that must end with this exit code and print nothing else.
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
    let files = names.filter(|name| folder.join(name).is_file());
    files.map(|name| (name.clone(), fs::read(folder.join(name)).unwrap())).collect()
}

fn flux(summary: &Value) -> f64 {
    summary["measures"]["exit.flux"]["value"].as_f64().unwrap()
}

/// Sends the signal of Ctrl-C by the system's own tool: the code of this package is free of `unsafe`.
#[cfg(unix)]
fn send_ctrl_c(child: &std::process::Child) {
    let mut kill = std::process::Command::new("kill");
    assert!(kill.args(["-INT", &child.id().to_string()]).status().unwrap().success());
}
