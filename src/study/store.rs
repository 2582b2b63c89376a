//! Results of a batch on disk: the facts of the study, and a record of every design as soon as it has one.
//!
//! A record appears whole or not at all, so that a batch killed at any moment can be resumed. The
//! records alone show which designs are done. Facts and records are sealed: a changed one is
//! refused by name.

use lumiduct_base::error::{Error, Result};
use lumiduct_report::study::{DESIGN_FORMAT, DesignRecord, FACTS_FORMAT, StudyFacts};
use lumiduct_report::{
    Existing, FolderLock, OutputFile, is_staged, remove_if_there, remove_report, report_files,
    seal, sweep, unseal, write_whole,
};
use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Names in the folder of a batch.
const FACTS: &str = "batch.json";
const DESIGNS: &str = "designs";
const TIMING: &str = "timing.csv";

/// Hint for an invalid record.
const REMOVE: &str = "remove it, and `batch --resume` computes the design again";
/// Hint for invalid facts.
const BEGIN_ANEW: &str = "use --overwrite to start again, or -o for another folder";

/// What to do with existing results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OnExisting {
    /// Refuse to touch them.
    Keep,
    /// Resume where they end.
    Resume,
    /// Begin anew.
    Replace,
}

/// The folder of a batch.
#[derive(Debug)]
pub(crate) struct Store {
    dir: PathBuf,
    facts: StudyFacts,
    /// Keeps other programs from writing here; `None` for a folder that is only read.
    lock: Option<FolderLock>,
}

impl Store {
    /// Checks, before any work is done, that results of a study can be written to a folder, and
    /// writes the facts of the study.
    pub(crate) fn open(
        dir: &Path,
        facts: &StudyFacts,
        text: &str,
        existing: OnExisting,
    ) -> Result<Self> {
        let lock = Some(FolderLock::take(dir)?);
        let store = Self { dir: dir.to_path_buf(), facts: facts.clone(), lock };
        if existing == OnExisting::Replace {
            store.clear()?;
        } else {
            match Self::facts_in(dir)? {
                None => store.expect_empty()?,
                Some(found) => store.expect_same(&found, existing)?,
            }
            store.sweep()?;
        }
        let designs = store.dir.join(DESIGNS);
        fs::create_dir_all(&designs).map_err(|source| Error::io(&designs, source))?;
        let text_of_facts = serde_json::to_string_pretty(facts);
        write_sealed(&dir.join(FACTS), text_of_facts)?;
        write_whole(&store.text_path(), text.as_bytes(), Existing::Replace)?;
        Ok(store)
    }

    /// The results in a folder, as they are.
    pub(crate) fn read(dir: &Path) -> Result<Self> {
        let facts = Self::facts_in(dir)?.ok_or_else(|| {
            Error::Usage(format!("{} holds no results of a study", dir.display()))
        })?;
        Ok(Self { dir: dir.to_path_buf(), facts, lock: None })
    }

    /// Checks that existing results belong to this study and may be resumed.
    fn expect_same(&self, found: &StudyFacts, existing: OnExisting) -> Result<()> {
        let dir = self.dir.display();
        if !found.is_same_study(&self.facts) {
            return Err(Error::Usage(format!(
                "{dir} holds results of another study: the study, its scene, the command line or the \
                    numerics of the program differ; {BEGIN_ANEW}"
            )));
        }
        match existing {
            OnExisting::Resume | OnExisting::Replace => Ok(()),
            OnExisting::Keep => Err(Error::Usage(format!(
                "{dir} holds results of this study; use --resume to continue, or --overwrite to start again"
            ))),
        }
    }

    /// The lock on the folder.
    pub(crate) fn lock(&self) -> Result<FolderLock> {
        self.lock.clone().map_or_else(|| FolderLock::take(&self.dir), Ok)
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

    /// Copies all records of another folder, and the reports of its designs.
    pub(crate) fn take(&self, other: &Self) -> Result<()> {
        for (design, record) in other.records()? {
            self.write(&record)?;
            for OutputFile { name, bytes } in other.report_files_of(design)? {
                write_whole(&self.report_of(design).join(name), &bytes, Existing::Replace)?;
            }
        }
        Ok(())
    }

    /// Checks that the reports of these designs, where they exist, are unchanged.
    pub(crate) fn expect_whole_reports<'a>(
        &self,
        designs: impl IntoIterator<Item = &'a usize>,
    ) -> Result<()> {
        designs.into_iter().try_for_each(|design| self.report_files_of(*design).map(|_| ()))
    }

    /// The files of the report of a design; none where it has no report.
    fn report_files_of(&self, design: usize) -> Result<Vec<OutputFile>> {
        let folder = self.report_of(design);
        if folder.is_dir() { report_files(&folder) } else { Ok(Vec::new()) }
    }

    /// Whether a folder contains results of a study, readable or not.
    pub(crate) fn is_there(dir: &Path) -> bool {
        dir.join(FACTS).exists()
    }

