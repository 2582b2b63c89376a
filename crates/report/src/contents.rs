//! The contents of the report of a run, part by part, for any page format.
//!
//! In the order of a reader's interest: the verdict, the requested numbers, pictures and readings
//! of each sensor, what was simulated, where the light went, and how it was computed.

use crate::by_light::{self, LightMatrix, from_light, matrix, remark_on_totals, sum_over_weathers};
use crate::csv::{intensity_name, map_name, map_words};
use crate::figures::{
    BOUNCES_SHOWN, bounce_plot, directions_map, has_sectors, intensity_plot, sensor_map,
    spectrum_plot, where_and_when,
};
use crate::html::data;
use crate::key_figures::{Listed, is_one_cell, is_shown, key_figures, listed};
use crate::page::{Block, PagePart, Plots, Standing, table};
use crate::words::{
    CHOICES_HEAD, CLASSES_HEAD, ERRORS, NO_LINES, balance_lines, choice_row, class_rows, entry,
    evenness_head, evenness_rows, is_silent, lost_paths, measure_cells, outcome_word, quantity,
    run_lines, variation,
};
use crate::{Report, by_sun, luminaire, rays, record};
use lumiduct_base::number::format_value;
use lumiduct_core::measure::{CheckOutcome, Measure, SensorMap, SensorPaths, Status};
use lumiduct_core::plan::Estimator;
use lumiduct_core::transport::AccountEntry;

/// Share of the flux that the logarithmic histogram of bounces shows, which reveals more of the
/// tail.
const BOUNCES_BY_DECADES: f64 = 0.9999;

/// All parts in order; their plots are added to `plots`.
pub(crate) fn parts(report: &Report, plots: &mut Plots) -> Vec<PagePart> {
    let mut parts: Vec<PagePart> = checks(report).into_iter().collect();
    parts.push(results(report));
    let sensors = &report.measures.sensor_paths;
    parts.extend(sensors.iter().map(|paths| sensor(report, &paths.sensor, plots)));
    parts.push(scene(report, plots));
    parts.push(balance(report, plots));
    parts.push(computation(report, plots));
    parts
}

/// The outcome of the checks.
pub(crate) fn verdict(report: &Report) -> (Standing, String) {
    let count = report.checks.len();
    let missed =
        report.checks.iter().filter(|one| one.verdict.outcome != CheckOutcome::Passed).count();
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
        record::RunOutcome::Missed => Standing::Bad,
        record::RunOutcome::Good if count == 0 => Standing::Open,
        record::RunOutcome::Good => Standing::Good,
    };
    (standing, words)
}

/// Checks and remarks; `None` without either.
fn checks(report: &Report) -> Option<PagePart> {
    let mut blocks = Vec::new();
    if !report.checks.is_empty() {
        let row = |result: &record::CheckResult| {
            let word = outcome_word(result.verdict.outcome).to_owned();
            vec![result.check.measure.clone(), word, result.verdict.reason.clone()]
        };
        blocks.push(table(&["check", "result", "why"], report.checks.iter().map(row).collect()));
    }
    if !report.warnings.is_empty() {
        if !blocks.is_empty() {
            blocks.push(Block::Heading { text: "Remarks".into() });
        }
        blocks.push(Block::List { items: report.warnings.clone() });
    }
    let title = if report.checks.is_empty() { "Remarks" } else { "Checks" };
    (!blocks.is_empty()).then(|| PagePart { title: title.into(), blocks })
}

