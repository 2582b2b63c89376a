//! Studies as a user runs them.

use crate::*;

pub(crate) const STUDY: &str = r#"
lumiduct_study = 1
title = "How long a rod?"
scene = "rod.toml"
measures = ["exit.efficiency", "exit.uniformity_min_avg"]
plan = "grid"
[parameters.length]
keys = ["solids.rod.cylinder.length_mm"]
unit = "mm"
values = [5, 10, 20]
[parameters.index]
keys = ["media.acrylic.index"]
range = { from = 1.4, to = 1.6, count = 2 }
[run]
paths = 20_000
estimator = "forward"
[ranking]
measure = "exit.efficiency"
"#;

/// A place with a study and its scene.
pub(crate) fn study(text: &str) -> Place {
    let place = Place::new();
    fs::write(place.path("study.toml"), text).unwrap();
    place
}

fn rows(place: &Place, folder: &str) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(place.path(folder).join("study.csv")).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

#[test]
fn a_grid_becomes_a_row_for_each_design_and_they_are_what_runs_give() {
    let place = study(STUDY);
    let said = place.good("batch study.toml");
    assert!(
        said.contains("6 designs") && said.contains("reports/studies/study/study.md"),
        "{said}"
    );
    let rows = rows(&place, "reports/studies/study");
    assert_eq!(rows.len(), 6);
    assert_eq!((rows[4]["length_mm"].as_str(), rows[4]["index"].as_str()), ("20", "1.4"));
    // The batches of a study hold other paths than those of a run alone: the same light, other noise.
    place
        .good("run rod.toml -D solids.rod.cylinder.length_mm=20 -D media.acrylic.index=1.4 -o one");
    let summary = place.summary("one");
    let alone = &summary["measures"]["exit.efficiency"];
    let number = |name: &str| rows[4][name].parse::<f64>().unwrap();
    let apart = number("exit.efficiency") - alone["value"].as_f64().unwrap();
    let error = number("exit.efficiency.std_error").hypot(alone["std_error"].as_f64().unwrap());
    assert!(apart.abs() < 4.0 * error, "{apart} ± {error}");
    let page = fs::read_to_string(place.path("reports/studies/study/study.md")).unwrap();
    for words in
        ["## Ranking", "## Sensitivity", "effect.exit.efficiency.length.png", "scatter.png"]
    {
        assert!(page.contains(words), "no {words}");
    }
}

#[test]
fn a_scene_is_no_study_and_a_study_no_scene() {
    let place = study(STUDY);
    assert!(place.bad(2, "run study.toml").contains("run it with `lumiduct batch`"));
    assert!(place.bad(2, "batch rod.toml").contains("trace it with `lumiduct run`"));
}

#[test]
fn the_command_line_does_not_set_what_a_parameter_sets() {
    let said = study(STUDY).bad(2, "batch study.toml -o out -D media.acrylic.index=1.3");
    assert!(said.contains("what `-D media.acrylic.index=1.3` sets"), "{said}");
}

#[test]
fn a_design_that_makes_no_scene_is_a_row_with_its_error_and_the_rest_goes_on() {
    // A rod of index 0.5 is out of range, be it the first value or the last.
    let place = study(&STUDY.replace("from = 1.4, to = 1.6", "from = 0.5, to = 1.4"));
    let output = place.run("batch study.toml -o out");
    assert_eq!(code(&output), 1, "{}", errors(&output));
    let rows = rows(&place, "out");
    assert!(rows[0]["error"].contains("out of range") && rows[0]["exit.efficiency"].is_empty());
    assert!(rows[1]["error"].is_empty() && !rows[1]["exit.efficiency"].is_empty());
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains("gives no valid scene") && !said.contains(&*place.0.path().to_string_lossy())
    );
}

