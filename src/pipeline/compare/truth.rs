//! What estimators are compared with: a given value, one from a file, or a long run of an unbiased
//! estimator.

use crate::pipeline::compare::bench::Bench;
use crate::pipeline::compare::method::Method;
use crate::pipeline::compare::runner::{ReportedValue, Stint, trace};
use crate::pipeline::compare::truth_file::read;
use lumiduct_base::error::{Error, Result};
use lumiduct_core::plan::Request;
use lumiduct_core::transport::invisible;
use lumiduct_report::{TrueCells, Truth};
use std::path::PathBuf;
use std::time::Duration;

/// Where the truth comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum TruthOption {
    /// It is known, in the unit of the measure.
    Given {
        /// The value.
        value: f64,
        /// Its standard error.
        std_error: f64,
    },
    /// A `measures.csv` of a report, or a `truth.csv` of a comparison; lines with `#` are comments.
    File(PathBuf),
    /// The best of forward, backward and mix for this time.
    Run(Duration),
}

/// Share of the time of a long run that the trial of each of the two estimators takes.
const TRIAL: f64 = 0.05;

/// What is known of the truth before any work.
pub(super) enum Known {
    Truth(Truth),
    /// It takes a run of this time.
    Takes(Duration),
}

/// What is known of the truth before any work.
pub(super) fn known(bench: &Bench<'_>, wish: &TruthOption) -> Result<Known> {
    match wish {
        TruthOption::Given { value, std_error } => {
            let origin = "as given on the command line".to_owned();
            let truth = Truth { value: *value, std_error: *std_error, origin, cells: None };
            usable(bench, truth).map(Known::Truth)
        }
        TruthOption::File(path) => usable(bench, read(path, bench)?).map(Known::Truth),
        TruthOption::Run(time) => Ok(Known::Takes(*time)),
    }
}

/// Finds the truth by a long run of the unbiased estimator with the smallest error after a short
/// trial.
pub(super) fn find(
    bench: &Bench<'_>,
    repetitions: u32,
    time: Duration,
    watch: &mut dyn FnMut(&str),
) -> Result<Truth> {
    let scene = &bench.job.scene;
    // Seeds beyond those of the runs that are compared.
    let seed = u64::from(repetitions);
    let is_visible = scene.sources.iter().all(|source| invisible(source, scene).is_none());
    let candidates = [Request::Forward, Request::Backward, Request::Mix];
    let able = candidates.into_iter().filter(|request| is_visible || *request != Request::Backward);
    let mut best: Option<(Request, f64)> = None;
    for request in able {
        watch(&format!("truth: trial of {}", request.name()));
        let trial = run(bench, request, seed, time.mul_f64(TRIAL))?;
        let error = trial.std_error / trial.value.abs();
        if error.is_finite() && best.is_none_or(|(_, least)| error < least) {
            best = Some((request, error));
        }
    }
    let Some((request, _)) = best else {
        return Err(Error::Usage(format!(
            "no light was found on `{}` in {:.1} s: give the truth with --truth or --truth-file, or a \
                longer --truth-time",
            bench.measure(),
            time.mul_f64(TRIAL).as_secs_f64()
        )));
    };
    let (name, seconds) = (request.name(), time.as_secs_f64());
    watch(&format!("truth: {name} for {seconds:.0} s"));
    let ReportedValue { value, std_error, cells } = run(bench, request, seed + 1, time)?;
    let used = bench.plan(request, seed + 1).seed;
    usable(
        bench,
        Truth {
            value,
            std_error,
            origin: format!("by {name} for {seconds:.1} s with seed {used}"),
            cells: if bench.cells() > 1 { TrueCells::new(cells) } else { None },
        },
    )
}

fn usable(bench: &Bench<'_>, truth: Truth) -> Result<Truth> {
    let is_value = truth.value.is_finite() && truth.value != 0.0;
    if is_value && truth.std_error.is_finite() && truth.std_error >= 0.0 {
        return Ok(truth);
    }
    Err(Error::Usage(format!(
        "the truth of `{}` is {} ± {}, {}: errors are relative to the truth, which must not be 0 and must \
            have an error",
        bench.measure(),
        truth.value,
        truth.std_error,
        truth.origin
    )))
}

fn run(bench: &Bench<'_>, request: Request, run: u64, time: Duration) -> Result<ReportedValue> {
    let stint = Stint { method: Method::Run(request), run, checkpoints: &[time], cells: None };
    let nothing = ReportedValue { value: 0.0, std_error: f64::INFINITY, cells: Vec::new() };
    Ok(trace(bench, &stint)?.last.unwrap_or(nothing))
}
