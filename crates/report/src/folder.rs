//! Writes files whole or not at all.

#[cfg(test)]
mod tests;

use crate::destination::folder_of;
use crate::leftovers::{REPLACING, STAGED, is_staged, remove_if_there, sweep};
use crate::manifest::{MANIFEST, Manifest};
use crate::recipe::FoundIdentity;
use crate::{FolderLock, OutputFile, Recipe};
use lumiduct_base::error::{Error, Result};
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// What to do with existing output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Refuse to change it.
    Keep,
    /// Replace the files of the same name when the new ones are complete.
    Replace,
}

/// What writing changed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Written {
    /// At least one file is new or replaced.
    New,
    /// Everything existed before, byte for byte.
    Same,
    /// Nothing: these files exist with other contents and may not be replaced.
    Nothing {
        /// Their names.
        differing: Vec<String>,
    },
}

/// The folder of a report, locked against other programs.
#[derive(Debug)]
pub struct Folder {
    lock: FolderLock,
    existing: Existing,
}

impl Folder {
    /// Checks, before any work is done, that a report can be written to a folder: it is empty, or
    /// its files may be replaced, or it contains the report of the same `recipe`, whose bytes will
    /// be equal. A run that the clock stops has no recipe. Leftovers of a killed run are removed.
    ///
    /// # Errors
    ///
    /// [`Error::Usage`] if the folder holds anything else; [`Error::Io`] if it cannot be read or a leftover cannot be
    /// removed.
    pub fn open(lock: FolderLock, existing: Existing, recipe: Option<&Recipe>) -> Result<Self> {
        let path = lock.path();
        sweep(path)?;
        if existing == Existing::Keep && holds_files(path)? {
            let what = match (FoundIdentity::read(path), recipe) {
                (FoundIdentity::Report(found), Some(recipe)) if *found == *recipe => {
                    return Ok(Self { lock, existing });
                }
                (FoundIdentity::Report(found), Some(recipe)) => recipe.difference_of(&found),
                (FoundIdentity::Report(_), None) => {
                    "a report, and a run with a time limit never repeats one exactly"
                }
                (FoundIdentity::Partial, _) => "a report of a run that was stopped",
                (FoundIdentity::Older, _) => "a report by an older version of the program",
                (FoundIdentity::Other, _) => "files that are not a complete report",
            };
            return Err(Error::Usage(format!(
                "{} holds {what}; use --overwrite to replace the files in it, or -o for another folder",
                path.display()
            )));
        }
        Ok(Self { lock, existing })
    }

    /// The folder of files derived from other reports, which may therefore exist already. Others
    /// may not, unless they may be replaced.
    ///
    /// # Errors
    ///
    /// [`Error::Usage`] if the folder holds another file that is to be kept; [`Error::Io`] if it cannot be read or a
    /// leftover cannot be removed.
    pub fn of_derived(lock: FolderLock, existing: Existing, files: &[OutputFile]) -> Result<Self> {
        let path = lock.path();
        sweep(path)?;
        let entries = fs::read_dir(path).map_err(|source| Error::io(path, source))?;
        for entry in entries {
            let entry = entry.map_err(|source| Error::io(path, source))?;
            let name = entry.file_name();
            let is_own = name == MANIFEST || files.iter().any(|file| name == *file.name);
            if existing == Existing::Keep && !is_own {
                return Err(Error::Usage(format!(
                    "{} is not one of the files to write; use --overwrite to keep it and write beside it, \
                        or -o for another folder",
                    entry.path().display()
                )));
            }
        }
        Ok(Self { lock, existing })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        self.lock.path()
    }

    /// Writes all files and their manifest, each under a temporary name first. None is renamed
    /// before all are complete, and the manifest is renamed last. An existing file with the same
    /// bytes is left alone. Where one differs and may not be replaced, none is written. Other files
    /// of an older report are removed where permitted.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] if a file cannot be read, written, renamed or removed. Existing files that differ and are to be
    /// kept are no error, but [`Written::Nothing`].
    pub fn write(&self, files: &[OutputFile]) -> Result<Written> {
        let manifest = Manifest::of(files).file(MANIFEST)?;
        let (mut staged, mut differing) = (Vec::new(), Vec::new());
        for file in files.iter().chain([&manifest]) {
            let path = self.path().join(&file.name);
            match (compare(&path, &file.bytes)?, self.existing) {
                // While files are renamed the manifest is removed, so it is always written again.
                (FileComparison::Same, _) if staged.is_empty() || file.name != MANIFEST => {}
                (FileComparison::Different, Existing::Keep) => differing.push(file.name.clone()),
                (FileComparison::Different, Existing::Replace)
                | (FileComparison::Missing | FileComparison::Same, _) => {
                    staged.push((stage(&path, &file.bytes)?, file.name.clone()));
                }
            }
        }
        if !differing.is_empty() {
            // If other files differ, so does the manifest.
            if differing.len() > 1 {
                differing.retain(|name| name != MANIFEST);
            }
            return Ok(Written::Nothing { differing });
        }
        if staged.is_empty() {
            return Ok(Written::Same);
        }
        let outdated = self.outdated(files)?;
        let names = staged.iter().map(|(_, name)| name).chain(&outdated);
        let replacing: Vec<OutputFile> =
            names.map(|name| OutputFile::text(name.as_str(), String::new())).collect();
        let list = Manifest::of(&replacing).file(REPLACING)?.bytes;
        let list_path = self.path().join(REPLACING);
        write_whole(&list_path, &list, Existing::Replace)?;
        for name in [MANIFEST].into_iter().chain(outdated.iter().map(String::as_str)) {
            remove_if_there(&self.path().join(name))?;
        }
        for (temporary, name) in staged {
            let path = self.path().join(name);
            temporary.persist(&path).map_err(|error| Error::io(&path, error.error))?;
        }
        remove_if_there(&list_path)?;
        Ok(Written::New)
    }