#[test]
fn samples_tell_the_share_that_fails_and_what_it_hangs_on() {
    let text = STUDY
        .replace("plan = \"grid\"", "plan = { tolerance = { samples = 24, seed = 2 } }")
        .replace("values = [5, 10, 20]", "spread = { uniform = { from = 5, to = 20 } }")
        .replace(
            "range = { from = 1.4, to = 1.6, count = 2 }",
            "spread = { normal = { mean = 1.5, std_dev = 0.05, from = 1.4 } }",
        )
        + "[[check]]\nmeasure = \"exit.efficiency\"\nmin = 0.865\n";
    let place = study(&text);
    let output = place.run("batch study.toml -o out");
    assert_eq!(code(&output), 1, "{}", errors(&output));
    let summary: Value =
        serde_json::from_slice(&fs::read(place.path("out/study.json")).unwrap()).unwrap();
    let all = &summary["analysis"]["failures"][0];
    let count = |name: &str| all[name].as_u64().unwrap();
    assert_eq!(count("passed") + count("failed") + count("undecided"), 24);
    let fails =
        rows(&place, "out").iter().filter(|row| row["check exit.efficiency"] == "failed").count();
    assert_eq!(fails as u64, count("failed"));
    let indices = summary["analysis"]["sensitivities"][0]["indices"].as_array().unwrap().clone();
    // Fresnel losses grow with the index, and the length of a clear rod has no effect.
    let index = indices.iter().find(|own| own["parameter"] == "index").unwrap();
    assert!(index["value"].as_f64().unwrap() < -0.8, "{index}");
    assert!(place.path("out/distribution.exit.efficiency.png").exists());
}

#[test]
fn a_choice_that_makes_no_scene_is_named_with_its_line() {
    let misspelt = "choices = { acrylic = \"acrylic\", dense = \"acrylc\" }";
    let text = STUDY
        .replace("media.acrylic.index", "solids.rod.cylinder.medium")
        .replace("range = { from = 1.4, to = 1.6, count = 2 }", misspelt);
    let place = study(&text);
    let output = place.run("batch study.toml -o out");
    assert_eq!(code(&output), 1);
    let said = String::from_utf8(output.stderr).unwrap();
    let words = ["study.toml:13", "unknown medium `acrylc`", "did you mean `acrylic`"];
    assert!(words.iter().all(|word| said.contains(word)), "{said}");
    // Before anything is computed, and so before a batch that fails.
    let said = place.bad(2, "batch study.toml -o out");
    let [remark, failure] = ["unknown medium `acrylc`", "error:"].map(|part| said.find(part));
    assert!(remark.is_some() && remark < failure, "{said}");
}

#[test]
fn tables_choices_and_whole_reports() {
    let text = STUDY
        .replace(
            "plan = \"grid\"",
            "plan = { list = { file = \"designs.csv\" } }\nkeep = \"reports\"",
        )
        .replace("values = [5, 10, 20]\n", "")
        .replace(
            "range = { from = 1.4, to = 1.6, count = 2 }",
            "choices = { light = 1.4, dense = 1.6 }",
        );
    let place = study(&text);
    fs::write(place.path("designs.csv"), "index, length\nlight, 5\n,7.5\ndense,\n").unwrap();
    place.good("batch study.toml -o out");
    let rows = rows(&place, "out");
    let row = |place: usize| [rows[place]["length_mm"].as_str(), rows[place]["index"].as_str()];
    // Empty cells are as in the scene.
    assert_eq!([row(0), row(1), row(2)], [["5", "light"], ["7.5", "1.49"], ["10", "dense"]]);
    assert!(place.path("out/designs/0003/report.md").exists());

    fs::write(
        place.path("study.toml"),
        text.replace("[parameters.index]", "whole = true\n[parameters.index]"),
    )
    .unwrap();
    fs::write(place.path("designs.csv"), "index,length\nlight,7.4\nlight,-0.4\n").unwrap();
    assert_eq!(code(&place.run("batch study.toml -o round")), 1);
    let rounded = self::rows(&place, "round");
    assert_eq!([&rounded[0]["length_mm"], &rounded[1]["length_mm"]], ["7", "0"]);
    fs::write(place.path("study.toml"), &text).unwrap();
    for (table, line, words) in [
        ("index,lenght\nheavy,5\n", 1, "there is no parameter `lenght`"),
        ("index,length\nlight,5\nheavy,5\n", 3, "`heavy` is not one of its choices"),
        ("index,length\nlight,five\n", 2, "`five` is not a number"),
        ("index,length\nlight\n", 2, "a different number of cells"),
        ("index,length,length\nlight,5,6\n", 1, "the column `length` occurs twice"),
        ("index;length\nlight;5\n", 1, "by commas, not by semicolons"),
        ("index\tlength\nlight\t5\n", 1, "by commas, not by tabs"),
        ("index,length\nlight,\"5\nlight,6\n", 2, "a quotation mark is not closed"),
        ("index,length\n", 1, "no designs"),
    ] {
        fs::write(place.path("designs.csv"), table).unwrap();
        let said = place.bad(2, "batch study.toml -o bad");
        assert!(said.contains(&format!("designs.csv:{line}")), "{table}: {said}");
        assert!(said.contains(words), "{table}: {said}");
    }
    assert!(!place.path("bad").exists());

    // Nothing of an older study remains next to the new results.
    fs::write(place.path("study.toml"), text.replace("keep = \"reports\"", "")).unwrap();
    fs::write(place.path("designs.csv"), "index,length\nlight,5\n").unwrap();
    place.good("batch study.toml -o out --overwrite");
    assert_eq!(names(&place.path("out/designs")), ["0001.json"]);
}

