//! `diff.html`: a comparison as a page for a browser, with what matters to the customer first.

use crate::diff::page::{HEADER, cells, findings, remark, title};
use crate::diff::{Diff, DiffRow, MapDiff, MapOutcome, maps};
use crate::html::data;
use crate::html::frame::{Page, render};
use crate::page::{Block, PagePart, Plots, Standing};
use lumiduct_base::error::Result;

/// Rows of a table that are shown; further ones are folded away.
const ROWS_SHOWN: usize = 60;

/// The whole page.
pub(crate) fn html(diff: &Diff) -> Result<String> {
    let mut plots = Plots::default();
    let [checked, light, others] = by_interest(diff);
    let groups = [
        ("Measures of the checks", checked),
        ("Flux and efficiency", light),
        ("All other measures, largest differences first", others),
    ];
    let groups = groups.into_iter().filter(|(_, rows)| !rows.is_empty());
    let mut parts: Vec<PagePart> = groups
        .map(|(title, rows)| PagePart { title: title.into(), blocks: measures(&rows) })
        .collect();
    parts.extend(differences(diff, &mut plots));
    let items = findings(diff);
    parts.push(PagePart { title: "What was found".into(), blocks: vec![Block::List { items }] });
    let page = Page {
        title: title(diff),
        masthead: None,
        description: Some(format!("A: {}\nB: {}", diff.facts[0], diff.facts[1])),
        verdict: verdict(diff),
        standing: if diff.is_within() { Standing::Good } else { Standing::Bad },
        parts,
        footer: format!("lumiduct {}", env!("CARGO_PKG_VERSION")),
    };
    render(&page, &plots)
}

/// The outcome, in a sentence.
fn verdict(diff: &Diff) -> String {
    let maps = diff.maps_that_count().filter(|map| !map.is_noise()).count();
    let words = findings(diff).pop().unwrap_or_default();
    match maps {
        0 => words,
        1 => format!("{words}; one map differs by more than noise"),
        count => format!("{words}; {count} maps differ by more than noise"),
    }
}

/// Rows of the measures that checks judge, in the order of the checks; then fluxes and efficiencies; then all others.
fn by_interest(diff: &Diff) -> [Vec<&DiffRow>; 3] {
    let place = |row: &DiffRow| diff.checks.iter().position(|name| name == row.measure());
    let is_light = |row: &DiffRow| {
        let last = row.measure().rsplit('.').next();
        matches!(last, Some("flux" | "efficiency"))
    };
    let (mut checked, rest): (Vec<&DiffRow>, Vec<&DiffRow>) =
        diff.rows.iter().partition(|row| place(row).is_some());
    checked.sort_by_key(|row| place(row));
    let (light, others) = rest.into_iter().partition(|row| is_light(row));
    [checked, light, others]
}

fn measures(rows: &[&DiffRow]) -> Vec<Block> {
    let head: Vec<String> = HEADER.into_iter().chain([""]).map(str::to_owned).collect();
    let row = |row: &&DiffRow| -> Vec<String> {
        let remark = remark(row).trim_matches('*').to_owned();
        cells(row).into_iter().chain([remark]).collect()
    };
    let is_single =
        |row: &&DiffRow| [".cell.", ".ring."].iter().any(|part| row.measure().contains(part));
    let (single, rows): (Vec<&DiffRow>, Vec<&DiffRow>) = rows.iter().copied().partition(is_single);
    let (shown, rest) = rows.split_at(rows.len().min(ROWS_SHOWN));
    let table = |rows: &[&DiffRow], folded: Option<String>| Block::Table {
        head: head.clone(),
        rows: rows.iter().map(row).collect(),
        folded,
    };
    let mut blocks = vec![table(shown, None)];
    let folded = [(rest, "more"), (&single[..], "single cells and rings")];
    for (rows, what) in folded.into_iter().filter(|(rows, _)| !rows.is_empty()) {
        blocks.push(table(rows, Some(format!("{} {what}", rows.len()))));
    }
    blocks
}

/// The differences of all maps that were compared.
fn differences(diff: &Diff, plots: &mut Plots) -> Option<PagePart> {
    let block = |map: &MapDiff| {
        let MapOutcome::Compared { difference, .. } = &map.outcome else { return None };
        let data = data::map(&maps::drawn(map, difference));
        let label = format!("{}: B − A", map.name);
        let plot = plots.add(label, data, Some(map.picture_name()));
        Some([plot, Block::Words { text: map.sentence() }])
    };
    let blocks: Vec<Block> = diff.maps.iter().filter_map(block).flatten().collect();
    (!blocks.is_empty()).then(|| PagePart { title: "Maps".into(), blocks })
}
