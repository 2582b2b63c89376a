//! `lumiduct run`: a scene becomes a report, or a part of one.

use crate::cli::console::{print, print_error};
use crate::cli::display::Display;
use crate::cli::exit::{INTERRUPTED, fail, finish, warn};
use crate::cli::junit::{open_junit, write_junit};
use crate::cli::process::{on_ctrl_c, use_threads};
use crate::cli::values::{
    parse_angle, parse_count, parse_percent, parse_radius, parse_records, parse_shard, parse_time,
    words,
};
use crate::pipeline::{
    self, FinishedRun, Output, RunStart, SliceOptions, SliceWritten, Stop, WrittenFile,
};
use clap::Args;
use lumiduct_core::plan::{GatherPlan, Request, Schedule};
use lumiduct_core::transport::{Interrupt, Shard};
use lumiduct_input::Settings;
use lumiduct_report::{Existing, Pictures, RunOutcome, Written, run_junit};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Arguments of the command.
#[derive(Debug, Args)]
pub(super) struct RunArgs {
    /// The scene file.
    scene: PathBuf,
    /// Folder of the report [default: reports/NAME below this folder].
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set a key of the scene, such as `-D solids.pipe.sweep.path.0.straight_mm=20`.
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    define: Vec<String>,
    /// How flux is estimated; auto chooses for each sensor by a short pilot run. A sensor with a key `estimator` keeps
    /// its own.
    #[arg(long, value_parser = words(Request::ALL.map(Request::name), Request::named))]
    estimator: Option<Request>,
    /// Stop at this relative standard error of the target measure, such as 0.5%. Without a measure in the scene, the
    /// target is the first sensor's flux.
    #[arg(long, value_parser = parse_percent, value_name = "PERCENT")]
    target: Option<f64>,
    /// Stop after this many paths, such as 2M: photon paths from the sources, and gather paths from the sensors where the
    /// estimator has them. Rounded up to whole batches, or to waves of them: 128, or 4 passes of gathering.
    #[arg(long, value_parser = parse_count, value_name = "COUNT")]
    paths: Option<u64>,
    /// Stop after this time, such as 60s or 5min, including the pilot of auto. Unfinished batches are dropped; the report
    /// gives the command that repeats the run.
    #[arg(long, value_parser = parse_time, value_name = "TIME")]
    time: Option<Duration>,
    /// Seed of the random numbers.
    #[arg(long)]
    seed: Option<u64>,
    /// Number of threads [default: all cores].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Replace an existing report.
    #[arg(long)]
    overwrite: bool,
    /// Draw no PNG files: a report takes a fraction of the time. report.html has all plots in any case.
    #[arg(long, conflicts_with = "shard")]
    no_pictures: bool,
    /// Save a checkpoint in the folder of the report at this interval, such as 60s, for --resume.
    #[arg(long, value_parser = parse_time, value_name = "TIME", conflicts_with = "shard")]
    checkpoint: Option<Duration>,
    /// Resume from the checkpoint in the folder of the report; without one, start again.
    #[arg(long, conflicts_with_all = ["shard", "overwrite"])]
    resume: bool,
    /// Trace only this part of the paths, such as 3/16; `merge` combines the parts.
    #[arg(long, value_parser = parse_shard, value_name = "PART/OF")]
    shard: Option<Shard>,
    /// Write a JUnit XML file with a test case for each check.
    #[arg(long, value_name = "FILE", conflicts_with = "shard")]
    junit: Option<PathBuf>,
    /// Write what the goniometer measures as a luminaire file: .ies (LM-63), .ldt (EULUMDAT) or .xml (TM-33). The key `luminaire` of the
    /// sensor has the details, such as the edition; without it, the table is the finest that the cells allow. An existing file needs --overwrite.
    #[arg(long, value_name = "FILE", conflicts_with = "shard")]
    ies: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
    // The last one: its heading holds for everything that follows.
    #[command(flatten)]
    gather: GatherArgs,
}

/// Settings of the gather estimator.
#[derive(Debug, Args)]
#[command(next_help_heading = "Gather")]
pub(super) struct GatherArgs {
    /// Largest depth of gather paths, up to 1000; the first surface has depth 0 [default: chosen by a short pilot run,
    /// like the other numbers here].
    #[arg(long, value_parser = clap::value_parser!(u32).range(..=1000))]
    depth: Option<u32>,
    /// Radius of the window in the first stage, in mm.
    #[arg(long, value_parser = parse_radius, value_name = "MM")]
    radius_mm: Option<f64>,
    /// Half-angle of the window in the first stage, in degrees below 90.
    #[arg(long, value_parser = parse_angle, value_name = "DEG")]
    angle_deg: Option<f64>,
    /// Gather paths in a pass, such as 100k.
    #[arg(long, value_parser = parse_records, value_name = "COUNT")]
    records: Option<u64>,
    /// Photon paths in a pass, such as 5M.
    #[arg(long, value_parser = parse_count, value_name = "COUNT")]
    photons: Option<u64>,
    /// How the window shrinks: in stages of many passes, or not at all [default: stages].
    #[arg(long, value_parser = words(Schedule::ALL.map(Schedule::name), Schedule::named))]
    schedule: Option<Schedule>,
}

