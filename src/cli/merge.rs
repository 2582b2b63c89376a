//! `lumiduct merge`: joins parts to the whole.

use crate::cli::exit::fail;
use crate::cli::junit::{open_junit, write_junit};
use crate::cli::{batch, run};
use crate::pipeline::{Output, has_slice, merge_slices};
use crate::study::{OnExisting, has_study, merge_study};
use clap::Args;
use lumiduct_base::error::Error;
use lumiduct_report::{Existing, run_junit, study_junit};
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of the command.
#[derive(Debug, Args)]
pub(super) struct MergeArgs {
    /// Folders of all parts, of one run or of one study.
    #[arg(required = true)]
    parts: Vec<PathBuf>,
    /// Folder of the whole [default: reports/NAME or reports/studies/NAME below this folder].
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    output: Option<PathBuf>,
    /// The scene file of a run, if it is no longer where the parts were started with it.
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Replace an existing report.
    #[arg(long)]
    overwrite: bool,
    /// Write a JUnit XML file with a test case for each check.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub(super) fn merge(args: &MergeArgs) -> ExitCode {
    let existing = if args.overwrite { Existing::Replace } else { Existing::Keep };
    let junit = match open_junit(args.junit.as_deref(), args.output.as_deref(), existing) {
        Ok(junit) => junit,
        Err(error) => return fail(&error),
    };
    if args.parts.iter().all(|dir| has_slice(dir)) {
        let output = Output::new(args.output.clone(), existing);
        return match merge_slices(&args.parts, args.scene.as_deref(), &output) {
            Ok(finished) => {
                let code = run::tell(&finished, args.quiet);
                write_junit(junit.as_ref(), || run_junit(&finished.report), code)
            }
            Err(error) => fail(&error),
        };
    }
    if args.parts.iter().all(|dir| has_study(dir)) {
        if args.scene.is_some() {
            return fail(&Error::Usage(
                "--scene is for the parts of a run, but these are of a study".into(),
            ));
        }
        let existing = if args.overwrite { OnExisting::Replace } else { OnExisting::Resume };
        return match merge_study(&args.parts, args.output.as_deref(), existing) {
            Ok(finished) => {
                let code = batch::tell(&finished, args.quiet);
                let Some(report) = &finished.report else { return code };
                write_junit(junit.as_ref(), || study_junit(report), code)
            }
            Err(error) => fail(&error),
        };
    }
    let strange = args.parts.iter().find(|dir| !has_slice(dir) && !has_study(dir));
    fail(&Error::Usage(match strange {
        Some(dir) => format!(
            "{} holds no part of a run or a study: neither slice.bin nor batch.json",
            dir.display()
        ),
        None => "some of these folders hold parts of a run, and others parts of a study".into(),
    }))
}
