//! Writing files whole or not at all.

use crate::error::{Error, Result};
use crate::report::{OutputFile, Recipe};
use serde_json::Value;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// How the names of files begin that are not complete yet.
const STAGED: &str = ".lumiduct-";

/// What to do with output that is there.
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
    /// Everything was there before, the same to the byte.
    Same,
    /// Nothing: these files are there with other contents and may not be replaced.
    Nothing {
        /// Their names.
        differing: Vec<String>,
    },
}

/// The folder of a report.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    existing: Existing,
}

impl Folder {
    /// Makes sure, before any work is done, that a report can be written to `path`: the folder is made, and it is
    /// empty, or its files may be replaced, or it holds the report of this very `recipe`, which is going to be the
    /// same. A run that the clock stops has no recipe.
    pub fn open(path: &Path, existing: Existing, recipe: Option<&Recipe>) -> Result<Self> {
        expect_room(path)?;
        let is_kept = existing == Existing::Keep && holds_files(path)?;
        let found = if is_kept { Recipe::read(path) } else { None };
        if is_kept && (recipe.is_none() || found.as_ref() != recipe) {
            let what = match (found, recipe) {
                (Some(found), Some(recipe)) => recipe.difference_of(&found),
                (Some(_), None) => "a report, and a run that the clock stops never repeats one",
                (None, _) => "files that are no complete report",
            };
            return Err(Error::Usage(format!(
                "{} holds {what}; use --overwrite to replace the files in it, or -o for another folder",
                path.display()
            )));
        }
        Ok(Self { path: path.to_path_buf(), existing })
    }

    /// The folder of files that follow from other reports alone, and so may be there already; others may not, unless they
    /// may be replaced.
    pub fn of_derived(path: &Path, existing: Existing, files: &[OutputFile]) -> Result<Self> {
        expect_room(path)?;
        let entries = fs::read_dir(path).map_err(|source| Error::io(path, source))?;
        for entry in entries {
            let entry = entry.map_err(|source| Error::io(path, source))?;
            let is_own = files.iter().any(|file| entry.file_name() == *file.name);
            if existing == Existing::Keep && !is_own && !is_staged(&entry.path()) {
                return Err(Error::Usage(format!(
                    "{} is none of these files; use --overwrite to write beside it, or -o for another folder",
                    entry.path().display()
                )));
            }
        }
        Ok(Self { path: path.to_path_buf(), existing })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes all files, each under a temporary name first; none takes its place before all are complete. A file that
    /// is there with the same bytes is left alone. Where one differs that may not be replaced, none is written.
    pub fn write(&self, files: &[OutputFile]) -> Result<Written> {
        let (mut staged, mut differing) = (Vec::new(), Vec::new());
        for file in files {
            let path = self.path.join(&file.name);
            match (compare(&path, &file.bytes)?, self.existing) {
                (Comparison::Same, _) => {}
                (Comparison::Different, Existing::Keep) => differing.push(file.name.clone()),
                (Comparison::Different, Existing::Replace) | (Comparison::Missing, _) => {
                    staged.push((stage(&path, &file.bytes)?, path));
                }
            }
        }
        if !differing.is_empty() {
            return Ok(Written::Nothing { differing });
        }
        let written = if staged.is_empty() { Written::Same } else { Written::New };
        for (temporary, path) in staged {
            temporary.persist(&path).map_err(|error| Error::io(&path, error.error))?;
        }
        Ok(written)
    }

    /// Writes a file that lies outside of the reproducible set. One that is there stays, unless it may be replaced.
    pub fn write_beside(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.path.join(name);
        if self.existing == Existing::Keep && path.exists() {
            return Ok(());
        }
        stage(&path, bytes)?.persist(&path).map_err(|error| Error::io(&path, error.error))?;
        Ok(())
    }
}

/// Makes a folder in which a file can be made, which tells more than permissions do.
pub(crate) fn expect_room(folder: &Path) -> Result<()> {
    if folder.is_file() {
        return Err(Error::Usage(format!("{} is a file, not a folder", folder.display())));
    }
    fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    tempfile::tempfile_in(folder)
        .map(|_| ())
        .map_err(|source| Error::io(folder, source.kind().into()))
}

/// Whether a folder is one of these, by whatever path.
pub(crate) fn is_among(folder: &Path, others: &[PathBuf]) -> bool {
    let place = |path: &Path| path.canonicalize().ok();
    let own = place(folder);
    own.is_some() && others.iter().any(|other| place(other) == own)
}

/// Whether a folder holds anything but what a program that was killed has left half written.
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

/// Whether a file is one that is not complete yet, or was left so.
pub(crate) fn is_staged(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(STAGED))
}

