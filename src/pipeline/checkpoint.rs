//! Checkpoints of a long run: its state, saved to disk at intervals.

use crate::pipeline::output::{Output, Start};
use crate::pipeline::snapshot::{self, Kind};
use lumiduct_base::error::{Error, Result};
use lumiduct_core::transport::{Run, State};
use lumiduct_report::{Existing, Recipe, remove_if_there, sweep};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of the checkpoint in the folder of a report.
const NAME: &str = "checkpoint.bin";

/// A run as it was saved.
#[derive(Serialize, Deserialize)]
pub(super) struct Checkpoint {
    pub(super) state: State,
    /// Waves after which the stop rules are checked next.
    pub(super) round_end: u64,
    /// Elapsed time so far.
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
    /// Looks for a checkpoint of this recipe to resume. One that is not to be resumed is an error,
    /// unless it may be replaced.
    pub(super) fn open(
        dir: &Path,
        recipe: Recipe,
        output: &Output,
    ) -> Result<(Self, Option<Checkpoint>)> {
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
                let checkpoint = keeper.read()?;
                Ok((Self { last: checkpoint.elapsed, ..keeper }, Some(checkpoint)))
            }
            (Start::Anew, Existing::Replace) => Ok((keeper, None)),
            (Start::Anew, Existing::Keep) => Err(Error::Usage(format!(
                "{} holds a checkpoint of a run that was stopped; use --resume to go on, or --overwrite to begin anew",
                dir.display()
            ))),
        }
    }

    fn read(&self) -> Result<Checkpoint> {
        let (recipe, checkpoint): (Recipe, Checkpoint) =
            snapshot::read(&self.path, Kind::Checkpoint)?;
        if recipe != self.recipe {
            return Err(Error::Usage(format!(
                "{} is no checkpoint of this run but of {}; use --overwrite to begin anew, or -o for another folder",
                self.path.display(),
                self.recipe.difference_of(&recipe)
            )));
        }
        Ok(checkpoint)
    }

    /// Keeps a checkpoint if one is due.
    pub(super) fn keep_if_due(
        &mut self,
        run: &Run<'_>,
        round_end: u64,
        elapsed: Duration,
    ) -> Result<()> {
        match self.every {
            Some(every) if elapsed.saturating_sub(self.last) >= every => {
                self.keep(run, round_end, elapsed)
            }
            Some(_) | None => Ok(()),
        }
    }

    fn keep(&mut self, run: &Run<'_>, round_end: u64, elapsed: Duration) -> Result<()> {
        self.last = elapsed;
        let checkpoint = Checkpoint { state: run.state(), round_end, elapsed };
        snapshot::write(&self.path, Kind::Checkpoint, &(&self.recipe, &checkpoint))
    }

    /// Keeps a checkpoint of a run that the user has stopped, if checkpoints are enabled.
    pub(super) fn keep_last(
        &mut self,
        run: &Run<'_>,
        round_end: u64,
        elapsed: Duration,
    ) -> Result<()> {
        if self.every.is_some() { self.keep(run, round_end, elapsed) } else { Ok(()) }
    }

    /// Removes the checkpoint of a run that has ended.
    pub(super) fn remove(&self) -> Result<()> {
        remove_if_there(&self.path)
    }
}
