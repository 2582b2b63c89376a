//! Checkpoints of a long run: how far it has come, on disk every now and then.

use crate::error::{Error, Result};
use crate::pipeline::Output;
use crate::pipeline::snapshot::{self, Kind};
use crate::report::{Existing, Recipe, remove_if_there, sweep};
use crate::transport::{Run, State};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of the checkpoint in the folder of a report.
const NAME: &str = "checkpoint.bin";

/// Whether a run begins anew or goes on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Start {
    /// From its first path.
    Anew,
    /// From the checkpoint in the folder of its report, if there is one.
    Resume,
}

/// Where a run stands.
#[derive(Serialize, Deserialize)]
pub(super) struct Stand {
    pub(super) state: State,
    /// Waves after which the stop rules are looked at next.
    pub(super) round_end: u64,
    /// Time that it has taken so far.
    pub(super) elapsed: Duration,
}

/// Keeps checkpoints of a run.
pub(super) struct Keeper {
    path: PathBuf,
    recipe: Recipe,
    every: Option<Duration>,
    last: Duration,
}

impl Keeper {
    /// Looks for a checkpoint in a folder, from which a run of this recipe is to go on. One that is not to be gone on
    /// from is in the way, unless it may be replaced.
    pub(super) fn open(
        dir: &Path,
        recipe: Recipe,
        output: &Output,
    ) -> Result<(Self, Option<Stand>)> {
        let (path, every) = (dir.join(NAME), output.checkpoint_every);
        let keeper = Self { path, recipe, every, last: Duration::ZERO };
        if output.start == Start::Resume {
            sweep(dir)?;
        }
        if !keeper.path.exists() {
            return Ok((keeper, None));
        }
        match (output.start, output.existing) {
            (Start::Resume, _) => {
                let stand = keeper.read()?;
                Ok((Self { last: stand.elapsed, ..keeper }, Some(stand)))
            }
            (Start::Anew, Existing::Replace) => Ok((keeper, None)),
            (Start::Anew, Existing::Keep) => Err(Error::Usage(format!(
                "{} holds a checkpoint of a run that was stopped; use --resume to go on, or --overwrite to begin anew",
                dir.display()
            ))),
        }
    }

    fn read(&self) -> Result<Stand> {
        let (recipe, stand): (Recipe, Stand) = snapshot::read(&self.path, Kind::Checkpoint)?;
        if recipe != self.recipe {
            return Err(Error::Usage(format!(
                "{} is no checkpoint of this run but of {}; use --overwrite to begin anew, or -o for another folder",
                self.path.display(),
                self.recipe.difference_of(&recipe)
            )));
        }
        Ok(stand)
    }

    /// Keeps a checkpoint if one is due.
    pub(super) fn keep_if_due(
        &mut self,
        run: &Run<'_>,
        round_end: u64,
        elapsed: Duration,
    ) -> Result<()> {
        match self.every {
            Some(every) if elapsed >= self.last + every => self.keep(run, round_end, elapsed),
            Some(_) | None => Ok(()),
        }
    }

    fn keep(&mut self, run: &Run<'_>, round_end: u64, elapsed: Duration) -> Result<()> {
        self.last = elapsed;
        let stand = Stand { state: run.state(), round_end, elapsed };
        snapshot::write(&self.path, Kind::Checkpoint, &(&self.recipe, &stand))
    }

    /// Keeps a checkpoint of a run that the user has stopped, if any were wanted.
    pub(super) fn keep_last(
        &mut self,
        run: &Run<'_>,
        round_end: u64,
        elapsed: Duration,
    ) -> Result<()> {
        if self.every.is_some() { self.keep(run, round_end, elapsed) } else { Ok(()) }
    }

    /// Takes the checkpoint of a run away that has come to its end.
    pub(super) fn remove(&self) -> Result<()> {
        remove_if_there(&self.path)
    }
}
