//! What a comparison of estimators found.

use crate::compare::cells::TrueCells;

/// A comparison of estimators on one sensor.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Title of the scene.
    pub title: String,
    /// Name and hash of the scene file, and its command-line overrides.
    pub scene: String,
    /// The program, its seed and its threads.
    pub program: String,
    /// Name of the sensor on which they are compared.
    pub sensor: String,
    /// Its cells, in all views.
    pub cells: usize,
    /// Dotted name of the measure that is compared.
    pub measure: String,
    /// Its unit.
    pub unit: String,
    /// Its true value.
    pub truth: Truth,
    /// Independent runs of each estimator.
    pub repetitions: u32,
    /// Time limit of a run, s.
    pub run_time: f64,
    /// The estimators in the order of the request.
    pub contestants: Vec<Contestant>,
}

/// The true value of a measure.
#[derive(Debug, Clone, PartialEq)]
pub struct Truth {
    /// In the unit of the measure; not 0.
    pub value: f64,
    /// Standard error, in the same unit.
    pub std_error: f64,
    /// Where it comes from.
    pub origin: String,
    /// The cells of its sensor, if there are several and they are known.
    pub cells: Option<TrueCells>,
}

/// The results of an estimator.
#[derive(Debug, Clone)]
pub struct Contestant {
    /// Its name on the command line.
    pub name: String,
    /// What it is called in tables and plots.
    pub label: String,
    /// Whose method it is.
    pub origin: MethodOrigin,
    /// For each run its sample at each checkpoint, `None` where it had no value yet.
    pub runs: Vec<Vec<Option<CheckpointSample>>>,
    /// Share of the throughput of its gather paths that it cut off, 1.
    pub cut: f64,
}

/// Whose method an estimator is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MethodOrigin {
    /// This program's.
    Own,
    /// Well known: a rival.
    Literature,
}

/// The state of a run at a checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CheckpointSample {
    /// Time spent, s.
    pub seconds: f64,
    /// Segments traced: the work, independent of any clock.
    pub segments: u64,
    /// The value, in the unit of the measure.
    pub value: f64,
    /// Its error per cell, 1; `None` where the cells of the truth are not known.
    pub cell_error: Option<f64>,
}
