//! What is traced, and how precisely.

use crate::table::Precision;

/// Set by `cargo xtask validate`: `all`, or every tenth run from a number on, as `3/10`.
const VARIABLE: &str = "LUMIDUCT_VALIDATION";

/// What is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Every run, quickly.
    Quick,
    /// Every run, as precisely as the page has it.
    Page,
    /// Some of these runs: number `first` and every `step`th after it.
    Part { first: usize, step: usize },
}

impl Scope {
    /// What the environment demands.
    pub(crate) fn demanded() -> Self {
        match std::env::var(VARIABLE) {
            Err(_) => Self::Quick,
            Ok(text) if text == "all" => Self::Page,
            Ok(text) => {
                let numbers = text.split_once('/').and_then(|(first, step)| {
                    Some((first.parse().ok()?, step.parse().ok().filter(|step| *step > 0)?))
                });
                let (first, step) = numbers
                    .unwrap_or_else(|| panic!("{VARIABLE} is `{text}`, not `all` or as `3/10`"));
                Self::Part { first, step }
            }
        }
    }

    /// Whether it has a run, by its number in the order of the tables.
    pub(crate) fn has(self, run: usize) -> bool {
        match self {
            Self::Quick | Self::Page => true,
            Self::Part { first, step } => run % step == first % step,
        }
    }

    pub(crate) fn precision(self) -> Precision {
        match self {
            Self::Quick => Precision::Quick,
            Self::Page | Self::Part { .. } => Precision::Page,
        }
    }
}
