//! Chores of the repository: `cargo xtask --help`.

#![allow(clippy::print_stdout, reason = "a program for developers")]

mod manual;

use clap::Parser;
use std::io;
use std::path::{Path, PathBuf};

/// Chores of the repository.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
enum Chore {
    /// Write the pages on scene and study files in docs from the schemas.
    Manual,
}

fn main() -> io::Result<()> {
    match Chore::parse() {
        Chore::Manual => {
            for (page, markdown) in manual::pages() {
                std::fs::write(root().join(page), markdown)?;
                println!("{page}");
            }
            Ok(())
        }
    }
}

/// The root of the repository.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
