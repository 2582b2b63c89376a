//! `report.html`: the page for people with a browser. One file, without anything to load.
//!
//! The parts are made here, as tables and as plots in plain data; `frame` makes a page of them, and `assets` draws. What is
//! said about numbers is that of `words`, which `report.md` says as well.

mod coarse;
pub(crate) mod data;
pub(crate) mod frame;

use crate::error::Result;
use crate::measure::{Outcome, SensorPaths, Status};
use crate::number::{format_value, format_with_error};
use crate::report::by_sun;
use crate::report::csv::{map_name, map_words};
use crate::report::figures::{BOUNCES_SHOWN, bounce_plot, intensity_plot};
use crate::report::html::frame::{Block, Page, Part, Plots, Standing, render, table};
use crate::report::words::{
    CHOICES_HEAD, CLASSES_HEAD, NO_LINES, balance_lines, choice_row, class_rows, evenness_head,
    evenness_rows, gathering, lost_paths, outcome_word, quantity, remark, run_lines, stage_row,
    variation,
};
use crate::report::{Report, record};

/// Share of the flux that the histogram of bounces shows by decades, where more is to be seen of a tail.
const BOUNCES_BY_DECADES: f64 = 0.9999;

/// The whole page.
pub(crate) fn html(report: &Report) -> Result<String> {
    let mut plots = Plots::default();
    let mut parts = vec![checks(report), sensors(report), scene(report, &mut plots)];
    let sensors = &report.measures.sensor_paths;
    parts.extend(sensors.iter().map(|paths| sensor(report, paths, &mut plots)));
    parts.push(balance(report, &mut plots));
    parts.push(run(report));
    let (standing, verdict) = verdict(report);
    let page = Page {
        title: report.scene.title.clone(),
        description: report.scene.description.as_ref().map(|text| text.trim().to_owned()),
        verdict,
        standing,
        parts,
        footer: format!("lumiduct {}, scene {}", report.run.version, report.scene.name),
    };
    render(&page, &plots)
}

/// What has become of the checks.
fn verdict(report: &Report) -> (Standing, String) {
    let count = report.checks.len();
    let missed = report.checks.iter().filter(|one| one.verdict.outcome != Outcome::Passed).count();
    let mut words = match (count, missed) {
        (0, _) => "No checks".to_owned(),
        (1, 0) => "The check passed".to_owned(),
        (_, 0) => format!("All {count} checks passed"),
        (_, _) => format!("{missed} of {count} checks missed"),
    };
    if report.run.partial {
        words += "; partial: the run was interrupted";
    }
    if report.run.target.as_ref().is_some_and(|target| !target.is_reached()) {
        words += "; the target was not reached";
    }
    let standing = match report.outcome() {
        _ if report.run.partial => Standing::Bad,
        record::Outcome::Missed => Standing::Bad,
        record::Outcome::Good if count == 0 => Standing::Open,
        record::Outcome::Good => Standing::Good,
    };
    (standing, words)
}

fn checks(report: &Report) -> Part {
    let mut blocks = Vec::new();
    if !report.checks.is_empty() {
        let row = |result: &record::CheckResult| {
            let word = outcome_word(result.verdict.outcome).to_owned();
            vec![result.check.measure.clone(), word, result.verdict.reason.clone()]
        };
        blocks.push(table(["check", "result", "why"], report.checks.iter().map(row).collect()));
    }
    if !report.warnings.is_empty() {
        blocks.push(Block::Heading { text: "Remarks".into() });
        blocks.push(Block::List { items: report.warnings.clone() });
    }
    if blocks.is_empty() {
        blocks.push(Block::Words { text: "The scene has no checks.".into() });
    }
    Part { title: "Checks".into(), blocks }
}