/// Takes away what a program that was killed has left half written in a folder. A folder that is not there holds nothing.
pub fn sweep(folder: &Path) -> Result<()> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        other => other.map_err(|source| Error::io(folder, source))?,
    };
    for entry in entries {
        let entry = entry.map_err(|source| Error::io(folder, source))?;
        if is_staged(&entry.path()) {
            remove_if_there(&entry.path())?;
        }
    }
    Ok(())
}

/// Takes away an older report: the files that its summary names, the summary among them. Others stay.
pub(crate) fn remove_report(folder: &Path, summary: &str) -> Result<()> {
    let found: Option<Value> =
        fs::read(folder.join(summary)).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok());
    let files = found.as_ref().and_then(|summary| summary["files"].as_array());
    for name in files.into_iter().flatten().filter_map(Value::as_str) {
        // Only names of this folder: the file may have been changed by others.
        if Path::new(name).components().count() == 1 && !name.starts_with('.') {
            remove_if_there(&folder.join(name))?;
        }
    }
    Ok(())
}

/// Takes a file away; one that is not there is no error.
pub fn remove_if_there(path: &Path) -> Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(Error::io(path, error)),
        Ok(()) | Err(_) => Ok(()),
    }
}

/// Writes one file, whole or not at all. One that is there with the same bytes is left alone.
pub fn write_whole(path: &Path, bytes: &[u8], existing: Existing) -> Result<()> {
    match (compare(path, bytes)?, existing) {
        (Comparison::Same, _) => return Ok(()),
        (Comparison::Different, Existing::Keep) => {
            return Err(Error::Usage(format!(
                "{} exists with other contents; use --overwrite to replace it",
                path.display()
            )));
        }
        (Comparison::Different, Existing::Replace) | (Comparison::Missing, _) => {}
    }
    let folder = folder_of(path);
    fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    stage(path, bytes)?.persist(path).map_err(|error| Error::io(path, error.error))?;
    Ok(())
}

/// How a file on the disk compares with what is to be written.
enum Comparison {
    Missing,
    Same,
    Different,
}

fn compare(path: &Path, bytes: &[u8]) -> Result<Comparison> {
    match fs::read(path) {
        Ok(old) if old == bytes => Ok(Comparison::Same),
        Ok(_) => Ok(Comparison::Different),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(Comparison::Missing),
        Err(source) => Err(Error::io(path, source)),
    }
}

/// A complete file under a temporary name, readable as any other file the user makes.
fn stage(path: &Path, bytes: &[u8]) -> Result<tempfile::NamedTempFile> {
    let failed = |source| Error::io(path, source);
    let mut builder = tempfile::Builder::new();
    builder.prefix(STAGED);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The file mode creation mask takes away what the user does not want.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    // The temporary name would tell nobody anything.
    let mut file =
        builder.tempfile_in(folder_of(path)).map_err(|error| failed(error.kind().into()))?;
    file.as_file_mut().write_all(bytes).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    Ok(file)
}

