//! The command line: arguments, progress, exit codes. It and its children are all that prints.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "this is the program's face")]

mod compare;
mod display;
mod film;
mod mesh;
mod values;

use crate::cli::compare::CompareArgs;
use crate::cli::display::Display;
use crate::cli::film::FilmArgs;
use crate::cli::mesh::MeshArgs;
use crate::cli::values::{
    parse_angle, parse_count, parse_percent, parse_radius, parse_records, parse_time, words,
};
use crate::error::{Diagnostic, Error};
use crate::input::diagnostic::{self, Colour};
use crate::input::{self, GatherSettings, Settings};
use crate::pipeline::{self, Output, Stop};
use crate::report::{Existing, Outcome, Written};
use crate::scene::plan::{Request, Schedule};
use crate::transport::Interrupt;
use clap::{Args, CommandFactory, Parser, Subcommand};
use std::io::{ErrorKind, IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

/// Photometric sensor data for light tubes and light guides: flux, uniformity, maps and far fields with error bars.
#[derive(Debug, Parser)]
#[command(name = "lumiduct", version, about, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 good; 1 a check was missed; 2 not run (usage or input); 3 internal or I/O \
error; 130 stopped by Ctrl-C.";

/// What shells give for a program that was stopped by Ctrl-C: 128 and the number of the signal.
const INTERRUPTED: u8 = 130;

#[derive(Debug, Subcommand)]
enum Command {
    /// Trace a scene and write its report.
    Run(RunArgs),
    /// Run several estimators and baselines on the same time and compare their errors with a truth.
    Compare(CompareArgs),
    /// Validate a scene, print what is in it, and draw a cross-section with 50 traced paths.
    Check(CheckArgs),
    /// Print reflectance and transmittance of the prism films of a scene against the angle.
    Film(FilmArgs),
    /// Examine a mesh file: is it closed, the right way out, and fine enough? Exits with 1 if it cannot be a solid.
    Mesh(MeshArgs),
    /// List scenes and sensor files in a folder.
    List {
        /// The folder to look in.
        #[arg(default_value = ".")]
        folder: PathBuf,
    },
    /// Print the JSON Schema of scene files.
    Schema,
    /// Print a completion script.
    Completions {
        /// The shell to print it for.
        shell: clap_complete::Shell,
    },
    /// Print the manual page.
    Man,
}

#[derive(Debug, Args)]
struct RunArgs {
    /// The scene file.
    scene: PathBuf,
    /// Folder of the report [default: reports/NAME below this folder].
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set a key of the scene, such as `-D solids.pipe.sweep.path.0.straight_mm=20`.
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    define: Vec<String>,
    /// How flux is estimated; auto chooses for every sensor by a short trial.
    #[arg(long, value_parser = words(Request::ALL.map(Request::name), Request::named))]
    estimator: Option<Request>,
    /// Stop at this relative standard error of the target measure, such as 0.5%; the first sensor's flux if the scene
    /// names no measure.
    #[arg(long, value_parser = parse_percent, value_name = "PERCENT")]
    target: Option<f64>,
    /// Stop after this many paths, such as 2M.
    #[arg(long, value_parser = parse_count, value_name = "COUNT")]
    paths: Option<u64>,
    /// Stop after this time, such as 60s or 5min.
    #[arg(long, value_parser = parse_time, value_name = "TIME")]
    time: Option<Duration>,
    /// Seed of the random numbers.
    #[arg(long)]
    seed: Option<u64>,
    /// Number of threads [default: all cores].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Replace a report that is there.
    #[arg(long)]
    overwrite: bool,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
    // The last one: its heading holds for everything that follows.
    #[command(flatten)]
    gather: GatherArgs,
}

#[derive(Debug, Args)]
#[command(next_help_heading = "Gather")]
struct GatherArgs {
    /// Depth at which gather paths end at the latest, up to 1000; the first surface has depth 0 [default: chosen by a
    /// short trial, as for the other numbers here].
    #[arg(long, value_parser = clap::value_parser!(u32).range(..=1000))]
    depth: Option<u32>,
    /// Radius of the window in the first pass, in mm.
    #[arg(long, value_parser = parse_radius, value_name = "MM")]
    radius_mm: Option<f64>,
    /// Half-angle of the window in the first pass, in degrees below 90.
    #[arg(long, value_parser = parse_angle, value_name = "DEG")]
    angle_deg: Option<f64>,
    /// Gather paths in a pass, such as 100k.
    #[arg(long, value_parser = parse_records, value_name = "COUNT")]
    records: Option<u64>,
    /// Photon paths in a pass, such as 5M.
    #[arg(long, value_parser = parse_count, value_name = "COUNT")]
    photons: Option<u64>,
    /// How the window shrinks: in stages of many passes, or a little from pass to pass [default: stages].
    #[arg(long, value_parser = words(Schedule::ALL.map(Schedule::name), Schedule::named))]
    schedule: Option<Schedule>,
}

#[derive(Debug, Args)]
struct CheckArgs {
    /// The scene file.
    scene: PathBuf,
    /// Set a key of the scene.
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    define: Vec<String>,
    /// The cross-section's PNG [default: NAME.check.png in this folder].
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace a FILE that is there; NAME.check.png is replaced in any case.
    #[arg(long)]
    overwrite: bool,
}

/// Runs the program on the arguments of the process.
pub fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // Help and version are no errors; a closed pipe is nobody's.
            _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    match cli.command {
        Command::Run(args) => run(&args),
        Command::Compare(args) => compare::compare(&args),
        Command::Check(args) => check(&args),
        Command::Film(args) => film::film(&args),
        Command::Mesh(args) => mesh::mesh(&args),
        Command::List { folder } => finish(input::list(&folder)),
        Command::Schema => finish(Ok(format!("{:#}\n", input::schema::json_schema()))),
        Command::Completions { shell } => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "lumiduct", &mut script);
            finish(Ok(String::from_utf8_lossy(&script).into_owned()))
        }
        Command::Man => {
            let mut page = Vec::new();
            let rendered = clap_mangen::Man::new(Cli::command()).render(&mut page);
            finish(rendered.map(|()| String::from_utf8_lossy(&page).into_owned()).map_err(
                |reason| Error::Output { what: "manual page".into(), reason: reason.to_string() },
            ))
        }
    }
}

