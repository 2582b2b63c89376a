//! The methods that can be compared, and what each of them cannot do.

use lumiduct_baselines::Baseline;
use lumiduct_core::plan::{Estimator, Request};
use lumiduct_report::MethodOrigin;

/// What can be compared: the estimators of this program and baselines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// An estimator.
    Run(Request),
    /// A baseline.
    Baseline(Baseline),
}

impl Method {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        Request::ALL.map(Self::Run).into_iter().chain(Baseline::ALL.map(Self::Baseline))
    }

    /// Its name on the command line and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Run(request) => request.name(),
            Self::Baseline(baseline) => baseline.name(),
        }
    }

    /// What it is called in tables and plots: gather paths that are joined to sources are known by another name.
    pub(super) fn label(self) -> String {
        match self {
            Self::Run(Request::Backward) => format!("{} (path tracing)", self.name()),
            Self::Run(
                Request::Auto | Request::Forward | Request::Mix | Request::Gather | Request::Mis,
            )
            | Self::Baseline(_) => self.name().to_owned(),
        }
    }

    /// Whose method it is.
    pub(super) fn origin(self) -> MethodOrigin {
        match self {
            Self::Run(Request::Forward | Request::Backward) | Self::Baseline(_) => {
                MethodOrigin::Literature
            }
            Self::Run(Request::Auto | Request::Mix | Request::Gather | Request::Mis) => {
                MethodOrigin::Own
            }
        }
    }

    /// The method of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().find(|method| method.name() == name)
    }

    /// Whether it can distinguish the first passage of a path through a sensor from later ones.
    pub(super) fn knows_first_passages(self) -> bool {
        match self {
            Self::Run(request) => !request.estimator().is_some_and(Estimator::has_records),
            Self::Baseline(Baseline::Metropolis) => true,
            Self::Baseline(Baseline::Sppm | Baseline::Whitted) => false,
        }
    }

    /// Whether its gather paths must hit the sources.
    pub(super) fn meets_sources(self) -> bool {
        match self {
            Self::Run(request) => request.estimator().is_some_and(Estimator::must_meet_sources),
            Self::Baseline(Baseline::Sppm | Baseline::Whitted | Baseline::Metropolis) => true,
        }
    }
}