    /// Files of an older whole report that are not in the new one, where they may be replaced.
    fn outdated(&self, files: &[OutputFile]) -> Result<Vec<String>> {
        let is_new = |name: &str| files.iter().any(|file| file.name == name);
        Ok(match (self.existing, Manifest::read(self.path(), MANIFEST)) {
            (Existing::Replace, Ok(Some(old))) => {
                old.names().filter(|name| !is_new(name)).map(str::to_owned).collect()
            }
            (Existing::Replace, Ok(None) | Err(Error::Usage(_))) | (Existing::Keep, _) => {
                Vec::new()
            }
            (Existing::Replace, Err(error)) => return Err(error),
        })
    }

    /// Writes a file outside the reproducible set. An existing one stays, unless it may be
    /// replaced.
    ///
    /// # Errors
    ///
    /// [`Error::Io`] if the file cannot be written.
    pub fn write_beside(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.path().join(name);
        if self.existing == Existing::Keep && path.exists() {
            return Ok(());
        }
        stage(&path, bytes)?.persist(&path).map_err(|error| Error::io(&path, error.error))?;
        Ok(())
    }
}

/// Whether a folder contains anything except half-written files of a killed program.
fn holds_files(folder: &Path) -> Result<bool> {
    let entries = fs::read_dir(folder).map_err(|source| Error::io(folder, source))?;
    for entry in entries {
        let entry = entry.map_err(|source| Error::io(folder, source))?;
        if !is_staged(&entry.path()) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Writes one file, whole or not at all. An existing file with the same bytes is left alone.
///
/// # Errors
///
/// [`Error::Usage`] if the file exists with other contents and is to be kept; [`Error::Io`] if it cannot be read or
/// written, or its folder cannot be created.
pub fn write_whole(path: &Path, bytes: &[u8], existing: Existing) -> Result<()> {
    match (compare(path, bytes)?, existing) {
        (FileComparison::Same, _) => return Ok(()),
        (FileComparison::Different, Existing::Keep) => {
            return Err(Error::Usage(format!(
                "{} exists with other contents; use --overwrite to replace it",
                path.display()
            )));
        }
        (FileComparison::Different, Existing::Replace) | (FileComparison::Missing, _) => {}
    }
    let folder = folder_of(path);
    fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    stage(path, bytes)?.persist(path).map_err(|error| Error::io(path, error.error))?;
    Ok(())
}

/// Writes one file of any length as it is made, whole or not at all.
///
/// # Errors
///
/// [`Error::Usage`] if the file exists and is to be kept; [`Error::Io`] if it cannot be written, or its folder cannot be created; those of
/// `make`.
pub fn write_streamed(
    path: &Path,
    existing: Existing,
    make: impl FnOnce(&mut fs::File) -> Result<()>,
) -> Result<()> {
    if existing == Existing::Keep && path.exists() {
        let name = path.display();
        return Err(Error::Usage(format!("{name} exists; use --overwrite to replace it")));
    }
    let folder = folder_of(path);
    fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    let staged = staged_with(path, make)?;
    staged.persist(path).map_err(|error| Error::io(path, error.error))?;
    Ok(())
}

/// How a file on disk compares with what is to be written.
enum FileComparison {
    Missing,
    Same,
    Different,
}

fn compare(path: &Path, bytes: &[u8]) -> Result<FileComparison> {
    match fs::read(path) {
        Ok(old) if old == bytes => Ok(FileComparison::Same),
        Ok(_) => Ok(FileComparison::Different),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(FileComparison::Missing),
        Err(source) => Err(Error::io(path, source)),
    }
}

/// A complete file under a temporary name, with the usual permissions of the user's files.
fn stage(path: &Path, bytes: &[u8]) -> Result<tempfile::NamedTempFile> {
    staged_with(path, |file| file.write_all(bytes).map_err(|error| Error::io(path, error)))
}

/// The same, of contents that are made as they are written.
fn staged_with(
    path: &Path,
    make: impl FnOnce(&mut fs::File) -> Result<()>,
) -> Result<tempfile::NamedTempFile> {
    let failed = |source| Error::io(path, source);
    let mut builder = tempfile::Builder::new();
    builder.prefix(STAGED);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The umask removes unwanted permissions.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    // The temporary name would mean nothing to the user.
    let mut file =
        builder.tempfile_in(folder_of(path)).map_err(|error| failed(error.kind().into()))?;
    make(file.as_file_mut())?;
    file.as_file().sync_all().map_err(failed)?;
    Ok(file)
}
