//! Arguments of `lumiduct compare`.

use crate::cli::console::print_error;
use crate::cli::exit::{INTERRUPTED, fail, finish, warn};
use crate::cli::process::{on_ctrl_c, use_threads};
use crate::cli::run::GatherArgs;
use crate::cli::values::{parse_number, parse_time, words};
use crate::pipeline::{self, CompareOptions, Method, Output, TruthOption};
use clap::Args;
use lumiduct_input::Settings;
use lumiduct_report::Existing;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

/// Default ratio of the time for the truth to the time of a method.
const TRUTH_TIMES: u32 = 10;

#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    /// The scene file.
    scene: PathBuf,
    /// The sensor whose flux and cells are compared [default: the only one].
    #[arg(long, value_name = "NAME")]
    sensor: Option<String>,
    /// Estimators to compare, in the order of the table.
    #[arg(
        long,
        required = true,
        value_delimiter = ',',
        value_name = "NAMES",
        value_parser = words(Method::all().map(Method::name), Method::named)
    )]
    estimators: Vec<Method>,
    /// Time for each estimator, all its runs together, such as 60s or 5min.
    #[arg(long, value_parser = parse_time, value_name = "TIME", default_value = "10s")]
    time: Duration,
    /// Independent runs of each estimator, 2 to 1000; they share its time.
    #[arg(long, value_parser = clap::value_parser!(u32).range(2..=1000), default_value_t = 8)]
    runs: u32,
    /// The true flux, in lm or W, if it is known.
    #[arg(
        long,
        value_parser = parse_number,
        value_name = "FLUX",
        conflicts_with = "truth_file",
        allow_negative_numbers = true
    )]
    truth: Option<f64>,
    /// Standard error of the true flux.
    #[arg(long, value_parser = parse_number, value_name = "FLUX", requires = "truth")]
    truth_error: Option<f64>,
    /// Take the true flux from measures.csv of a report, or with its cells from truth.csv of a comparison.
    #[arg(long, value_name = "FILE")]
    truth_file: Option<PathBuf>,
    /// Time for a run that computes the true flux, by the best of forward, backward and mix [default: 10 times --time].
    #[arg(
        long,
        value_parser = parse_time,
        value_name = "TIME",
        conflicts_with_all = ["truth", "truth_file"]
    )]
    truth_time: Option<Duration>,
    /// Folder of the results [default: reports/NAME-compare below this folder].
    #[arg(short = 'o', long = "output", value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set a key of the scene.
    #[arg(short = 'D', value_name = "KEY=VALUE")]
    define: Vec<String>,
    /// Seed of the random numbers.
    #[arg(long)]
    seed: Option<u64>,
    /// Number of threads [default: all cores].
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Replace existing results.
    #[arg(long)]
    overwrite: bool,
    /// Print nothing but errors.
    #[arg(short, long)]
    quiet: bool,
    // The last one: its heading holds for everything that follows.
    #[command(flatten)]
    gather: GatherArgs,
}

/// Compares estimators.
pub(super) fn compare(args: &CompareArgs) -> ExitCode {
    if let Err(error) = use_threads(args.threads) {
        return fail(&error);
    }
    let settings = Settings {
        overrides: args.define.clone(),
        gather: args.gather.settings(),
        seed: args.seed,
        ..Settings::default()
    };
    let truth = match (args.truth, &args.truth_file) {
        (Some(value), _) => {
            TruthOption::Given { value, std_error: args.truth_error.unwrap_or(0.0) }
        }
        (None, Some(path)) => TruthOption::File(path.clone()),
        (None, None) => {
            TruthOption::Run(args.truth_time.unwrap_or(args.time.saturating_mul(TRUTH_TIMES)))
        }
    };
    let mut methods: Vec<Method> = Vec::new();
    for method in &args.estimators {
        if !methods.contains(method) {
            methods.push(*method);
        }
    }
    let options = CompareOptions {
        sensor: args.sensor.clone(),
        methods,
        time: args.time,
        repetitions: args.runs,
        truth,
    };
    let existing = if args.overwrite { Existing::Replace } else { Existing::Keep };
    let output = Output::new(args.output.clone(), existing);
    let interrupt = on_ctrl_c();
    let mut tell = |line: &str| {
        if !args.quiet {
            print_error(&format!("{line}\n"));
        }
    };
    match pipeline::compare(&args.scene, &settings, &options, &output, &interrupt, &mut tell) {
        Ok(_) if args.quiet => ExitCode::SUCCESS,
        Ok(compared) => {
            warn(&compared.warnings);
            finish(Ok(compared.text))
        }
        Err(error) if interrupt.is_raised() => {
            fail(&error);
            ExitCode::from(INTERRUPTED)
        }
        Err(error) => fail(&error),
    }
}
