//! Building blocks of HTML pages: one file each, with nothing to load.
//!
//! `frame` makes a page of its parts ([`crate::page`]); `data` gives plots as numbers, which the
//! scripts in `assets` draw. This module knows no report: each kind has its own module for its
//! page.

mod axes;
pub(crate) mod cells;
pub(crate) mod check;
pub(crate) mod data;
pub(crate) mod frame;

use crate::base64::png_uri;
use crate::html::frame::Masthead;
use lumiduct_input::Project;

/// The head of the pages of a project.
pub(crate) fn masthead(project: Option<&Project>) -> Option<Masthead> {
    let project = project?;
    let lines = project.entries().into_iter().map(|(name, text)| [name, text].map(str::to_owned));
    Some(Masthead { lines: lines.collect(), logo: project.logo.as_deref().map(png_uri) })
}
