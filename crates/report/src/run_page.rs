//! `report.html`: the page of a run for a browser.
//!
//! Its contents come from `contents`, as those of `report.md`.

use crate::Report;
use crate::contents::{parts, verdict};
use crate::html::frame::{Page, render};
use crate::html::masthead;
use crate::page::Plots;
use lumiduct_base::error::Result;

/// The whole page.
pub(crate) fn html(report: &Report) -> Result<String> {
    let mut plots = Plots::default();
    let parts = parts(report, &mut plots);
    let (standing, verdict) = verdict(report);
    let page = Page {
        title: report.scene.title.clone(),
        masthead: masthead(report.scene.project.as_ref()),
        description: report.scene.description.as_ref().map(|text| text.trim().to_owned()),
        verdict,
        standing,
        parts,
        footer: format!("lumiduct {}, scene {}", report.run.version, report.scene.name),
    };
    render(&page, &plots)
}
