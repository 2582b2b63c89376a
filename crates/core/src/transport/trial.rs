//! Trials of estimators before a run: what each costs, measured on every sensor with the same
//! effort. This module does not draw conclusions.

use crate::plan::{Estimator, RunPlan};
use crate::scene::{Scene, SensorId, SourceId};
use crate::tally::Tally;
use crate::transport::stop::StopSignal;
use crate::transport::{Layout, Readings};
use serde::{Deserialize, Serialize};

/// Batches from which an estimator is judged.
pub(crate) const BATCHES: u64 = 16;
/// The pilot uses random numbers of another seed, so that its paths do not count again in the run.
pub(crate) const SEED: u64 = 0x7069_6c6f_7431;
/// Segments of photon paths in an automatic pass of gathering: seconds of work, so that the
/// first stage ends soon.
pub(crate) const PASS_SEGMENTS: f64 = 4e6;

/// Performance of an estimator in a pilot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The estimator.
    pub estimator: Estimator,
    /// Work × relative variance, in seconds of one thread of the reference machine: divided by the
    /// square of a relative error, it is the time to reach that error. `None` where nothing was
    /// found.
    pub cost: Option<f64>,
    /// Bias over the value, for a biased estimator, 1.
    pub bias: Option<f64>,
    /// Work before there is any result, in seconds of one thread of the reference machine.
    pub least: f64,
    /// What excludes it, whatever it costs.
    pub objection: Option<Objection>,
}

impl Trial {
    /// Seconds of one thread of the reference machine until a relative error is reached, 1; `None` where nothing was found.
    pub fn time(&self, error: f64) -> Option<f64> {
        self.cost.map(|cost| (cost / (error * error)).max(self.least))
    }
}

/// Objections to an estimator.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Objection {
    /// Its bias is above the target, beyond its noise.
    Biased,
    /// Its flux disagrees with an unbiased estimator's; for an unbiased one, it is less than
    /// another's.
    Contradicted,
}

/// The conditions of trials, and the effort.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trials<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) plan: &'a RunPlan,
    pub(crate) photons: PhotonPilot,
    pub(crate) sensors: &'a [SensorId],
    /// Work for each estimator.
    pub(crate) effort: f64,
    /// Stops the trial.
    pub(crate) signal: &'a StopSignal,
}

/// A trial, and the flux it found, batch by batch: in total, and from each source.
#[derive(Debug)]
pub(crate) struct Tried {
    pub(crate) trial: Trial,
    pub(crate) flux: Tally,
    pub(crate) by_source: Vec<Tally>,
    /// For a biased estimator: its bias, batch by batch.
    pub(crate) bias: Option<Tally>,
}

/// Measurements by pilot photons.
#[derive(Debug, Clone, Copy)]
pub struct PhotonPilot {
    /// Mean number of segments of a photon path.
    pub(crate) segments_per_path: f64,
    /// Segments of photon paths in an automatic pass of gathering.
    pub(crate) pass_segments: f64,
    is_limited: bool,
}

impl PhotonPilot {
    /// Photons with this many segments per path, in passes of the usual size.
    pub fn new(segments_per_path: f64) -> Self {
        Self { segments_per_path, pass_segments: PASS_SEGMENTS, is_limited: false }
    }

    /// The same for a run of limited time, with passes of at most this many segments.
    pub(crate) fn with_passes_up_to(self, segments: f64) -> Self {
        Self { pass_segments: self.pass_segments.min(segments), is_limited: true, ..self }
    }

    /// Whether the time of the run is limited.
    pub(crate) fn is_limited(self) -> bool {
        self.is_limited
    }
}

impl Trials<'_> {
    /// Performance of an estimator on each sensor with this much work.
    pub(crate) fn judged(
        &self,
        batches: &[Readings],
        work: f64,
        estimator: Estimator,
    ) -> Vec<Tried> {
        let merged = batches.iter().skip(1).fold(batches[0].clone(), |sum, batch| sum.merge(batch));
        let of_sensor = |&sensor: &SensorId| {
            let variance = relative_variance(self.scene, batches, &merged, sensor);
            let cost = variance.map(|variance| 1e-9 * work * variance);
            let trial = Trial { estimator, cost, bias: None, least: 0.0, objection: None };
            let by_source = sources(self.scene)
                .map(|source| flux_of(self.scene, batches, sensor, std::iter::once(source)));
            let by_source = by_source.collect();
            Tried { trial, flux: flux(self.scene, batches, sensor), by_source, bias: None }
        };
        self.sensors.iter().map(of_sensor).collect()
    }
}

/// Relative variance of the mean over all batches: of the flux, or over cells of Σ σ² / Σ mean². `None` in the dark.
fn relative_variance(
    scene: &Scene,
    batches: &[Readings],
    merged: &Readings,
    sensor: SensorId,
) -> Option<f64> {
    let cells = &merged.sensors[sensor.index()].cells;
    if cells.count() == 1 {
        let flux = flux(scene, batches, sensor);
        return (flux.mean() != 0.0).then(|| (flux.std_error() / flux.mean()).powi(2));
    }
    let (mut variance, mut square) = (0.0, 0.0);
    for cell in 0..cells.count() {
        let (mean, error) = cells.mean(cell, merged.batch_count());
        variance += error * error;
        // Noise adds its own square to that of the mean.
        square += mean * mean - error * error;
    }
    (variance > 0.0).then(|| if square > 0.0 { variance / square } else { 1.0 })
}

/// The flux of a sensor, batch by batch.
pub(crate) fn flux(scene: &Scene, batches: &[Readings], sensor: SensorId) -> Tally {
    flux_of(scene, batches, sensor, sources(scene))
}

/// The flux of some sources.
fn flux_of(
    scene: &Scene,
    batches: &[Readings],
    sensor: SensorId,
    sources: impl Iterator<Item = SourceId> + Clone,
) -> Tally {
    let layout = Layout::new(scene);
    Tally::of(batches.iter().map(|batch| {
        let sums = &batch.groups[0].sums;
        sources.clone().map(|source| sums[layout.sensor_flux(sensor, source)]).sum()
    }))
}

fn sources(scene: &Scene) -> impl Iterator<Item = SourceId> + Clone + use<> {
    (0..scene.sources.len()).map(SourceId::new)
}
