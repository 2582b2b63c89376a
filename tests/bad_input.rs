//! Bad scene files, each with its expected problems written next to the lines that have them.
//!
//! A comment `#~ key: words | words` at the end of a line expects one diagnostic for that line,
//! with that key, and with these words in its message or hint; `#~7 ...` expects it for line 7,
//! `#~0 ...` for no line. A line `#~-D key=value` sets a value on the command line,
//! `#~include file` expects the problems given in another file. Every problem must be reported, and
//! nothing else.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

use std::path::{Path, PathBuf};

use lumiduct_base::error::{Diagnostic, Error};
use lumiduct_input as input;

struct Expected {
    file: PathBuf,
    line: Option<usize>,
    key: String,
    words: Vec<String>,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input")
}

fn expectations(file: &Path) -> Vec<Expected> {
    let text = String::from_utf8_lossy(&std::fs::read(file).unwrap()).into_owned();
    let mut all = Vec::new();
    for (i, line) in text.lines().enumerate() {
        for note in line.split("#~").skip(1) {
            if let Some(other) = note.strip_prefix("include ") {
                all.extend(expectations(&file.parent().unwrap().join(other.trim())));
            } else if !note.starts_with("-D ") {
                let (place, rest) = note.split_once(' ').unwrap();
                let line = if place.is_empty() { i + 1 } else { place.parse().unwrap() };
                let (key, words) = rest.split_once(':').unwrap();
                let words = words.split('|').map(|word| word.trim().to_owned()).collect();
                let line = (line > 0).then_some(line);
                all.push(Expected {
                    file: file.to_path_buf(),
                    line,
                    key: key.trim().into(),
                    words,
                });
            }
        }
    }
    all
}

fn overrides(file: &Path) -> Vec<String> {
    let text = String::from_utf8_lossy(&std::fs::read(file).unwrap()).into_owned();
    text.lines().filter_map(|line| Some(line.split_once("#~-D ")?.1.to_owned())).collect()
}

fn diagnostics(file: &Path) -> Vec<Diagnostic> {
    let settings = input::Settings { overrides: overrides(file), ..input::Settings::default() };
    match input::load(file, &settings) {
        Ok(job) => job.warnings,
        Err(Error::Input(diagnostics)) => diagnostics,
        Err(other) => panic!("{}: {other}", file.display()),
    }
}

fn fits(expected: &Expected, diagnostic: &Diagnostic) -> bool {
    let text = format!("{} {}", diagnostic.message, diagnostic.hint.as_deref().unwrap_or_default());
    let same_file = expected.line.is_none() || diagnostic.file.as_deref() == Some(&expected.file);
    same_file
        && expected.line == diagnostic.line
        && expected.key == diagnostic.key
        && expected.words.iter().all(|word| text.contains(word.as_str()))
}

fn cases() -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let mut cases: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    cases.sort();
    cases
}

#[test]
fn every_problem_of_a_bad_file_is_reported_at_its_line_and_nothing_else() {
    let cases = cases();
    assert!(cases.len() >= 40, "only {} cases", cases.len());
    let mut failures = String::new();
    for case in cases {
        let mut found = diagnostics(&case);
        for expected in expectations(&case) {
            match found.iter().position(|diagnostic| fits(&expected, diagnostic)) {
                Some(index) => drop(found.remove(index)),
                None => {
                    let (line, key, words) =
                        (expected.line.unwrap_or(0), expected.key, expected.words);
                    failures += &format!("missing {}:{line}: `{key}`: {words:?}\n", case.display());
                }
            }
        }
        let rest = input::diagnostic::render(
            &found,
            &input::diagnostic::sources_of(&found),
            input::diagnostic::Colour::Never,
        );
        if !found.is_empty() {
            failures += &format!("not expected in {}:\n{rest}", case.display());
        }
    }
    assert!(failures.is_empty(), "\n{failures}");
}

#[test]
fn every_bad_file_expects_something_and_is_rendered_with_its_lines() {
    for case in cases() {
        let expected = expectations(&case);
        assert!(!expected.is_empty(), "{} expects nothing", case.display());
        let diagnostics = diagnostics(&case);
        let text = input::diagnostic::render(
            &diagnostics,
            &input::diagnostic::sources_of(&diagnostics),
            input::diagnostic::Colour::Never,
        );
        for diagnostic in diagnostics.iter().filter(|diagnostic| diagnostic.line.is_some()) {
            let file = diagnostic.file.as_ref().unwrap().display();
            assert!(text.contains(&format!("{file}:{}: ", diagnostic.line.unwrap())), "{text}");
        }
        assert!(expected.iter().all(|one| one.line.is_none()) || text.contains('^'), "{text}");
    }
}

