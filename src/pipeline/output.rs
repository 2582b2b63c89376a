//! Where the report of a run goes, and what may happen to files that are there.

use lumiduct_report::Existing;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Where the report goes, and whether one that is there may be replaced.
#[derive(Debug, Clone)]
pub struct Output {
    /// The folder of the report; `reports/NAME` when none is given.
    pub dir: Option<PathBuf>,
    /// What to do with a report that is there.
    pub existing: Existing,
    /// How often a checkpoint is kept in the folder; `None` for never.
    pub checkpoint_every: Option<Duration>,
    /// Whether to go on from the checkpoint that is there.
    pub start: Start,
}

impl Output {
    /// A report in a folder, without checkpoints.
    pub fn new(dir: Option<PathBuf>, existing: Existing) -> Self {
        Self { dir, existing, checkpoint_every: None, start: Start::Anew }
    }
}

/// Whether a run begins anew or goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// From its first path.
    Anew,
    /// From the checkpoint in the folder of its report, if there is one.
    Resume,
}

/// `reports/NAME` after the scene file, unless told otherwise.
pub(super) fn output_dir(scene: &Path, output: &Output) -> PathBuf {
    output
        .dir
        .clone()
        .unwrap_or_else(|| Path::new("reports").join(scene.file_stem().unwrap_or_default()))
}
