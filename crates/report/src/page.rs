//! The parts of a page, for any format: headings, words, lists, tables and plots as plain data.
//!
//! This module knows no report and no format.

use serde::Serialize;

/// A verdict as a status.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// Everything is as requested.
    Good,
    /// Something is not.
    Bad,
    /// Nothing was requested, or it is not finished.
    Open,
}

/// A part of a page, with a heading that the table of contents links to.
#[derive(Debug, Serialize)]
pub(crate) struct PagePart {
    /// Its heading.
    pub(crate) title: String,
    /// Its contents.
    pub(crate) blocks: Vec<Block>,
}

impl PagePart {
    /// A part with this heading.
    pub(crate) fn new(title: &str, blocks: Vec<Block>) -> Self {
        Self { title: title.to_owned(), blocks }
    }
}

/// Something in a part.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum Block {
    /// A heading.
    Heading {
        /// The words.
        text: String,
    },
    /// A paragraph.
    Words {
        /// The words.
        text: String,
    },
    /// A list.
    List {
        /// Its lines.
        items: Vec<String>,
    },
    /// A table.
    Table {
        /// The heads of its columns.
        head: Vec<String>,
        /// Its rows.
        rows: Vec<Vec<String>>,
        /// Words to click on, for a table that is folded away.
        folded: Option<String>,
    },
    /// A plot.
    Plot {
        /// What is plotted.
        label: String,
        /// Its number among the plots of the page.
        index: usize,
        /// Name of a picture file next to the page for use without scripts.
        picture: Option<String>,
    },
    /// Plots side by side.
    PlotRow {
        /// The plots.
        plots: Vec<Block>,
    },
}

/// The plots of a page, as the data that the scripts of a browser page draw.
#[derive(Debug, Default)]
pub(crate) struct Plots(Vec<serde_json::Value>);

impl Plots {
    /// Adds a plot and returns its place. The field `plot` of `data` names the script that draws
    /// it.
    pub(crate) fn add(
        &mut self,
        label: impl Into<String>,
        data: serde_json::Value,
        picture: Option<String>,
    ) -> Block {
        self.0.push(data);
        Block::Plot { label: label.into(), index: self.0.len() - 1, picture }
    }

    /// Their data, in order.
    pub(crate) fn data(&self) -> &[serde_json::Value] {
        &self.0
    }
}

/// A table that is not folded away.
pub(crate) fn table(head: &[impl AsRef<str>], rows: Vec<Vec<String>>) -> Block {
    let head = head.iter().map(|name| name.as_ref().to_owned()).collect();
    Block::Table { head, rows, folded: None }
}
