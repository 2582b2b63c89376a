//! A measured beside a computed map in words: the printed text, the pages and the tables.

use crate::OutputFile;
use crate::csv::table as csv_table;
use crate::html::data;
use crate::html::frame::{Page, render};
use crate::markdown;
use crate::measured::pictures::{self, NamedMap, NamedSection, adjusted_words};
use crate::measured::{DifferenceFigures, MeasuredDiff};
use crate::page::{Block, PagePart, Plots, Standing, table};
use lumiduct_base::error::Result;
use lumiduct_base::number::{format_fixed, format_percent, format_value, format_with_error};
use lumiduct_base::text::markdown_page;
use std::fmt::Write;

/// A row of figures: its name, and a number for each side with a unit; `1` for none.
struct FigureRow {
    name: &'static str,
    values: [Option<f64>; 2],
    unit: String,
}

/// The printed text.
pub fn measured_text(diff: &MeasuredDiff) -> String {
    let [report, file] = &diff.facts;
    let mut text = format!("computed: {}, {report}\nmeasured: {file}\n\n", diff.name);
    for line in findings(diff) {
        _ = writeln!(text, "{line}");
    }
    text.push('\n');
    for [name, computed, measured] in side_cells(diff) {
        _ = writeln!(text, "{name}: computed {computed}, measured {measured}");
    }
    for remark in &diff.remarks {
        _ = writeln!(text, "remark: {remark}");
    }
    _ = writeln!(text, "\n{}", verdict(diff));
    text
}

/// All files: pictures first, so that the pages can name them.
///
/// # Errors
///
/// `Error::Output` if a picture cannot be drawn, or a table or the page cannot be composed.
pub fn measured_files(diff: &MeasuredDiff) -> Result<Vec<OutputFile>> {
    let (maps, sections) = (pictures::maps(diff), pictures::sections(diff));
    let mut files = pictures::files(&maps, &sections)?;
    let mut plots = Plots::default();
    let parts = parts(diff, &maps, &sections, &mut plots);
    let title = format!("{} of {}, measured and computed", diff.name, diff.scene);
    let [report, file] = &diff.facts;
    let mut text = format!(
        "# {title}\n\n* computed: {report}\n* measured: {file}\n\n**{}**\n\n",
        verdict(diff)
    );
    for part in &parts {
        markdown::add(&mut text, part, usize::MAX);
    }
    files.push(figure_table(diff)?);
    files.push(cell_table(diff)?);
    files.push(OutputFile::text("diff.md", markdown_page(text.trim_end()) + "\n"));
    let page = Page {
        title,
        masthead: None,
        description: Some(format!("computed: {report}\nmeasured: {file}")),
        verdict: verdict(diff),
        standing: match diff.limit {
            None => Standing::Open,
            Some(_) if diff.is_within() => Standing::Good,
            Some(_) => Standing::Bad,
        },
        parts,
        footer: format!("lumiduct {}", env!("CARGO_PKG_VERSION")),
    };
    files.push(OutputFile::text("diff.html", render(&page, &plots)?));
    Ok(files)
}

/// The outcome in a sentence.
pub(crate) fn verdict(diff: &MeasuredDiff) -> String {
    let rms = format_percent(diff.after.rms_of_max);
    let adjusted = match adjusted_words(diff) {
        "" => String::new(),
        words => format!(" ({})", words.trim_start_matches(", ")),
    };
    let words = format!("the rms difference{adjusted} is {rms} of the largest computed value");
    match diff.limit {
        None => format!("{words}; no limit was given"),
        Some(limit) if diff.is_within() => {
            format!("{words}, within the limit of {}", format_percent(limit))
        }
        Some(limit) => format!("{words}, beyond the limit of {}", format_percent(limit)),
    }
}