/// The totals of every sensor, and how it was estimated.
fn sensors(report: &Report) -> Part {
    let measures = &report.measures;
    let row = |paths: &SensorPaths| {
        let name = &paths.sensor;
        let cell = |what: &str| {
            measures.values.get(&format!("{name}.{what}")).map_or(String::new(), quantity)
        };
        let estimator = measures.estimators.get(name).map_or("", |estimator| estimator.name());
        vec![name.clone(), estimator.to_owned(), cell("flux"), cell("efficiency")]
    };
    let rows = measures.sensor_paths.iter().map(row).collect();
    let mut blocks = vec![table(["sensor", "estimator", "flux", "efficiency"], rows)];
    if !measures.choices.is_empty() {
        let rows = measures.choices.iter().map(|(sensor, choice)| {
            std::iter::once(sensor.clone()).chain(choice_row(choice)).collect()
        });
        let head = ["sensor", "chosen", "forward", "backward", "mix", "gather"];
        blocks.push(Block::Heading { text: "Choice of estimators".into() });
        blocks.push(Block::Words { text: CHOICES_HEAD.into() });
        blocks.push(table(head, rows.collect()));
    }
    Part { title: "Sensors".into(), blocks }
}

fn scene(report: &Report, plots: &mut Plots) -> Part {
    let drawing = &report.drawing;
    let label = format!("the scene with {} paths by where they end", drawing.paths.len());
    let mut blocks = vec![plots.add(label, data::scene(drawing), None)];
    if !drawing.remarks.is_empty() {
        let text = format!("Left out of the picture: {}.", drawing.remarks.join("; "));
        blocks.push(Block::Words { text });
    }
    Part { title: "Scene".into(), blocks }
}

fn sensor(report: &Report, paths: &SensorPaths, plots: &mut Plots) -> Part {
    let (name, measures) = (&paths.sensor, &report.measures);
    let mut blocks = Vec::new();
    for map in measures.maps.iter().filter(|map| map.sensor == *name) {
        let picture = Some(format!("{}.png", map_name(map)));
        blocks.push(plots.add(map_words(map), data::map(map), picture));
        blocks.extend(evenness(map));
    }
    for intensity in measures.intensities.iter().filter(|table| table.sensor == *name) {
        let polar = data::polar(&intensity_plot(intensity));
        let radius = intensity.radius_mm.map(|radius| format!(" at {} mm", format_value(radius)));
        let label = format!("intensity{}", radius.unwrap_or(", far field".into()));
        blocks.push(plots.add(label, polar, Some(format!("{name}.intensity.png"))));
        let all = data::directions(intensity);
        blocks.extend(all.map(|all| plots.add("intensity by direction", all, None)));
    }
    if let Some(found) = by_sun::by_sun(report, name) {
        let picture = Some(format!("{name}.transmission.png"));
        let chart = data::chart(&found.plot, "1");
        blocks.push(plots.add("transmission by the elevation of the sun", chart, picture));
        blocks.push(Block::Words { text: by_sun::HEAD.into() });
        let rows = found.rows.into_iter().map(Vec::from).collect();
        blocks.push(table(["source", "elevation of the sun", "transmission"], rows));
    }
    blocks.push(Block::Heading { text: "Measures".into() });
    blocks.extend(values(report, name));
    if !paths.depths.is_empty() {
        let unit = measures.unit.flux();
        let [shown, all] =
            [BOUNCES_SHOWN, BOUNCES_BY_DECADES].map(|share| bounce_plot(paths, unit, share));
        let mut chart = data::chart(&all, unit);
        chart["linear_to"] = data::last_place(&shown);
        let picture = Some(format!("{name}.bounces.png"));
        blocks.push(plots.add("flux by number of bounces", chart, picture));
    }
    blocks.extend(ways(report, paths));
    Part { title: format!("Sensor {name}"), blocks }
}

fn evenness(map: &crate::measure::SensorMap) -> Vec<Block> {
    let Some(head) = evenness_head(map) else { return Vec::new() };
    let row = |(name, row): (&str, [String; 3])| {
        std::iter::once(name.to_owned()).chain(row).collect::<Vec<_>>()
    };
    let rows = evenness_rows(map).into_iter().map(row).collect();
    vec![
        Block::Words { text: head },
        table(["over", "min/avg", "min/max", "max/min"], rows),
        Block::Words { text: variation(map) },
    ]
}

