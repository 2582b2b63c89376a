//! Searches for a front, and searches that end when they gain nothing, with a rod whose transmission follows from Beer and Lambert's law.

use crate::searches::{LONGEST, expect_refusal, longest, search, stopped_when};
use lumiduct::study::{OnExisting, SearchLead};
use lumiduct_report::study::{DesignRecord, StudyReport};
use std::fs;

/// The rods that are long, narrow and clear: the narrowest is the best for every length.
fn front(designs: u32) -> String {
    let objectives = r#"cost = { length = -1, radius = 10 }, objectives = [
        { measure = "cost", best = "lowest" }, { measure = "exit.efficiency" }] } }
[parameters.radius]
keys = ["solids.rod.cylinder.radius_mm"]
unit = "mm"
range = { from = 2, to = 8 }"#;
    LONGEST
        .replace("designs = 40", &format!("designs = {designs}"))
        .replace("cost = { length = -1 } } }", objectives)
        .replace("min = 0.5", "min = 0.2")
}

fn length(design: &DesignRecord) -> f64 {
    design.settings["length"].number().unwrap()
}

fn value(design: &DesignRecord, measure: &str) -> f64 {
    design.measure(measure).unwrap().value
}

#[test]
fn a_front_is_the_law_of_absorption_in_the_narrowest_rod() {
    let (folder, path) = longest(&front(72));
    let out = folder.path().join("out");
    let found = search(&path, &out, OnExisting::Keep);
    let of_front: Vec<&DesignRecord> = found.front().collect();
    assert!(of_front.len() >= 8 && found.is_good(), "{}", of_front.len());
    let mut last = f64::NEG_INFINITY;
    for design in &of_front {
        let [cost, share] = ["cost", "exit.efficiency"].map(|name| value(design, name));
        assert!(cost > last && design.passes());
        last = cost;
        // A rod of this share that is as narrow as possible, and 3 mm of length or 0.3 mm of radius more.
        let least = 20.0 + share.ln() / 0.05;
        assert!(cost < least + 3.0, "design {}: {cost}, least {least}", design.design);
    }
    // From the longest that passes, as 0.2 of the light is left after 32.19 mm, to the shortest.
    let ends = [0, of_front.len() - 1].map(|place| length(of_front[place]));
    assert!((31.5..32.2).contains(&ends[0]) && ends[1] < 1.1, "{ends:?}");
    // No other design that passes is better in both.
    for own in &of_front {
        let beats = |other: &&DesignRecord| {
            other.passes()
                && value(other, "cost") < value(own, "cost")
                && value(other, "exit.efficiency") > value(own, "exit.efficiency")
        };
        assert!(!found.designs.iter().any(|other| beats(&other)));
    }
    expect_files(&found, &out);
    // As after a kill within the search.
    let again = folder.path().join("again");
    fs::create_dir_all(again.join("designs")).unwrap();
    let names = ["batch.json", "longest.toml"].map(str::to_owned).into_iter();
    for name in names.chain((1..=30).map(|design| format!("designs/{design:04}.json"))) {
        fs::copy(out.join(&name), again.join(&name)).unwrap();
    }
    search(&path, &again, OnExisting::Resume);
    for name in ["study.json", "study.md", "study.csv"] {
        let [before, after] = [&out, &again].map(|out| fs::read(out.join(name)).unwrap());
        assert_eq!(before, after, "{name}");
    }
}

/// Checks the files of a front: a scene of each design, its place in the table, the page and the picture.
fn expect_files(found: &StudyReport, out: &std::path::Path) {
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    assert!(page.contains("## Front") && page.contains("traced again, all pass"), "{page}");
    assert!(page.contains("front.exit.efficiency.cost.png"), "{page}");
    let table = fs::read_to_string(out.join("study.csv")).unwrap();
    let mut rows = csv::Reader::from_reader(table.trim_start_matches('\u{feff}').as_bytes());
    let rank = rows.headers().unwrap().iter().position(|name| name == "rank").unwrap();
    let ranks: Vec<String> = rows.records().map(|row| row.unwrap()[rank].to_owned()).collect();
    for (place, design) in found.front().enumerate() {
        assert_eq!(ranks[design.design - 1], (place + 1).to_string());
        let scene = format!("dye_design_{}.toml", design.design);
        let scene = fs::read_to_string(out.join(scene)).unwrap();
        assert!(scene.contains(&format!("length_mm = {}", length(design))), "{scene}");
        let again = found.confirmations.iter().filter(|own| own.design == Some(design.design));
        assert_eq!(again.count(), 2);
    }
    assert_eq!(ranks.iter().filter(|rank| !rank.is_empty()).count(), found.front().count());
    assert!(!out.join("dye_best.toml").exists());
    let words = lumiduct_report::study::terminal(found);
    assert!(words.contains("the front has ") && words.contains(", exit.efficiency 0."), "{words}");
}