#[test]
fn a_file_that_a_choice_names_is_part_of_the_study() {
    let text = STUDY.replace("measures = [", "measures = [\"extra.flux\", ")
        + "[parameters.cells]\nkeys = [\"sensors.extra.file\"]\n"
        + "choices = { coarse = \"coarse.toml\", fine = \"fine.toml\" }\n";
    let place = study(&text);
    let scene = fs::read_to_string(place.path("rod.toml")).unwrap();
    let scene = scene.replace(
        "[sensors]\n",
        "[sensors]\nextra = { file = \"coarse.toml\", on = \"rod.exit\", counts = \"leaving\" }\n",
    );
    fs::write(place.path("rod.toml"), scene).unwrap();
    fs::write(place.path("coarse.toml"), "plane = { cells = [2, 2] }\n").unwrap();
    assert_eq!(code(&place.run("batch study.toml -o out")), 1);
    assert_eq!(rows(&place, "out").iter().filter(|row| !row["error"].is_empty()).count(), 6);
    fs::write(place.path("fine.toml"), "plane = { cells = [8, 8] }\n").unwrap();
    assert!(place.bad(2, "batch study.toml -o out --resume").contains("another study"));
    place.good("batch study.toml -o out --overwrite");
    fs::write(place.path("fine.toml"), "plane = { cells = [9, 9] }\n").unwrap();
    assert!(place.bad(2, "batch study.toml -o out --resume").contains("another study"));
    // A choice that gives no valid scene counts, too: with other parameters it might.
    fs::write(place.path("fine.toml"), "plane = { cells = [9, 0] }\n").unwrap();
    assert_eq!(code(&place.run("batch study.toml -o out --overwrite")), 1);
    assert_eq!(code(&place.run("batch study.toml -o out --resume")), 1);
    fs::write(place.path("fine.toml"), "plane = { cells = [8, 0] }\n").unwrap();
    assert!(place.bad(2, "batch study.toml -o out --resume").contains("another study"));
}

#[test]
fn whole_numbers_of_a_spread_are_as_likely_as_it_says_and_within_its_limits() {
    let text = STUDY
        .replace("plan = \"grid\"", "plan = { latin_hypercube = { samples = 30 } }")
        .replace(
            "values = [5, 10, 20]",
            "spread = { uniform = { from = 4.2, to = 7.9 } }\nwhole = true",
        )
        .replace("paths = 20_000", "paths = 200");
    let place = study(&text);
    place.run("batch study.toml -o out");
    let rows = rows(&place, "out");
    for length in ["5", "6", "7"] {
        assert_eq!(rows.iter().filter(|row| row["length_mm"] == length).count(), 10, "{length}");
    }
}

#[test]
fn a_table_may_say_what_the_scene_says() {
    let text = STUDY
        .replace("plan = \"grid\"", "plan = { list = { file = \"designs.csv\" } }")
        .replace("values = [5, 10, 20]\n", "")
        .replace("range = { from = 1.4, to = 1.6, count = 2 }\n", "");
    let place = study(&text);
    // The rod of the scene has a length of 10 mm: these differ only in their index.
    fs::write(place.path("designs.csv"), "length,index\n,1.4\n10,1.6\n").unwrap();
    place.good("batch study.toml -o out");
    let summary: Value =
        serde_json::from_slice(&fs::read(place.path("out/study.json")).unwrap()).unwrap();
    let effects = summary["analysis"]["effects"].as_array().unwrap();
    assert!(effects.iter().any(|effect| effect["parameter"] == "index"), "{effects:?}");
}

