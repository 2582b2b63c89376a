//! The example studies: their results in the repository belong to the current studies and are
//! reproducible.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod fronts;
#[path = "../package/mod.rs"]
mod package;
mod searches;
#[path = "../skip/mod.rs"]
mod skip;

use crate::searches::stopped_when;
use lumiduct::study::{BatchOptions, OnExisting, run_study};
use lumiduct_core::transport::{Interrupt, Shard};
use lumiduct_input::{Plan, StudySettings, load_study};
use lumiduct_report::study::{DesignRecord, Pairing};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

/// The design of each study that is traced again; any other would do.
const AGAIN: u64 = 3;

fn studies() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/studies");
    let mut paths: Vec<PathBuf> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    paths.sort();
    paths
}

fn results(study: &Path) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/studies").join(study.file_stem().unwrap())
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn every_study_has_results_of_its_own_and_none_is_without_a_design() {
    if package::is_without_reports() {
        return;
    }
    assert!(studies().len() >= 4);
    for path in studies() {
        let study = load_study(&path, &StudySettings::default()).unwrap();
        let manifest = json(&results(&path).join("batch.json"));
        let name = path.display();
        assert_eq!(manifest["hash"], study.hash, "{name}: run lumiduct batch with --overwrite");
        let records = ["designs", "production_designs"].map(|key| manifest[key].as_u64());
        let records: u64 = records.into_iter().flatten().sum();
        let found = fs::read_dir(results(&path).join("designs")).unwrap().count();
        assert_eq!(found as u64, records, "{name}");
        let summary = json(&results(&path).join("study.json"));
        for file in summary["files"].as_array().unwrap() {
            assert!(results(&path).join(file.as_str().unwrap()).is_file(), "{name}: {file}");
        }
        for row in summary["rows"].as_array().unwrap() {
            assert!(row.get("failed").is_none(), "{name}: {row}");
        }
    }
}

#[test]
fn a_design_of_every_study_comes_out_as_it_is_in_the_repository() {
    if package::is_without_reports() {
        return;
    }
    for path in studies() {
        let study = load_study(&path, &StudySettings::default()).unwrap();
        if matches!(study.plan, Plan::Search(_)) {
            begin_again(&path);
            continue;
        }
        let manifest = json(&results(&path).join("batch.json"));
        let folder = tempfile::tempdir().unwrap();
        let options = BatchOptions {
            settings: StudySettings::default(),
            dir: Some(folder.path().to_path_buf()),
            existing: OnExisting::Keep,
            jobs: 1,
            shard: Shard::new(AGAIN, manifest["designs"].as_u64().unwrap()).unwrap(),
        };
        run_study(&path, &options, &Interrupt::default(), &|_| {}).unwrap();
        let record = |folder: &Path| {
            // Another build may have traced the results in the repository; its numbers are the
            // same.
            DesignRecord { build: String::new(), ..record(folder, AGAIN) }
        };
        assert_eq!(record(folder.path()), record(&results(&path)), "{}", path.display());
    }
}

fn record(folder: &Path, design: u64) -> DesignRecord {
    let path = folder.join(format!("designs/{design:04}.json"));
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Traces the first designs of a search again.
fn begin_again(path: &Path) {
    const DESIGNS: usize = 4;
    let folder = tempfile::tempdir().unwrap();
    stopped_when(path, folder.path(), |progress| progress.done == DESIGNS);
    for number in 1..=DESIGNS as u64 {
        let [again, before] = [folder.path(), &results(path)].map(|dir| record(dir, number));
        assert_eq!((&again.settings, &again.outcome), (&before.settings, &before.outcome));
    }
}

/// A rod with two indices, for a seed.
const PAIR: &str = r#"
lumiduct_study = 1
title = "Two rods"
scene = "rod.toml"
measures = ["exit.flux"]
plan = "grid"
[parameters.index]
keys = ["media.acrylic.index"]
values = [1.49, 1.52]
[run]
paths = 20_000
estimator = "forward"
[ranking]
measure = "exit.flux"
"#;

#[test]
fn the_error_of_a_difference_is_what_it_says_and_smaller_than_that_of_independent_designs() {
    let folder = tempfile::tempdir().unwrap();
    let scene = concat!(
        "lumiduct = 1\ntitle = \"Rod\"\n",
        include_str!("../rod.toml"),
        "[sensors]\nexit = { plane = { cells = [1, 1] }, on = \"rod.exit\", counts = \"leaving\" }\n"
    );
    fs::write(folder.path().join("rod.toml"), scene).unwrap();
    let path = folder.path().join("pair.toml");
    fs::write(&path, PAIR).unwrap();
    let (mut differences, mut errors, mut alone) = (Vec::new(), Vec::new(), Vec::new());
    for seed in 1..=48 {
        let options = BatchOptions {
            settings: StudySettings { seed: Some(seed), ..StudySettings::default() },
            dir: Some(folder.path().join(format!("out{seed}"))),
            existing: OnExisting::Keep,
            jobs: 2,
            shard: Shard::WHOLE,
        };
        let finished = run_study(&path, &options, &Interrupt::default(), &|_| {}).unwrap();
        let report = finished.report.unwrap();
        let [first, second] =
            [0, 1].map(|place| report.designs[place].measure("exit.flux").unwrap());
        let behind = report.analysis.ranked[1].behind.unwrap();
        assert_eq!(behind.evidence, Pairing::Paired);
        differences.push(first.value - second.value);
        errors.push(behind.std_error);
        alone.push(first.std_error.hypot(second.std_error));
    }
    // The spread over seeds is the truth; with 48 seeds its own error is 1/sqrt(2 * 47) = 10 %.
    let spread = lumiduct_core::tally::Tally::of(differences.iter().copied());
    let spread = spread.std_error() * (differences.len() as f64).sqrt();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let ratio = mean(&errors) / spread;
    assert!((0.7..1.45).contains(&ratio), "told {}, found {spread}", mean(&errors));
    assert!(mean(&alone) > 2.0 * mean(&errors), "{} and {}", mean(&alone), mean(&errors));
}