/// Alignment, scale and differences, a line each.
fn findings(diff: &MeasuredDiff) -> Vec<String> {
    let mut lines = alignment(diff);
    lines.push(match diff.scale {
        None => "scale: not applied (--no-scale)".to_owned(),
        Some(scale) => format!(
            "scale: the measured values are {} of the computed ones; they are divided by it",
            format_with_error(scale.value, scale.std_error)
        ),
    });
    let differences =
        [("as the file is", &diff.before), ("after alignment and scale", &diff.after)];
    for (
        words,
        DifferenceFigures { rms_of_max, rms_of_mean, noise_of_max, correlation, cells, .. },
    ) in differences
    {
        lines.push(format!(
            "{words}: rms difference {} of the maximum ({} from the errors of the computed cells), {} of the mean; \
             correlation {}; {cells} cells",
            format_percent(*rms_of_max),
            format_percent(*noise_of_max),
            format_percent(*rms_of_mean),
            format_fixed(*correlation, 5)
        ));
    }
    lines
}

fn alignment(diff: &MeasuredDiff) -> Vec<String> {
    let places = diff.computed.kind.places;
    let line = |axis: usize| {
        let value = format_with_error(diff.shift.value[axis], diff.shift.std_errors[axis]);
        let (unit, most) = (places.units[axis], format_value(diff.shift.range[axis]));
        let what = if diff.computed.is_intensity() {
            "turned about the axis C, in the direction of growing C,".to_owned()
        } else {
            format!("shifted along {}", places.names[axis])
        };
        format!(
            "alignment: the measured pattern is {what} by {value} {unit} (searched up to ±{most} {unit}); it is moved back"
        )
    };
    let lines: Vec<String> =
        [0, 1].into_iter().filter(|axis| diff.shift.is_found(*axis)).map(line).collect();
    if lines.is_empty() { vec!["alignment: none applied".to_owned()] } else { lines }
}

/// Figures of both maps.
fn side_rows(diff: &MeasuredDiff) -> Vec<FigureRow> {
    let is_intensity = diff.computed.is_intensity();
    let row = |name, f: &dyn Fn(&crate::measured::SideFigures) -> Option<f64>, unit: &str| {
        FigureRow { name, values: diff.sides.each_ref().map(f), unit: unit.to_owned() }
    };
    let mut rows = Vec::new();
    if is_intensity {
        rows.push(row("flux", &|side| side.flux_lm, "lm"));
        rows.push(row("peak: largest cell", &|side| Some(side.max), &diff.unit));
        rows.push(row("beam angle C0-C180, 50 % of γ = 0", &|side| side.beams_deg[0], "deg"));
        rows.push(row("beam angle C90-C270, 50 % of γ = 0", &|side| side.beams_deg[1], "deg"));
    } else {
        rows.push(row("mean", &|side| Some(side.mean), &diff.unit));
        rows.push(row("largest cell", &|side| Some(side.max), &diff.unit));
        rows.push(row("smallest cell", &|side| Some(side.min), &diff.unit));
        rows.push(row("uniformity min/mean", &|side| Some(side.min / side.mean), "1"));
        rows.push(row("uniformity min/max", &|side| Some(side.min / side.max), "1"));
    }
    rows
}

fn side_cells(diff: &MeasuredDiff) -> Vec<[String; 3]> {
    let cell = |value: Option<f64>, unit: &str| match value {
        None => "n/a".to_owned(),
        Some(value) if unit == "1" => format_value(value),
        Some(value) => format!("{} {unit}", format_value(value)),
    };
    let rows = side_rows(diff).into_iter();
    rows.map(|row| {
        let [computed, measured] = row.values.map(|value| cell(value, &row.unit));
        [row.name.to_owned(), computed, measured]
    })
    .collect()
}

