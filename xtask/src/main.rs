//! Chores of the repository: `cargo xtask --help`.

#![allow(clippy::print_stdout, reason = "a program for developers")]

mod comparisons;
mod manual;
mod validate;
mod verify;

use crate::comparisons::{CompareTimes, compare};
use crate::validate::{ResultsPage, validate};
use crate::verify::verify;
use clap::Parser;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Chores of the repository.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
enum Chore {
    /// Write the pages on scene, study and optimisation files in docs from the schemas.
    Manual,
    /// Run all scenes and studies anew and compare their committed reports byte by byte.
    VerifyReports {
        /// Only one in ten; the number of commits says which.
        #[arg(long)]
        tenth: bool,
        /// The program to run, instead of one that is built for it.
        #[arg(long)]
        program: Option<PathBuf>,
    },
    /// Compare the estimators in the scenes of docs/comparison and write their folders: about 20 minutes each.
    Compare(CompareTimes),
    /// Trace the values of docs/validation.md anew and compare the page.
    Validate {
        /// Only one run in ten; the number of commits says which.
        #[arg(long)]
        tenth: bool,
        /// Write the page instead.
        #[arg(long, conflicts_with = "tenth")]
        write: bool,
    },
}

/// How much a chore does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Share {
    /// All of it.
    All,
    /// One in ten; the number of commits says which.
    Tenth,
}

impl Share {
    fn new(is_tenth: bool) -> Self {
        if is_tenth { Self::Tenth } else { Self::All }
    }
}

fn main() -> io::Result<ExitCode> {
    match Chore::parse() {
        Chore::Manual => {
            for (page, markdown) in manual::pages() {
                std::fs::write(root().join(page), markdown)?;
                println!("{page}");
            }
            Ok(ExitCode::SUCCESS)
        }
        Chore::VerifyReports { tenth, program } => {
            Ok(exit_code(verify(Share::new(tenth), program)?))
        }
        Chore::Compare(times) => Ok(exit_code(compare(&times)?)),
        Chore::Validate { tenth, write } => {
            let page = if write { ResultsPage::Write } else { ResultsPage::Verify };
            Ok(exit_code(validate(Share::new(tenth), page)?))
        }
    }
}

fn exit_code(is_good: bool) -> ExitCode {
    if is_good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Commits up to the present one.
fn commits() -> io::Result<usize> {
    let mut git = Command::new("git");
    let printed = git.args(["rev-list", "--count", "HEAD"]).current_dir(root()).output()?.stdout;
    String::from_utf8_lossy(&printed).trim().parse().map_err(io::Error::other)
}
