//! Leftovers of a killed program in a folder, and their removal.
//!
//! Files are created under temporary names. While those of a report are renamed, a list of their
//! names lies next to them, so that a partial report is never mistaken for files of the user.

use crate::manifest::Manifest;
use lumiduct_base::error::{Error, Result};
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Prefix of the names of incomplete files.
pub(crate) const STAGED: &str = ".lumiduct-";
/// The list of files that are being replaced.
pub(crate) const REPLACING: &str = ".lumiduct-replacing.json";

/// Whether a file is incomplete.
pub fn is_staged(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(STAGED))
}

/// Removes what a killed program left in a folder: files under temporary names, and those of a
/// report that was never complete. A missing folder counts as empty.
///
/// # Errors
///
/// [`Error::Io`] if the folder cannot be read or a leftover cannot be removed.
pub fn sweep(folder: &Path) -> Result<()> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        other => other.map_err(|source| Error::io(folder, source))?,
    };
    // An incomplete list was never acted upon.
    if let Ok(Some(replacing)) = Manifest::read(folder, REPLACING) {
        for name in replacing.names() {
            remove_if_there(&folder.join(name))?;
        }
    }
    for entry in entries {
        let entry = entry.map_err(|source| Error::io(folder, source))?;
        if is_staged(&entry.path()) {
            remove_if_there(&entry.path())?;
        }
    }
    Ok(())
}

/// Removes an older report: the files that its manifest lists, if that is intact, and the manifest.
/// Other files stay.
///
/// # Errors
///
/// [`Error::Io`] if one of its files cannot be removed. A folder without an intact manifest is left as it is.
pub fn remove_report(folder: &Path) -> Result<()> {
    let Ok(manifest) = Manifest::expect(folder) else { return Ok(()) };
    for name in manifest.names() {
        remove_if_there(&folder.join(name))?;
    }
    remove_if_there(&folder.join(crate::manifest::MANIFEST))
}

/// Removes a file; a missing one is not an error.
///
/// # Errors
///
/// [`Error::Io`] if the file is there and cannot be removed.
pub fn remove_if_there(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::io(path, error)),
        Ok(()) | Err(_) => Ok(()),
    }
}
