//! A comparison in words: the table on the terminal, the page and the table as files.

use crate::OutputFile;
use crate::csv::table;
use crate::diff::{Diff, DiffRow, Judgement, MapOutcome};
use lumiduct_base::error::Result;
use lumiduct_base::number::{format_fixed, format_percent, format_value, format_with_error};
use lumiduct_base::text::{markdown_cell, markdown_page};
use statrs::distribution::{ContinuousCDF, Normal};
use std::fmt::Write;

/// Rows of the table on the terminal, unless all are wanted.
const ROWS_SHOWN: usize = 12;
/// Names of a list that are listed one by one.
const NAMES_SHOWN: usize = 5;
/// Differences beyond this many errors are counted and compared with chance.
const REMARKABLE: f64 = 3.0;

/// How much of the table is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShownRows {
    /// The worst dozen.
    Worst,
    /// All of them.
    All,
}

/// The heads of the columns.
pub(crate) const HEADER: [&str; 6] = ["measure", "A", "B", "B − A", "sigmas", "relative"];

/// The printed text: both reports, the worst measures or all, and the findings.
pub fn diff_table(diff: &Diff, rows: ShownRows) -> String {
    let shown = match rows {
        ShownRows::Worst => diff.rows.len().min(ROWS_SHOWN),
        ShownRows::All => diff.rows.len(),
    };
    let mut lines = vec![HEADER.map(str::to_owned)];
    lines.extend(diff.rows[..shown].iter().map(cells));
    let mut text = format!("A: {}\nB: {}\n\n{}", diff.facts[0], diff.facts[1], aligned(&lines));
    if shown < diff.rows.len() {
        _ = writeln!(text, "and {} more (use --all to show them)", diff.rows.len() - shown);
    }
    text.push('\n');
    for line in findings(diff) {
        text += &line;
        text.push('\n');
    }
    text
}

/// `diff.md`.
pub(crate) fn markdown(diff: &Diff) -> String {
    let mut page =
        format!("# {}\n\n* A: {}\n* B: {}\n\n", title(diff), diff.facts[0], diff.facts[1]);
    for line in findings(diff) {
        _ = writeln!(page, "* {}", markdown_cell(&line));
    }
    page += "\n## Measures, largest differences first\n\n";
    _ = writeln!(page, "| {} | |\n|---|--:|--:|--:|--:|--:|---|", HEADER.join(" | "));
    for row in &diff.rows {
        let cells = cells(row).map(|cell| markdown_cell(&cell));
        _ = writeln!(page, "| {} | {} |", cells.join(" | "), markdown_cell(&remark(row)));
    }
    let compared = |map: &&crate::diff::MapDiff| match map.outcome {
        MapOutcome::Compared { .. } => true,
        MapOutcome::OtherCells => false,
    };
    for map in diff.maps.iter().filter(compared) {
        let (name, picture) = (&map.name, map.picture_name());
        _ = write!(page, "\n## {name}\n\n![Difference of {name}]({picture})\n");
    }
    markdown_page(&page)
}

/// What was compared.
pub(crate) fn title(diff: &Diff) -> String {
    let [a, b] = &diff.names;
    if a == b { format!("Two reports of {a}") } else { format!("{a} and {b}") }
}

/// `diff.csv`.
pub(crate) fn table_file(diff: &Diff) -> Result<OutputFile> {
    let header = [
        "measure",
        "value_a",
        "error_a",
        "value_b",
        "error_b",
        "difference",
        "error",
        "sigmas",
        "relative",
        "unit",
        "judgement",
    ];
    let rows = diff.rows.iter().map(|row| {
        let [a, b] = &row.values;
        let relative = row.relative().map_or(String::new(), |share| share.to_string());
        let numbers = [
            a.value,
            a.total_error(),
            b.value,
            b.total_error(),
            row.difference,
            row.error,
            row.sigmas,
        ];
        let mut line = vec![row.name.clone()];
        line.extend(numbers.map(|number| number.to_string()));
        line.extend([relative, a.unit.clone(), word(row.judgement).to_owned()]);
        line
    });
    table("diff.csv".into(), &header, rows)
}

/// A judgement in a word.
fn word(judgement: Judgement) -> &'static str {
    match judgement {
        Judgement::Within => "within",
        Judgement::Tolerated => "tolerated",
        Judgement::Beyond => "beyond",
        Judgement::Unknown => "unknown",
    }
}

/// The remark on a row besides its numbers.
pub(crate) fn remark(row: &DiffRow) -> String {
    match row.judgement {
        Judgement::Within => String::new(),
        Judgement::Tolerated => "within the relative limit".to_owned(),
        Judgement::Beyond => "**beyond the limit**".to_owned(),
        Judgement::Unknown => row.doubt.clone().unwrap_or_default(),
    }
}

/// A row in a sentence.
pub(crate) fn sentence(row: &DiffRow) -> String {
    let [_, a, b, difference, sigmas, relative] = cells(row);
    format!("{} is {a} in A and {b} in B: {difference}, {sigmas} sigmas, {relative}", row.name)
}

