//! The errors of estimators, from the samples of their runs and the truth.

use crate::compare::comparison::{CheckpointSample, Comparison, Contestant, Truth};
use lumiduct_core::tally::Tally;

/// The errors of an estimator at a checkpoint, over its runs. In the unit of the measure, except
/// time and work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorRow {
    /// Mean time of a run, s.
    pub seconds: f64,
    /// Mean number of segments.
    pub segments: f64,
    /// Mean of the runs.
    pub value: f64,
    /// Standard error of that mean.
    pub std_error: f64,
    /// Standard deviation of a run: noise.
    pub noise: f64,
    /// Mean less truth.
    pub bias: f64,
    /// Standard error of the bias, including that of the truth.
    pub bias_std_error: f64,
    /// Root mean square deviation of a run from the truth: noise and bias together.
    pub total_error: f64,
    /// Root mean square over the runs of the error per cell, 1; `None` where it is not known.
    pub cell_error: Option<f64>,
}

impl ErrorRow {
    /// Squared total error times time: the time for a given error, up to a factor.
    pub(crate) fn cost(&self) -> Option<f64> {
        Some(self.total_error.powi(2) * self.seconds)
    }

    /// The same of the error per cell.
    pub(crate) fn cost_of_cells(&self) -> Option<f64> {
        self.cell_error.map(|error| error.powi(2) * self.seconds)
    }

    /// Whether the bias is more than noise: beyond two of its standard errors.
    pub(crate) fn is_biased(&self) -> bool {
        self.bias.abs() > 2.0 * self.bias_std_error
    }
}

/// The errors of an estimator at all checkpoints that every run has reached.
pub fn rows(contestant: &Contestant, truth: &Truth) -> Vec<ErrorRow> {
    let checkpoints = contestant.runs.iter().map(Vec::len).min().unwrap_or(0);
    let at = |place: usize| -> Option<Vec<CheckpointSample>> {
        contestant.runs.iter().map(|run| run[place]).collect()
    };
    (0..checkpoints).filter_map(at).map(|samples| row(&samples, truth)).collect()
}

/// The errors of all estimators at the end of their runs.
pub(crate) fn last_rows(comparison: &Comparison) -> Vec<(&Contestant, ErrorRow)> {
    let last = |one: &Contestant| rows(one, &comparison.truth).pop();
    comparison.contestants.iter().filter_map(|one| Some((one, last(one)?))).collect()
}

fn row(samples: &[CheckpointSample], truth: &Truth) -> ErrorRow {
    let mean = |of: fn(&CheckpointSample) -> f64| Tally::of(samples.iter().map(of)).mean();
    let values = Tally::of(samples.iter().map(|sample| sample.value));
    let cell_errors: Option<Vec<f64>> = samples.iter().map(|sample| sample.cell_error).collect();
    let squares = samples.iter().map(|sample| (sample.value - truth.value).powi(2));
    ErrorRow {
        seconds: mean(|sample| sample.seconds),
        segments: mean(|sample| sample.segments as f64),
        value: values.mean(),
        std_error: values.std_error(),
        noise: values.std_error() * (samples.len() as f64).sqrt(),
        bias: values.mean() - truth.value,
        bias_std_error: values.std_error().hypot(truth.std_error),
        total_error: Tally::of(squares).mean().sqrt(),
        cell_error: cell_errors
            .map(|errors| Tally::of(errors.into_iter().map(|error| error * error)).mean().sqrt()),
    }
}
