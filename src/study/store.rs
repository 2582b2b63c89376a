//! Results of a batch on disk: a manifest, and a record of every design as soon as it has one.
//!
//! A record appears whole or not at all, so that a batch that was killed at any moment can go on. Which designs are done
//! is told from the records alone.

use crate::error::{Error, Result};
use crate::report::study::{self, DESIGN_FORMAT, DesignRecord, StudyFacts};
use crate::report::{
    self, Existing, expect_room, is_staged, remove_if_there, remove_report, sweep, write_whole,
};
use crate::study::OnExisting;
use serde::de::DeserializeOwned;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Names in the folder of a batch.
const MANIFEST: &str = "batch.json";
const DESIGNS: &str = "designs";
const TIMING: &str = "timing.csv";

/// What to do about a record that is none.
const REMOVE: &str = "remove it, and the design is computed anew";

/// The folder of a batch.
#[derive(Debug)]
pub(crate) struct Store {
    dir: PathBuf,
    facts: StudyFacts,
    /// Keeps other programs from writing here as long as it is open; of one that is only read, there is none.
    _lock: Option<File>,
}

impl Store {
    /// Makes sure, before any work is done, that results of a study can be written to a folder, and writes what the
    /// study is.
    pub(crate) fn open(
        dir: &Path,
        facts: &StudyFacts,
        text: &str,
        existing: OnExisting,
    ) -> Result<Self> {
        expect_room(dir)?;
        let store = Self { dir: dir.to_path_buf(), facts: facts.clone(), _lock: lock(dir)? };
        match (Self::manifest(dir)?, existing) {
            (_, OnExisting::Replace) => store.clear()?,
            (None, OnExisting::Keep | OnExisting::Resume) => {
                store.expect_empty()?;
                store.sweep()?;
            }
            (Some(found), OnExisting::Keep | OnExisting::Resume) if found != *facts => {
                let what = if found.version == facts.version {
                    "another study: the study, its scene or what the command line sets differs"
                } else {
                    "a study by another version of the program"
                };
                return Err(Error::Usage(format!(
                    "{} holds results of {what}; use --overwrite to begin anew, or -o for another folder",
                    dir.display()
                )));
            }
            (Some(_), OnExisting::Keep) => {
                return Err(Error::Usage(format!(
                    "{} holds results of this study; use --resume to go on with them, or --overwrite to begin anew",
                    dir.display()
                )));
            }
            (Some(_), OnExisting::Resume) => store.sweep()?,
        }
        let designs = store.dir.join(DESIGNS);
        fs::create_dir_all(&designs).map_err(|source| Error::io(&designs, source))?;
        let manifest = serde_json::to_string_pretty(facts).map_err(|reason| Error::Output {
            what: MANIFEST.into(),
            reason: reason.to_string(),
        })?;
        write_whole(&dir.join(MANIFEST), (manifest + "\n").as_bytes(), Existing::Replace)?;
        write_whole(&store.text_path(), text.as_bytes(), Existing::Replace)?;
        Ok(store)
    }

    /// The results in a folder, as they are.
    pub(crate) fn read(dir: &Path) -> Result<Self> {
        let facts = Self::manifest(dir)?.ok_or_else(|| {
            Error::Usage(format!("{} holds no results of a study", dir.display()))
        })?;
        Ok(Self { dir: dir.to_path_buf(), facts, _lock: None })
    }

    /// What the study is.
    pub(crate) fn facts(&self) -> &StudyFacts {
        &self.facts
    }

    /// The study file, byte for byte.
    pub(crate) fn text(&self) -> Result<String> {
        let path = self.text_path();
        fs::read_to_string(&path).map_err(|source| Error::io(&path, source))
    }

    fn text_path(&self) -> PathBuf {
        self.dir.join(format!("{}.toml", self.facts.name))
    }

    /// Takes over all records of another folder, and the reports of its designs.
    pub(crate) fn take(&self, other: &Self) -> Result<()> {
        for (design, record) in other.records()? {
            self.write(&record)?;
            let report = other.report_of(design);
            if !report.is_dir() {
                continue;
            }
            for path in entries(&report)? {
                let bytes = fs::read(&path).map_err(|source| Error::io(&path, source))?;
                let name = path.file_name().unwrap_or_default();
                write_whole(&self.report_of(design).join(name), &bytes, Existing::Replace)?;
            }
        }
        Ok(())
    }

    /// Whether a folder holds results of a study, readable or not.
    pub(crate) fn is_there(dir: &Path) -> bool {
        dir.join(MANIFEST).exists()
    }

    /// What study a folder holds results of; `None` if it holds none.
    fn manifest(dir: &Path) -> Result<Option<StudyFacts>> {
        Self::is_there(dir).then(|| read_json(&dir.join(MANIFEST))).transpose()
    }

    /// The folder.
    pub(crate) fn path(&self) -> &Path {
        &self.dir
    }

