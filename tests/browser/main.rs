//! `report.html` and `study.html` in a browser, as a user sees it: values under the pointer, switches, sections, turning, printing.
//!
//! Needs Chromium. Without it each test says on the terminal that it is skipped, and passes;
//! `LUMIDUCT_BROWSER=required` makes it fail.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod driver;
mod phone;
mod protocol;
#[path = "../skip/mod.rs"]
mod skip;
mod study;

use assert_cmd::Command;
use driver::{Modifier, Open};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A rod with a sensor of each kind, and a title with markup that must stay text.
const SCENE: &str = concat!(
    "lumiduct = 1\ntitle = \"Short rod </script><b>&\\\"\"\n",
    include_str!("../rod.toml"),
    r#"
[sensors]
exit = { plane = { cells = [8, 8] }, on = "rod.exit", counts = "leaving" }
rings = { plane = { rings = 4, sectors = 6 }, on = "rod.entry", counts = "incident" }
far = { goniometer = { c_step_deg = 30, gamma_step_deg = 10 }, at = { face = "rod.exit" } }
[run]
paths = 40_000
[[check]]
measure = "exit.efficiency"
min = 0.5
"#
);

/// The report of a small run in its own folder.
struct Report(TempDir);

impl Report {
    fn new() -> Self {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("rod.toml"), SCENE).unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_lumiduct"));
        let output =
            command.current_dir(dir.path()).args(["run", "rod.toml", "-o", "out", "-q"]).output();
        let output = output.unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Self(dir)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join("out").join(name)
    }

    fn open(&self, program: &Path) -> Open {
        Open::new(program, &self.path("report.html"))
    }
}

/// The figure whose caption is `label`, the `nth` of them, as an expression of the page.
fn figure(label: &str, nth: usize) -> String {
    format!(
        "[...document.querySelectorAll('figure')].filter((f) => f.ariaLabel === '{label}')[{nth}]"
    )
}

/// The value and the error after the colon of a readout.
fn told(readout: &str) -> [f64; 2] {
    // Large numbers have narrow spaces between groups of three digits.
    let numbers = readout.rsplit(": ").next().unwrap().replace('\u{202f}', "");
    let power = numbers.split("×10").nth(1).map_or(0, |rest| {
        let digits = "⁰¹²³⁴⁵⁶⁷⁸⁹";
        let place = |c: char| digits.chars().position(|digit| digit == c);
        rest.chars().map_while(place).fold(0, |sum, digit| 10 * sum + digit as i32)
    });
    let plain: Vec<f64> = numbers
        .split(|c: char| !c.is_ascii_digit() && c != '.')
        .filter_map(|part| part.parse().ok())
        .take(2)
        .collect();
    [plain[0], plain[1]].map(|number| number * 10f64.powi(power))
}

#[test]
fn values_under_the_pointer_are_those_of_the_tables() {
    let Some(program) = driver::find() else { return };
    let report = Report::new();
    let page = report.open(&program);
    assert_eq!(page.text("document.querySelector('h1').textContent"), "Short rod </script><b>&\"");
    assert_eq!(page.text("document.querySelector('.verdict').textContent"), "The check passed");

    let map = figure("illuminance", 0);
    page.point_at(&format!("{map}.querySelector('image')"), [0.5625, 0.4375]);
    let readout = format!("{map}.querySelector('.readout').textContent");
    page.expect(&format!("{readout}.includes('±')"));
    assert!(page.text(&readout).contains('\u{202f}'), "{}", page.text(&readout));
    let [value, error] = told(&page.text(&readout));
    // Column 4 and row 4 from below, each of eight. Rounding leaves up to a seventh of the error.
    let table = fs::read_to_string(report.path("exit.illuminance.csv")).unwrap();
    let row = table.lines().skip(1).find(|line| {
        let place: Vec<f64> = line.split(',').take(2).map(|part| part.parse().unwrap()).collect();
        place.iter().all(|x| *x > 0.0 && *x < 0.5)
    });
    let numbers: Vec<f64> = row.unwrap().split(',').map(|part| part.parse().unwrap()).collect();
    assert!((value - numbers[2]).abs() < 0.15 * numbers[3], "{value} is not {}", numbers[2]);
    assert!((error / numbers[3] - 1.0).abs() < 0.15, "{error} is not {}", numbers[3]);

    let polar = figure("intensity, far field", 0);
    page.point_at(&format!("{polar}.querySelector('svg')"), [0.5, 0.3]);
    page.expect(&format!("{polar}.querySelector('.readout').textContent.includes('cd')"));
    let bounces = figure("flux by number of bounces", 0);
    page.point_at(&format!("{bounces}.querySelector('svg')"), [0.4, 0.3]);
    page.expect(&format!("{bounces}.querySelector('.readout').textContent.includes('lm')"));
    page.expect_no_complaints();
}