impl GatherArgs {
    fn settings(&self) -> GatherSettings {
        GatherSettings {
            depth: self.depth,
            radius_mm: self.radius_mm,
            angle_deg: self.angle_deg,
            records: self.records,
            photons: self.photons,
            schedule: self.schedule,
        }
    }
}

/// Sets the number of threads, all cores if none is given.
fn use_threads(threads: Option<u16>) -> Result<(), Error> {
    let Some(threads) = threads else { return Ok(()) };
    rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(threads))
        .build_global()
        .map_err(|reason| Error::Usage(format!("--threads {threads}: {reason}")))
}

/// A flag that Ctrl-C raises; the second time it ends the program.
fn on_ctrl_c() -> Interrupt {
    let interrupt = Interrupt::default();
    let on_signal = interrupt.clone();
    // Without a handler Ctrl-C ends the program at once: worse, but no reason not to run.
    _ = ctrlc::set_handler(move || {
        if on_signal.is_raised() {
            std::process::exit(INTERRUPTED.into());
        }
        on_signal.raise();
    });
    interrupt
}

fn run(args: &RunArgs) -> ExitCode {
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
    };
    let existing = if args.overwrite { Existing::Replace } else { Existing::Keep };
    let output = Output { dir: args.output.clone(), existing };
    let mut display = Display::new(args.quiet);
    let outcome = pipeline::run_one(&args.scene, &settings, &output, &interrupt, &mut |progress| {
        display.show(progress);
    });
    display.close();
    match outcome {
        Ok(finished) => {
            let is_kept = matches!(finished.written, Written::Nothing { .. });
            let text = crate::report::terminal(&finished.report, &finished.dir, &finished.written);
            let printed = if args.quiet {
                Ok(())
            } else {
                warn(&finished.warnings);
                print(&text)
            };
            match printed {
                Err(error) => fail(&error),
                Ok(()) if is_kept => {
                    eprintln!("error: {}", text.lines().last().unwrap_or_default());
                    ExitCode::from(3)
                }
                Ok(()) => exit_code(finished.stop, finished.report.outcome()),
            }
        }
        Err(error) if interrupt.is_raised() => {
            fail(&error);
            ExitCode::from(INTERRUPTED)
        }
        Err(error) => fail(&error),
    }
}

fn exit_code(stop: Stop, outcome: Outcome) -> ExitCode {
    if stop == Stop::Interrupted {
        return ExitCode::from(INTERRUPTED);
    }
    match outcome {
        Outcome::Missed => ExitCode::from(1),
        Outcome::Good => ExitCode::SUCCESS,
    }
}

fn check(args: &CheckArgs) -> ExitCode {
    let existing = if args.overwrite { Existing::Replace } else { Existing::Keep };
    let settings = Settings { overrides: args.define.clone(), ..Settings::default() };
    match pipeline::check(&args.scene, &settings, args.output.as_deref(), existing) {
        Ok(checked) => {
            warn(&checked.warnings);
            finish(Ok(checked.text))
        }
        Err(error) => fail(&error),
    }
}

/// Prints a text, or says why there is none.
fn finish(text: crate::error::Result<String>) -> ExitCode {
    match text.and_then(|text| print(&text)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => fail(&error),
    }
}

/// Prints to stdout; a reader that closed the pipe has seen enough.
fn print(text: &str) -> Result<(), Error> {
    let mut stdout = std::io::stdout();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(reason) if reason.kind() != ErrorKind::BrokenPipe => {
            Err(Error::Output { what: "standard output".into(), reason: reason.to_string() })
        }
        Ok(()) | Err(_) => Ok(()),
    }
}

fn warn(warnings: &[Diagnostic]) {
    if !warnings.is_empty() {
        eprint!("{}", rendered(warnings));
    }
}

/// Diagnostics with the lines they are about, in colour on a terminal.
fn rendered(diagnostics: &[Diagnostic]) -> String {
    let colour = if std::io::stderr().is_terminal() { Colour::Always } else { Colour::Never };
    diagnostic::render(diagnostics, &diagnostic::sources_of(diagnostics), colour)
}

fn fail(error: &Error) -> ExitCode {
    match error {
        Error::Input(diagnostics) => {
            eprint!("{}", rendered(diagnostics));
            ExitCode::from(2)
        }
        Error::Usage(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
        Error::Io { .. } | Error::Output { .. } => {
            eprintln!("error: {error}");
            ExitCode::from(3)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_make_sense_together() {
        Cli::command().debug_assert();
    }
}
