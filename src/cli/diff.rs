//! `lumiduct diff`: two reports side by side.

use crate::cli::console::print;
use crate::cli::exit::fail;
use crate::cli::junit::{open_junit, write_junit};
use crate::cli::values::{parse_percent, parse_sigmas};
use clap::Args;
use lumiduct_base::error::{Error, Result};
use lumiduct_report::diff::{
    Diff, DiffOptions, Limits, MapLimit, ShownRows, diff, diff_files, diff_table, read,
};
use lumiduct_report::{Existing, Folder, FolderLock, Written, diff_junit, is_among};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of the command.
#[derive(Debug, Args)]
pub(super) struct DiffArgs {
    /// Folder of the first report: of a run, or of a study.
    a: PathBuf,
    /// Folder of the second report, of the same kind.
    b: PathBuf,
    /// A measure differs if it changes by more than this many errors of the difference.
    #[arg(long, value_parser = parse_sigmas, value_name = "COUNT", default_value = "4")]
    sigmas: f64,
    /// It must also change by more than this share of its first value, such as 1%.
    #[arg(long, value_parser = parse_percent, value_name = "PERCENT")]
    relative: Option<f64>,
    /// Compare maps, too: a map differs if its cells are others, or if one cell differs by more than noise causes once in
    /// a thousand maps.
    #[arg(long)]
    maps: bool,
    /// Compare only measures whose names begin like this, such as `exit.`; may be given several times.
    #[arg(long, value_name = "PATTERN")]
    only: Vec<String>,
    /// Show all measures, not only the worst.
    #[arg(long)]
    all: bool,
    /// Write diff.html, diff.md, diff.csv and pictures of the differences of maps into this folder.
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    output: Option<PathBuf>,
    /// Write a JUnit XML file with a test case for each measure.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Replace existing files.
    #[arg(long)]
    overwrite: bool,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command; the exit code says whether the reports differ.
pub(super) fn run(args: &DiffArgs) -> ExitCode {
    let existing = if args.overwrite { Existing::Replace } else { Existing::Keep };
    let outcome = open_junit(args.junit.as_deref(), args.output.as_deref(), existing)
        .and_then(|junit| Ok((junit, compare(args, existing)?)));
    match outcome {
        Ok((junit, diff)) => {
            let code = ExitCode::from(u8::from(!diff.is_within()));
            write_junit(junit.as_ref(), || diff_junit(&diff), code)
        }
        Err(error) => fail(&error),
    }
}

fn compare(args: &DiffArgs, existing: Existing) -> Result<Diff> {
    let sides = [read(&args.a)?, read(&args.b)?];
    let maps = if args.maps { MapLimit::Noise } else { MapLimit::Told };
    let limits = Limits { sigmas: args.sigmas, relative: args.relative, maps };
    let diff = diff(&sides, &DiffOptions { limits, only: args.only.clone() })?;
    if let Some(dir) = &args.output {
        if is_among(dir, &[args.a.clone(), args.b.clone()]) {
            let dir = dir.display();
            return Err(Error::Usage(format!(
                "{dir} is one of the reports; use -o for another folder"
            )));
        }
        let files = diff_files(&diff)?;
        let written =
            Folder::of_derived(FolderLock::take(dir)?, existing, &files)?.write(&files)?;
        if let Written::Nothing { differing } = written {
            return Err(Error::Usage(format!(
                "{} holds other files of the same names ({}); use --overwrite to replace them",
                dir.display(),
                differing.join(", ")
            )));
        }
    }
    if !args.quiet {
        let rows = if args.all { ShownRows::All } else { ShownRows::Worst };
        let mut text = diff_table(&diff, rows);
        if let Some(dir) = &args.output {
            text += &format!("report: {}\n", dir.join("diff.html").display());
        }
        print(&text)?;
    }
    Ok(diff)
}
