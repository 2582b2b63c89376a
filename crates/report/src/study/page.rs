//! `study.md`: the results of a study for a reader.

use crate::markdown::masthead;
use crate::study::StudyReport;
use crate::study::contents::{Item, StudyPart, parts, verdict};
use crate::study::figures::Figure;
use lumiduct_base::text::{markdown_cell, markdown_page};
use std::fmt::Write;

/// Rows of a table that are shown; `study.csv` has all.
const ROWS_SHOWN: usize = 60;

/// The whole page.
pub(super) fn page(report: &StudyReport, figures: &[Figure]) -> String {
    let mut page = format!("# {}\n\n", report.facts.title);
    page += &masthead(report.facts.whole_project().as_ref());
    if let Some(description) = &report.facts.description {
        page += &format!("{}\n\n", description.trim());
    }
    page += &format!("{}.\n\n", verdict(report));
    let [before, after] = parts(report);
    before.iter().for_each(|part| add(&mut page, part));
    if !figures.is_empty() {
        page += "## Pictures\n\n";
    }
    for figure in figures {
        _ = write!(page, "![{}]({})\n\n", figure.label, figure.file);
    }
    after.iter().for_each(|part| add(&mut page, part));
    markdown_page(page.trim_end()) + "\n"
}

fn add(page: &mut String, part: &StudyPart) {
    _ = write!(page, "## {}\n\n", part.title);
    for item in &part.items {
        match item {
            Item::Words(text) => _ = write!(page, "{text}\n\n"),
            Item::List(lines) => {
                lines.iter().for_each(|line| page.push_str(&format!("- {line}\n")));
                page.push('\n');
            }
            Item::Table { head, rows } => table(page, head, rows),
        }
    }
}

fn table(page: &mut String, head: &[String], rows: &[Vec<String>]) {
    let mut line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| markdown_cell(cell)).collect();
        _ = writeln!(page, "| {} |", cells.join(" | "));
    };
    line(head);
    line(&vec!["---".to_owned(); head.len()]);
    rows.iter().take(ROWS_SHOWN).for_each(|row| line(row));
    if rows.len() > ROWS_SHOWN {
        _ = write!(page, "\n{} more rows are in `study.html`.\n", rows.len() - ROWS_SHOWN);
    }
    page.push('\n');
}
