//! `study.md`: the results of a study for a reader.

use crate::markdown::{add, masthead};
use crate::page::PagePart;
use crate::study::StudyReport;
use crate::study::contents::{parts, verdict};
use crate::study::figure::Figure;
use lumiduct_base::text::markdown_page;
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
    let add_all = |page: &mut String, parts: &[PagePart]| {
        parts.iter().for_each(|part| add(page, part, ROWS_SHOWN));
    };
    add_all(&mut page, &before);
    if !figures.is_empty() {
        page += "## Pictures\n\n";
    }
    for figure in figures {
        _ = write!(page, "![{}]({})\n\n", figure.label, figure.file);
    }
    add_all(&mut page, &after);
    markdown_page(page.trim_end()) + "\n"
}
