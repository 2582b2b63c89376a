//! `report.html`: the page for people with a browser. One file, without anything to load.
//!
//! What is on it is that of `contents`, which `report.md` shows as well; `frame` makes a page of it, and `assets` draws.

mod axes;
pub(crate) mod check;
mod coarse;
pub(crate) mod data;
pub(crate) mod frame;

use crate::Report;
use crate::base64::png_uri;
use crate::contents::{parts, verdict};
use crate::html::frame::{Masthead, Page, Plots, render};
use lumiduct_base::error::Result;
use lumiduct_input::Project;

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

/// The head of the pages of a project.
pub(crate) fn masthead(project: Option<&Project>) -> Option<Masthead> {
    let project = project?;
    let lines = project.entries().into_iter().map(|(name, text)| [name, text].map(str::to_owned));
    Some(Masthead { lines: lines.collect(), logo: project.logo.as_deref().map(png_uri) })
}
