//! `lumiduct diff`: two reports side by side, or a report beside a measured file.

use crate::cli::console::print;
use crate::cli::exit::fail;
use crate::cli::junit::{open_junit, write_junit};
use crate::cli::measured::{MeasuredArgs, refuse};
use crate::cli::values::{parse_percent, parse_sigmas};
use clap::Args;
use lumiduct_base::error::{Error, Result};
use lumiduct_report::diff::{
    Diff, DiffOptions, Limits, MapLimit, ShownRows, diff, diff_files, diff_table, read,
};
use lumiduct_report::measured::{
    MeasuredDiff, compare_measured, is_measured, measured_files, measured_text,
};
use lumiduct_report::{
    Existing, Folder, FolderLock, OutputFile, Written, diff_junit, is_among, measured_junit,
};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Errors of a difference that a measure may change by, unless given.
const SIGMAS: f64 = 4.0;

/// Arguments of the command.
#[derive(Debug, Args)]
pub(super) struct DiffArgs {
    /// Folder of the first report: of a run, or of a study.
    a: PathBuf,
    /// Folder of the second report, of the same kind; or a measured file: .ies, .ldt or .csv for the intensities of a goniometer,
    /// .csv for a map.
    b: PathBuf,
    /// A measure differs if it changes by more than this many errors of the difference (4 unless given).
    #[arg(long, value_parser = parse_sigmas, value_name = "COUNT")]
    sigmas: Option<f64>,
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
    #[command(flatten)]
    measured: MeasuredArgs,
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
    let outcome =
        open_junit(args.junit.as_deref(), args.output.as_deref(), existing).and_then(|junit| {
            let compared = if is_measured(&args.b) {
                DiffOutcome::Measured(Box::new(compare_file(args, existing)?))
            } else {
                DiffOutcome::Reports(Box::new(compare(args, existing)?))
            };
            Ok((junit, compared))
        });
    match outcome {
        Ok((junit, compared)) => {
            let code = ExitCode::from(u8::from(!compared.is_within()));
            write_junit(junit.as_ref(), || compared.junit(), code)
        }
        Err(error) => fail(&error),
    }
}

/// What was compared with the first report.
enum DiffOutcome {
    Reports(Box<Diff>),
    Measured(Box<MeasuredDiff>),
}

impl DiffOutcome {
    fn is_within(&self) -> bool {
        match self {
            Self::Reports(diff) => diff.is_within(),
            Self::Measured(diff) => diff.is_within(),
        }
    }

    fn junit(&self) -> Result<String> {
        match self {
            Self::Reports(diff) => diff_junit(diff),
            Self::Measured(diff) => measured_junit(diff),
        }
    }
}

fn compare_file(args: &DiffArgs, existing: Existing) -> Result<MeasuredDiff> {
    let why = "is for two reports; a measured file is judged by --max-difference";
    refuse(&args.options_of_measures(), why)?;
    let diff = compare_measured(&args.a, &args.b, &args.measured.options())?;
    if let Some(dir) = &args.output {
        let reports = std::slice::from_ref(&args.a);
        write_files(dir, reports, existing, || measured_files(&diff))?;
    }
    args.print(measured_text(&diff))?;
    Ok(diff)
}

fn compare(args: &DiffArgs, existing: Existing) -> Result<Diff> {
    args.measured.expect_none()?;
    let sides = [read(&args.a)?, read(&args.b)?];
    let maps = if args.maps { MapLimit::Noise } else { MapLimit::Told };
    let limits = Limits { sigmas: args.sigmas.unwrap_or(SIGMAS), relative: args.relative, maps };
    let diff = diff(&sides, &DiffOptions { limits, only: args.only.clone() })?;
    if let Some(dir) = &args.output {
        write_files(dir, &[args.a.clone(), args.b.clone()], existing, || diff_files(&diff))?;
    }
    let rows = if args.all { ShownRows::All } else { ShownRows::Worst };
    args.print(diff_table(&diff, rows))?;
    Ok(diff)
}

impl DiffArgs {
    /// Prints a text and where the page is.
    fn print(&self, mut text: String) -> Result<()> {
        if let Some(dir) = &self.output {
            text += &format!("report: {}\n", dir.join("diff.html").display());
        }
        if self.quiet { Ok(()) } else { print(&text) }
    }

    /// Options that judge measures, and so make no sense beside a measured file.
    fn options_of_measures(&self) -> [(&'static str, bool); 5] {
        [
            ("--sigmas", self.sigmas.is_some()),
            ("--relative", self.relative.is_some()),
            ("--maps", self.maps),
            ("--only", !self.only.is_empty()),
            ("--all", self.all),
        ]
    }
}

/// Writes the files of a comparison into a folder that is none of the reports.
fn write_files(
    dir: &Path,
    reports: &[PathBuf],
    existing: Existing,
    files: impl FnOnce() -> Result<Vec<OutputFile>>,
) -> Result<()> {
    if is_among(dir, reports) {
        let dir = dir.display();
        return Err(Error::Usage(format!(
            "{dir} is one of the reports; use -o for another folder"
        )));
    }
    let files = files()?;
    let written = Folder::of_derived(FolderLock::take(dir)?, existing, &files)?.write(&files)?;
    if let Written::Nothing { differing } = written {
        return Err(Error::Usage(format!(
            "{} holds other files of the same names ({}); use --overwrite to replace them",
            dir.display(),
            differing.join(", ")
        )));
    }
    Ok(())
}
