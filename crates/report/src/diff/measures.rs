//! Whether two values of a measure differ.

use indexmap::IndexMap;
use lumiduct_core::measure::{Measure, Status};

/// Differences below this share of a value are rounding: sums over millions of paths in another
/// order, or on another machine. The flux balance closes to the same.
const ROUNDING: f64 = 1e-9;
/// Where nothing was counted, the flux of up to three paths may have been missed, with 95 %
/// confidence: see [`Status::NoSignal`].
const PATHS_MISSED: f64 = 3.0;

/// Limits beyond which two values differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// A difference counts beyond this many of its errors.
    pub sigmas: f64,
    /// To count, it must also exceed this share of the first value.
    pub relative: Option<f64>,
    /// Whether maps count.
    pub maps: MapLimit,
}

/// What a difference of two maps means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapLimit {
    /// It is only reported.
    Told,
    /// It counts if noise alone would exceed it less than once in a thousand maps, or if the cells
    /// differ.
    Noise,
}

impl Limits {
    /// The limits in words.
    pub(crate) fn words(self) -> String {
        let sigmas = self.sigmas;
        self.relative.map_or(format!("{sigmas} sigmas"), |share| {
            // Undoes the rounding of the conversion from percent.
            let percent = (1e11 * share).round() / 1e9;
            format!("{sigmas} sigmas and {percent} %")
        })
    }
}

/// How two values of a measure compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Judgement {
    /// Equal within the errors.
    Within,
    /// Different, but by too little to matter.
    Tolerated,
    /// Different.
    Beyond,
    /// Unknown: the value or the error of one of them is unreliable.
    Unknown,
}

/// A measure on both sides.
#[derive(Debug)]
pub(crate) struct Pair {
    /// Its name, with its design.
    pub(crate) name: String,
    /// Its dotted name.
    pub(crate) measure: String,
    /// Its values on both sides.
    pub(crate) values: [Measure; 2],
    /// The value that sets its rounding, in its unit: the greater of its own, except for a sum that
    /// should vanish.
    pub(crate) scale: f64,
}

/// Two values of a measure.
#[derive(Debug, Clone, PartialEq)]
pub struct DiffRow {
    /// Its name, with its design.
    pub name: String,
    /// The values of both reports.
    pub values: [Measure; 2],
    /// Second value less the first, in the unit of the measure.
    pub difference: f64,
    /// Error of the difference, in the unit of the measure: standard errors, biases and rounding of both.
    pub error: f64,
    /// The difference over its error, 1.
    pub sigmas: f64,
    /// Whether the error exceeds rounding.
    pub is_noisy: bool,
    /// Whether they differ.
    pub judgement: Judgement,
    /// Why that is unknown, if it is.
    pub doubt: Option<String>,
}

impl DiffRow {
    /// Dotted name of the measure, without its design.
    pub(crate) fn measure(&self) -> &str {
        self.name.rsplit(": ").next().unwrap_or(&self.name)
    }

    /// The difference as a share of the first value, 1; `None` where that is zero.
    pub(crate) fn relative(&self) -> Option<f64> {
        let [a, _] = &self.values;
        (a.value != 0.0 && a.value.is_finite()).then(|| self.difference / a.value.abs())
    }
}

/// The value that sets the rounding of a measure, in its unit. The residual of the balance is pure
/// rounding of the emitted flux.
pub(crate) fn scale(name: &str, sides: [&IndexMap<String, Measure>; 2]) -> f64 {
    let whole = if name == "balance.residual" { "balance.emitted" } else { name };
    let values = sides.iter().flat_map(|side| [side.get(name), side.get(whole)]);
    values.flatten().map(|measure| measure.value.abs()).fold(0.0, f64::max)
}

/// Judges two values.
pub(crate) fn judge(pair: Pair, limits: Limits) -> DiffRow {
    let Pair { name, values, scale, .. } = pair;
    let [a, b] = &values;
    // Two infinite values are equal.
    let difference = if a.value == b.value { 0.0 } else { b.value - a.value };
    let noise = error(a).hypot(error(b));
    let rounding = ROUNDING * scale;
    let error = noise.hypot(rounding);
    // Equal values agree, whatever their errors.
    let sigmas = if difference == 0.0 { 0.0 } else { difference / error };
    let doubt = if difference == 0.0 && a == b { None } else { doubt(&values) };
    let is_large = limits.relative.is_none_or(|share| difference.abs() > share * a.value.abs());
    let judgement = match (doubt.is_some(), sigmas.abs() > limits.sigmas) {
        (true, _) => Judgement::Unknown,
        (false, false) => Judgement::Within,
        (false, true) if is_large => Judgement::Beyond,
        (false, true) => Judgement::Tolerated,
    };
    let is_noisy = noise > rounding;
    DiffRow { name, values, difference, error, sigmas, is_noisy, judgement, doubt }
}

/// The error of a value, in its unit.
fn error(measure: &Measure) -> f64 {
    match measure.status {
        Status::NoSignal => PATHS_MISSED * measure.total_error(),
        Status::Ok
        | Status::TooFew
        | Status::NoiseLimited
        | Status::Undefined
        | Status::BiasInNoise
        | Status::BiasNotResolved
        | Status::Contradicted => measure.total_error(),
    }
}

/// Why two values cannot be compared.
fn doubt(values: &[Measure; 2]) -> Option<String> {
    let [a, b] = values;
    if a.unit != b.unit {
        return Some(format!("is in {} and in {}", a.unit, b.unit));
    }
    [("A", a), ("B", b)].into_iter().find_map(|(side, measure)| {
        let why = match measure.status {
            Status::TooFew => "has too few counts",
            Status::NoiseLimited => "is mostly noise",
            Status::Undefined => "is not defined for the light",
            Status::BiasNotResolved => "has a bias that is not resolved",
            Status::Contradicted => "is contradicted by photons of the same run",
            Status::Ok | Status::NoSignal | Status::BiasInNoise => {
                let is_known = measure.value.is_finite() && measure.total_error().is_finite();
                return (!is_known).then(|| format!("has no known value or error in {side}"));
            }
        };
        Some(format!("{why} in {side}"))
    })
}

/// Sorts the worst first, unjudged ones last. Ties keep the order of the measures.
pub(crate) fn sort(rows: &mut [DiffRow]) {
    let rank = |row: &DiffRow| match row.judgement {
        Judgement::Beyond => 0,
        Judgement::Within | Judgement::Tolerated => 1,
        Judgement::Unknown => 2,
    };
    rows.sort_by(|a, b| {
        let sigmas = || b.sigmas.abs().total_cmp(&a.sigmas.abs());
        let both_known = rank(a).max(rank(b)) < 2;
        let ranks = rank(a).cmp(&rank(b));
        if both_known { ranks.then_with(sigmas) } else { ranks }
    });
}