impl GatherArgs {
    /// The gather settings.
    pub(super) fn settings(&self) -> GatherPlan {
        GatherPlan {
            depth: self.depth,
            radius_mm: self.radius_mm,
            angle_deg: self.angle_deg,
            records: self.records,
            photons: self.photons,
            schedule: self.schedule,
        }
    }
}

/// Runs the command.
pub(super) fn run(args: &RunArgs) -> ExitCode {
    if let Err(error) = use_threads(args.threads) {
        return fail(&error);
    }
    let interrupt = on_ctrl_c();
    let settings = Settings {
        overrides: args.define.clone(),
        estimator: args.estimator,
        gather: args.gather.settings(),
        target: args.target,
        paths: args.paths,
        time: args.time,
        seed: args.seed,
        ..Settings::default()
    };
    let existing = if args.overwrite { Existing::Replace } else { Existing::Keep };
    let junit = match open_junit(args.junit.as_deref(), args.output.as_deref(), existing) {
        Ok(junit) => junit,
        Err(error) => return fail(&error),
    };
    if let Some(shard) = args.shard {
        let options = SliceOptions { shard, dir: args.output.clone(), existing };
        return slice(args, &settings, &options, &interrupt);
    }
    let start = if args.resume { RunStart::Resume } else { RunStart::Anew };
    let (dir, checkpoint_every) = (args.output.clone(), args.checkpoint);
    let luminaire = args.ies.clone();
    let pictures = if args.no_pictures { Pictures::LeftOut } else { Pictures::Drawn };
    let output = Output { dir, existing, pictures, checkpoint_every, start, luminaire };
    let mut display = Display::new(args.quiet);
    let outcome = pipeline::run_one(&args.scene, &settings, &output, &interrupt, &mut |progress| {
        display.show(progress);
    });
    display.close();
    match outcome {
        Ok(finished) => {
            let code = tell(&finished, args.quiet);
            write_junit(junit.as_ref(), || run_junit(&finished.report), code)
        }
        Err(error) if interrupt.is_raised() => {
            fail(&error);
            ExitCode::from(INTERRUPTED)
        }
        Err(error) => fail(&error),
    }
}

/// Prints the results of a run; the exit code says whether it meets what its scene asks for.
pub(super) fn tell(finished: &FinishedRun, quiet: bool) -> ExitCode {
    let is_kept = matches!(finished.written, Written::Nothing { .. });
    let FinishedRun { report, dir, written, warnings, luminaire, .. } = finished;
    let text = lumiduct_report::terminal(report, warnings.len(), dir, written);
    let further =
        luminaire.as_ref().map_or(String::new(), |WrittenFile { path, format, remarks }| {
            let notes: String = remarks.iter().map(|remark| format!("note: {remark}\n")).collect();
            format!("written: {} ({format})\n{notes}", path.display())
        });
    let printed = if quiet {
        Ok(())
    } else {
        warn(warnings);
        print(&format!("{text}{further}"))
    };
    match printed {
        Err(error) => fail(&error),
        Ok(()) if is_kept => {
            print_error(&format!("error: {}\n", text.lines().last().unwrap_or_default()));
            ExitCode::from(3)
        }
        Ok(()) => exit_code(finished.stop, finished.report.outcome()),
    }
}

/// Traces a part of a run.
fn slice(
    args: &RunArgs,
    settings: &Settings,
    options: &SliceOptions,
    interrupt: &Interrupt,
) -> ExitCode {
    let mut display = Display::new(args.quiet);
    let begin = Instant::now();
    let written = pipeline::run_slice(&args.scene, settings, options, interrupt, &mut |share| {
        display.show_share(share, begin.elapsed());
    });
    display.close();
    match written {
        Ok(SliceWritten { title, batches: Some(batches), of, dir }) => {
            let text = format!(
                "{title}\npart {}: {} of {of} batches are in {}\n",
                options.shard,
                batches.end - batches.start,
                dir.display()
            );
            finish(Ok(if args.quiet { String::new() } else { text }))
        }
        Ok(SliceWritten { batches: None, .. }) => {
            print_error("error: the part was stopped, and nothing was written\n");
            ExitCode::from(INTERRUPTED)
        }
        Err(error) => fail(&error),
    }
}

fn exit_code(stop: Stop, outcome: RunOutcome) -> ExitCode {
    if stop == Stop::Interrupted {
        return ExitCode::from(INTERRUPTED);
    }
    match outcome {
        RunOutcome::Missed => ExitCode::from(1),
        RunOutcome::Good => ExitCode::SUCCESS,
    }
}
