//! A look at a scene without measures: what is in it, and a picture with some paths.

use crate::pipeline::{inventory_of, prepare, shown_tracks};
use lumiduct_base::error::{Diagnostic, Error, Result};
use lumiduct_input::Settings;
use lumiduct_report::{self as report, Existing, SectionView, expect_file, write_whole};
use std::path::{Path, PathBuf};

/// Paths that a check draws.
const CHECK_PATHS: usize = 50;

/// What a check draws, and where.
#[derive(Debug)]
pub struct CheckPictures {
    /// The file of the cross-section; `None` is NAME.check.png in this folder.
    pub picture: Option<PathBuf>,
    /// What to do with an existing `picture`.
    pub existing: Existing,
    /// How the cross-section is drawn.
    pub section: SectionView,
    /// Whether the 3D page of the scene is written next to the picture.
    pub page: CheckPage,
}

/// Whether a page is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CheckPage {
    /// It is.
    Wanted,
    /// It is not.
    Unwanted,
}

/// What a check found.
#[derive(Debug)]
pub struct Checked {
    /// What is in the scene.
    pub text: String,
    /// Remarks on the scene file.
    pub warnings: Vec<Diagnostic>,
}

/// Validates a scene, lists what is in it, and draws its cross-section with some traced paths.
///
/// # Errors
///
/// As [`prepare`]. Also [`Error::Usage`] if the section cannot be shown or an existing picture is to be kept;
/// [`Error::Output`] if the picture or the page cannot be composed; [`Error::Io`] if it cannot be written.
pub fn check(scene: &Path, settings: &Settings, wished: &CheckPictures) -> Result<Checked> {
    let job = prepare(scene, settings)?;
    let default = PathBuf::from(format!("{}.check.png", job.name));
    // The default name belongs to this program: it is drawn anew at every check.
    let (picture, existing) = wished
        .picture
        .as_deref()
        .map_or((&*default, Existing::Replace), |path| (path, wished.existing));
    let page = match wished.page {
        CheckPage::Wanted => Some(page_beside(picture)?),
        CheckPage::Unwanted => None,
    };
    expect_file(picture)?;
    page.iter().try_for_each(|page| expect_file(page))?;
    let tracks = shown_tracks(&job, CHECK_PATHS);
    let bytes = report::scene_picture(&job.title, &job.scene, &tracks, &wished.section)?;
    write_whole(picture, &bytes, existing)?;
    let listed = inventory_of(&job).text();
    let mut text = format!("{}\n{listed}picture: {}\n", job.title, picture.display());
    if let Some(path) = page {
        let page = report::check_page(&job.title, &job.scene, &tracks, &listed)?;
        write_whole(&path, page.as_bytes(), existing)?;
        text += &format!("page: {}\n", path.display());
    }
    Ok(Checked { text, warnings: job.warnings })
}

/// The file of the page next to a picture.
fn page_beside(picture: &Path) -> Result<PathBuf> {
    let path = picture.with_extension("html");
    if path != picture {
        return Ok(path);
    }
    Err(Error::Usage(format!(
        "-o {}: is the name of the page; name the picture, such as {}",
        picture.display(),
        picture.with_extension("png").display()
    )))
}
