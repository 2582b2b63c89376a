//! The output for the user: one record, and pure functions that turn it into files.
//!
//! A report depends on the scene, the seed and the number of paths alone: this crate knows no
//! clock, thread count or machine, except in `timing.csv` and the comparison of estimators, which
//! are outside the reproducible set.
//!
//! A folder gets the files of a report, with a manifest of their digests, and gives them back:
//!
//! ```
//! use lumiduct_report::{Existing, Folder, FolderLock, OutputFile, Written, report_files};
//!
//! let dir = tempfile::tempdir()?;
//! let table = b"angle_deg,intensity_cd\n0,1.5\n";
//! let files = [OutputFile { name: "far.csv".into(), bytes: table.to_vec() }];
//! let folder = Folder::open(FolderLock::take(dir.path())?, Existing::Keep, None)?;
//! assert_eq!(folder.write(&files)?, Written::New);
//! assert_eq!(folder.write(&files)?, Written::Same);
//! assert_eq!(report_files(dir.path())?[0].bytes, table);
//!
//! // A file that was changed is no part of the report.
//! std::fs::write(dir.path().join("far.csv"), "angle_deg,intensity_cd\n0,9.9\n")?;
//! assert!(report_files(dir.path()).unwrap_err().to_string().contains("far.csv"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod base64;
mod by_light;
mod by_sun;
mod cell_grid;
mod compare;
mod contents;
mod csv;
mod destination;
pub mod diff;
mod drawing;
mod figures;
mod film;
mod folder;
mod html;
mod inventory;
mod junit;
mod key_figures;
mod leftovers;
mod library;
mod local_axes;
mod lock;
mod luminaire;
mod manifest;
mod markdown;
pub mod measured;
mod mesh;
mod npz;
pub mod optimise;
mod output;
mod page;
pub(crate) mod png;
mod rays;
mod recipe;
mod record;
mod remarks;
mod run_page;
pub mod seal;
mod section;
mod spreadsheet;
pub mod study;
mod summary;
mod terminal;
mod upright;
mod words;

pub use compare::cells::TrueCells;
pub use compare::comparison::{CheckpointSample, Comparison, Contestant, MethodOrigin, Truth};
pub use compare::errors::rows;
pub use compare::page::comparison_table;
pub use compare::{cell_prefix, comparison_files};
pub use destination::{expect_file, is_among};
pub use drawing::SceneDrawing;
pub use drawing::drawing;
pub use film::film_tables;
pub use folder::{Existing, Folder, Written, write_streamed, write_whole};
pub use html::check::check_page;
pub use inventory::Inventory;
pub use junit::{JunitFile, diff_junit, measured_junit, run_junit, study_junit};
pub use leftovers::{is_staged, remove_report};
pub use leftovers::{remove_if_there, sweep};
pub use library::library_table;
pub use lock::FolderLock;
pub use luminaire::{LuminaireOrigin, MeasuredLuminaire};
pub(crate) use manifest::Manifest;
pub use manifest::report_files;
pub use mesh::mesh_report;
pub use output::{OutputFile, Pictures};
pub use page::Standing;
pub use rays::MeasuredRays;
pub use recipe::Recipe;
pub use record::{
    CheckResult, Report, RunFacts, RunOutcome, SceneFacts, TargetFacts, asked, leak_places,
    requested_gathering,
};
pub use remarks::{remark_on_paths, remarks, remarks_on_passages, remarks_on_ray_sets};
pub use seal::{seal, unseal};
pub use section::{CutPlane, SectionView, scene_picture};
pub use terminal::terminal;

use crate::output::{LOGO, SUMMARY};
use lumiduct_base::error::Result;

/// All files of a report, in the reproducible order: pictures and tables first, so that the page can name them.
///
/// # Errors
///
/// `Error::Output` if a picture cannot be drawn, or a table, a page or the summary cannot be composed.
pub fn files(report: &Report, scene_text: &str, pictures: Pictures) -> Result<Vec<OutputFile>> {
    let mut files = spreadsheet::files(report)?;
    files.extend(csv::files(report)?);
    files.extend(npz::files(report)?);
    files.extend(by_sun::files(report, pictures)?);
    match pictures {
        Pictures::Drawn => files.extend(figures::files(report)?),
        Pictures::LeftOut => {}
    }
    files.extend(luminaire::files(&report.luminaires));
    files.extend(rays::files(&report.rays)?);
    files.push(OutputFile::text(format!("{}.toml", report.scene.name), scene_text.to_owned()));
    let logo = report.scene.project.as_ref().and_then(|project| project.logo.clone());
    files.extend(logo.map(|bytes| OutputFile { name: LOGO.to_owned(), bytes }));
    files.push(OutputFile::text("report.md", markdown::markdown(report, pictures)));
    files.push(OutputFile::text("report.html", run_page::html(report)?));
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).chain([SUMMARY]).collect();
    files.push(summary::file(report, &names)?);
    Ok(files)
}
