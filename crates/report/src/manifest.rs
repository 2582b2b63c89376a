//! `manifest.json`: the files of a report, with a digest of each. It is the last file to be
//! renamed, so that files of two runs, or of a killed run, are never taken for a report.

use crate::OutputFile;
use crate::seal::{digest, seal, unseal};
use indexmap::IndexMap;
use lumiduct_base::error::{Error, Result};
use serde::{Deserialize, Serialize};
use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path};

/// Its name in the folder of a report.
pub(crate) const MANIFEST: &str = "manifest.json";
/// Version of the layout of this file.
const FORMAT: u32 = 1;

/// The files of a report.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Manifest {
    #[serde(rename = "lumiduct_manifest")]
    format: u32,
    /// Digests by the names of files within the folder.
    #[serde(rename = "files")]
    files: IndexMap<String, String>,
}

impl Manifest {
    /// The manifest of these files.
    pub(crate) fn of(files: &[OutputFile]) -> Self {
        let files = files.iter().map(|file| (file.name.clone(), digest(&file.bytes)));
        Self { format: FORMAT, files: files.collect() }
    }

    /// Its file.
    pub(crate) fn file(&self, name: &str) -> Result<OutputFile> {
        let text = serde_json::to_string_pretty(self)
            .map_err(|reason| Error::Output { what: name.into(), reason: reason.to_string() })?;
        Ok(OutputFile::text(name, seal(&text)))
    }

    /// The manifest in a folder, if there is one. A damaged one is an error.
    pub(crate) fn read(folder: &Path, name: &str) -> Result<Option<Self>> {
        let path = folder.join(name);
        let bytes = match fs::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            other => other.map_err(|source| Error::io(&path, source))?,
        };
        unseal(&bytes).map(Some).map_err(|damage| {
            Error::Usage(format!(
                "{} is not a valid manifest of a report: {damage}; run the scene or study again with --overwrite",
                path.display()
            ))
        })
    }

    /// The manifest of a whole report; an error where there is none.
    pub(crate) fn expect(folder: &Path) -> Result<Self> {
        Self::read(folder, MANIFEST)?.ok_or_else(|| {
            Error::Usage(format!(
                "{} holds no whole report: it has no {MANIFEST}. The run that wrote it was killed, or was by an older \
                 version of the program; run the scene or study again with --overwrite",
                folder.display()
            ))
        })
    }

    /// Names of the files, restricted to the folder itself: the manifest may come from elsewhere.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str).filter(|name| is_plain(name))
    }

    /// Checks that a file of the folder is as the report was written.
    pub(crate) fn expect_file(&self, path: &Path, bytes: &[u8]) -> Result<()> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if self.files.get(name.as_ref()).is_some_and(|known| *known == digest(bytes)) {
            return Ok(());
        }
        Err(Error::Usage(format!(
            "{} is not the file that the report was written with: its digest is not that of {MANIFEST}; run the scene or \
             study again with --overwrite",
            path.display()
        )))
    }
}

/// The files of the whole report in a folder, the manifest last.
///
/// # Errors
///
/// [`Error::Usage`] if the folder holds no whole report, or a file is missing or was changed after it was written;
/// [`Error::Io`] if the manifest cannot be read.
pub fn report_files(folder: &Path) -> Result<Vec<OutputFile>> {
    let manifest = Manifest::expect(folder)?;
    let mut files = Vec::new();
    for name in manifest.names() {
        let path = folder.join(name);
        let bytes = fs::read(&path).map_err(|reason| {
            Error::Usage(format!("{} is missing from a report: {reason}", path.display()))
        })?;
        manifest.expect_file(&path, &bytes)?;
        files.push(OutputFile { name: name.to_owned(), bytes });
    }
    files.push(manifest.file(MANIFEST)?);
    Ok(files)
}

/// Whether a name is that of a file in the folder itself that is not hidden.
fn is_plain(name: &str) -> bool {
    let mut components = Path::new(name).components();
    let first = components.next();
    let is_one = matches!(first, Some(Component::Normal(_))) && components.next().is_none();
    is_one && !name.starts_with('.') && !name.contains(['/', '\\'])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_knows_its_files_and_none_outside_of_its_folder() {
        let file = |name: &str| OutputFile::text(name, "1".into());
        let names = ["a.csv", "../a", "b/c", "/etc/passwd", "..", ".hidden", "b\\c", ""];
        let manifest = Manifest::of(&names.map(file));
        assert_eq!(manifest.names().collect::<Vec<_>>(), ["a.csv"]);
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Manifest::read(folder.path(), MANIFEST).unwrap(), None);
        assert!(Manifest::expect(folder.path()).is_err());
        let path = folder.path().join(MANIFEST);
        let bytes = manifest.file(MANIFEST).unwrap().bytes;
        fs::write(&path, &bytes).unwrap();
        assert_eq!(Manifest::expect(folder.path()).unwrap(), manifest);
        manifest.expect_file(&folder.path().join("a.csv"), b"1").unwrap();
        assert!(manifest.expect_file(&folder.path().join("a.csv"), b"2").is_err());
        assert!(manifest.expect_file(&folder.path().join("new.csv"), b"1").is_err());
        fs::write(&path, &bytes[..bytes.len() - 9]).unwrap();
        let said = Manifest::expect(folder.path()).unwrap_err().to_string();
        assert!(said.contains(MANIFEST) && said.contains("cut off"), "{said}");
    }
}
