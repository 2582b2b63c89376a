//! Chores of the repository: `cargo xtask --help`.

#![allow(clippy::print_stdout, reason = "a program for developers")]

mod manual;
mod verify;

use crate::verify::{ReportShare, verify};
use clap::Parser;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Chores of the repository.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
enum Chore {
    /// Write the pages on scene and study files in docs from the schemas.
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
            let share = if tenth { ReportShare::Tenth } else { ReportShare::All };
            let is_same = verify(share, program)?;
            Ok(if is_same { ExitCode::SUCCESS } else { ExitCode::FAILURE })
        }
    }
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
