//! Checkpoints of a long run: its state, saved to disk at intervals.

use crate::pipeline::output::{Output, RunStart};
use crate::pipeline::snapshot::{self, SnapshotKind};
use lumiduct_base::error::{Error, Result};
use lumiduct_core::transport::{Run, RunState};
use lumiduct_report::{Existing, Recipe, remove_if_there, sweep};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of the checkpoint in the folder of a report.
const NAME: &str = "checkpoint.bin";

/// A run as it was saved.
#[derive(Serialize, Deserialize)]
pub(super) struct Checkpoint {
    pub(super) state: RunState,
    /// Waves after which the stop rules are checked next.
    pub(super) round_end: u64,
    /// Elapsed time so far.
    pub(super) elapsed: Duration,
}

/// A moment at which a checkpoint may be saved.
pub(super) struct Pause<'a> {
    pub(super) run: &'a Run<'a>,
    /// Waves after which the stop rules are checked next.
    pub(super) round_end: u64,
    pub(super) elapsed: Duration,
    pub(super) follows: Follows,
}

/// What follows a pause.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Follows {
    /// More work.
    Work,
    /// Nothing: the user has stopped the run.
    End,
}

impl Pause<'_> {
    /// The run as it is now.
    pub(super) fn checkpoint(&self) -> Checkpoint {
        let &Self { run, round_end, elapsed, .. } = self;
        Checkpoint { state: run.state(), round_end, elapsed }
    }
}

/// Where the checkpoints of a run are saved.
pub(super) struct CheckpointFile {
    path: PathBuf,
    recipe: Recipe,
    every: Option<Duration>,
    last: Duration,
}

impl CheckpointFile {
    /// Looks for a checkpoint of this recipe to resume. One that is not to be resumed is an error,
    /// unless it may be replaced.
    pub(super) fn open(
        dir: &Path,
        recipe: Recipe,
        output: &Output,
    ) -> Result<(Self, Option<Checkpoint>)> {
        let (path, every) = (dir.join(NAME), output.checkpoint_every);
        let file = Self { path, recipe, every, last: Duration::ZERO };
        if output.start == RunStart::Resume {
            sweep(dir)?;
        }
        if !file.path.exists() {
            return Ok((file, None));
        }
        match (output.start, output.existing) {
            (RunStart::Resume, _) => {
                let checkpoint = file.read()?;
                Ok((Self { last: checkpoint.elapsed, ..file }, Some(checkpoint)))
            }
            (RunStart::Anew, Existing::Replace) => Ok((file, None)),
            (RunStart::Anew, Existing::Keep) => Err(Error::Usage(format!(
                "{} holds a checkpoint of a run that was stopped; use --resume to continue it, or \
                    --overwrite to start again",
                dir.display()
            ))),
        }
    }

    fn read(&self) -> Result<Checkpoint> {
        let (recipe, checkpoint): (Recipe, Checkpoint) =
            snapshot::read(&self.path, SnapshotKind::Checkpoint)?;
        if recipe != self.recipe {
            return Err(Error::Usage(format!(
                "{} is not a checkpoint of this run but of {}; use --overwrite to start again, or -o for \
                    another folder",
                self.path.display(),
                self.recipe.difference_of(&recipe)
            )));
        }
        Ok(checkpoint)
    }

    /// Saves a checkpoint if one is due, or if the user has stopped the run.
    pub(super) fn save(&mut self, pause: &Pause<'_>) -> Result<()> {
        let Some(every) = self.every else { return Ok(()) };
        let is_due = pause.elapsed.saturating_sub(self.last) >= every;
        if !is_due && pause.follows == Follows::Work {
            return Ok(());
        }
        self.last = pause.elapsed;
        snapshot::write(&self.path, SnapshotKind::Checkpoint, &(&self.recipe, &pause.checkpoint()))
    }

    /// Removes the checkpoint of a run that has ended.
    pub(super) fn remove(&self) -> Result<()> {
        remove_if_there(&self.path)
    }
}
