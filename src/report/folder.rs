//! Writing files whole or not at all.

use crate::error::{Error, Result};
use crate::report::OutputFile;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// What to do with output that is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Existing {
    /// Refuse.
    Keep,
    /// Replace the files of the same name when the new ones are complete.
    Replace,
}

/// The folder of a report.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Makes sure, before any work is done, that a report can be written to `path`: the folder is made, and it is empty
    /// unless its files may be replaced.
    pub fn open(path: &Path, existing: Existing) -> Result<Self> {
        fs::create_dir_all(path).map_err(|source| Error::io(path, source))?;
        let mut entries = fs::read_dir(path).map_err(|source| Error::io(path, source))?;
        if existing == Existing::Keep && entries.next().is_some() {
            return Err(Error::Usage(format!(
                "{} is not empty; use --overwrite to replace the report in it, or -o for another folder",
                path.display()
            )));
        }
        // A file that can be made tells more than permissions do.
        tempfile::tempfile_in(path).map_err(|source| Error::io(path, source))?;
        Ok(Self { path: path.to_path_buf() })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes all files, each under a temporary name first; none takes its place before all are complete.
    pub fn write(&self, files: &[OutputFile]) -> Result<()> {
        let mut staged = Vec::new();
        for file in files {
            staged.push((self.path.join(&file.name), stage(&self.path, &file.bytes)?));
        }
        for (path, temporary) in staged {
            temporary.persist(&path).map_err(|error| Error::io(&path, error.error))?;
        }
        Ok(())
    }
}

/// Writes one file, whole or not at all.
pub fn write_whole(path: &Path, bytes: &[u8], existing: Existing) -> Result<()> {
    if existing == Existing::Keep && path.exists() {
        return Err(Error::Usage(format!(
            "{} exists; use --overwrite to replace it",
            path.display()
        )));
    }
    let folder =
        path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(|source| Error::io(folder, source))?;
    stage(folder, bytes)?.persist(path).map_err(|error| Error::io(path, error.error))?;
    Ok(())
}

/// A complete file under a temporary name, readable as any other file the user makes.
fn stage(folder: &Path, bytes: &[u8]) -> Result<tempfile::NamedTempFile> {
    let failed = |source| Error::io(folder, source);
    let mut builder = tempfile::Builder::new();
    builder.prefix(".lumiduct-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The file mode creation mask takes away what the user does not want.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    file.as_file().sync_all().map_err(failed)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(name: &str, text: &str) -> OutputFile {
        OutputFile { name: name.into(), bytes: text.into() }
    }

    #[test]
    fn a_report_is_not_replaced_unless_asked_and_other_files_stay() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("report");
        Folder::open(&path, Existing::Keep).unwrap().write(&[file("a.csv", "1")]).unwrap();
        assert!(matches!(Folder::open(&path, Existing::Keep), Err(Error::Usage(_))));
        fs::write(path.join("notes.txt"), "mine").unwrap();
        Folder::open(&path, Existing::Replace).unwrap().write(&[file("a.csv", "2")]).unwrap();
        assert_eq!(fs::read_to_string(path.join("a.csv")).unwrap(), "2");
        assert_eq!(fs::read_to_string(path.join("notes.txt")).unwrap(), "mine");
        assert_eq!(fs::read_dir(&path).unwrap().count(), 2, "a temporary file was left");
    }

    #[test]
    fn a_file_in_the_way_of_the_folder_is_an_error() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("report");
        fs::write(&path, "a file").unwrap();
        assert!(matches!(Folder::open(&path, Existing::Keep), Err(Error::Io { .. })));
    }
}
