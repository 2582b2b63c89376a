//! `report.md`: the page for people.

use crate::measure::{
    Action, Extent, GatheredFacts, LostPaths, Measure, Outcome, PathClass, PathStep, Resolution,
    SensorMap, SensorPaths, StageFacts, Statistic, Status, strongest,
};
use crate::number::{format_percent, format_value, format_with_error};
use crate::report::by_sun;
use crate::report::csv::{map_name, map_words};
use crate::report::{CheckResult, Report};
use crate::scene::plan::Estimator;
use crate::transport::{Objection, Trial};
use std::fmt::Write;

/// Path classes that are listed one by one for a sensor.
const CLASSES_SHOWN: usize = 8;

/// A bias is told from this share of the standard error on, 1.
const BIAS_TOLD: f64 = 0.3;

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

/// A value with its error and unit.
pub(crate) fn quantity(measure: &Measure) -> String {
    let unit = if measure.unit == "1" { String::new() } else { format!(" {}", measure.unit) };
    let (value, error) = (measure.value, measure.std_error);
    if measure.status == Status::NoSignal && value == 0.0 && error.is_finite() {
        // The error of nothing is what a single path or count would have brought.
        return format!("0{unit} (nothing counted; one path is {}{unit})", format_value(error));
    }
    if measure.status == Status::NoSignal && error.is_infinite() {
        return "unknown (nothing counted)".into();
    }
    // A bias well below the noise is no news.
    let bias = measure
        .bias
        .filter(|bias| *bias > BIAS_TOLD * error)
        .map_or(String::new(), |bias| format!(", bias up to {}{unit}", format_value(bias)));
    format!("{}{unit}{bias}{}", format_with_error(value, error), remark(measure.status))
}

fn remark(status: Status) -> &'static str {
    match status {
        Status::Ok => "",
        Status::NoSignal => " (nothing counted)",
        Status::TooFew => " (too few counts for an error bar)",
        Status::NoiseLimited => " (limited by noise)",
        Status::BiasInNoise => " (bias not resolved from noise)",
        Status::BiasNotResolved => " (bias not resolved)",
        Status::Contradicted => " (photons found more)",
    }
}