/// A row of the table: measure, both values, difference, sigmas and share.
pub(crate) fn cells(row: &DiffRow) -> [String; 6] {
    let [a, b] = &row.values;
    let is_known = row.judgement != Judgement::Unknown;
    let unknown = || "?".to_owned();
    let sigmas = if is_known { sigmas(row.sigmas) } else { unknown() };
    let relative = match row.relative() {
        Some(share) if is_known => format_percent(share),
        Some(_) => unknown(),
        None => "n/a".to_owned(),
    };
    // An error that is pure rounding is not shown.
    let difference = if row.is_noisy {
        format_with_error(row.difference, row.error)
    } else if row.sigmas.abs() < 1.0 {
        "0".to_owned()
    } else {
        format_value(row.difference)
    };
    [row.name.clone(), a.to_string(), b.to_string(), difference, sigmas, relative]
}

/// A number of errors with one decimal; beyond ten thousand the exact number does not matter.
fn sigmas(sigmas: f64) -> String {
    const MANY: f64 = 1e4;
    match sigmas {
        many if many > MANY => "> 10000".to_owned(),
        many if many < -MANY => "< −10000".to_owned(),
        few => format_fixed(few, 1),
    }
}

/// Everything except the table, one line each; the last says whether the reports differ.
pub(crate) fn findings(diff: &Diff) -> Vec<String> {
    let mut lines = vec![chance(diff)];
    let unknown: Vec<&DiffRow> =
        diff.rows.iter().filter(|row| row.judgement == Judgement::Unknown).collect();
    if !unknown.is_empty() {
        let names = unknown.iter().map(|row| {
            let doubt = row.doubt.as_deref().unwrap_or_default();
            format!("{} ({doubt})", row.name)
        });
        lines.push(format!("{} cannot be judged: {}", measures(unknown.len()), list(names)));
    }
    for (side, names) in ["A", "B"].into_iter().zip(&diff.only_in) {
        if !names.is_empty() {
            let [count, names] = [measures(names.len()), list(names.iter().cloned())];
            lines.push(format!("only {side} has {count}: {names}"));
        }
    }
    lines.extend(diff.maps.iter().map(|map| {
        let beyond = if map.is_noise() { "" } else { "; beyond noise" };
        format!("map {}: {}{beyond}", map.name, map.sentence())
    }));
    let limit = diff.limits.words();
    let tolerated = diff.count(Judgement::Tolerated);
    if tolerated > 0 {
        lines.push(format!(
            "{} beyond {} sigmas, but within the relative limit",
            are(tolerated),
            diff.limits.sigmas
        ));
    }
    lines.push(match diff.count(Judgement::Beyond) {
        0 => format!("no measure is beyond the limit of {limit}"),
        count => format!("{} beyond the limit of {limit}", are(count)),
    });
    lines
}

/// How many measures differ remarkably, and how many would by chance.
fn chance(diff: &Diff) -> String {
    let judged = |row: &&DiffRow| row.judgement != Judgement::Unknown;
    let noisy = diff.rows.iter().filter(judged).filter(|row| row.is_noisy).count();
    let remarkable = diff.rows.iter().filter(judged);
    let remarkable = remarkable.filter(|row| row.sigmas.abs() > REMARKABLE).count();
    let expected = noisy as f64 * chance_beyond(REMARKABLE);
    format!(
        "{} compared, {noisy} of them with noise: {remarkable} beyond {REMARKABLE} sigmas, {} expected by chance",
        measures(diff.rows.len()),
        format_value((1e2 * expected).round() / 1e2)
    )
}

/// Probability that noise alone exceeds this many errors on either side.
fn chance_beyond(sigmas: f64) -> f64 {
    2.0 * Normal::standard().sf(sigmas)
}

fn measures(count: usize) -> String {
    if count == 1 { "1 measure".to_owned() } else { format!("{count} measures") }
}

fn are(count: usize) -> String {
    if count == 1 { "1 measure is".to_owned() } else { format!("{count} measures are") }
}

/// The first few of some names.
fn list(names: impl ExactSizeIterator<Item = String>) -> String {
    let more = names.len().saturating_sub(NAMES_SHOWN);
    let shown: Vec<String> = names.take(NAMES_SHOWN).collect();
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &rest
}

/// Aligned columns: the first to the left, the others to the right.
fn aligned(lines: &[[String; 6]]) -> String {
    let mut widths = [0; 6];
    for line in lines {
        for (width, cell) in widths.iter_mut().zip(line) {
            *width = cell.chars().count().max(*width);
        }
    }
    let mut text = String::new();
    for line in lines {
        _ = write!(text, "  {:1$}", line[0], widths[0]);
        for (cell, width) in line.iter().zip(widths).skip(1) {
            _ = write!(text, "  {cell:>width$}");
        }
        text.push('\n');
    }
    text
}
