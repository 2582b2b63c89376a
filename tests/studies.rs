//! The example studies: their results in the repository belong to the current studies and are
//! reproducible.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod package;
mod skip;

use lumiduct::study::{BatchOptions, BatchProgress, FinishedStudy, OnExisting, run_study};
use lumiduct_core::measure::CheckOutcome;
use lumiduct_core::transport::{Interrupt, Shard};
use lumiduct_input::{Plan, Study, StudySettings, load_study};
use lumiduct_report::study::{DesignOutcome, DesignRecord, Pairing, StudyReport};
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
        let designs = manifest["designs"].as_u64().unwrap() as usize;
        assert_eq!(fs::read_dir(results(&path).join("designs")).unwrap().count(), designs);
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
            begin_again(&path, &study);
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

/// Traces the first designs of a search again: one of fewer designs begins with the same.
fn begin_again(path: &Path, study: &Study) {
    const DESIGNS: u64 = 4;
    let folder = tempfile::tempdir().unwrap();
    let mut text: toml::Table = study.text.parse().unwrap();
    text["scene"] = fs::canonicalize(&study.scene).unwrap().to_str().unwrap().into();
    text["plan"]["search"]["designs"] = (DESIGNS as i64).into();
    let copy = folder.path().join("first.toml");
    fs::write(&copy, text.to_string()).unwrap();
    let found = search(&copy, &folder.path().join("out"), OnExisting::Keep);
    assert_eq!(found.designs.len() as u64, DESIGNS);
    for design in &found.designs {
        let before = record(&results(path), design.design as u64);
        assert_eq!((&design.settings, &design.outcome), (&before.settings, &before.outcome));
    }
}

/// The results of a whole search.
fn search(path: &Path, dir: &Path, existing: OnExisting) -> StudyReport {
    let options = BatchOptions {
        settings: StudySettings::default(),
        dir: Some(dir.to_path_buf()),
        existing,
        jobs: 2,
        shard: Shard::WHOLE,
    };
    run_study(path, &options, &Interrupt::default(), &|_| {}).unwrap().report.unwrap()
}

/// Half of a beam passes ln 2 / 0.05 mm of this dye.
const DYE: &str = r#"
lumiduct = 1
title = "Dye"
[media.dye]
index = 1
absorption_per_mm = 0.05
[solids.rod.cylinder]
radius_mm = 5
length_mm = 10
medium = "dye"
[sources.beam.disk]
radius_mm = 1
flux_lm = 1
emission = "collimated"
at = { position_mm = [0, 0, -1] }
[sensors.exit]
plane = {}
on = "rod.exit"
counts = "leaving"
"#;

/// The longest rod through which half of the light passes.
const LONGEST: &str = r#"
lumiduct_study = 1
title = "Longest rod"
scene = "dye.toml"
measures = ["exit.efficiency"]
plan = { search = { designs = 40, cost = { length = -1 } } }
[parameters.length]
keys = ["solids.rod.cylinder.length_mm"]
unit = "mm"
range = { from = 1, to = 50 }
[run]
paths = 1000
estimator = "forward"
[[check]]
measure = "exit.efficiency"
min = 0.5
"#;

fn longest(text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("dye.toml"), DYE).unwrap();
    let path = folder.path().join("longest.toml");
    fs::write(&path, text).unwrap();
    (folder, path)
}

#[test]
fn a_search_finds_the_length_of_a_law_of_absorption_and_goes_on_where_it_was_stopped() {
    let (folder, path) = longest(LONGEST);
    let out = folder.path().join("out");
    let whole = search(&path, &out, OnExisting::Keep);
    let best = whole.best_passing().unwrap();
    let length = best.settings["length"].number().unwrap();
    let truth = 2f64.ln() / 0.05;
    assert!(length <= truth && length > truth - 0.02, "{length}, not {truth}");
    assert_eq!(whole.designs[0].settings["length"].number(), Some(10.0), "as in the scene");
    let scene = fs::read_to_string(out.join("dye_best.toml")).unwrap();
    assert!(scene.contains(&format!("length_mm = {length}")), "{scene}");
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    let words = format!("the best that passes is design {}", best.design);
    assert!(page.contains(&words) && page.contains("history.png"), "{page}");
    let again = &whole.confirmations;
    assert_eq!(
        again.iter().map(|own| own.estimator.as_str()).collect::<Vec<_>>(),
        ["forward", "mix"]
    );
    assert!(again.iter().all(|own| own.seed == whole.facts.seed + 1) && whole.is_good());
    assert!(page.contains("## Traced again") && page.contains("traced again, it passes"), "{page}");
    let records = |out: &Path| -> Vec<Vec<u8>> {
        let path = |design: &DesignRecord| out.join(format!("designs/{:04}.json", design.design));
        whole.designs.iter().map(|design| fs::read(path(design)).unwrap()).collect()
    };
    // As after a kill within the search.
    let again = folder.path().join("again");
    fs::create_dir_all(again.join("designs")).unwrap();
    let names = ["batch.json", "longest.toml"].map(str::to_owned).into_iter();
    for name in names.chain((1..=10).map(|design| format!("designs/{design:04}.json"))) {
        fs::copy(out.join(&name), again.join(&name)).unwrap();
    }
    search(&path, &again, OnExisting::Resume);
    assert_eq!(records(&out), records(&again));
    for name in ["study.json", "study.md", "study.csv", "dye_best.toml"] {
        let [before, after] = [&out, &again].map(|out| fs::read(out.join(name)).unwrap());
        assert_eq!(before, after, "{name}");
    }
}