#[test]
fn a_front_on_which_no_design_passes_is_empty_and_not_good() {
    let (folder, path) = longest(&front(24).replace("min = 0.2", "min = 0.99"));
    let out = folder.path().join("out");
    let found = search(&path, &out, OnExisting::Keep);
    assert!(found.front().next().is_none() && !found.is_good());
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    assert!(page.contains("no design passes, so the search found none"), "{page}");
}

#[test]
fn the_progress_of_a_front_says_how_many_designs_it_has() {
    let (folder, path) = longest(&front(24));
    let stopped = stopped_when(&path, &folder.path().join("out"), |progress| {
        let size = match progress.lead {
            Some(SearchLead::Front { designs }) => designs,
            Some(SearchLead::Best(_)) => panic!("there is no best design"),
            None => return false,
        };
        assert!(progress.sentence().contains(&format!(", {size} on the front")));
        progress.done >= 5
    });
    assert!(stopped.report.is_none() && stopped.done[0] >= 5);
}

#[test]
fn objectives_that_contradict_other_keys_are_refused() {
    let refused = |old: &str, new: &str, words: &str| {
        let text = front(24);
        let changed = text.replace(old, new);
        assert_ne!(changed, text);
        expect_refusal(&changed, words);
    };
    refused("\"exit.efficiency\" }]", "\"exit.flux\" }]", "`exit.flux` is not one of `measures`");
    refused(", { measure = \"exit.efficiency\" }", "", "a front has two or more");
    refused("\"exit.efficiency\" }]", "\"cost\" }]", "`cost` is listed twice");
    refused("{ measure = \"cost\", best = \"lowest\" }, ", "", "it is none of the `objectives`");
    refused("designs = 24", "designs = 11", "give 12 or more");
    refused("designs = 24", "designs = 24, least_gain = 0", "a front has no best design to gain");
    let ranked = "[ranking]\nmeasure = \"exit.efficiency\"\n[run]";
    refused("[run]", ranked, "`ranking` already says which design is the best");
    let tolerant = "to = 50 }\ntolerance = { plus_minus = 0.1 }";
    refused("to = 50 }", tolerant, "a front has no best design to scatter");
    let other = "keys = [\"solids.rod.cylinder.medium\"]\nchoices = { a = \"dye\", b = \"dye\" }";
    let chosen = front(23).replace("[run]", &format!("[parameters.medium]\n{other}\n[run]"));
    expect_refusal(&chosen, "give 24 or more, or fewer choices");
}

#[test]
fn a_search_ends_when_its_latest_designs_gain_no_more_than_is_wanted() {
    let (folder, path) =
        longest(&LONGEST.replace("designs = 40", "designs = 80, least_gain = 0.05"));
    let out = folder.path().join("out");
    let found = search(&path, &out, OnExisting::Keep);
    // The longest of 13.863 mm is known to 0.05 after some twenty designs, and ten later it ends.
    assert!((20..60).contains(&found.designs.len()), "{}", found.designs.len());
    let best = length(found.best_passing().unwrap());
    assert!((13.7..=13.864).contains(&best), "{best}");
    let gain = found.analysis.latest_gain.unwrap();
    assert!(gain.designs == 10 && (0.0..=0.05).contains(&gain.gain.value), "{gain:?}");
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    assert!(page.contains("ended because its latest 10 designs gained no more than"), "{page}");
    let before = fs::read(out.join("study.json")).unwrap();
    for number in 9..=found.designs.len() {
        fs::remove_file(out.join(format!("designs/{number:04}.json"))).unwrap();
    }
    search(&path, &out, OnExisting::Resume);
    assert_eq!(fs::read(out.join("study.json")).unwrap(), before);
}