/// The requested numbers: the measure of the target, and the key figures of every sensor.
fn results(report: &Report) -> PagePart {
    let measures = &report.measures;
    let mut blocks = Vec::new();
    if let Some(target) = &report.run.target {
        let value = measures.values.get(&target.measure).map_or("unknown".into(), quantity);
        let text = format!("{} = {value}; {}.", target.measure, target.sentence());
        blocks.push(Block::Words { text });
    }
    let mut rows = Vec::new();
    for paths in &measures.sensor_paths {
        // Only the first figure of a sensor carries its name.
        let names = std::iter::once(paths.sensor.clone()).chain(std::iter::repeat(String::new()));
        let figures = key_figures(measures, &paths.sensor).into_iter();
        rows.extend(
            figures.zip(names).map(|(own, name)| vec![name, own.label, quantity(own.measure)]),
        );
    }
    let sum = sum_over_weathers(measures.weathers.len());
    let sum = sum.map_or(String::new(), |words| format!(", {words}"));
    blocks.push(table(&["sensor", "", &format!("value ± standard error{sum}")], rows));
    blocks.push(Block::Words { text: ERRORS.into() });
    if let Some(LightMatrix { head, rows }) = matrix(measures) {
        blocks.push(Block::Heading { text: "By source".into() });
        blocks.push(Block::Words { text: by_light::HEAD.into() });
        blocks.push(Block::Table { head, rows, folded: None });
    }
    PagePart { title: "Results".into(), blocks }
}

/// Pictures and readings of a sensor.
fn sensor(report: &Report, name: &str, plots: &mut Plots) -> PagePart {
    let measures = &report.measures;
    let mut blocks = Vec::new();
    let maps = measures.maps.iter().filter(|map| map.sensor == name);
    for map in maps.filter(|map| !is_one_cell(map)) {
        let picture = Some(format!("{}.png", map_name(map)));
        blocks.push(plots.add(map_words(map), data::map(&sensor_map(map)), picture));
        blocks.extend(evenness(map));
    }
    for intensity in measures.intensities.iter().filter(|table| table.sensor == name) {
        let polar = data::polar(&intensity_plot(intensity));
        let light = from_light(intensity.light.as_deref());
        let label = format!("intensity{light}, {}", where_and_when(intensity));
        let picture = Some(format!("{}.png", intensity_name(intensity)));
        blocks.push(plots.add(label, polar, picture));
        let sum = sum_over_weathers(intensity.weathers);
        let label = sum.map_or(String::new(), |words| format!(", {words}"));
        if has_sectors(intensity) {
            let label = format!("intensity{light} by direction{label}");
            blocks.push(plots.add(label, data::map(&directions_map(intensity)), None));
        }
    }
    for spectrum in measures.spectra.iter().filter(|spectrum| spectrum.sensor == name) {
        let chart = data::chart(&spectrum_plot(spectrum), "W/nm");
        blocks.push(plots.add("spectrum", chart, Some(format!("{name}.spectrum.png"))));
    }
    blocks.extend(luminaire::page::blocks(&report.luminaires, name));
    if let Some(text) = rays::sentence(&report.rays, name) {
        blocks.push(Block::Heading { text: "Rays".into() });
        blocks.push(Block::Words { text });
    }
    if let Some(found) = by_sun::by_sun(report, name) {
        let picture = Some(format!("{name}.transmission.png"));
        let chart = data::chart(&found.plot, "1");
        blocks.push(plots.add("transmission by the elevation of the sun", chart, picture));
        blocks.push(Block::Words { text: by_sun::HEAD.into() });
        let rows = found.rows.into_iter().map(Vec::from).collect();
        blocks.push(table(&["source", "elevation of the sun", "transmission"], rows));
    }
    blocks.push(Block::Heading { text: "Measures".into() });
    blocks.extend(remark_on_totals(measures).map(|text| Block::Words { text }));
    blocks.extend(measures_of(report, name, Listed::Reading));
    let cells = measures_rows(report, name, Listed::Cell);
    if !cells.is_empty() {
        let what = format!("{} single cells and rings", cells.len());
        blocks.push(folded(measures_table(cells), what));
    }
    PagePart { title: format!("Sensor {name}"), blocks }
}

