//! Comparisons of reports, and checks for CI machines.

use crate::*;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus};

const STUDY: &str = r#"
lumiduct_study = 1
title = "How long a rod?"
scene = "rod.toml"
measures = ["exit.efficiency"]
plan = "grid"
[parameters.length]
keys = ["solids.rod.cylinder.length_mm"]
unit = "mm"
values = [5, 20]
[run]
paths = 20_000
estimator = "forward"
"#;

/// A place with the report of the scene.
fn with_report(lines: &str) -> Place {
    let place = Place::with(lines);
    place.run("run rod.toml -q -o a");
    place
}

fn junit(place: &Place, name: &str) -> Report {
    let text = fs::read_to_string(place.path(name)).unwrap();
    for word in ["timestamp", "time=", "uuid"] {
        assert!(!text.contains(word), "{word} in {text}");
    }
    Report::deserialize_from_str(&text).unwrap()
}

/// The only suite of a file: its cases.
fn cases(report: &Report) -> &[TestCase] {
    assert_eq!(report.test_suites.len(), 1);
    assert_eq!(report.tests, report.test_suites[0].test_cases.len());
    &report.test_suites[0].test_cases
}

/// Kind, type and message of a case that did not pass.
fn trouble(case: &TestCase) -> (NonSuccessKind, &str, &str) {
    let TestCaseStatus::NonSuccess { kind, message, ty, .. } = &case.status else {
        panic!("{case:?} passed")
    };
    (*kind, ty.as_ref().unwrap().as_str(), message.as_ref().unwrap().as_str())
}

#[test]
fn another_seed_is_within_the_limits_and_maps_differ_by_noise_alone() {
    let place = with_report("");
    place.good("run rod.toml -q --seed 2 -o b");
    let said = place.good("diff a b -o difference --junit d.xml");
    for words in ["seed 1", "seed 2", "no measure is beyond the limit of 4 sigmas", "map exit."] {
        assert!(said.contains(words), "no {words} in {said}");
    }
    assert_eq!(
        names(&place.path("difference")),
        [
            "diff.csv",
            "diff.html",
            "diff.md",
            "exit.illuminance.difference.png",
            "far.intensity.difference.png",
            "manifest.json"
        ]
    );
    assert!(said.contains("report: difference/diff.html"), "{said}");
    let measures = cases(&junit(&place, "d.xml")).len();
    place.good("diff a b --maps --junit m.xml");
    let report = junit(&place, "m.xml");
    let maps = cases(&report).iter().filter(|case| case.name.as_str().starts_with("map ")).count();
    assert_eq!((cases(&report).len() - measures, maps), (2, 2));
    let mut table = csv::Reader::from_path(place.path("difference/diff.csv")).unwrap();
    let rows: Vec<BTreeMap<String, String>> = table.deserialize().map(Result::unwrap).collect();
    let flux = rows.iter().find(|row| row["measure"] == "exit.flux").unwrap();
    let number = |name: &str| flux[name].parse::<f64>().unwrap();
    assert!(number("difference") != 0.0 && number("sigmas").abs() < 4.0);
    assert_eq!(number("value_a"), self::flux(&place.summary("a")));
    let report = junit(&place, "d.xml");
    assert_eq!((report.tests, report.failures, report.errors), (rows.len(), 0, 0));
    assert_eq!(report.test_suites[0].name.as_str(), "diff rod");
    // The page names no folder, and the same comparison gives the same bytes.
    place.good("diff a b -o again --all");
    assert_eq!(contents(&place.path("again")), contents(&place.path("difference")));
}

#[test]
fn a_report_is_the_same_as_itself() {
    let place = with_report("");
    let said = place.good("diff a a --sigmas 0.001");
    assert!(said.contains(": 0 beyond 3 sigmas"), "{said}");
}

#[test]
fn a_changed_scene_fails_and_the_measure_is_named() {
    let place = with_report("");
    place.good("run rod.toml -q --seed 2 -D media.acrylic.index=1.6 -o b");
    let output = place.run("diff a b --only exit.flux --only exit.eff --junit d.xml");
    let said = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(code(&output), 1, "{said}");
    let worst = said.lines().find(|line| line.starts_with("  exit.")).unwrap();
    assert!(worst.contains("exit.efficiency") || worst.contains("exit.flux"), "{said}");
    assert!(said.contains("beyond the limit of 4 sigmas") && !said.contains("far."), "{said}");
    let report = junit(&place, "d.xml");
    let flux = cases(&report).iter().find(|case| case.name.as_str() == "exit.flux").unwrap();
    let (kind, ty, message) = trouble(flux);
    assert_eq!((kind, ty), (NonSuccessKind::Failure, "beyond"));
    assert!(message.contains("the limit is 4 sigmas"), "{message}");
    // A difference that is too small to matter is reported, but is not a failure.
    let said = place.good("diff a b --only exit.flux --only exit.eff --relative 60%");
    assert!(said.contains("but within the relative limit"), "{said}");
    place.good("diff a b --only exit.flux --sigmas 1000");
}

#[test]
fn studies_are_compared_design_by_design() {
    let place = Place::new();
    fs::write(place.path("study.toml"), STUDY).unwrap();
    fs::write(place.path("turned.toml"), STUDY.replace("[5, 20]", "[20, 5, 40]")).unwrap();
    place.good("batch study.toml -q -o a");
    place.good("batch turned.toml -q --seed 2 -o b");
    let said = place.good("diff a b");
    assert!(said.contains("design 1 (length 5): exit.efficiency"), "{said}");
    assert!(said.contains("only B has 1 measure: design 3 (length 40): exit.efficiency"), "{said}");
    place.good("batch study.toml -q -D media.acrylic.index=1.6 -o c");
    let output = place.run("diff a c --only exit.");
    assert_eq!(code(&output), 1, "{output:?}");
    place.good("run rod.toml -q -o run");
    let said = place.bad(2, "diff run a");
    assert!(said.contains("the report of a run") && said.contains("of a study"), "{said}");
}