    /// Where a whole report of a design lies.
    pub(crate) fn report_of(&self, design: usize) -> PathBuf {
        self.dir.join(DESIGNS).join(format!("{design:04}"))
    }

    /// Writes the record of a design.
    pub(crate) fn write(&self, record: &DesignRecord) -> Result<()> {
        let text = serde_json::to_string(record).map_err(|reason| Error::Output {
            what: format!("record of design {}", record.design),
            reason: reason.to_string(),
        })?;
        write_whole(&self.record_path(record.design), (text + "\n").as_bytes(), Existing::Replace)
    }

    /// Begins the table of seconds, which lies outside of the reproducible files, if it is not there.
    pub(crate) fn begin_timing(&self) -> Result<()> {
        let path = self.dir.join(TIMING);
        let header = b"design,seconds\n";
        if path.exists() { Ok(()) } else { write_whole(&path, header, Existing::Replace) }
    }

    /// Notes how long a design took.
    pub(crate) fn note_seconds(&self, design: usize, seconds: f64) -> Result<()> {
        let path = self.dir.join(TIMING);
        let line = format!("{design},{seconds:.3}\n");
        let file = OpenOptions::new().append(true).open(&path);
        // One write of a short line: those of several threads do not mix.
        file.and_then(|mut file| file.write_all(line.as_bytes()))
            .map_err(|source| Error::io(&path, source))
    }

    /// All records that are there, by the numbers of their designs.
    pub(crate) fn records(&self) -> Result<BTreeMap<usize, DesignRecord>> {
        let designs = self.dir.join(DESIGNS);
        let mut records = BTreeMap::new();
        for path in entries(&designs)? {
            if path.extension().is_none_or(|extension| extension != "json") {
                continue;
            }
            let record: DesignRecord = read_json(&path).map_err(|error| match error {
                Error::Usage(message) => Error::Usage(format!("{message}; {REMOVE}")),
                other @ (Error::Input(_) | Error::Io { .. } | Error::Output { .. }) => other,
            })?;
            if record.lumiduct_design != DESIGN_FORMAT
                || record.study != self.facts.hash
                || path != self.record_path(record.design)
            {
                return Err(Error::Usage(format!(
                    "{} is no record of this study; {REMOVE}",
                    path.display()
                )));
            }
            records.insert(record.design, record);
        }
        Ok(records)
    }

    fn record_path(&self, design: usize) -> PathBuf {
        self.dir.join(DESIGNS).join(format!("{design:04}.json"))
    }

    fn expect_empty(&self) -> Result<()> {
        let is_ours = |path: &PathBuf| *path == self.dir.join(DESIGNS) || is_staged(path);
        if entries(&self.dir)?.iter().all(is_ours)
            && entries(&self.dir.join(DESIGNS))?.iter().all(|path| is_staged(path))
        {
            return Ok(());
        }
        Err(Error::Usage(format!(
            "{} holds files that are no results of a batch; use --overwrite to replace those of the same name, or -o \
             for another folder",
            self.dir.display()
        )))
    }

    /// Takes away what a killed batch left half written.
    fn sweep(&self) -> Result<()> {
        sweep(&self.dir)?;
        sweep(&self.dir.join(DESIGNS))
    }

    /// Takes away the results of an older batch: its records, and the files that its summary and those of its designs name.
    fn clear(&self) -> Result<()> {
        self.sweep()?;
        remove_report(&self.dir, study::SUMMARY)?;
        remove_if_there(&self.dir.join(TIMING))?;
        for path in entries(&self.dir.join(DESIGNS))? {
            if path.is_dir() {
                sweep(&path)?;
                remove_report(&path, report::SUMMARY)?;
                // A folder with files of others stays.
                if entries(&path)?.is_empty() {
                    fs::remove_dir(&path).map_err(|source| Error::io(&path, source))?;
                }
            } else if path.extension().is_some_and(|extension| extension == "json") {
                remove_if_there(&path)?;
            }
        }
        Ok(())
    }
}

/// A lock on a folder itself, which nothing replaces; an error where another program holds it.
fn lock(dir: &Path) -> Result<Option<File>> {
    // Some systems open no folders as files.
    let Ok(file) = File::open(dir) else { return Ok(None) };
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(Error::Usage(format!(
            "another batch is at work in {}; wait for its end, or use -o for another folder",
            dir.display()
        ))),
        // Some file systems have no locks.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(Some(file)),
    }
}

/// Everything in a folder, by name; nothing of one that is not there.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = |source| Error::io(folder, source);
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        other => other.map_err(failed)?,
    };
    let paths: std::io::Result<Vec<PathBuf>> =
        entries.map(|entry| entry.map(|entry| entry.path())).collect();
    let mut paths = paths.map_err(failed)?;
    paths.sort();
    Ok(paths)
}

fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let bytes = fs::read(path).map_err(|source| Error::io(path, source))?;
    serde_json::from_slice(&bytes).map_err(|reason| {
        Error::Usage(format!("{} cannot be read as results of a batch: {reason}", path.display()))
    })
}
