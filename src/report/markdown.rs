//! `report.md`: the page for people.

use crate::measure::{GatheredFacts, Outcome, PathClass, SensorMap, SensorPaths};
use crate::report::csv::{map_name, map_words};
use crate::report::words::{
    CHOICES_HEAD, CLASSES_HEAD, NO_LINES, balance_lines, choice_row, class_rows, evenness_head,
    evenness_rows, gathering, lost_paths, outcome_word, quantity, run_lines, stage_row, variation,
};
use crate::report::{CheckResult, Report, by_sun};
use std::fmt::Write;

/// The whole page. `files` are the other files of the report.
pub(crate) fn markdown(report: &Report, files: &[&str]) -> String {
    let mut page = format!("# {}\n\n", report.scene.title);
    if let Some(description) = &report.scene.description {
        page += &format!("{}\n\n", description.trim());
    }
    if report.run.partial {
        page += "**This report is partial: the run was interrupted.**\n\n";
    }
    page += &checks(&report.checks);
    page += &warnings(&report.warnings);
    page += &overview(report);
    page += &choices(report);
    for paths in &report.measures.sensor_paths {
        page += &sensor(report, paths, files);
    }
    page += &balance(report);
    page += &run(report);
    page
}

fn checks(results: &[CheckResult]) -> String {
    if results.is_empty() {
        return String::new();
    }
    let mut text = "## Checks\n\n| check | result | why |\n|---|---|---|\n".to_owned();
    for result in results {
        let word = match result.verdict.outcome {
            Outcome::Passed => outcome_word(Outcome::Passed).to_owned(),
            other @ (Outcome::Undecided | Outcome::Failed | Outcome::Unknown) => {
                format!("**{}**", outcome_word(other))
            }
        };
        text += &format!("| {} | {word} | {} |\n", result.check.measure, result.verdict.reason);
    }
    text + "\n"
}

fn warnings(warnings: &[String]) -> String {
    if warnings.is_empty() {
        return String::new();
    }
    let lines: String = warnings.iter().map(|warning| format!("- {warning}\n")).collect();
    format!("## Remarks\n\n{lines}\n")
}

/// The totals of every sensor in one table.
fn overview(report: &Report) -> String {
    let mut text =
        "## Sensors\n\n| sensor | estimator | flux | efficiency |\n|---|---|---|---|\n".to_owned();
    for paths in &report.measures.sensor_paths {
        let cell = |name: &str| {
            report
                .measures
                .values
                .get(&format!("{}.{name}", paths.sensor))
                .map_or("".into(), quantity)
        };
        let estimator =
            report.measures.estimators.get(&paths.sensor).map_or("", |estimator| estimator.name());
        let (flux, efficiency) = (cell("flux"), cell("efficiency"));
        text += &format!("| {} | {estimator} | {flux} | {efficiency} |\n", paths.sensor);
    }
    text + "\n"
}

/// What the pilot found out, and what it chose.
fn choices(report: &Report) -> String {
    let choices = &report.measures.choices;
    if choices.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "## Choice of estimators\n\n{CHOICES_HEAD}\n\n| sensor | chosen | forward | backward | mix | gather |\n\
         |---|---|--:|--:|--:|--:|\n"
    );
    for (sensor, choice) in choices {
        text += &format!("| {sensor} | {} |\n", choice_row(choice).join(" | "));
    }
    text + "\n"
}

fn sensor(report: &Report, paths: &SensorPaths, files: &[&str]) -> String {
    let name = &paths.sensor;
    let mut text = format!("## Sensor `{name}`\n\n");
    for map in report.measures.maps.iter().filter(|map| map.sensor == *name) {
        let words = map_words(map);
        if map.view.is_some() {
            text += &format!("### {words}\n\n");
        }
        text += &format!("![{words}]({}.png)\n\n", map_name(map));
        text += &uniformity(map);
    }
    let prefix = format!("{name}.");
    for file in files.iter().filter(|file| file.starts_with(&prefix) && file.ends_with(".png")) {
        let drawn =
            report.measures.maps.iter().any(|map| format!("{}.png", map_name(map)) == **file);
        if !drawn {
            let stem = file.trim_end_matches(".png");
            text += &format!("![{}]({file})\n\n", stem.replace('.', ": "));
        }
    }
    text += &by_sun::section(report, name);
    text += "| measure | value |\n|---|---|\n";
    for (key, measure) in &report.measures.values {
        // Single cells and rings are in the tables of numbers.
        let listed = key
            .strip_prefix(&prefix)
            .is_some_and(|rest| !rest.starts_with("cell.") && !rest.starts_with("ring."));
        if listed {
            text += &format!("| {key} | {} |\n", quantity(measure));
        }
    }
    text += "\n";
    for facts in report.measures.gathered.iter().filter(|facts| facts.sensor == *name) {
        text += &gathered(facts, report.measures.unit.flux());
    }
    if let Some(lost) = paths.lost {
        text += &format!("{}\n\n", lost_paths(lost));
    }
    text + &classes(&paths.classes)
}

/// How gathered values came about.
fn gathered(facts: &GatheredFacts, unit: &str) -> String {
    let mut text: String =
        gathering(facts, unit).iter().map(|sentences| format!("{sentences}\n\n")).collect();
    _ = writeln!(text, "| stage | passes | radius | angle | E1 in {unit} | E2 | E3 | E0 |");
    text += "|---|---|---|---|---|---|---|---|\n";
    for stage in &facts.stages {
        text += &format!("| {} |\n", stage_row(stage).join(" | "));
    }
    text + "\n"
}

/// Empty for a single cell, which is even.
fn uniformity(map: &SensorMap) -> String {
    let Some(head) = evenness_head(map) else { return String::new() };
    let mut text = format!("{head}\n\n| over | min/avg | min/max | max/min |\n|---|---|---|---|\n");
    for (name, row) in evenness_rows(map) {
        text += &format!("| {name} | {} |\n", row.join(" | "));
    }
    text + &format!("\n{}\n\n", variation(map))
}

fn classes(classes: &[PathClass]) -> String {
    if classes.is_empty() {
        return String::new();
    }
    let mut text = format!("{CLASSES_HEAD}\n\n");
    text += "| share | mean bounces | path |\n|---|---|---|\n";
    for row in class_rows(classes) {
        text += &format!("| {} |\n", row.join(" | "));
    }
    text + "\n"
}

fn balance(report: &Report) -> String {
    let mut text = "## Flux balance\n\n![flux balance](balance.png)\n\n| line | flux | share |\n|---|---|---|\n".to_owned();
    for (name, flux, share) in balance_lines(report) {
        text += &format!("| {name} | {flux} | {share} |\n");
    }
    text + &format!("\n{NO_LINES}\n\n")
}

fn run(report: &Report) -> String {
    let list: String = run_lines(report).iter().map(|line| format!("- {line}\n")).collect();
    format!("## Run\n\n{list}")
}
