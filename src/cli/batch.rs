//! `lumiduct batch`: a study becomes a folder of results.

use crate::cli::console::print;
use crate::cli::display::Display;
use crate::cli::exit::{INTERRUPTED, fail, warn};
use crate::cli::junit::{open_junit, write_junit};
use crate::cli::process::{on_ctrl_c, use_threads};
use crate::cli::values::{parse_count, parse_percent, parse_shard};
use crate::study::{BatchEvent, BatchOptions, FinishedStudy, OnExisting, run_study};
use clap::Args;
use lumiduct_core::transport::Shard;
use lumiduct_input::StudySettings;
use lumiduct_report::{Existing, Written, study_junit};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;

/// Arguments of the command.
#[derive(Debug, Args)]
pub(super) struct BatchArgs {
    /// The study file.
    study: PathBuf,
    /// Folder of the results [default: reports/studies/NAME below this folder].
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set a key of the scene for all designs.
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    define: Vec<String>,
    /// Stop each design at this relative standard error of its target measure, such as 0.5%.
    #[arg(long, value_parser = parse_percent, value_name = "PERCENT")]
    target: Option<f64>,
    /// Stop each design after this many paths, such as 200k.
    #[arg(long, value_parser = parse_count, value_name = "COUNT")]
    paths: Option<u64>,
    /// Seed of the random numbers of light, the same for all designs.
    #[arg(long)]
    seed: Option<u64>,
    /// Number of threads [default: all cores].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Number of designs computed at once; they share the threads [default: number of threads].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Resume a batch that was stopped or is complete; finished designs are not repeated.
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Start again and replace existing results.
    #[arg(long)]
    overwrite: bool,
    /// Compute only this part of the designs, such as 3/16; `merge` combines the parts.
    #[arg(long, value_parser = parse_shard, value_name = "PART/OF")]
    shard: Option<Shard>,
    /// Write a JUnit XML file with a test case for each check of each design.
    #[arg(long, value_name = "FILE", conflicts_with = "shard")]
    junit: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
}

/// Runs the command.
pub(super) fn batch(args: &BatchArgs) -> ExitCode {
    if let Err(error) = use_threads(args.threads) {
        return fail(&error);
    }
    let existing = if args.overwrite { Existing::Replace } else { Existing::Keep };
    let junit = match open_junit(args.junit.as_deref(), args.output.as_deref(), existing) {
        Ok(junit) => junit,
        Err(error) => return fail(&error),
    };
    let interrupt = on_ctrl_c();
    let options = BatchOptions {
        settings: StudySettings {
            overrides: args.define.clone(),
            target: args.target,
            paths: args.paths,
            seed: args.seed,
        },
        dir: args.output.clone(),
        existing: match (args.resume, args.overwrite) {
            (true, _) => OnExisting::Resume,
            (false, true) => OnExisting::Replace,
            (false, false) => OnExisting::Keep,
        },
        jobs: args.jobs.map_or_else(rayon::current_num_threads, usize::from),
        shard: args.shard.unwrap_or(Shard::WHOLE),
    };
    let display = Mutex::new(Display::new(args.quiet));
    let outcome = run_study(&args.study, &options, &interrupt, &|event| match event {
        BatchEvent::Read(remarks) => {
            if !args.quiet {
                warn(remarks);
            }
        }
        BatchEvent::Progress(progress) => {
            if let Ok(mut display) = display.lock() {
                display.show_batch(&progress);
            }
        }
    });
    if let Ok(display) = display.lock() {
        display.close();
    }
    match outcome {
        Ok(finished) => {
            let code = tell(&finished, args.quiet);
            // A batch that was stopped has no verdict yet.
            let Some(report) = &finished.report else { return code };
            write_junit(junit.as_ref(), || study_junit(report), code)
        }
        Err(error) => fail(&error),
    }
}

/// Prints the outcome of a batch; the exit code says whether every design is as requested or, of a search, one is found.
pub(super) fn tell(finished: &FinishedStudy, quiet: bool) -> ExitCode {
    if !quiet && let Err(error) = print(&summary(finished)) {
        return fail(&error);
    }
    let [done, wanted] = finished.done;
    if done < wanted {
        return ExitCode::from(INTERRUPTED);
    }
    match &finished.report {
        Some(report) if !report.is_good() => ExitCode::from(1),
        Some(_) | None => ExitCode::SUCCESS,
    }
}

fn summary(finished: &FinishedStudy) -> String {
    let [done, wanted] = finished.done;
    let dir = finished.dir.display();
    let Some(report) = &finished.report else {
        let what = if done < wanted {
            "the batch was stopped; use --resume to continue"
        } else {
            "this part is complete; combine all parts with `lumiduct merge`"
        };
        return format!(
            "{}\n{done} of {wanted} designs are done in {dir}: {what}\n",
            finished.facts.title
        );
    };
    let state = match &finished.written {
        Written::New => String::new(),
        Written::Same => " (already there, identical to the byte)".into(),
        Written::Nothing { differing } => format!(" (kept; {} would differ)", differing.join(", ")),
    };
    format!("{}report: {dir}/study.md{state}\n", lumiduct_report::study::terminal(report))
}