/// The folder that a file lies in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> OutputFile {
        OutputFile { name: name.into(), bytes: text.into() }
    }

    fn recipe(seed: u64) -> Recipe {
        let (version, scene_hash) = ("0.1.0".to_owned(), "e9a5".to_owned());
        let (estimator, gather) = ("gather".to_owned(), "depth 8".to_owned());
        Recipe { version, scene_hash, seed, estimator, gather, asked: "20 paths".to_owned() }
    }

    fn summary(seed: u64, partial: &str) -> String {
        format!(
            r#"{{"scene": {{"hash": "e9a5"}},
                "run": {{"version": "0.1.0", "seed": {seed}, "estimator": "gather", "gather": "depth 8",
                         "partial": {partial}, "asked": "20 paths"}}}}"#
        )
    }

    #[test]
    fn a_report_is_not_replaced_unless_asked_and_other_files_stay() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("report");
        let open = |existing| Folder::open(&path, existing, Some(&recipe(1)));
        open(Existing::Keep).unwrap().write(&[file("a.csv", "1")]).unwrap();
        assert!(matches!(open(Existing::Keep), Err(Error::Usage(_))));
        fs::write(path.join("notes.txt"), "mine").unwrap();
        let written = open(Existing::Replace).unwrap().write(&[file("a.csv", "2")]).unwrap();
        assert_eq!(written, Written::New);
        assert_eq!(fs::read_to_string(path.join("a.csv")).unwrap(), "2");
        assert_eq!(fs::read_to_string(path.join("notes.txt")).unwrap(), "mine");
        assert_eq!(fs::read_dir(&path).unwrap().count(), 2, "a temporary file was left");
    }

    #[test]
    fn a_report_of_the_same_recipe_may_be_run_again_and_must_come_out_the_same() {
        let dir = tempfile::tempdir().unwrap();
        let open = |recipe: Option<&Recipe>| Folder::open(dir.path(), Existing::Keep, recipe);
        let files = [file("summary.json", &summary(1, "false")), file("a.csv", "1")];
        open(None).unwrap().write(&files).unwrap();
        assert_eq!(open(Some(&recipe(1))).unwrap().write(&files).unwrap(), Written::Same);
        assert!(open(Some(&recipe(2))).is_err() && open(None).is_err());

        let other = [file("new.csv", "3"), file("a.csv", "2")];
        let written = open(Some(&recipe(1))).unwrap().write(&other).unwrap();
        assert_eq!(written, Written::Nothing { differing: vec!["a.csv".into()] });
        assert_eq!(fs::read_to_string(dir.path().join("a.csv")).unwrap(), "1");
        assert_eq!(
            fs::read_dir(dir.path()).unwrap().count(),
            2,
            "a file was written in spite of it"
        );
    }

    #[test]
    fn a_partial_report_is_not_run_over() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("summary.json"), summary(1, "true")).unwrap();
        assert!(Folder::open(dir.path(), Existing::Keep, Some(&recipe(1))).is_err());
    }

    #[test]
    fn a_file_beside_the_report_stays_unless_it_may_be_replaced() {
        let dir = tempfile::tempdir().unwrap();
        let read = || fs::read_to_string(dir.path().join("timing.csv")).unwrap();
        let folder = |existing| Folder { path: dir.path().to_path_buf(), existing };
        folder(Existing::Keep).write_beside("timing.csv", b"1").unwrap();
        folder(Existing::Keep).write_beside("timing.csv", b"2").unwrap();
        assert_eq!(read(), "1");
        folder(Existing::Replace).write_beside("timing.csv", b"2").unwrap();
        assert_eq!(read(), "2");
    }

    #[test]
    fn a_single_file_is_replaced_only_when_asked_or_when_it_is_the_same() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("new").join("a.png");
        write_whole(&path, b"1", Existing::Keep).unwrap();
        write_whole(&path, b"1", Existing::Keep).unwrap();
        assert!(matches!(write_whole(&path, b"2", Existing::Keep), Err(Error::Usage(_))));
        write_whole(&path, b"2", Existing::Replace).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"2");
    }

    #[test]
    fn a_file_in_the_way_of_the_folder_is_an_error() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("report");
        fs::write(&path, "a file").unwrap();
        assert!(matches!(Folder::open(&path, Existing::Keep, None), Err(Error::Usage(_))));
        let below = path.join("below");
        assert!(matches!(Folder::open(&below, Existing::Keep, None), Err(Error::Io { .. })));
    }
}
