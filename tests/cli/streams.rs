//! Streams that are closed or full: nothing panics, and exit codes still reflect the work.

use crate::*;
use std::io::pipe;
use std::process::Stdio;

/// A sensor that faces away from the rod, so that a run prints a remark on stderr.
const BLIND: &str = "[sensors.eye]\nat = { position_mm = [0, 0, 20], axis = [0, 0, 1] }\n\
     luminance = { disk = { radius_mm = 1 }, cells = [1, 1], acceptance_half_angle_deg = 1, \
     directions = [{ theta_deg = 0, phi_deg = 0 }] }\n";

/// A stream whose reader has closed it.
fn closed() -> Stdio {
    let (_, writer) = pipe().unwrap();
    writer.into()
}

fn code_of(place: &Place, arguments: &str, stdout: Stdio, stderr: Stdio) -> Option<i32> {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_lumiduct"));
    command.current_dir(place.0.path()).args(arguments.split_whitespace());
    command.stdout(stdout).stderr(stderr).status().unwrap().code()
}

/// Arguments and the expected exit code.
const CASES: [(&str, i32); 7] = [
    ("run rod.toml -o out --estimator backward --paths 3k --overwrite", 0),
    ("check rod.toml -D run.estimator=\"backward\"", 0),
    ("list .", 0),
    ("schema", 0),
    ("run missing.toml", 2),
    ("run rod.toml --pahts 2", 2),
    ("check rod.toml -D run.path=3", 2),
];

#[test]
fn closed_streams_end_quietly_with_the_code_that_the_work_deserves() {
    let place = Place::with(BLIND);
    for (arguments, code) in CASES {
        assert_eq!(code_of(&place, arguments, closed(), closed()), Some(code), "{arguments}");
        assert_eq!(code_of(&place, arguments, Stdio::null(), closed()), Some(code), "{arguments}");
    }
    assert!(place.path("out/summary.json").is_file());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_stderr_changes_no_exit_code() {
    let place = Place::with(BLIND);
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    for (arguments, code) in CASES {
        let stderr = Stdio::from(full());
        assert_eq!(code_of(&place, arguments, Stdio::null(), stderr), Some(code), "{arguments}");
    }
    assert_eq!(code_of(&place, "schema", full().into(), full().into()), Some(3));
}
