//! Reports and records that were changed, mixed or left incomplete are refused by name.

use crate::*;
use lumiduct_report::FolderLock;

const STUDY: &str = "lumiduct_study = 1\ntitle = \"Lengths\"\nscene = \"rod.toml\"\nmeasures = [\"exit.flux\"]\n\
     plan = \"grid\"\n[parameters.length]\nkeys = [\"solids.rod.cylinder.length_mm\"]\nvalues = [10, 11]\n\
     [run]\npaths = 2_000\n";

fn study() -> Place {
    let place = Place::new();
    fs::write(place.path("study.toml"), STUDY).unwrap();
    place.good("batch study.toml -o out -q");
    place
}

#[test]
fn a_design_record_with_a_changed_digit_is_refused_by_its_name() {
    let place = study();
    let path = place.path("out/designs/0002.json");
    let bytes = fs::read(&path).unwrap();
    let digits: Vec<usize> = (0..bytes.len()).filter(|at| bytes[*at].is_ascii_digit()).collect();
    for at in digits.iter().step_by(digits.len() / 12) {
        let mut changed = bytes.clone();
        changed[*at] = if changed[*at] == b'7' { b'3' } else { b'7' };
        fs::write(&path, changed).unwrap();
        for arguments in ["batch study.toml -o out --resume", "merge out -o whole"] {
            let said = place.bad(2, arguments);
            assert!(said.contains("0002.json") && said.contains("changed"), "{said}");
        }
    }
    // A record of another design in its place is refused, too.
    fs::copy(place.path("out/designs/0001.json"), &path).unwrap();
    assert!(place.bad(2, "batch study.toml -o out --resume").contains("another design"));
    fs::write(&path, r#"{"lumiduct_design":1,"study":"33fe9f8655e5f076","design":2}"#).unwrap();
    let said = place.bad(2, "batch study.toml -o out --resume");
    assert!(said.contains("0002.json") && said.contains("older version"), "{said}");
    fs::write(&path, bytes).unwrap();
    assert!(place.good("batch study.toml -o out --resume").contains("identical to the byte"));
    let facts = place.path("out/batch.json");
    let text = fs::read_to_string(&facts).unwrap();
    fs::write(&facts, text.replace("Lengths", "Length")).unwrap();
    let said = place.bad(2, "batch study.toml -o out --resume");
    assert!(said.contains("batch.json") && said.contains("--overwrite"), "{said}");
}

#[test]
fn merge_refuses_a_kept_report_that_is_not_as_it_was_written() {
    let place = Place::new();
    fs::write(
        place.path("study.toml"),
        STUDY.replace("plan = \"grid\"", "plan = \"grid\"\nkeep = \"reports\""),
    )
    .unwrap();
    for part in ["1/2", "2/2"] {
        place.good(&format!("batch study.toml --shard {part} -o {} -q", part.replace('/', "of")));
    }
    let kept = place.path("2of2/designs/0002");
    let (measures, manifest) = (kept.join("measures.csv"), kept.join("manifest.json"));
    let whole = fs::read(&measures).unwrap();
    fs::write(&measures, "measure,value\n").unwrap();
    let said = place.bad(2, "merge 1of2 2of2 -o merged");
    assert!(said.contains("measures.csv is not the file"), "{said}");
    fs::remove_file(&measures).unwrap();
    let said = place.bad(2, "merge 1of2 2of2 -o merged");
    assert!(said.contains("measures.csv is missing"), "{said}");
    fs::write(&measures, whole).unwrap();
    let list = fs::read(&manifest).unwrap();
    fs::remove_file(&manifest).unwrap();
    assert!(place.bad(2, "merge 1of2 2of2 -o merged").contains("holds no whole report"));
    assert!(!place.path("merged").exists());
    fs::write(&manifest, list).unwrap();
    place.good("merge 1of2 2of2 -o merged -q");
    assert_eq!(contents(&kept), contents(&place.path("merged/designs/0002")));
}

#[test]
fn a_report_with_a_file_of_another_run_is_no_report() {
    let place = Place::new();
    place.good("run rod.toml -o a -q");
    place.good("run rod.toml -o b -q --seed 2");
    place.good("diff a b");
    fs::copy(place.path("a/summary.json"), place.path("b/summary.json")).unwrap();
    let said = place.bad(2, "diff a b");
    assert!(said.contains("summary.json is not the file"), "{said}");
    place.good("run rod.toml -o b -q --seed 2 --overwrite");
    place.good("diff a b");
    fs::copy(place.path("a/exit.illuminance.csv"), place.path("b/exit.illuminance.csv")).unwrap();
    assert!(place.bad(2, "diff a b").contains("exit.illuminance.csv"));
    fs::remove_file(place.path("a/manifest.json")).unwrap();
    assert!(place.bad(2, "diff a b").contains("no whole report"));
    assert!(place.bad(2, "run rod.toml -o a").contains("not a complete report"));
}

#[test]
fn two_runs_are_not_at_work_in_one_folder() {
    let place = Place::new();
    let lock = FolderLock::take(&place.path("out")).unwrap();
    for arguments in ["run rod.toml -o out", "run rod.toml -o out --resume --checkpoint 1s"] {
        assert!(place.bad(2, arguments).contains("another run or batch is using"));
    }
    assert!(names(&place.path("out")).is_empty());
    drop(lock);
    place.good("run rod.toml -o out");
}

#[test]
fn what_identifies_a_run_is_in_its_report_and_the_build_is_not() {
    let place = Place::new();
    place.good("run rod.toml -o out -q --seed 3");
    let summary = place.summary("out");
    let identity = &summary["run"]["identity"];
    assert_eq!(identity["plan"]["seed"], 3);
    assert_eq!(identity["plan"]["stop"]["paths"], 20_000);
    assert!(identity["numerics"].as_u64().unwrap() >= 1);
    for (name, bytes) in contents(&place.path("out")) {
        let text = String::from_utf8_lossy(&bytes);
        assert!(!text.contains(concat!(env!("CARGO_PKG_VERSION"), "+")), "{name} names the build");
    }
}

#[test]
fn overwriting_takes_away_what_a_whole_manifest_lists_and_nothing_else() {
    let place = study();
    for name in ["out/mine.txt", "out/designs/mine.json", "out/designs/0007.json"] {
        fs::write(place.path(name), "mine").unwrap();
    }
    let manifest = place.path("out/manifest.json");
    let text = fs::read_to_string(&manifest).unwrap();
    fs::write(&manifest, text.replace("study.csv", "mine.txt")).unwrap();
    let said = place.bad(2, "batch study.toml -o out --overwrite -q");
    assert!(said.contains("0007.json"), "{said}");
    assert_eq!(fs::read_to_string(place.path("out/designs/0007.json")).unwrap(), "mine");
    fs::remove_file(place.path("out/designs/0007.json")).unwrap();
    place.good("batch study.toml -o out --overwrite -q");
    for name in ["out/mine.txt", "out/designs/mine.json"] {
        assert_eq!(fs::read_to_string(place.path(name)).unwrap(), "mine");
    }
}
