//! `report.html` and `report.md` of an optimisation.

use crate::html::data::chart;
use crate::html::frame::{Page, render};
use crate::markdown::add;
use crate::optimise::OptimisationReport;
use crate::optimise::contents::{parts, verdict};
use crate::optimise::figures::OptimisationFigure;
use crate::page::{PagePart, Plots};
use lumiduct_base::error::Result;
use lumiduct_base::text::markdown_page;
use std::fmt::Write;

/// The page for a browser, in one file with nothing to load.
pub(super) fn html(report: &OptimisationReport, figures: &[OptimisationFigure]) -> Result<String> {
    let mut plots = Plots::default();
    let blocks = figures.iter().map(|own| {
        plots.add(own.plot.title.clone(), chart(&own.plot, &own.unit), Some(own.name()))
    });
    let pictures = PagePart { title: "Plots".into(), blocks: blocks.collect() };
    let [before, after] = parts(report);
    let page = Page {
        title: report.title.clone(),
        masthead: None,
        description: report.description.as_ref().map(|text| text.trim().to_owned()),
        verdict: verdict(report),
        standing: report.ending.standing(),
        parts: before.into_iter().chain([pictures]).chain(after).collect(),
        footer: format!("lumiduct {}, optimisation {}", report.version, report.identity.name),
    };
    render(&page, &plots)
}

/// The page for Markdown viewers.
pub(super) fn markdown(report: &OptimisationReport, figures: &[OptimisationFigure]) -> String {
    let mut page = format!("# {}\n\n", report.title);
    if let Some(description) = &report.description {
        page += &format!("{}\n\n", description.trim());
    }
    page += &format!("**{}.**\n\n", verdict(report).trim_end_matches('.'));
    let [before, after] = parts(report);
    before.iter().for_each(|part| add(&mut page, part, usize::MAX));
    page += "## Plots\n\n";
    for own in figures {
        _ = write!(page, "![{}]({})\n\n", own.plot.title, own.name());
    }
    after.iter().for_each(|part| add(&mut page, part, usize::MAX));
    markdown_page(page.trim_end()) + "\n"
}
