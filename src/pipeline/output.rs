//! Where the report of a run goes, and what may happen to existing files.

use lumiduct_report::{Existing, Pictures};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Where the report goes, and whether an existing one may be replaced.
#[derive(Debug, Clone)]
pub struct Output {
    /// The folder of the report; `reports/NAME` when none is given.
    pub dir: Option<PathBuf>,
    /// What to do with an existing report.
    pub existing: Existing,
    /// Whether the report has pictures.
    pub pictures: Pictures,
    /// How often a checkpoint is kept in the folder; `None` for never.
    pub checkpoint_every: Option<Duration>,
    /// Whether to resume from an existing checkpoint.
    pub start: RunStart,
    /// A luminaire file of the scene's goniometer, IES or EULUMDAT by its ending.
    pub luminaire: Option<PathBuf>,
}

impl Output {
    /// A report in a folder, without checkpoints.
    pub fn new(dir: Option<PathBuf>, existing: Existing) -> Self {
        Self {
            dir,
            existing,
            pictures: Pictures::Drawn,
            checkpoint_every: None,
            start: RunStart::Anew,
            luminaire: None,
        }
    }
}

/// Whether a run starts over or resumes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunStart {
    /// From its first path.
    Anew,
    /// From the checkpoint in the folder of its report, if there is one.
    Resume,
}

/// `reports/NAME` after the scene file, unless a folder is given.
pub(super) fn output_dir(scene: &Path, output: &Output) -> PathBuf {
    output
        .dir
        .clone()
        .unwrap_or_else(|| Path::new("reports").join(scene.file_stem().unwrap_or_default()))
}
