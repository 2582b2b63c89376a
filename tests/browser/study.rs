//! `study.html` in a browser.

use crate::{driver, figure};
use assert_cmd::Command;
use driver::Open;
use std::collections::BTreeSet;
use std::fs;

const STUDY: &str = r#"
lumiduct_study = 1
title = "Rods </script><b>"
scene = "rod.toml"
measures = ["exit.efficiency"]
plan = "grid"
[parameters.length]
keys = ["solids.rod.cylinder.length_mm"]
unit = "mm"
values = [5, 10, 20]
[parameters.finish]
keys = ["solids.rod.cylinder.faces"]
choices = { clear = {}, black = { wall = "black" } }
[run]
paths = 5_000
estimator = "forward"
[ranking]
measure = "exit.efficiency"
[[check]]
measure = "exit.efficiency"
min = 0.1
"#;

#[test]
fn the_page_of_a_study_tells_values_under_the_pointer() {
    let Some(program) = driver::find() else { return };
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("rod.toml"), crate::SCENE).unwrap();
    fs::write(dir.path().join("study.toml"), STUDY).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lumiduct"));
    let arguments = ["batch", "study.toml", "-o", "out", "-q"];
    let output = command.current_dir(dir.path()).args(arguments).output().unwrap();
    assert!(output.status.code().is_some_and(|code| code < 2), "{output:?}");

    let page = Open::new(&program, &dir.path().join("out/study.html"));
    assert_eq!(page.text("document.querySelector('h1').textContent"), "Rods </script><b>");
    let verdict = page.text("document.querySelector('.verdict').textContent");
    assert!(verdict.starts_with("6 designs of the scene “rod”: "), "{verdict}");
    let ranks = "[...document.querySelectorAll('table')][0].querySelectorAll('tbody tr').length";
    assert_eq!(page.ask(ranks), 6);

    // Pictures come after the first table, and before all others.
    let order = "[...document.querySelectorAll('table, figure')].map((e) => e.localName).join(' ')";
    let order = page.text(order);
    assert!(order.starts_with("table figure"), "{order}");
    assert_eq!(order.matches("table figure").count(), 1, "{order}");

    let plot = figure("response of exit.efficiency", 0);
    page.point_at(&format!("{plot}.querySelector('svg')"), [0.5, 0.4]);
    let readout = format!("{plot}.querySelector('.readout').textContent");
    page.expect(&format!("{readout}.includes('±') && {readout}.includes('10')"));
    let drawn = format!("{plot}.querySelector('svg').outerHTML");
    let before = page.text(&drawn);
    page.click(&format!("{plot}.querySelector('button.scale')"));
    assert_ne!(page.text(&drawn), before, "the logarithmic plot is the linear one");
    let colours: BTreeSet<_> = page.picture(&dir.path().join("study.png")).into_iter().collect();
    assert!(colours.len() > 20, "a blank page");
    page.expect_no_complaints();
}
