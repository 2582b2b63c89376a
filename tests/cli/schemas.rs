//! The printed JSON Schemas, which editors use, tested with an independent validator.

use crate::*;
use jsonschema::Validator;

/// The validator of one kind of file, from what the program prints.
fn validator(arguments: &str) -> Validator {
    let schema: Value = serde_json::from_str(&Place::new().good(arguments)).unwrap();
    assert!(jsonschema::meta::is_valid(&schema), "{arguments}: no valid schema");
    jsonschema::validator_for(&schema).unwrap()
}

/// The TOML files of a folder of the repository.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let paths = names(&folder).into_iter().map(|name| folder.join(name));
    paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml")).collect()
}

fn json(text: &str) -> Value {
    toml::from_str(text).unwrap()
}

/// Where a text differs from a schema.
fn differences(validator: &Validator, text: &str) -> Vec<String> {
    let found = json(text);
    let errors = validator.iter_errors(&found);
    errors.map(|error| format!("{}: {error}", error.instance_path())).collect()
}

fn expect_all_accepted(arguments: &str, folders: &[&str], least: usize) {
    let validator = validator(arguments);
    let paths: Vec<_> = folders.iter().flat_map(|folder| files(folder)).collect();
    assert!(paths.len() >= least, "{} files", paths.len());
    for path in paths {
        let differences = differences(&validator, &fs::read_to_string(&path).unwrap());
        assert!(differences.is_empty(), "{}: {differences:#?}", path.display());
    }
}

#[test]
fn every_shipped_file_fits_its_schema() {
    expect_all_accepted("schema", &["scenes", "scenes/validation"], 105);
    expect_all_accepted("schema study", &["scenes/studies"], 4);
    expect_all_accepted("schema sensor", &["sensors"], 7);
}

#[test]
fn a_sensor_with_a_file_may_leave_out_what_the_file_has_and_nothing_else_may() {
    let validator = validator("schema");
    let with =
        |sensor: &str| differences(&validator, &format!("{SCENE}\n[sensors.more]\n{sensor}"));
    assert_eq!(with("file = \"a.toml\"\non = \"rod.exit\""), [""; 0]);
    assert_eq!(with("file = \"a.toml\"\nluminance = { cells = [2, 2] }"), [""; 0]);
    assert_eq!(with("plane = { cells = [2, 2] }\non = \"rod.exit\""), [""; 0]);
    for wrong in [
        "on = \"rod.exit\"",
        "luminance = { cells = [2, 2] }",
        "plane = {}\ngoniometer = {}",
        "file = \"a.toml\"\non = 3",
        "file = \"a.toml\"\nplain = {}",
        "file = \"a.toml\"\nplane = { cells = [0, 2] }",
        "file = \"a.toml\"\ncounts = \"twice\"",
    ] {
        assert!(!with(wrong).is_empty(), "accepted: {wrong}");
    }
}

#[test]
fn wrong_files_do_not_fit() {
    let scene = validator("schema");
    assert_eq!(differences(&scene, SCENE), [""; 0]);
    for (right, wrong) in [
        ("lumiduct = 1", "lumiduct = 2"),
        ("title =", "titel ="),
        ("cells = [4, 4]", "cells = [4.5, 4]"),
        ("paths = 20_000", "paths = 0"),
        ("counts = \"leaving\"", "counts = \"going\""),
        ("goniometer = {", "goniometer = { c_stepp_deg = 3, "),
    ] {
        assert!(SCENE.contains(right), "{right}");
        let text = SCENE.replacen(right, wrong, 1);
        assert!(!differences(&scene, &text).is_empty(), "accepted: {wrong}");
    }
    let sensor = validator("schema sensor");
    for wrong in ["file = \"b.toml\"", "plane = { cels = [1, 1] }", "absorbing = 1"] {
        assert!(!differences(&sensor, wrong).is_empty(), "accepted: {wrong}");
    }
    let study = validator("schema study");
    for wrong in ["lumiduct_study = 1", "lumiduct = 1"] {
        assert!(!differences(&study, wrong).is_empty(), "accepted: {wrong}");
    }
}
