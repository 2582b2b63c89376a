//! Results of an optimisation on disk: its identity, and a record of every measurement as soon as it ends.
//!
//! A record appears whole or not at all, so that an optimisation killed at any moment can be resumed. What is decided is decided from
//! records that were read back, so that a resumed optimisation goes the same way.

use crate::study::OnExisting;
use lumiduct_base::error::{Error, Result};
use lumiduct_report::optimise::{MeasuredStep, OPTIMISATION_FORMAT, OptimisationIdentity};
use lumiduct_report::{
    Existing, FolderLock, is_staged, remove_if_there, remove_report, seal, sweep, unseal,
    write_whole,
};
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Names in the folder of an optimisation.
const IDENTITY: &str = "optimisation.json";
const STEPS: &str = "steps";
/// Most records that a folder can hold.
const MOST_RECORDS: usize = 2000;

/// The folder of an optimisation, locked against other programs.
#[derive(Debug)]
pub(crate) struct StepStore {
    dir: PathBuf,
    hash: String,
    lock: FolderLock,
}

impl StepStore {
    /// Checks, before any work is done, that results can be written to a folder, and writes what they belong to.
    pub(crate) fn open(
        dir: &Path,
        identity: &OptimisationIdentity,
        existing: OnExisting,
    ) -> Result<Self> {
        let lock = FolderLock::take(dir)?;
        let store = Self { dir: dir.to_path_buf(), hash: identity.hash.clone(), lock };
        let (path, name) = (dir.join(IDENTITY), dir.display());
        sweep(dir)?;
        match (existing, path.is_file()) {
            (OnExisting::Replace, _) => store.clear()?,
            (OnExisting::Keep | OnExisting::Resume, false) => store.expect_empty()?,
            (OnExisting::Keep, true) => {
                return Err(Error::Usage(format!(
                    "{name} holds results of an optimisation; use --resume to continue, or --overwrite to start again"
                )));
            }
            (OnExisting::Resume, true) => {
                let found: Option<OptimisationIdentity> =
                    fs::read(&path).ok().and_then(|bytes| unseal(&bytes).ok());
                if found.as_ref() != Some(identity) {
                    return Err(Error::Usage(format!(
                        "{name} holds results of another optimisation: the study, its scene, the command line or the numerics of the \
                         program differ; use --overwrite to start again, or -o for another folder"
                    )));
                }
            }
        }
        let steps = dir.join(STEPS);
        fs::create_dir_all(&steps).map_err(|source| Error::io(&steps, source))?;
        sweep(&steps)?;
        write_sealed(&path, identity)?;
        Ok(store)
    }

    /// The lock on the folder.
    pub(crate) fn lock(&self) -> FolderLock {
        self.lock.clone()
    }

    /// The folder.
    pub(crate) fn path(&self) -> &Path {
        &self.dir
    }

    /// The record of a measurement, if there is one.
    pub(crate) fn step(&self, step: usize) -> Result<Option<MeasuredStep>> {
        let path = self.record(step);
        if !path.is_file() {
            return Ok(None);
        }
        let bytes = fs::read(&path).map_err(|source| Error::io(&path, source))?;
        let refuse = |why: &str| {
            Error::Usage(format!(
                "{} is not a record of this optimisation: {why}; remove it and those after it, and --resume measures again",
                path.display()
            ))
        };
        let found: MeasuredStep = unseal(&bytes).map_err(|damage| refuse(&damage.to_string()))?;
        if found.lumiduct_step != OPTIMISATION_FORMAT {
            return Err(refuse("it has the layout of another version of the program"));
        }
        if found.hash != self.hash || found.step != step {
            return Err(refuse("it is of another optimisation or another step"));
        }
        Ok(Some(found))
    }

    /// Writes the record of a measurement and reads it back.
    pub(crate) fn write(&self, step: &MeasuredStep) -> Result<MeasuredStep> {
        let path = self.record(step.step);
        write_sealed(&path, step)?;
        self.step(step.step)?.ok_or_else(|| Error::Output {
            what: path.display().to_string(),
            reason: "it disappeared after it was written".into(),
        })
    }

    /// Error for a record that does not fit the steps before it.
    pub(crate) fn misplaced(&self, step: usize) -> Error {
        Error::Usage(format!(
            "{} does not follow from the records before it; remove it and those after it, and --resume measures again",
            self.record(step).display()
        ))
    }

    fn record(&self, step: usize) -> PathBuf {
        self.dir.join(STEPS).join(format!("{step:04}.json"))
    }

    fn expect_empty(&self) -> Result<()> {
        let steps = self.dir.join(STEPS);
        let entries = fs::read_dir(&self.dir).map_err(|source| Error::io(&self.dir, source))?;
        for entry in entries {
            let path = entry.map_err(|source| Error::io(&self.dir, source))?.path();
            if !is_staged(&path) && path != steps {
                return Err(Error::Usage(format!(
                    "{} holds files that are not results of an optimisation; use --overwrite to replace those of the same name, or -o \
                     for another folder",
                    self.dir.display()
                )));
            }
        }
        Ok(())
    }

    /// Removes the results of an older optimisation; other files stay.
    fn clear(&self) -> Result<()> {
        remove_report(&self.dir)?;
        remove_if_there(&self.dir.join(IDENTITY))?;
        (1..=MOST_RECORDS).try_for_each(|step| remove_if_there(&self.record(step)))
    }
}

/// Writes an object in JSON with its seal, whole or not at all.
fn write_sealed(path: &Path, object: &impl Serialize) -> Result<()> {
    let json = serde_json::to_string(object).map_err(|reason| Error::Output {
        what: path.display().to_string(),
        reason: reason.to_string(),
    })?;
    write_whole(path, seal(&json).as_bytes(), Existing::Replace)
}