    /// The facts of the study in a folder; `None` if it contains no results.
    fn facts_in(dir: &Path) -> Result<Option<StudyFacts>> {
        if !Self::is_there(dir) {
            return Ok(None);
        }
        let path = dir.join(FACTS);
        let bytes = fs::read(&path).map_err(|source| Error::io(&path, source))?;
        let refuse = |why: &str| {
            Error::Usage(format!("{} cannot be resumed: {why}; {BEGIN_ANEW}", path.display()))
        };
        let facts: StudyFacts = unseal(&bytes).map_err(|damage| refuse(&damage.to_string()))?;
        if facts.lumiduct_batch != FACTS_FORMAT {
            return Err(refuse("it has the layout of another version of the program"));
        }
        Ok(Some(facts))
    }

    /// The folder.
    pub(crate) fn path(&self) -> &Path {
        &self.dir
    }

    /// Folder of the whole report of a design.
    pub(crate) fn report_of(&self, design: usize) -> PathBuf {
        self.dir.join(DESIGNS).join(format!("{design:04}"))
    }

    /// Writes the record of a design.
    pub(crate) fn write(&self, record: &DesignRecord) -> Result<()> {
        write_sealed(&self.record_path(record.design), serde_json::to_string(record))
    }

    /// Creates the table of timings, which is outside the reproducible files, if it is missing.
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
        // One write of a short line: lines of several threads do not mix.
        file.and_then(|mut file| file.write_all(line.as_bytes()))
            .map_err(|source| Error::io(&path, source))
    }

    /// All existing records, by the numbers of their designs.
    pub(crate) fn records(&self) -> Result<BTreeMap<usize, DesignRecord>> {
        let designs = self.dir.join(DESIGNS);
        let mut records = BTreeMap::new();
        for path in entries(&designs)? {
            let is_numbered = path.file_stem().is_some_and(|stem| {
                stem.to_string_lossy().bytes().all(|letter| letter.is_ascii_digit())
            });
            if !is_numbered || path.extension().is_none_or(|extension| extension != "json") {
                continue;
            }
            let bytes = fs::read(&path).map_err(|source| Error::io(&path, source))?;
            let record: DesignRecord =
                unseal(&bytes).map_err(|damage| refusal(&path, &damage.to_string()))?;
            if record.lumiduct_design != DESIGN_FORMAT {
                return Err(refusal(&path, "it has the layout of another version of the program"));
            }
            if record.study != self.facts.hash || path != self.record_path(record.design) {
                return Err(refusal(&path, "it is of another study or another design"));
            }
            records.insert(record.design, record);
        }
        Ok(records)
    }

    /// Error for an invalid record of a design.
    pub(crate) fn no_record(&self, design: usize, why: &str) -> Error {
        refusal(&self.record_path(design), why)
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
            "{} holds files that are not results of a batch; use --overwrite to replace those of the same name, or -o \
             for another folder",
            self.dir.display()
        )))
    }

    /// Removes what a killed batch left half written.
    fn sweep(&self) -> Result<()> {
        sweep(&self.dir)?;
        sweep(&self.dir.join(DESIGNS))
    }

    /// Removes the results of an older batch: files that intact manifests list, and the records of
    /// its designs. Where the facts of that batch are damaged, it removes only records that this
    /// batch will write. Other files stay.
    fn clear(&self) -> Result<()> {
        self.sweep()?;
        let older = Self::facts_in(&self.dir).ok().flatten();
        let designs = older.map_or(0, |facts| facts.records()).max(self.facts.records());
        remove_report(&self.dir)?;
        remove_if_there(&self.dir.join(FACTS))?;
        remove_if_there(&self.dir.join(TIMING))?;
        for path in entries(&self.dir.join(DESIGNS))? {
            let is_own = |design: &usize| {
                path == self.record_path(*design) || path == self.report_of(*design)
            };
            let number = path.file_stem().and_then(|stem| stem.to_str()?.parse().ok());
            if number.filter(|design| (1..=designs).contains(design)).filter(is_own).is_none() {
                continue;
            }
            // A link to a folder points elsewhere.
            if path.is_symlink() || path.is_file() {
                remove_if_there(&path)?;
            } else {
                sweep(&path)?;
                remove_report(&path)?;
                // A folder with other files stays.
                if entries(&path)?.is_empty() {
                    fs::remove_dir(&path).map_err(|source| Error::io(&path, source))?;
                }
            }
        }
        Ok(())
    }
}

/// Error for a file that is not a record of a design.
fn refusal(path: &Path, why: &str) -> Error {
    Error::Usage(format!("{} is not a record of this study: {why}; {REMOVE}", path.display()))
}

/// Writes an object in JSON with its seal, whole or not at all.
fn write_sealed(path: &Path, json: serde_json::Result<String>) -> Result<()> {
    let json = json.map_err(|reason| Error::Output {
        what: path.display().to_string(),
        reason: reason.to_string(),
    })?;
    write_whole(path, seal(&json).as_bytes(), Existing::Replace)
}

/// Everything in a folder, by name; empty if it does not exist.
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
