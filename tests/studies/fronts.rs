//! Searches for a front, and searches that end when they gain nothing, with a rod whose transmission follows from Beer and Lambert's law.

use crate::searches::{LONGEST, expect_refusal, longest, search, stopped_when};
use lumiduct::study::{OnExisting, SearchLead};
use lumiduct_report::study::{DesignRecord, StudyReport};
use std::fs;
use std::sync::Mutex;

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
    // All designs for which no other that passes is as good in both and better in one, and no others.
    let costs = |own: &DesignRecord| [value(own, "cost"), -value(own, "exit.efficiency")];
    let passing: Vec<&DesignRecord> = found.designs.iter().filter(|own| own.passes()).collect();
    let is_beaten = |own: &DesignRecord| {
        let [cost, loss] = costs(own);
        passing
            .iter()
            .map(|other| costs(other))
            .any(|other| other[0] <= cost && other[1] <= loss && other != [cost, loss])
    };
    let unbeaten = passing.iter().filter(|own| !is_beaten(own)).map(|own| own.design);
    let mut of_front: Vec<usize> = of_front.iter().map(|own| own.design).collect();
    of_front.sort_unstable();
    assert_eq!(unbeaten.collect::<Vec<_>>(), of_front);
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
    assert!(page.contains("## Front\n") && page.contains("traced again, all pass"), "{page}");
    assert!(page.contains("## Front traced again") && page.contains(" | dye_design_"), "{page}");
    assert!(page.contains("lie at the edge of a range tried"), "{page}");
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
        assert!(scene.contains(&format!("title = \"Dye, design {}\"", design.design)), "{scene}");
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
    let (folder, path) = longest(&front(30).replace("min = 0.2", "min = 0.99"));
    let out = folder.path().join("out");
    let found = search(&path, &out, OnExisting::Keep);
    assert!(found.front().next().is_none() && !found.is_good());
    let page = fs::read_to_string(out.join("study.md")).unwrap();
    assert!(page.contains("no design passes, so the search found none"), "{page}");
}

#[test]
fn a_front_of_three_objectives_has_a_picture_of_each_pair() {
    let third =
        "{ measure = \"exit.efficiency\" }, { measure = \"exit.flux\", best = \"lowest\" }]";
    let text = front(50)
        .replace("{ measure = \"exit.efficiency\" }]", third)
        .replace("measures = [", "measures = [\"exit.flux\", ");
    let (folder, path) = longest(&text);
    let out = folder.path().join("out");
    let found = search(&path, &out, OnExisting::Keep);
    // Flux and efficiency of one lumen are the same, so that every length has its narrowest rod on the front.
    assert!(found.front().count() > 10 && found.designs.len() == 50);
    let pairs = ["exit.efficiency.cost", "exit.flux.cost", "exit.efficiency.exit.flux"];
    let files: Vec<String> = fs::read_dir(&out)
        .unwrap()
        .map(|own| own.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.starts_with("front."))
        .collect();
    assert_eq!(files.len(), 3, "{pairs:?} {files:?}");
}

#[test]
fn the_progress_of_a_front_says_how_many_designs_it_has() {
    let (folder, path) = longest(&front(30));
    let sizes = Mutex::new(Vec::new());
    let stopped = stopped_when(&path, &folder.path().join("out"), |progress| {
        if let Some(SearchLead::Front { designs }) = progress.lead {
            assert!(progress.sentence().contains(&format!(", {designs} on the front")));
            sizes.lock().unwrap().push(designs);
        }
        false
    });
    let report = stopped.report.unwrap();
    let last = sizes.into_inner().unwrap().last().copied();
    assert_eq!(last, Some(report.front().count()));
}

