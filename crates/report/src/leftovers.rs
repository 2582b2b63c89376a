//! What a program that was killed has left in a folder, and how it goes away.
//!
//! Files appear under temporary names. While those of a report take their places, a list of their names lies beside them, so
//! that a part of them is never mistaken for files of anybody's own.

use crate::manifest::Manifest;
use lumiduct_base::error::{Error, Result};
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// How the names of files begin that are not complete yet.
pub(crate) const STAGED: &str = ".lumiduct-";
/// The list of files that are being replaced.
pub(crate) const REPLACING: &str = ".lumiduct-replacing.json";

/// Whether a file is one that is not complete yet, or was left so.
pub fn is_staged(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(STAGED))
}

/// Takes away what a program that was killed has left in a folder: files under temporary names, and those of a report that
/// was never whole. A folder that is not there holds nothing.
pub fn sweep(folder: &Path) -> Result<()> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        other => other.map_err(|source| Error::io(folder, source))?,
    };
    // A list that is not whole was never acted upon.
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

/// Takes away an older report: the files that its manifest lists, if that is whole, and the manifest. Others stay.
pub fn remove_report(folder: &Path) -> Result<()> {
    let Ok(manifest) = Manifest::expect(folder) else { return Ok(()) };
    for name in manifest.names() {
        remove_if_there(&folder.join(name))?;
    }
    remove_if_there(&folder.join(crate::manifest::MANIFEST))
}

/// Takes a file away; one that is not there is no error.
pub fn remove_if_there(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::io(path, error)),
        Ok(()) | Err(_) => Ok(()),
    }
}