#[test]
fn what_is_no_report_is_refused_with_a_hint() {
    let place = with_report("");
    fs::create_dir(place.path("empty")).unwrap();
    fs::create_dir(place.path("broken")).unwrap();
    fs::write(place.path("broken/summary.json"), "{\"lumiduct_summary\": 1}").unwrap();
    fs::create_dir(place.path("newer")).unwrap();
    fs::write(place.path("newer/summary.json"), "{\"lumiduct_summary\": 99}").unwrap();
    for (arguments, words) in [
        ("diff a nowhere", "nowhere is not a folder"),
        ("diff a a/summary.json", "name the folder of a report"),
        ("diff a empty", "neither summary.json of a run nor study.json"),
        ("diff broken a", "cannot be read as a report"),
        ("diff newer a", "has format 99"),
        ("diff a a --only exit.fluks", "exit.flux"),
        ("diff a a --relative 1", "percentage"),
        ("diff a a --sigmas 0", "above 0"),
        ("diff a a -o a", "is one of the reports"),
    ] {
        let said = place.bad(2, arguments);
        assert!(said.contains(words), "{arguments}: {said}");
    }
}

#[test]
fn checks_become_test_cases_that_pass_fail_and_are_undecided() {
    let place = Place::with(
        r#"
[[check]]
measure = "exit.efficiency"
min = 0.1
[[check]]
measure = "exit.efficiency"
min = 0.99
[[check]]
measure = "exit.flux"
min = 1
max_std_error = 1e-9
"#,
    );
    assert_eq!(code(&place.run("run rod.toml -o a --junit ci/run.xml")), 1);
    let report = junit(&place, "ci/run.xml");
    assert_eq!((report.tests, report.failures, report.errors), (3, 2, 0));
    assert_eq!(report.test_suites[0].name.as_str(), "rod");
    let [passed, failed, undecided] = cases(&report) else { panic!("three checks") };
    assert_eq!(passed.name.as_str(), "exit.efficiency (1)");
    assert!(matches!(passed.status, TestCaseStatus::Success { .. }));
    assert_eq!(failed.name.as_str(), "exit.efficiency (2)");
    let (kind, ty, message) = trouble(failed);
    assert_eq!((kind, ty), (NonSuccessKind::Failure, "failed"));
    assert!(message.contains("at least 0.99 is required"), "{message}");
    assert_eq!(trouble(undecided).1, "undecided");
    // A later run replaces its own file; a file of others is reported before any work is done.
    assert_eq!(code(&place.run("run rod.toml -q -o b --paths 40k --junit ci/run.xml")), 1);
    assert!(matches!(trouble(&cases(&junit(&place, "ci/run.xml"))[1]), (_, "failed", _)));
    fs::write(place.path("mine.xml"), "<mine/>").unwrap();
    let said = place.bad(2, "run rod.toml -o c --junit mine.xml");
    assert!(said.contains("is not a JUnit file; use --overwrite"), "{said}");
    assert!(place.bad(2, "run rod.toml -o c --junit ci").contains("is not a regular file"));
    assert!(place.bad(2, "run rod.toml -o c --junit mine.xml/x.xml").contains("mine.xml"));
    assert!(place.bad(2, "run rood.toml -o c --junit new/x.xml").contains("rood.toml"));
    assert!(!place.path("new").exists());
    assert!(place.bad(2, "run rod.toml -o c --junit c").contains("is the folder given by -o"));
    assert!(!place.path("c").exists());
}

#[test]
fn designs_become_test_cases_and_those_without_a_scene_are_errors() {
    let place = Place::new();
    let check = "[[check]]\nmeasure = \"exit.efficiency\"\nmin = 0.1\n";
    let study = STUDY.replace("[5, 20]", "[5, -1]");
    fs::write(place.path("study.toml"), format!("{study}{check}")).unwrap();
    assert_eq!(code(&place.run("batch study.toml -q --junit s.xml")), 1);
    let report = junit(&place, "s.xml");
    assert_eq!((report.tests, report.failures, report.errors), (2, 0, 1));
    let [done, broken] = cases(&report) else { panic!("two designs") };
    assert_eq!(done.classname.as_ref().unwrap().as_str(), "study.design 1");
    assert_eq!(trouble(broken).1, "no scene");
}

#[test]
fn the_page_of_a_comparison_has_the_measures_of_checks_first() {
    let check = "[[check]]\nmeasure = \"far.flux\"\nmin = 1\n[[check]]\nmeasure = \"exit.share_deeper_than_10\"\nmax = 1\n";
    let place = with_report(check);
    place.good("run rod.toml -q --seed 2 -o b");
    place.good("diff a b -q -o difference");
    let page = fs::read_to_string(place.path("difference/diff.html")).unwrap();
    let at = |text: &str| page.find(text).unwrap_or_else(|| panic!("no {text} in {page}"));
    let order = [
        "<h2>Measures of the checks</h2>",
        "<td>far.flux</td>",
        "<td>exit.share_deeper_than_10</td>",
        "<h2>Flux and efficiency</h2>",
        "<td>exit.flux</td>",
        "<h2>All other measures, largest differences first</h2>",
        "<td>balance.emitted</td>",
        "<h2>Maps</h2>",
        "<h2>What was found</h2>",
    ];
    assert!(order.map(at).is_sorted(), "{:?}", order.map(at));
    assert_eq!(page.matches("<td>far.flux</td>").count(), 1);
}
