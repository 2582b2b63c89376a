//! What a few photon paths show before a run: how long paths are, and how fast the machine is.

/// Segments of photon paths in an automatic pass of gathering where the length of the run is not known.
pub(crate) const PASS_SEGMENTS: f64 = 1e6;

/// Measurements by pilot photons.
#[derive(Debug, Clone, Copy)]
pub struct PhotonPilot {
    /// Mean number of segments of a photon path, where rows of mirror bounces are taken at once.
    pub(crate) segments_per_path: f64,
    /// The same step by step.
    pub(crate) steps_per_path: f64,
    /// Segments of photon paths in an automatic pass of gathering.
    pub(crate) pass_segments: f64,
    /// Work of an automatic pass of gathering where the time of the run is limited, ns.
    pub(crate) pass_work: Option<f64>,
    /// Work of this machine in a second over that of the reference machine, by the clock; 1 where no time is limited.
    pub(crate) speed: f64,
}

impl PhotonPilot {
    /// Photons with this many segments per path, or steps, in passes of the usual size.
    pub fn new(segments_per_path: f64, steps_per_path: f64) -> Self {
        let pass_segments = PASS_SEGMENTS;
        Self { segments_per_path, steps_per_path, pass_segments, pass_work: None, speed: 1.0 }
    }

    /// The same where photons go step by step.
    pub(crate) fn step_by_step(self) -> Self {
        Self { segments_per_path: self.steps_per_path, ..self }
    }
}
