//! `lumiduct optimise`: finds a design and checks it.

use crate::cli::console::print;
use crate::cli::display::Display;
use crate::cli::exit::{INTERRUPTED, fail, warn};
use crate::cli::process::{on_ctrl_c, use_threads};
use crate::cli::values::parse_count;
use crate::optimise::{FinishedOptimisation, OptimisationOptions, run_optimisation};
use crate::study::OnExisting;
use clap::Args;
use lumiduct_input::StudySettings;
use lumiduct_report::optimise::terminal;
use lumiduct_report::{Standing, Written};
use std::cell::RefCell;
use std::path::PathBuf;
use std::process::ExitCode;

/// Arguments of the command.
#[derive(Debug, Args)]
pub(super) struct OptimiseArgs {
    /// The study file, with a table `optimise`.
    study: PathBuf,
    /// Folder of the results [default: reports/optimisations/NAME below this folder].
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set a key of the scene for all measurements.
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    define: Vec<String>,
    /// Paths of the last measurements and of the check, such as 2M.
    #[arg(long, value_parser = parse_count, value_name = "COUNT")]
    paths: Option<u64>,
    /// Seed of the random numbers of light.
    #[arg(long)]
    seed: Option<u64>,
    /// Number of threads [default: all cores]. The result does not depend on it.
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Resume an optimisation that was stopped; finished measurements are not repeated.
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Start again and replace existing results.
    #[arg(long)]
    overwrite: bool,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub(super) fn optimise(args: &OptimiseArgs) -> ExitCode {
    if let Err(error) = use_threads(args.threads) {
        return fail(&error);
    }
    let interrupt = on_ctrl_c();
    let options = OptimisationOptions {
        settings: StudySettings {
            overrides: args.define.clone(),
            target: None,
            paths: args.paths,
            seed: args.seed,
        },
        dir: args.output.clone(),
        existing: match (args.resume, args.overwrite) {
            (true, _) => OnExisting::Resume,
            (false, true) => OnExisting::Replace,
            (false, false) => OnExisting::Keep,
        },
    };
    let display = RefCell::new(Display::new(args.quiet));
    let outcome = run_optimisation(&args.study, &options, &interrupt, &|progress| {
        display.borrow_mut().show_optimisation(progress);
    });
    display.borrow().close();
    match outcome {
        Ok(finished) => print_outcome(&finished, args.quiet),
        Err(error) => fail(&error),
    }
}

/// Prints the outcome; the exit code says whether the target is reached.
fn print_outcome(finished: &FinishedOptimisation, quiet: bool) -> ExitCode {
    if !quiet {
        warn(&finished.warnings);
        let state = match &finished.written {
            Written::New => String::new(),
            Written::Same => " (already there, identical to the byte)".into(),
            Written::Nothing { differing } => {
                format!(" (kept; {} would differ)", differing.join(", "))
            }
        };
        let dir = finished.dir.display();
        let text = format!("{}report: {dir}/report.html{state}\n", terminal(&finished.report));
        if let Err(error) = print(&text) {
            return fail(&error);
        }
    }
    match finished.report.ending.standing() {
        Standing::Good => ExitCode::SUCCESS,
        Standing::Open => ExitCode::from(INTERRUPTED),
        Standing::Bad => ExitCode::from(1),
    }
}
