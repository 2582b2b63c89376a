//! What is refused, and what is left alone.

use crate::*;

#[test]
fn bad_input_ends_with_2_and_writes_nothing() {
    let place = Place::with("[media.glass]\nindx = 1.5\n");
    let said = place.bad(2, "run rod.toml");
    for words in ["rod.toml:21", "indx", "index"] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    place.bad(2, "check rod.toml");
    assert!(place.bad(2, "run missing.toml").contains("missing.toml"));
    let unknown = Place::with("[[check]]\nmeasure = \"exit.fluxx\"\nmin = 1\n");
    assert!(unknown.bad(2, "run rod.toml").contains("exit.flux"));
    assert_eq!(
        (place.names(), unknown.names()),
        (vec!["rod.toml".into()], vec!["rod.toml".into()])
    );
}

#[test]
fn a_bad_command_line_ends_with_2_and_writes_nothing() {
    let place = Place::new();
    for arguments in [
        "",
        "walk rod.toml",
        "run",
        "run rod.toml --pahts 2M",
        "run rod.toml --paths 0",
        "run rod.toml --paths many",
        "run rod.toml --time -1s",
        "run rod.toml --target 0%",
        "run rod.toml --target 0.5",
        "run rod.toml -o rod.toml",
        "run rod.toml --threads 0",
        "run rod.toml --estimator psychic",
        "run rod.toml --records 0",
        "run rod.toml --angle-deg 90",
        "run rod.toml --radius-mm 0",
        "run rod.toml --depth 1001",
        "run rod.toml --schedule sometimes",
        "run rod.toml -D solids.rod.cylinder.length_mm",
        "run rod.toml -D solids.rod.cylinder.lenght_mm=3",
        "run rod.toml -D solids.rod.cylinder.length_mm=-3",
        "completions cobol",
    ] {
        assert!(!place.bad(2, arguments).is_empty(), "{arguments}");
    }
    assert_eq!(place.names(), ["rod.toml"]);
    let help = place.good("run --help");
    assert!(help.contains("Gather:") && help.contains("--estimator <ESTIMATOR>"), "{help}");
    assert!(help.contains("--overwrite") && place.good("--help").contains("Exit codes"));
}

#[test]
fn a_report_is_kept_unless_it_may_be_replaced() {
    let place = Place::new();
    place.good("run rod.toml -o out -q --seed 1");
    let first = contents(&place.path("out"));
    assert!(place.bad(2, "run rod.toml -o out -q --seed 2").contains("--overwrite"));
    assert!(place.bad(2, "run rod.toml -o out -q --time 1s").contains("--overwrite"));
    assert_eq!(contents(&place.path("out")), first);
    place.good("run rod.toml -o out -q --seed 2 --overwrite");
    assert_ne!(contents(&place.path("out"))["summary.json"], first["summary.json"]);
    fs::create_dir(place.path("notes")).unwrap();
    fs::write(place.path("notes/mine.txt"), "mine").unwrap();
    place.bad(2, "run rod.toml -o notes -q");
    assert_eq!(names(&place.path("notes")), ["mine.txt"]);
}

#[test]
fn a_run_over_its_own_report_leaves_it_alone_and_finds_what_was_changed() {
    let place = Place::new();
    place.good("run rod.toml -o out -q");
    let (first, timing) = (contents(&place.path("out")), place.path("out/timing.csv"));
    let seconds = fs::read(&timing).unwrap();
    assert!(place.good("run rod.toml -o out").contains("the same to the byte"));
    assert_eq!((contents(&place.path("out")), fs::read(&timing).unwrap()), (first, seconds));
    fs::write(place.path("out/measures.csv"), "changed").unwrap();
    assert!(place.bad(3, "run rod.toml -o out -q").contains("measures.csv"));
    let output = place.run("run rod.toml -o out");
    let said = String::from_utf8(output.stdout.clone()).unwrap();
    assert!(code(&output) == 3 && said.contains("efficiency") && said.contains("--overwrite"));
    assert_eq!(fs::read(place.path("out/measures.csv")).unwrap(), b"changed");
}
