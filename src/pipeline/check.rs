//! A look at a scene without measures: what is in it, and a picture with some paths.

use crate::error::{Diagnostic, Result};
use crate::input::Settings;
use crate::pipeline::{prepare, shown_tracks};
use crate::report::{self, Existing, inventory, write_whole};
use std::path::{Path, PathBuf};

/// Paths that a check draws.
const CHECK_PATHS: usize = 50;

/// What a check found.
#[derive(Debug)]
pub struct Checked {
    /// What is in the scene.
    pub text: String,
    /// Remarks on the scene file.
    pub warnings: Vec<Diagnostic>,
}

/// Validates a scene, lists what is in it, and draws its cross-section with some traced paths.
pub fn check(
    scene: &Path,
    settings: &Settings,
    picture: Option<&Path>,
    existing: Existing,
) -> Result<Checked> {
    let job = prepare(scene, settings)?;
    let default = PathBuf::from(format!("{}.check.png", job.name));
    // The default name belongs to this program: it is drawn anew at every check.
    let (picture, existing) =
        picture.map_or((&*default, Existing::Replace), |path| (path, existing));
    let bytes = report::scene_picture(&job.title, &job.scene, &shown_tracks(&job, CHECK_PATHS))?;
    write_whole(picture, &bytes, existing)?;
    let text = format!("{}\n{}picture: {}\n", job.title, inventory(&job.scene), picture.display());
    Ok(Checked { text, warnings: job.warnings })
}