fn checks(results: &[CheckResult]) -> String {
    if results.is_empty() {
        return String::new();
    }
    let mut text = "## Checks\n\n| check | result | why |\n|---|---|---|\n".to_owned();
    for result in results {
        let word = match result.verdict.outcome {
            Outcome::Passed => "passed",
            Outcome::Undecided => "**undecided**",
            Outcome::Failed => "**failed**",
            Outcome::Unknown => "**unknown measure**",
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
    let mut text = "## Choice of estimators\n\nA pilot has tried the estimators on each sensor. The table has the time that one \
                    thread would need until the sensor's flux or map is known to 1 %, told from counted work \
                    (docs/method.md). Gathering is not chosen where its windows differ by more than noise, or where an \
                    unbiased estimator contradicts it, and no estimator that found less light of a source than another, beyond their errors.\n\n\
                    | sensor | chosen | forward | backward | mix | gather |\n|---|---|--:|--:|--:|--:|\n"
        .to_owned();
    for (sensor, choice) in choices {
        _ = write!(text, "| {sensor} | {} |", choice.chosen.name());
        for estimator in
            [Estimator::Forward, Estimator::Backward, Estimator::Mix, Estimator::Gather]
        {
            let trial = choice.tried.iter().find(|trial| trial.estimator == estimator);
            _ = write!(text, " {} |", trial.map_or("not possible".into(), trial_words));
        }
        text += "\n";
    }
    text + "\n"
}

fn trial_words(trial: &Trial) -> String {
    let time = trial.time(0.01);
    let time = time.map_or("found nothing".into(), |time| format!("{} s", seconds(time)));
    match (trial.objection, trial.bias) {
        (Some(Objection::WindowsDiffer), Some(bias)) => {
            format!("{time} (its windows differ by {:.0} %)", 100.0 * bias)
        }
        (Some(Objection::WindowsDiffer), None) | (None, Some(_) | None) => time,
        (Some(Objection::Contradicted), _) => time + " (contradicted)",
    }
}

/// Two digits, which is what a pilot knows.
fn seconds(time: f64) -> String {
    let digits = 10f64.powi(1 - time.log10().floor() as i32);
    format_value((time * digits).round() / digits)
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
    if let Some(LostPaths { cut, leaked }) = paths.lost {
        _ = writeln!(
            text,
            "Of the throughput of gather paths from the sensor, {} was cut by the bounce limit and {} lost through holes in the geometry.\n",
            format_percent(cut),
            format_percent(leaked)
        );
    }
    text + &classes(&paths.classes)
}

/// How gathered values came about.
fn gathered(facts: &GatheredFacts, unit: &str) -> String {
    let from = facts.stages.iter().find(|stage| stage.number == facts.stage);
    let mut text = from.map_or(String::new(), |stage| {
        format!(
            "Gathered at depth {}: the values are those of stage {} with {} passes and windows up to {} mm and {} deg. ",
            facts.depth,
            stage.number,
            stage.passes,
            format_value(stage.radius_mm),
            format_value(stage.angle_deg)
        )
    });
    text += match facts.resolution {
        Resolution::Resolved => {
            "Bias resolved: it goes with the square of the window, and E0, which is free of such a bias, is the value.\n\n"
        }
        Resolution::InNoise => {
            "Bias not resolved from noise: the windows agree within their errors. The value is E0, free of a bias by the square of the window.\n\n"
        }
        Resolution::NotResolved => {
            "Bias not resolved: the windows differ, and not by the square of their size. The value is E3, that of the smallest window, and |E1 - E2| is no bound.\n\n"
        }
    };
    if let Some(off) = facts.off {
        let [flux, error] = facts.by_photons;
        _ = writeln!(
            text,
            "Photons of this run that came to the sensor itself carried {} {unit}, which is {:.1} errors from the value.\n",
            format_with_error(flux, error),
            off.abs()
        );
    }
    _ = writeln!(text, "| stage | passes | radius | angle | E1 in {unit} | E2 | E3 | E0 |");
    text += "|---|---|---|---|---|---|---|---|\n";
    for stage in &facts.stages {
        let [e1, e2, e3, e0] = [0, 1, 2, 3]
            .map(|window| format_with_error(stage.flux[window], stage.std_errors[window]));
        let (radius, angle) = (format_value(stage.radius_mm), format_value(stage.angle_deg));
        let StageFacts { number, passes, .. } = stage;
        _ = writeln!(
            text,
            "| {number} | {passes} | {radius} mm | {angle} deg | {e1} | {e2} | {e3} | {e0} |"
        );
    }
    text + "\n"
}

/// Empty for a single cell, which is even.
fn uniformity(map: &SensorMap) -> String {
    let summary = &map.summary;
    if summary.cells == 1 {
        return String::new();
    }
    let ([width, height], unit) = (summary.cell_size, map.axes.unit());
    let mut text = format!(
        "Uniformity over {} cells of {} {unit} x {} {unit}; extremes are corrected for noise, intervals hold 95 %.\n\n",
        summary.cells,
        format_value(width),
        format_value(height)
    );
    text += "| over | min/avg | min/max | max/min |\n|---|---|---|---|\n";
    let sets = [
        ("all cells", Some(&summary.all)),
        ("9 points", summary.nine.as_ref()),
        ("13 points", summary.thirteen.as_ref()),
    ];
    for (name, set) in sets {
        if let Some(set) = set {
            let row = [&set.min_avg, &set.min_max, &set.max_min].map(statistic);
            _ = writeln!(text, "| {name} | {} |", row.join(" | "));
        }
    }
    _ = writeln!(
        text,
        "\nCV (standard deviation over mean, noise taken out): {}\n",
        statistic(&summary.cv)
    );
    text
}

fn statistic(value: &Statistic) -> String {
    let [low, high] = value.interval;
    let number = format_with_error(value.value, value.std_error);
    format!("{number} [{}, {}]{}", format_value(low), format_value(high), remark(value.status))
}

fn classes(classes: &[PathClass]) -> String {
    if classes.is_empty() {
        return String::new();
    }
    let mut text =
        "How photons came (R reflected, T transmitted, steps in a row taken once):\n\n".to_owned();
    text += "| share | mean bounces | path |\n|---|---|---|\n";
    for class in &strongest(classes, CLASSES_SHOWN) {
        text += &format!(
            "| {} | {} | {} |\n",
            format_percent(class.share),
            format_value(class.bounces_mean),
            steps(class)
        );
    }
    text + "\n"
}

/// The steps of a class: `pipe.entry T, pipe.wall R`.
fn steps(class: &PathClass) -> String {
    let step = |step: &PathStep| match step.action {
        Action::Reflected => format!("{} R", step.face),
        Action::Transmitted => format!("{} T", step.face),
    };
    let text = class.steps.iter().map(step).collect::<Vec<_>>().join(", ");
    match class.extent {
        Extent::Whole if text.is_empty() => "direct".into(),
        Extent::Whole => text,
        Extent::CutOff => text + ", ...",
        Extent::Others => "all weaker classes".into(),
    }
}

fn balance(report: &Report) -> String {
    let mut text = "## Flux balance\n\n![flux balance](balance.png)\n\n| line | flux | share |\n|---|---|---|\n".to_owned();
    let whole = report.measures.source_flux;
    for (name, measure) in
        report.measures.values.iter().filter(|(name, _)| name.starts_with("balance."))
    {
        if measure.value != 0.0 || name.ends_with(".leaked") || name.ends_with(".residual") {
            let share = format_percent(measure.value / whole);
            text += &format!("| {name} | {} | {share} |\n", quantity(measure));
        }
    }
    text + "\nVirtual sensors let light pass: they are no lines of the balance.\n\n"
}

fn run(report: &Report) -> String {
    let (run, measures) = (&report.run, &report.measures);
    let mut lines = vec![
        format!("scene `{}`, hash {}", report.scene.name, report.scene.hash),
        format!("lumiduct {}, estimator {}, seed {}", run.version, run.estimator.name(), run.seed),
        format!(
            "{} paths in {} batches, {} segments",
            measures.paths, measures.batches, measures.segments
        ),
        format!("asked for {}; ended because {}", run.asked, run.stopped),
        format!("bounce limit {}", run.bounce_limit),
        "unpolarised light: the mean of both polarisations at every interface".to_owned(),
    ];
    if !run.gather.is_empty() {
        lines.push(format!("wishes for gathering: {}", run.gather));
    }
    if !run.gathering.is_empty() {
        lines.push(format!("gathering: {}", run.gathering));
    }
    if let Some(target) = &run.target {
        lines.push(target.sentence());
    }
    if !report.scene.overrides.is_empty() {
        lines.push(format!("overrides: {}", report.scene.overrides.join(", ")));
    }
    for leak in &run.leaks {
        lines.push(format!("leak at [{}, {}, {}] mm", leak.x, leak.y, leak.z));
    }
    let list: String = lines.iter().map(|line| format!("- {line}\n")).collect();
    format!("## Run\n\n{list}")
}
