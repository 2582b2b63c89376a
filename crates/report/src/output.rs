//! A file of a report before it is written, and file names that several modules use.
//!
//! This module knows neither the contents of the files nor their destination.

use lumiduct_base::error::{Error, Result};
use serde::Serialize;

/// A file of a report: its name and its bytes.
#[derive(Debug)]
pub struct OutputFile {
    /// Name within the folder.
    pub name: String,
    /// Contents.
    pub bytes: Vec<u8>,
}

impl OutputFile {
    /// A file of text.
    pub(crate) fn text(name: impl Into<String>, text: String) -> Self {
        Self { name: name.into(), bytes: text.into_bytes() }
    }

    /// A file of JSON.
    pub(crate) fn json(name: &str, value: &impl Serialize) -> Result<Self> {
        let failed = |reason: serde_json::Error| Error::Output {
            what: name.into(),
            reason: reason.to_string(),
        };
        Ok(Self::text(name, serde_json::to_string_pretty(value).map_err(failed)? + "\n"))
    }
}

/// Whether a report has pictures beside its page, which has plots of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pictures {
    /// PNG files of all maps and plots.
    Drawn,
    /// None: the page for Markdown viewers has no plots.
    LeftOut,
}

/// Name of the file with the logo of a project.
pub(crate) const LOGO: &str = "project_logo.png";

/// Name of the file with everything for programs.
pub(crate) const SUMMARY: &str = "summary.json";