fn evenness(map: &SensorMap) -> Vec<Block> {
    let Some(head) = evenness_head(map) else { return Vec::new() };
    let row = |(name, row): (&str, [String; 3])| {
        std::iter::once(name.to_owned()).chain(row).collect::<Vec<_>>()
    };
    let rows = evenness_rows(map).into_iter().map(row).collect();
    vec![
        Block::Words { text: head },
        trimmed(&["over", "min/avg", "min/max", "max/min"], rows),
        Block::Words { text: variation(map) },
    ]
}

/// The measures of a sensor that are listed in one place; those without any light are folded away.
fn measures_of(report: &Report, sensor: &str, place: Listed) -> Vec<Block> {
    let (dark, lit): (Vec<_>, Vec<_>) = measures_rows(report, sensor, place)
        .into_iter()
        .partition(|(_, measure)| measure.status == Status::NoSignal && measure.value == 0.0);
    if lit.is_empty() {
        return vec![measures_table(dark)];
    }
    let mut blocks = vec![measures_table(lit)];
    if !dark.is_empty() {
        let what = format!("{} measures for which nothing was counted", dark.len());
        blocks.push(folded(measures_table(dark), what));
    }
    blocks
}

/// Measures with their names.
type MeasureRows<'r> = Vec<(&'r String, &'r Measure)>;

fn measures_rows<'r>(report: &'r Report, sensor: &str, place: Listed) -> MeasureRows<'r> {
    let measures = &report.measures;
    let prefix = format!("{sensor}.");
    let is_here = |name: &str| {
        name.strip_prefix(&prefix)
            .is_some_and(|rest| listed(rest) == place && is_shown(measures, sensor, rest))
    };
    measures.values.iter().filter(|(name, _)| is_here(name)).collect()
}

fn measures_table(rows: MeasureRows<'_>) -> Block {
    let row = |(name, measure): (&String, &Measure)| {
        std::iter::once(name.clone()).chain(measure_cells(measure)).collect()
    };
    let rows = rows.into_iter().map(row).collect();
    trimmed(&["measure", "value ± standard error", "bias up to", "remark"], rows)
}

/// A table folded away behind a summary.
fn folded(table: Block, what: String) -> Block {
    match table {
        Block::Table { head, rows, folded: _ } => Block::Table { head, rows, folded: Some(what) },
        other @ (Block::Heading { .. }
        | Block::Words { .. }
        | Block::List { .. }
        | Block::Plot { .. }
        | Block::PlotRow { .. }) => other,
    }
}

/// A table without the columns that are empty in every row; the first one stays.
fn trimmed(head: &[&str], rows: Vec<Vec<String>>) -> Block {
    let kept: Vec<usize> = (0..head.len())
        .filter(|&column| column == 0 || rows.iter().any(|row| !is_silent(&row[column])))
        .collect();
    let pick = |row: &Vec<String>| kept.iter().map(|&column| row[column].clone()).collect();
    let head = kept.iter().map(|&column| head[column].to_owned()).collect();
    Block::Table { head, rows: rows.iter().map(pick).collect(), folded: None }
}

fn scene(report: &Report, plots: &mut Plots) -> PagePart {
    let drawing = &report.drawing;
    let label = format!("the scene with {} paths, coloured by their end", drawing.paths.len());
    let mut blocks = vec![plots.add(label, data::scene(drawing), None)];
    if !drawing.remarks.is_empty() {
        let text = format!("The picture is simplified: {}.", drawing.remarks.join("; "));
        blocks.push(Block::Words { text });
    }
    let measures = &report.measures;
    let text = format!(
        "Lengths are in mm, angles in deg, flux in {}; coordinates are those of the scene file. {} paths \
            were traced; the sources together emit {} {}.",
        measures.unit.flux(),
        measures.paths,
        format_value(measures.source_flux),
        measures.unit.flux(),
    );
    blocks.push(Block::Words { text });
    for list in &report.inventory.lists {
        let head = list.head.iter().map(|head| (*head).to_owned()).collect();
        blocks.push(Block::Table { head, rows: list.rows.clone(), folded: None });
        blocks.extend(list.left_out().map(|text| Block::Words { text }));
    }
    PagePart { title: "Scene".into(), blocks }
}

