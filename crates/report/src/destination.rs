//! Where files go, and whether they can be written there. This module does not know what is
//! written.

use lumiduct_base::error::{Error, Result};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Creates a folder and checks that a file can be created in it, which is safer than checking
/// permissions.
pub(crate) fn expect_room(folder: &Path) -> Result<()> {
    if folder.is_file() {
        return Err(Error::Usage(format!("{} is a file, not a folder", folder.display())));
    }
    fs::create_dir_all(folder).map_err(|source| match source.kind() {
        // A dangling link, a file in place of a folder, a name that is too long.
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory | ErrorKind::InvalidFilename => {
            Error::Usage(format!("{} cannot be made a folder: {source}", folder.display()))
        }
        _ => Error::io(folder, source),
    })?;
    tempfile::tempfile_in(folder)
        .map(|_| ())
        .map_err(|source| Error::io(folder, source.kind().into()))
}

/// Checks, before any work is done, that a file can be written. Folders are created when there is
/// something to put into them.
///
/// # Errors
///
/// [`Error::Usage`] if something other than a regular file is there, a name is too long or a folder of the path
/// cannot be one; [`Error::Io`] if no file can be created in the last folder of the path that exists.
pub fn expect_file(path: &Path) -> Result<()> {
    let refuse = |why: &str| Err(Error::Usage(format!("{}: {why}", path.display())));
    if path.exists() && !path.is_file() {
        return refuse("is not a regular file and cannot be replaced");
    }
    let folders = folder_of(path).ancestors().filter(|folder| !folder.as_os_str().is_empty());
    let there = folders.into_iter().find(|folder| folder.exists()).unwrap_or(Path::new("."));
    expect_room(there)?;
    let missing = path.strip_prefix(there).unwrap_or(path);
    for name in missing {
        match fs::symlink_metadata(there.join(name)) {
            Err(error) if error.kind() == ErrorKind::InvalidFilename => {
                return refuse("a name is too long for this file system");
            }
            // Other faults show on writing.
            Ok(_) | Err(_) => {}
        }
    }
    Ok(())
}

/// Whether a folder is one of these, by whatever path.
pub fn is_among(folder: &Path, others: &[PathBuf]) -> bool {
    let place = |path: &Path| path.canonicalize().ok();
    let own = place(folder);
    own.is_some() && others.iter().any(|other| place(other) == own)
}

/// The folder that a file lies in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