#[test]
fn a_good_scene_is_read_without_a_word() {
    let file = folder().join("include/good.toml");
    let loaded = input::read(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert!(loaded.warnings.is_empty());
    assert_eq!(loaded.text, std::fs::read_to_string(&file).unwrap());
    assert_eq!(loaded.spec.solids.len(), 8);
    assert_eq!(loaded.spec.sheets.len(), 8);
    assert_eq!(loaded.spec.sources.len(), 8);
    assert_eq!(loaded.spec.sensors.len(), 5);
}

#[test]
fn a_spec_that_is_written_out_reads_back_as_it_was() {
    let loaded = input::read(&folder().join("include/good.toml"), &[]).unwrap();
    let dir = tempfile::tempdir().unwrap();
    std::fs::copy(folder().join("include/good_sensor.toml"), dir.path().join("good_sensor.toml"))
        .unwrap();
    let file = dir.path().join("again.toml");
    std::fs::write(&file, toml::to_string(&loaded.spec).unwrap()).unwrap();
    let again = input::read(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(again.spec, loaded.spec);
}

#[test]
fn relative_paths_start_at_the_folder_of_the_file_that_names_them() {
    let good = folder().join("include/good.toml");
    let loaded = input::read(&good, &["solids.housing.mesh.unit=\"mm\"".into()]).unwrap();
    let key = input::keys::Key::of(&["solids", "housing", "mesh"]);
    assert_eq!(loaded.places.folder(&key.field("file")), folder().join("include"));
    assert_eq!(loaded.places.folder(&key.field("unit")), folder().join("include"));
    assert_eq!(loaded.places.line(&key.field("unit")), None);
    assert_eq!(loaded.places.line(&key.field("file")), Some(45));
    let cells = input::keys::Key::of(&["sensors", "exit", "plane", "rectangle", "width_mm"]);
    assert_eq!(loaded.places.line(&cells), Some(1));
}

/// Pseudo-random numbers, the same in every run (Steele et al., OOPSLA 2014, `SplitMix64`).
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn damaged_scenes_give_diagnostics_and_never_a_panic() {
    const PIECES: [&str; 16] = [
        "[", "]", "{", "}", "=", "\"", "'", "\"\"\"", "\n", ".", ",", "nan", "-inf", "1e999", "#",
        "\u{feff}",
    ];
    let good = std::fs::read(folder().join("include/good.toml")).unwrap();
    let dir = tempfile::tempdir().unwrap();
    std::fs::copy(folder().join("include/good_sensor.toml"), dir.path().join("good_sensor.toml"))
        .unwrap();
    let file = dir.path().join("damaged.toml");
    let mut state = 20260;
    let mut refused = 0;
    for _ in 0..500 {
        let mut bytes = good.clone();
        for _ in 0..1 + random(&mut state) % 4 {
            let at = random(&mut state) as usize % bytes.len();
            let end = (at + random(&mut state) as usize % 30).min(bytes.len());
            match random(&mut state) % 5 {
                0 => bytes[at] = random(&mut state) as u8,
                1 => drop(bytes.drain(at..end)),
                2 => drop(
                    bytes
                        .splice(at..at, PIECES[random(&mut state) as usize % PIECES.len()].bytes()),
                ),
                3 => bytes = [&bytes[..end], &bytes[at..]].concat(),
                _ => bytes.truncate(at.max(1)),
            }
        }
        std::fs::write(&file, &bytes).unwrap();
        if let Err(error) = input::read(&file, &[]) {
            let Error::Input(diagnostics) = error else { panic!("{error}") };
            assert!(!diagnostics.is_empty());
            let sources = input::diagnostic::sources_of(&diagnostics);
            assert!(
                !input::diagnostic::render(
                    &diagnostics,
                    &sources,
                    input::diagnostic::Colour::Never
                )
                .is_empty()
            );
            refused += 1;
        }
    }
    assert!(refused > 400, "only {refused} of 500 were refused");
}