#[test]
fn bad_studies_are_refused_with_the_line_to_change_and_write_nothing() {
    for (from, to, words) in [
        ("plan = \"grid\"", "plan = \"gird\"", "grid"),
        ("length_mm\"]", "lenght_mm\"]", "length_mm"),
        ("media.acrylic.index\"]", "media.acrylic.\"]", "not a dotted key"),
        ("values = [5, 10, 20]", "", "has no values"),
        ("values = [5, 10, 20]", "values = [5]\nchoices = { a = 1 }", "given twice"),
        ("values = [5, 10, 20]", "choices = [5, 10, 20]", "study.toml:10"),
        ("values = [5, 10, 20]", "spread = { uniform = { from = 2, to = 1 } }", "not below"),
        ("from = 1.4, to = 1.6", "from = 1.6, to = 1.4", "not below"),
        ("count = 2 }", "count = 2 }\nwhole = true", "no whole number from 1.4 to 1.6"),
        ("to = 1.6, count = 2 }", "to = 2.4, count = 3 }\nwhole = true", "2 is listed twice"),
        ("values = [5, 10, 20]", "values = [5, 10, 5]", "5 is listed twice"),
        ("values = [5, 10, 20]", "values = [5, 5.2, 6]\nwhole = true", "5 is listed twice"),
        ("[parameters.length]", "[parameters.\"a/b\"]", "letters, digits"),
        ("[parameters.length]", LONG_PARAMETER, "a name of 67 letters is too long, at most 64"),
        ("unit = \"mm\"", "unit = \"m\\nm\"", "a unit is a few letters"),
        ("[parameters.index]", "[parameters.design]", "two columns `design`"),
        (
            "[\"exit.efficiency\"",
            "[\"exit.efficiency\", \"exit.efficiency\"",
            "`exit.efficiency` is listed twice",
        ),
        (
            "keys = [\"media.acrylic.index\"]",
            "keys = [{ key = \"media.acrylic.index\", factor = 0 }]",
            "leaves nothing to vary",
        ),
        (
            "[run]",
            "[[check]]\nmeasure = \"exit.efficiency\"\nmin = 0.9\nmax = 0.8\n[run]",
            "0.9 is above `max`",
        ),
        ("[run]", "[set]\n\"media.acrylic.index\" = 1.5\n[run]", "sets it in every design"),
        ("[run]", "[set]\n\"media.acrylic.indx\" = 1.5\n[run]", "study.toml:15"),
        ("scene = \"rod.toml\"", "scene = \"rood.toml\"", "study.toml:4"),
        ("\"exit.uniformity_min_avg\"", "\"exit.uniformity_minavg\"", "exit.uniformity_min_avg"),
        ("\"exit.uniformity_min_avg\"", "\"exot.uniformity_min_avg\"", "study.toml:5"),
        ("[\"exit.efficiency\"", "[\"exit.eficiency\"", "study.toml:5"),
        (
            "[ranking]\nmeasure = \"exit.efficiency\"",
            "[ranking]\nmeasure = \"exit.flux\"",
            "not one of `measures`",
        ),
        ("paths = 20_000", "paths = 0", "at least 1"),
        ("count = 2", "count = 1", "out of range"),
        ("unit = \"mm\"", "units = \"mm\"", "unit"),
        (
            "lumiduct_study = 1",
            "lumiduct_study = 2",
            "study.toml:2: `lumiduct_study`: format version 2",
        ),
        ("\"How long a rod?\"", "\"How long\\na rod?\"", "a title must be one line"),
        ("lumiduct_study = 1", "lumiduct = 1", "study.toml:2: `lumiduct`: this is a scene"),
        ("media.acrylic.index\"]", "solids.rod.cylinder.length_mm\"]", "sets this key"),
        ("media.acrylic.index\"]", "solids.rod.cylinder\"]", "or a part of it"),
        (
            "values = [5, 10, 20]",
            "spread = { normal = { mean = 5, std_dev = 0.1, from = 6 } }",
            "exclude the whole distribution",
        ),
        ("[run]", "[set]\n\"run.seed\" = 3\n[run]", "under `run` of the study"),
    ] {
        let text = STUDY.replace(from, to);
        assert_ne!(text, STUDY, "{from}");
        let place = study(&text);
        let said = place.bad(2, "batch study.toml");
        assert!(said.contains(words), "{to}: no {words} in {said}");
        assert!(!place.path("reports").exists(), "{to}");
    }
}

/// A parameter whose name is too long for a file name together with that of a measure.
const LONG_PARAMETER: &str =
    "[parameters.length_6789_123456789_123456789_123456789_123456789_123456789_12345]";