fn balance(report: &Report, plots: &mut Plots) -> PagePart {
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
        table(&["line", "flux", "share"], rows),
    ];
    if !rest.is_empty() {
        let folded = Some(format!("{} lines without light", rest.len()));
        let head = ["line", "flux"].map(str::to_owned).to_vec();
        blocks.push(Block::Table { head, rows: rest, folded });
    }
    blocks.push(Block::Words { text: NO_LINES.into() });
    PagePart { title: "Flux balance".into(), blocks }
}

/// How the light reached the sensors, how it was estimated, and how to repeat the run.
fn computation(report: &Report, plots: &mut Plots) -> PagePart {
    let measures = &report.measures;
    let mut blocks = Vec::new();
    for paths in &measures.sensor_paths {
        blocks.push(Block::Heading { text: format!("Light on its way to {}", paths.sensor) });
        blocks.extend(journey(report, paths, plots));
    }
    blocks.push(Block::Heading { text: "Estimators".into() });
    blocks.extend(estimators(report));
    blocks.push(Block::Heading { text: "Run".into() });
    blocks.push(Block::List { items: run_lines(report) });
    PagePart { title: "Computation".into(), blocks }
}

/// How the light reached a sensor.
fn journey(report: &Report, paths: &SensorPaths, plots: &mut Plots) -> Vec<Block> {
    let mut blocks = Vec::new();
    if !paths.depths.is_empty() {
        let unit = report.measures.unit.flux();
        let [shown, all] =
            [BOUNCES_SHOWN, BOUNCES_BY_DECADES].map(|share| bounce_plot(paths, unit, share));
        let chart = data::chart_with_tail(&shown, &all, unit);
        let picture = Some(format!("{}.bounces.png", paths.sensor));
        blocks.push(plots.add("flux by number of bounces", chart, picture));
    }
    blocks.extend(measures_of(report, &paths.sensor, Listed::Journey));
    if !paths.classes.is_empty() {
        blocks.push(Block::Words { text: CLASSES_HEAD.into() });
        let rows = class_rows(&paths.classes).into_iter().map(Vec::from).collect();
        blocks.push(table(&["share", "mean bounces", "path"], rows));
    }
    blocks
}

/// Which estimator gave the values of each sensor, why, and with which windows.
fn estimators(report: &Report) -> Vec<Block> {
    let measures = &report.measures;
    let mut blocks = Vec::new();
    if measures.choices.is_empty() {
        let row = |(sensor, estimator): (&String, &Estimator)| {
            vec![sensor.clone(), estimator.name().to_owned()]
        };
        blocks.push(table(&["sensor", "estimator"], measures.estimators.iter().map(row).collect()));
    } else {
        let rows = measures.choices.iter().map(|(sensor, choice)| {
            std::iter::once(sensor.clone()).chain(choice_row(choice)).collect()
        });
        let tried = Estimator::TRIED.map(Estimator::name);
        let head: Vec<&str> = ["sensor", "chosen"].into_iter().chain(tried).collect();
        blocks.push(Block::Words { text: CHOICES_HEAD.into() });
        blocks.push(trimmed(&head, rows.collect()));
    }
    for account in &measures.accounts {
        let name = account.estimator.name();
        blocks.push(Block::Heading { text: format!("Sensor {}, by {name}", account.sensor) });
        let sentences = account.sentences.iter().cloned();
        blocks.extend(sentences.map(|text| Block::Words { text }));
        let row = |row: &Vec<AccountEntry>| row.iter().map(entry).collect();
        blocks.push(table(&account.columns, account.rows.iter().map(row).collect()));
    }
    for paths in &measures.sensor_paths {
        blocks.extend(paths.lost.map(|lost| Block::Words {
            text: format!("Sensor {}: {}", paths.sensor, lost_paths(lost)),
        }));
    }
    blocks
}