fn parts(
    diff: &MeasuredDiff,
    maps: &[NamedMap; 4],
    sections: &[NamedSection; 2],
    plots: &mut Plots,
) -> Vec<PagePart> {
    let part = |title: &str, blocks: Vec<Block>| PagePart { title: title.to_owned(), blocks };
    let mut add = |named: &NamedMap| {
        let map = data::map(&named.map);
        plots.add(named.map.title.clone(), map, Some(named.file.clone()))
    };
    let [computed, measured, after, before] = maps.each_ref().map(&mut add);
    let sections = sections.each_ref().map(|own| {
        let chart = data::chart(&own.plot, &diff.unit);
        plots.add(own.plot.title.clone(), chart, Some(own.file.clone()))
    });
    let rows = side_cells(diff).into_iter().map(|row| row.to_vec()).collect();
    let mut parts = vec![
        part("Alignment, scale and differences", vec![Block::List { items: findings(diff) }]),
        part(
            "Figures",
            vec![
                Block::Words {
                    text: "Of the cells that both have, with the measured values as the file is."
                        .to_owned(),
                },
                table(&["", "computed", "measured"], rows),
            ],
        ),
        part(
            "Maps",
            vec![
                Block::PlotRow { plots: vec![computed, measured] },
                Block::PlotRow { plots: vec![after, before] },
            ],
        ),
        part("Sections", vec![Block::PlotRow { plots: sections.into() }]),
    ];
    if !diff.remarks.is_empty() {
        parts.push(part("Remarks", vec![Block::List { items: diff.remarks.clone() }]));
    }
    parts
}

/// `diff.csv`: all figures.
fn figure_table(diff: &MeasuredDiff) -> Result<OutputFile> {
    let mut rows: Vec<[String; 4]> = Vec::new();
    let mut add = |name: String, value: f64, error: Option<f64>, unit: &str| {
        let error = error.map_or(String::new(), |error| error.to_string());
        rows.push([name, value.to_string(), error, unit.to_owned()]);
    };
    let places = diff.computed.kind.places;
    for axis in [0, 1].into_iter().filter(|axis| diff.shift.is_found(*axis)) {
        let name = if diff.computed.is_intensity() {
            "rotation".to_owned()
        } else {
            format!("shift_{}", ["u", "v"][axis])
        };
        add(name, diff.shift.value[axis], Some(diff.shift.std_errors[axis]), places.units[axis]);
    }
    if let Some(scale) = diff.scale {
        add("scale".to_owned(), scale.value, Some(scale.std_error), "1");
    }
    for (when, own) in [("before", &diff.before), ("after", &diff.after)] {
        add(format!("rms_{when}"), own.rms, None, &diff.unit);
        add(format!("rms_of_max_{when}"), own.rms_of_max, None, "1");
        add(format!("rms_of_mean_{when}"), own.rms_of_mean, None, "1");
        add(format!("correlation_{when}"), own.correlation, None, "1");
    }
    for row in side_rows(diff) {
        for (side, value) in ["computed", "measured"].into_iter().zip(row.values) {
            if let Some(value) = value {
                add(format!("{side}: {}", row.name), value, None, &row.unit);
            }
        }
    }
    let rows = rows.into_iter().map(|row| row.to_vec());
    csv_table("diff.csv".into(), &["figure", "value", "std_error", "unit"], rows)
}

/// `NAME.cells.csv`: every cell that is compared.
fn cell_table(diff: &MeasuredDiff) -> Result<OutputFile> {
    let [before, after] = &diff.measured;
    let unit = &diff.unit;
    let places = diff.computed.kind.places;
    let (x_name, y_name) = if diff.computed.is_intensity() { ("c", "gamma") } else { ("u", "v") };
    let header = [
        format!("{x_name}_{}", places.units[0]),
        format!("{y_name}_{}", places.units[1]),
        format!("computed_{unit}"),
        format!("std_error_{unit}"),
        format!("measured_{unit}"),
        format!("measured_adjusted_{unit}"),
    ];
    let [x, y] = diff.computed.edges();
    let cells = diff.computed.cells.values.indexed_iter().filter(|(_, value)| value.is_finite());
    let rows = cells.map(|(at, value)| {
        let middle =
            |edges: &[f64], place: usize| (0.5 * (edges[place] + edges[place + 1])).to_string();
        let cell = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
        let numbers = [*value, diff.computed.cells.errors[at], before[at], after[at]];
        [middle(x, at.1), middle(y, at.0)].into_iter().chain(numbers.map(cell)).collect()
    });
    csv_table(format!("{}.cells.csv", diff.name), &header, rows)
}