#[test]
fn a_design_that_fails_when_traced_again_is_not_good() {
    let (folder, path) = longest(&LONGEST.replace("designs = 40", "designs = 8"));
    let mut found = search(&path, &folder.path().join("out"), OnExisting::Keep);
    for (outcome, is_good, words) in [
        (CheckOutcome::Undecided, true, "with seed 2 by `mix`: a check is undecided"),
        (CheckOutcome::Failed, false, "traced again, it fails a check"),
    ] {
        let DesignOutcome::Done(result) = &mut found.confirmations[1].outcome else { panic!() };
        result.checks[0].verdict.outcome = outcome;
        assert_eq!(found.is_good(), is_good);
        let text = lumiduct_report::study::terminal(&found);
        assert!(text.contains(words), "{text}");
    }
}

/// A search that the user stops as soon as its progress is this.
fn stopped_when(
    path: &Path,
    out: &Path,
    is_reached: impl Fn(&BatchProgress) -> bool + Sync,
) -> FinishedStudy {
    let options = BatchOptions {
        settings: StudySettings::default(),
        dir: Some(out.to_path_buf()),
        existing: OnExisting::Keep,
        jobs: 1,
        shard: Shard::WHOLE,
    };
    let interrupt = Interrupt::default();
    let stop = |progress: &BatchProgress| {
        if is_reached(progress) {
            interrupt.raise();
        }
    };
    run_study(path, &options, &interrupt, &stop).unwrap()
}

#[test]
fn a_search_that_is_stopped_keeps_the_best_scene_so_far() {
    let (folder, path) = longest(LONGEST);
    let [whole, out] = ["whole", "out"].map(|name| folder.path().join(name));
    search(&path, &whole, OnExisting::Keep);
    let stopped = stopped_when(&path, &out, |progress| progress.done == 9);
    assert!(stopped.report.is_none() && stopped.done[0] < stopped.done[1]);
    let best = fs::read_to_string(out.join("dye_best.toml")).unwrap();
    assert!(best.contains("length_mm = ") && !out.join("study.md").exists(), "{best}");
    search(&path, &out, OnExisting::Resume);
    let [all, resumed] = [&whole, &out].map(|dir| fs::read(dir.join("dye_best.toml")).unwrap());
    assert_eq!(all, resumed);
}

#[test]
fn a_search_that_is_stopped_while_its_best_is_traced_again_is_resumed_there() {
    let (folder, path) = longest(&LONGEST.replace("designs = 40", "designs = 8"));
    let [whole, out] = ["whole", "out"].map(|name| folder.path().join(name));
    search(&path, &whole, OnExisting::Keep);
    // The eighth design is the last of the search.
    let stopped = stopped_when(&path, &out, |progress| progress.wanted > 8);
    assert!(stopped.report.is_none());
    assert_eq!(stopped.done, [8, 9]);
    assert!(out.join("dye_best.toml").exists() && !out.join("study.md").exists());
    search(&path, &out, OnExisting::Resume);
    let [all, resumed] = [&whole, &out].map(|dir| fs::read(dir.join("study.json")).unwrap());
    assert_eq!(all, resumed);
}

#[test]
fn a_search_without_a_design_that_passes_says_which_is_the_closest() {
    let none = LONGEST.replace("min = 0.5", "min = 0.99").replace("designs = 40", "designs = 12");
    let (folder, path) = longest(&none);
    let out = folder.path().join("out");
    let found = search(&path, &out, OnExisting::Keep);
    assert!(found.best_passing().is_none() && !found.is_good());
    let [closest, farthest] = [found.analysis.ranked.first(), found.analysis.ranked.last()];
    let length = |number: usize| found.designs[number - 1].settings["length"].number().unwrap();
    assert!(length(closest.unwrap().design) < length(farthest.unwrap().design));
    assert!(!out.join("dye_best.toml").exists());
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    assert!(page.contains("no design passes"), "{page}");
}

#[test]
fn a_search_for_the_highest_measure_needs_no_cost_and_ends_when_whole_numbers_do() {
    let text = LONGEST
        .replace(", cost = { length = -1 }", "")
        .replace("range = { from = 1, to = 50 }", "range = { from = 8, to = 12 }\nwhole = true")
        .replace("[run]", "[ranking]\nmeasure = \"exit.efficiency\"\n[run]");
    let (folder, path) = longest(&text);
    let found = search(&path, &folder.path().join("out"), OnExisting::Keep);
    assert_eq!(found.best_passing().unwrap().settings["length"].number(), Some(8.0));
    assert!(found.designs.len() <= 5 && found.facts.designs == found.designs.len());
}

#[test]
fn a_search_that_says_nothing_or_too_much_is_refused() {
    let refused = |old: &str, new: &str, words: &str| {
        let text = LONGEST.replace(old, new);
        assert_ne!(text, LONGEST);
        let (_folder, path) = longest(&text);
        let error = load_study(&path, &StudySettings::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{new}: {error}");
    };
    refused(", cost = { length = -1 }", "", "needs to know which design is the best");
    refused("length = -1", "lenght = -1", "there is no parameter `lenght`");
    refused("[run]", "[ranking]\nmeasure = \"exit.efficiency\"\n[run]", "`ranking` already says");
    refused("range = { from = 1, to = 50 }", "values = [1, 2]", "is not for the plan `search`");
    refused("designs = 40", "designs = 3", "3");
    let (folder, path) = longest(LONGEST);
    let options = BatchOptions {
        settings: StudySettings::default(),
        dir: Some(folder.path().join("out")),
        existing: OnExisting::Keep,
        jobs: 1,
        shard: Shard::new(1, 2).unwrap(),
    };
    let error = run_study(&path, &options, &Interrupt::default(), &|_| {}).unwrap_err();
    assert!(error.to_string().contains("a search cannot be split"), "{error}");
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
        include_str!("rod.toml"),
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