#[test]
fn scales_switch_lines_cut_and_the_scene_turns() {
    let Some(program) = driver::find() else { return };
    let report = Report::new();
    let page = report.open(&program);
    let map = figure("illuminance", 0);
    let picture = format!("{map}.querySelector('image').getAttribute('href')");
    let before = page.text(&picture);
    page.click(&format!("{map}.querySelector('button.scale')"));
    assert_ne!(page.text(&picture), before, "the logarithmic map is the linear one");
    assert_eq!(page.ask(&format!("{map}.querySelector('button.scale').ariaPressed")), "true");

    let section = format!("{map}.querySelector('.section svg').textContent");
    let before = page.text(&section);
    page.drag(&format!("{map}.querySelector('image')"), [0.2, 0.2], [0.8, 0.7]);
    let after = page.text(&section);
    assert!(after.contains("along the line from") && after != before, "{after}");

    let rings = figure("illuminance", 1);
    page.point_at(&format!("{rings}.querySelector('image')"), [0.6, 0.6]);
    page.expect(&format!("{rings}.querySelector('.readout').textContent.includes('radius')"));

    let canvas = "document.querySelector('.scene canvas')";
    let painted = format!("{canvas}.toDataURL()");
    let first = page.text(&painted);
    page.drag(canvas, [0.4, 0.4], [0.6, 0.5]);
    page.expect(&format!("{painted} !== {}", serde_json::to_string(&first).unwrap()));
    let turned = page.text(&painted);
    page.click("document.querySelector('.scene .legend button')");
    page.expect(&format!("{painted} !== {}", serde_json::to_string(&turned).unwrap()));
    assert_eq!(page.text("document.querySelector('.scene .legend button').ariaPressed"), "false");
    page.point_at(canvas, [0.5, 0.5]);
    page.expect("document.querySelector('.scene').parentElement.querySelector('.readout').textContent !== ''");
    page.expect_no_complaints();
}

#[test]
fn the_wheel_scrolls_the_page_and_zooms_the_scene_with_ctrl() {
    let Some(program) = driver::find() else { return };
    let report = Report::new();
    let page = report.open(&program);
    let canvas = "document.querySelector('.scene canvas')";
    let painted = format!("{canvas}.toDataURL()");
    page.place(canvas, [0.5, 0.5]);
    let [picture, from] = [page.text(&painted), page.ask("scrollY").to_string()];
    page.wheel(canvas, Modifier::Nothing);
    page.expect(&format!("scrollY > {from}"));
    assert_eq!(page.text(&painted), picture, "the wheel alone has zoomed the scene");
    page.wheel(canvas, Modifier::Ctrl);
    page.expect(&format!("{painted} !== {}", serde_json::to_string(&picture).unwrap()));
    assert_eq!(page.ask("scrollY").to_string(), from, "zooming has scrolled the page");
    page.expect_no_complaints();
}

#[test]
fn the_page_of_a_check_shows_the_axes_that_are_chosen() {
    let Some(program) = driver::find() else { return };
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("rod.toml"), SCENE).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_lumiduct"));
    let output = command.current_dir(dir.path()).args(["check", "rod.toml", "--html"]).output();
    assert!(output.unwrap().status.success());
    let page = Open::new(&program, &dir.path().join("rod.check.html"));
    let painted = "document.querySelector('.scene canvas').toDataURL()";
    // The wall has no sensor, so its axes are drawn on demand only.
    let wall =
        "[...document.querySelectorAll('.axes button')].find((b) => b.textContent === 'rod.wall')";
    assert_eq!(page.text(&format!("{wall}.ariaPressed")), "false");
    let before = page.text(painted);
    page.click(wall);
    page.expect(&format!("{painted} !== {}", serde_json::to_string(&before).unwrap()));
    assert_eq!(page.text(&format!("{wall}.ariaPressed")), "true");
    page.expect_no_complaints();
}

#[test]
fn the_page_is_light_or_dark_fits_narrow_windows_and_prints_on_pages() {
    let Some(program) = driver::find() else { return };
    let report = Report::new();
    let page = report.open(&program);
    let background = "getComputedStyle(document.body).backgroundColor";
    page.prefer("dark");
    page.expect(&format!("{background} === 'rgb(21, 24, 28)'"));
    let dark = page.picture(&report.path("dark.png"));
    page.click("document.getElementById('theme')");
    page.expect(&format!("{background} === 'rgb(255, 255, 255)'"));
    let light = page.picture(&report.path("light.png"));
    let brightness =
        |picture: &[[u8; 3]]| picture.iter().flatten().map(|part| u64::from(*part)).sum::<u64>();
    assert!(brightness(&dark) < brightness(&light) / 3);
    for picture in [&dark, &light] {
        assert!(picture.iter().collect::<BTreeSet<_>>().len() > 50, "a blank page");
    }

    page.prefer("dark");
    let pdf = page.print();
    let pdf = String::from_utf8_lossy(&pdf);
    let pages = pdf.matches("/Type /Page\n").count() + pdf.matches("/Type /Page/").count();
    assert!(pdf.starts_with("%PDF") && pages > 1, "{pages} pages");

    page.resize(800, 900);
    page.expect("document.documentElement.scrollWidth <= 800");
    page.expect_no_complaints();
}
