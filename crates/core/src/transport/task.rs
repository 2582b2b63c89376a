//! One batch of work, as every estimator gets it.

use crate::transport::stop::Pace;

/// A batch to be traced.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Task<'a> {
    /// Number of the batch.
    pub(crate) batch: u64,
    /// Number of the estimator's stage.
    pub(crate) stage: u32,
    /// Flux of one photon of each source, lm or W; 0 for dark ones.
    pub(crate) photon_fluxes: &'a [f64],
    /// Stops the paths.
    pub(crate) pace: &'a Pace<'a>,
}