/// All measures of a sensor; those of single cells and rings folded away.
fn values(report: &Report, sensor: &str) -> Vec<Block> {
    let prefix = format!("{sensor}.");
    let (mut rows, mut cells) = (Vec::new(), Vec::new());
    for (name, measure) in &report.measures.values {
        let Some(rest) = name.strip_prefix(&prefix) else { continue };
        let unit = if measure.unit == "1" { String::new() } else { format!(" {}", measure.unit) };
        // What the error of nothing is takes words.
        let value = match measure.status {
            Status::NoSignal => quantity(measure),
            Status::Ok
            | Status::TooFew
            | Status::NoiseLimited
            | Status::BiasInNoise
            | Status::BiasNotResolved
            | Status::Contradicted => {
                format!("{}{unit}", format_with_error(measure.value, measure.std_error))
            }
        };
        let row = vec![
            name.clone(),
            value,
            measure.bias.map_or("none".into(), |bias| format!("{}{unit}", format_value(bias))),
            measure.estimator.name().to_owned(),
            remark(measure.status).trim_matches([' ', '(', ')']).to_owned(),
        ];
        let of_cell = rest.starts_with("cell.") || rest.starts_with("ring.");
        if of_cell { cells.push(row) } else { rows.push(row) }
    }
    let head = ["measure", "value ± standard error", "bias up to", "estimator", "remark"];
    let mut blocks = vec![table(head, rows)];
    if !cells.is_empty() {
        let folded = Some(format!("{} single cells and rings", cells.len()));
        let head = head.map(str::to_owned).to_vec();
        blocks.push(Block::Table { head, rows: cells, folded });
    }
    blocks
}

/// How the light came to a sensor, and how gathered values came about.
fn ways(report: &Report, paths: &SensorPaths) -> Vec<Block> {
    let mut blocks = Vec::new();
    let unit = report.measures.unit.flux();
    for facts in report.measures.gathered.iter().filter(|facts| facts.sensor == paths.sensor) {
        blocks.push(Block::Heading { text: "Gathering".into() });
        let words = gathering(facts, unit).into_iter();
        blocks.extend(words.map(|text| Block::Words { text }));
        let e1 = format!("E1 in {unit}");
        let head = ["stage", "passes", "radius", "angle", e1.as_str(), "E2", "E3", "E0"];
        blocks.push(table(head, facts.stages.iter().map(stage_row).collect()));
    }
    blocks.extend(paths.lost.map(|lost| Block::Words { text: lost_paths(lost) }));
    if !paths.classes.is_empty() {
        blocks.push(Block::Heading { text: "Path classes".into() });
        blocks.push(Block::Words { text: CLASSES_HEAD.into() });
        let rows = class_rows(&paths.classes).into_iter().map(Vec::from).collect();
        blocks.push(table(["share", "mean bounces", "path"], rows));
    }
    blocks
}

fn balance(report: &Report, plots: &mut Plots) -> Part {
    let measures = &report.measures;
    let flow = data::flow(&measures.balance, measures.source_flux, measures.unit.flux());
    let lines = balance_lines(report);
    let is_told = |name: &str| lines.iter().any(|(told, _, _)| *told == name);
    let rest: Vec<Vec<String>> = measures
        .values
        .iter()
        .filter(|(name, _)| name.starts_with("balance.") && !is_told(name))
        .map(|(name, measure)| vec![name.clone(), quantity(measure)])
        .collect();
    let row = |(name, flux, share): &(&str, String, String)| {
        vec![(*name).to_owned(), flux.clone(), share.clone()]
    };
    let rows = lines.iter().map(row).collect();
    let mut blocks = vec![
        plots.add("where the light went", flow, Some("balance.png".into())),
        table(["line", "flux", "share"], rows),
    ];
    if !rest.is_empty() {
        let folded = Some(format!("{} lines without light", rest.len()));
        let head = ["line", "flux"].map(str::to_owned).to_vec();
        blocks.push(Block::Table { head, rows: rest, folded });
    }
    blocks.push(Block::Words { text: NO_LINES.into() });
    Part { title: "Flux balance".into(), blocks }
}

fn run(report: &Report) -> Part {
    Part { title: "Run".into(), blocks: vec![Block::List { items: run_lines(report) }] }
}
