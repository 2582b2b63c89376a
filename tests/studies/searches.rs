//! Searches for the best design of a rod whose transmission follows from Beer and Lambert's law.

use lumiduct::study::{
    BatchEvent, BatchOptions, BatchProgress, FinishedStudy, OnExisting, run_study,
};
use lumiduct_core::measure::CheckOutcome;
use lumiduct_core::transport::{Interrupt, Shard};
use lumiduct_input::{StudySettings, load_study};
use lumiduct_report::study::{DesignOutcome, DesignRecord, StudyReport};
use std::fs;
use std::path::{Path, PathBuf};

/// The results of a whole search.
pub(crate) fn search(path: &Path, dir: &Path, existing: OnExisting) -> StudyReport {
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
pub(crate) const LONGEST: &str = r#"
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

pub(crate) fn longest(text: &str) -> (tempfile::TempDir, PathBuf) {
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
    let words = format!("the best that passes is design {} (length {length:.2} mm)", best.design);
    assert!(page.contains(&words) && page.contains("history.png"), "{page}");
    // What fails may be longer than the best, but is not ahead of it.
    assert!(page.lines().any(|line| line.ends_with(" mm |  | failed |")), "{page}");
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
pub(crate) fn stopped_when(
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
    let stop = |event: BatchEvent<'_>| match event {
        BatchEvent::Progress(progress) if is_reached(&progress) => interrupt.raise(),
        BatchEvent::Read(_) | BatchEvent::Progress(_) => {}
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
fn a_search_finds_the_clearer_of_two_media_and_goes_on_where_it_was_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let ink = "[media.ink]\nindex = 1\nabsorption_per_mm = 0.1\n[solids";
    fs::write(folder.path().join("dye.toml"), DYE.replacen("[solids", ink, 1)).unwrap();
    let media = "[parameters.medium]\nkeys = [\"solids.rod.cylinder.medium\"]\nchoices = { dark = \"ink\", clear = \"dye\" }\n[run]";
    let path = folder.path().join("longest.toml");
    fs::write(&path, LONGEST.replace("[run]", media)).unwrap();
    let out = folder.path().join("out");
    let found = search(&path, &out, OnExisting::Keep);
    let best = found.best_passing().unwrap();
    assert_eq!(best.settings["medium"].to_string(), "clear");
    let length = best.settings["length"].number().unwrap();
    assert!((length - 2_f64.ln() / 0.05).abs() < 0.05, "{length}");
    let scene = fs::read_to_string(out.join("dye_best.toml")).unwrap();
    assert!(scene.contains("medium = \"dye\""), "{scene}");
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    let (_, table) = page.split_once("## Best of each combination of choices").unwrap();
    let rows = table.lines().filter(|line| line.starts_with("| ")).skip(2).take(2);
    let cells = |row: &str| -> Vec<String> { row.split(" | ").map(str::to_owned).collect() };
    let found_rows: Vec<_> = rows.map(cells).collect();
    assert!(found_rows[0][0].contains("clear") && found_rows[0][5].starts_with("30 "), "{page}");
    assert!(found_rows[1][0].contains("dark") && found_rows[1][5].starts_with("10 "), "{page}");
    // Without the records of later designs it traces these again, to the same bytes: in the first lap, at its end, after it.
    let before = fs::read(out.join("study.csv")).unwrap();
    for first in [5, 21, 30] {
        for number in first..=found.designs.len() {
            fs::remove_file(out.join(format!("designs/{number:04}.json"))).unwrap();
        }
        search(&path, &out, OnExisting::Resume);
        assert_eq!(fs::read(out.join("study.csv")).unwrap(), before);
    }
}

pub(crate) fn expect_refusal(text: &str, words: &str) {
    let (_folder, path) = longest(text);
    let error = load_study(&path, &StudySettings::default()).unwrap_err().to_string();
    assert!(error.contains(words), "{text}: {error}");
}

#[test]
fn a_search_that_says_nothing_or_too_much_is_refused() {
    let refused = |old: &str, new: &str, words: &str| {
        let text = LONGEST.replace(old, new);
        assert_ne!(text, LONGEST);
        expect_refusal(&text, words);
    };
    refused(", cost = { length = -1 }", "", "needs to know which design is the best");
    refused("length = -1", "lenght = -1", "there is no parameter `lenght`");
    refused("[run]", "[ranking]\nmeasure = \"exit.efficiency\"\n[run]", "`ranking` already says");
    refused("range = { from = 1, to = 50 }", "values = [1, 2]", "is not for the plan `search`");
    refused("designs = 40", "designs = 3", "3");
    let choices = "keys = [\"solids.rod.cylinder.length_mm\"]\nchoices = { a = 1, b = 2 }";
    let old =
        "keys = [\"solids.rod.cylinder.length_mm\"]\nunit = \"mm\"\nrange = { from = 1, to = 50 }";
    refused(old, choices, "there is nothing to search");
    let radius = format!("[parameters.radius]\n{}\n[run]", choices.replace("length", "radius"));
    let more = radius.replace("b = 2", "b = 2, c = 3, d = 4, e = 5, f = 6, g = 7, h = 8, i = 9, j = 10, k = 11, l = 12, m = 13, n = 14");
    refused("[run]", &more, "too few for 14 combinations");
    let tolerant = radius.replace("[run]", "tolerance = { plus_minus = 0.1 }\n[run]");
    refused("[run]", &tolerant, "a choice does not scatter");
    let priced = LONGEST.replace("length = -1", "length = -1, radius = 1");
    expect_refusal(&priced.replace("[run]", &radius), "its choices are no numbers");
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

/// The longest rod, whose length production keeps to 0.1 mm while the beam moves along its axis.
fn produced() -> String {
    let axis = "[parameters.gap]\nkeys = [\"sources.beam.disk.at.position_mm.2\"]\nunit = \"mm\"\ntolerance = { std_dev = 0.05 }\n[run]";
    LONGEST
        .replace("designs = 40,", "designs = 40, samples = 60,")
        .replace("to = 50 }", "to = 50 }\ntolerance = { plus_minus = 0.1 }")
        .replace("[run]", axis)
}

#[test]
fn half_of_the_rods_at_the_limit_fail_in_production_and_slopes_are_those_of_the_law() {
    let (folder, path) = longest(&produced());
    let out = folder.path().join("out");
    let found = search(&path, &out, OnExisting::Keep);
    let best = found.best_passing().unwrap().settings["length"].number().unwrap();
    let made = found.production.as_deref().unwrap();
    assert_eq!((made.designs.len(), made.facts.seed), (60, found.facts.seed + 1));
    for design in &made.designs {
        let length = design.settings["length"].number().unwrap();
        let share = design.measure("exit.efficiency").unwrap().value;
        assert!((length - best).abs() <= 0.1);
        assert!((share - (-0.05 * length).exp()).abs() < 1e-12, "{length}: {share}");
    }
    // The search ends at the limit, so half of them are too long: 30 of 60, with a standard deviation of 3.9.
    let failed = &made.analysis.failures[0];
    assert!((15..=45).contains(&failed.failed) && failed.undecided == 0, "{failed:?}");
    let [length, gap] = &made.analysis.sensitivities[0].indices[..] else { panic!() };
    let [slope, _] = length.slope.unwrap();
    // The derivative of exp(-0.05 x) where it is a half; to both sides it changes by 0.5 %.
    assert!((slope + 0.025).abs() < 1e-4, "{slope}");
    // What is left of the fit is the curvature of the law, up to 6e-6, over the 0.05 mm of the gap.
    assert!(gap.slope.unwrap()[0].abs() < 1e-4, "{gap:?}");
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    assert!(
        page.contains("## In production") && page.contains("length in mm: uniform from 13.7"),
        "{page}"
    );
    let table = fs::read_to_string(out.join("production.csv")).unwrap();
    assert_eq!(table.lines().count(), 61);
    assert!(out.join("production.exit.efficiency.png").exists());
    assert!(lumiduct_report::study::terminal(&found).contains("expected in production"));
}

#[test]
fn parts_that_give_no_scene_fail_and_are_told() {
    // The shortest rod that is allowed has 0.05 mm, so that about a quarter of the parts have less than none.
    let text = produced()
        .replace("length = -1", "length = 1")
        .replace("from = 1, to = 50", "from = 0.05, to = 50")
        .replace("designs = 40", "designs = 30");
    let (folder, path) = longest(&text);
    let found = search(&path, &folder.path().join("out"), OnExisting::Keep);
    let made = found.production.as_deref().unwrap();
    let broken = made.counts().broken;
    assert!((5..=27).contains(&broken), "{broken}");
    assert_eq!(made.analysis.failures[0].failed, broken);
    let words = format!("{broken} of 60 simulated parts give no valid scene and count as failed");
    assert!(lumiduct_report::study::terminal(&found).contains(&words));
    let page = fs::read_to_string(folder.path().join("out/study.md")).unwrap();
    assert!(page.contains(&words), "{page}");
    assert!(made.facts.measures.iter().all(|measure| measure != "cost"));
}

#[test]
fn production_that_is_stopped_is_resumed_there_and_replaced_as_a_whole() {
    let text = produced().replace("designs = 40", "designs = 8");
    let (folder, path) = longest(&text);
    let [whole, out] = ["whole", "out"].map(|name| folder.path().join(name));
    search(&path, &whole, OnExisting::Keep);
    let stopped = stopped_when(&path, &out, |progress| progress.wanted == 60 && progress.done > 20);
    assert!(stopped.report.is_none() && !out.join("study.md").exists());
    assert!((29..68).contains(&stopped.done[0]) && stopped.done[1] == 68, "{:?}", stopped.done);
    let records = |dir: &Path| fs::read_dir(dir.join("designs")).unwrap().count();
    search(&path, &out, OnExisting::Resume);
    for name in ["study.json", "study.md", "study.html", "production.csv", "designs/0068.json"] {
        let [before, after] = [&whole, &out].map(|dir| fs::read(dir.join(name)).unwrap());
        assert_eq!(before, after, "{name}");
    }
    // Without a tolerance nothing of production remains.
    fs::write(&path, LONGEST.replace("designs = 40", "designs = 8")).unwrap();
    let found = search(&path, &out, OnExisting::Replace);
    assert!(found.production.is_none() && records(&out) == 8);
    assert!(!out.join("production.csv").exists());
}

#[test]
fn tolerances_that_say_nothing_are_refused() {
    let refused = |old: &str, new: &str, words: &str| {
        let text = produced().replace(old, new);
        assert_ne!(text, produced());
        let (_folder, path) = longest(&text);
        let error = load_study(&path, &StudySettings::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{new}: {error}");
    };
    refused("plus_minus = 0.1", "plus_minus = 0", "0 is out of range, expected above 0");
    refused("plus_minus = 0.1", "plus_minus = 1e308", "is no width");
    refused("samples = 60", "samples = 1", "1 is out of range, expected 2 to");
    let text = LONGEST.replace("designs = 40,", "designs = 40, samples = 60,");
    let (_folder, path) = longest(&text);
    let error = load_study(&path, &StudySettings::default()).unwrap_err().to_string();
    assert!(error.contains("no parameter has a `tolerance`"), "{error}");
    refused(
        "tolerance = { plus_minus",
        "whole = true\ntolerance = { plus_minus",
        "does not scatter",
    );
    refused("position_mm.2\"", "offset_mm.0\"", "no common number");
    refused("length = -1", "length = -1, gap = 1", "the search does not change it");
    refused("range = { from = 1, to = 50 }\n", "", "there is nothing to search");
    let sampled = "latin_hypercube = { samples = 8 }";
    refused(
        "search = { designs = 40, samples = 60, cost = { length = -1 } }",
        sampled,
        "is for a search",
    );
}