#[test]
fn objectives_that_contradict_other_keys_are_refused() {
    let refused = |old: &str, new: &str, words: &str| {
        let text = front(30);
        let changed = text.replace(old, new);
        assert_ne!(changed, text);
        expect_refusal(&changed, words);
    };
    refused("\"exit.efficiency\" }]", "\"exit.flux\" }]", "`exit.flux` is not one of `measures`");
    refused(", { measure = \"exit.efficiency\" }", "", "expected 2 to 3 tables, found 1");
    refused("best = \"lowest\"", "best = \"highest\"", "the lowest cost is the best");
    refused("cost = { length = -1, radius = 10 }, ", "", "say what a design costs");
    let samples = "designs = 30, samples = 5";
    refused("designs = 30", samples, "production scatters a single best design");
    refused("\"exit.efficiency\" }]", "\"cost\" }]", "`cost` is listed twice");
    let twice = "{ measure = \"exit.efficiency\", best = \"lowest\" }";
    refused("{ measure = \"cost\", best = \"lowest\" }", twice, "it is none of the `objectives`");
    refused("designs = 30", "designs = 19", "give 20 or more");
    refused("designs = 30", "designs = 30, least_gain = 0", "follows a single best design");
    let ranked = "[ranking]\nmeasure = \"exit.efficiency\"\n[run]";
    refused("[run]", ranked, "`ranking` already says which design is the best");
    let tolerant = "to = 50 }\ntolerance = { plus_minus = 0.1 }";
    refused("to = 50 }", tolerant, "production scatters a single best design");
    let other = "keys = [\"solids.rod.cylinder.medium\"]\nchoices = { a = \"dye\", b = \"dye\" }";
    let chosen = front(39).replace("[run]", &format!("[parameters.medium]\n{other}\n[run]"));
    expect_refusal(
        &chosen,
        "give 40 or more, so that each direction has a simplex, or fewer choices",
    );
    let early = LONGEST.replace("designs = 40", "designs = 10, least_gain = 0.1");
    expect_refusal(&early, "compares the latest 10 designs");
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
    let end = format!("so it ended after {} of 80 designs", found.designs.len());
    assert!(page.contains(&end), "{page}");
    let before = fs::read(out.join("study.json")).unwrap();
    for number in 9..=found.designs.len() {
        fs::remove_file(out.join(format!("designs/{number:04}.json"))).unwrap();
    }
    search(&path, &out, OnExisting::Resume);
    assert_eq!(fs::read(out.join("study.json")).unwrap(), before);
}

/// The better of two dyes by a search for the highest efficiency, whose values have noise, with the gain that ends it.
fn clearer(least_gain: f64) -> String {
    let media = "[parameters.medium]\nkeys = [\"solids.rod.cylinder.medium\"]\nchoices = { dark = \"ink\", clear = \"dye\" }\n[ranking]\nmeasure = \"exit.flux\"\n[run]";
    LONGEST
        .replace("[run]", media)
        .replace(
            "designs = 40, cost = { length = -1 }",
            &format!("designs = 60, least_gain = {least_gain}"),
        )
        .replace("measures = [", "measures = [\"exit.flux\", ")
        .replace("min = 0.5", "max = 0.5")
}

#[test]
fn a_search_with_choices_shows_and_records_the_gain_of_the_choice_that_leads() {
    let (folder, path) = longest(&clearer(0.0));
    let ink = "[media.ink]\nindex = 1\nabsorption_per_mm = 0.1\n[solids";
    let dye = fs::read_to_string(folder.path().join("dye.toml")).unwrap();
    fs::write(folder.path().join("dye.toml"), dye.replacen("[solids", ink, 1)).unwrap();
    let last = Mutex::new(None);
    let ended = stopped_when(&path, &folder.path().join("out"), |progress| {
        if let Some(SearchLead::Best(best)) = progress.lead {
            *last.lock().unwrap() = Some(best);
        }
        false
    });
    let report = ended.report.unwrap();
    let best = last.into_inner().unwrap().unwrap();
    assert_eq!(Some(best.number), report.best_passing().map(|own| own.design));
    assert_eq!(best.gain, report.analysis.latest_gain);
    let gain = best.gain.unwrap().gain;
    // It ends where only noise is gained, or has all designs.
    assert!(report.designs.len() == 60 || gain.value <= gain.std_error, "{gain:?}");
}
