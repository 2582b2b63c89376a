//! The rules that end a run.

use crate::pipeline::progress::TargetProgress;
use lumiduct_core::measure::Status;
use lumiduct_core::plan::StopRules;

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// All requested paths are traced.
    Paths,
    /// All batches of `run.batches` are traced.
    Batches,
    /// The time is up.
    Time,
    /// The target is met.
    Target,
    /// The noise is well below the target; what remains is a bias that more paths do not reduce.
    Bias,
    /// Nothing of the target's measure was found in very many paths.
    Dark,
    /// The user asked to stop.
    Interrupted,
}

impl Stop {
    /// That of a run whose batches are all traced.
    pub(super) fn complete(rules: &StopRules) -> Self {
        if rules.batches.is_some() { Self::Batches } else { Self::Paths }
    }

    /// A sentence for the report, without times, as reports do not depend on the clock.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Paths => "all requested paths were traced",
            Self::Batches => "all batches of `run.batches` were traced",
            Self::Time => "the time limit was reached",
            Self::Target => "the target error was reached",
            Self::Bias => {
                "more paths would not help: the target error is below the bias of the measure"
            }
            Self::Dark => "more paths would hardly help: the target's measure is still zero",
            Self::Interrupted => "interrupted: this report is partial",
        }
    }
}

/// A run gives up on a target that its bias prevents once the noise is this share of the wanted
/// error, 1.
const NOISE_DONE: f64 = 0.3;
/// Paths after which a run to a target gives up on a measure that is still zero.
const DARK_PATHS: u64 = 200_000_000;

/// Whether the target ends a run of this many paths, and why.
pub(super) fn by_target(target: &TargetProgress, paths: u64) -> Option<Stop> {
    let (reached, wanted) = (&target.reached, target.wanted);
    // An error estimated from so few passes may be far too small.
    if reached.status == Status::TooFew {
        return None;
    }
    if reached.relative_error() <= wanted {
        return Some(Stop::Target);
    }
    let noise_done = NOISE_DONE * wanted * reached.value.abs();
    if reached.value != 0.0 && reached.std_error <= noise_done {
        return Some(Stop::Bias);
    }
    (reached.value == 0.0 && paths >= DARK_PATHS).then_some(Stop::Dark)
}

/// Whether less bias reduces the error of the target more than more paths would.
pub(super) fn is_limited_by_bias(target: &TargetProgress) -> bool {
    let reached = &target.reached;
    reached.status == Status::BiasNotResolved
        || reached.bias.is_some_and(|bias| bias > reached.std_error)
}
