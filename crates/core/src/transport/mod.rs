//! Light through a scene: photon paths, the one bounce loop, estimators, and their readings.
//!
//! This layer does not know file formats or reports. Its output is one serialisable value,
//! [`Findings`]. From the bottom up: `stop`, `tally`, `walk`; `task`, `trial` and `estimate`, what
//! every estimator gets and gives; `forward`, `gather` and `backward`; `estimators`, the one seam in
//! front of them; `choose`, `run`.

mod backward;
mod choose;
mod estimate;
mod estimators;
pub mod forward;
pub mod gather;
mod run;
pub mod stop;
pub mod tally;
mod task;
mod trial;
pub mod walk;

pub use choose::{BLIND_PATHS, EstimatorChoice, blind_sensors};
pub use estimate::{Account, AccountEntry, Bias, Estimate, Resolution};
pub use estimators::EstimatorFindings;
pub use forward::{Track, TrackEnd, tracks};
pub use gather::{GatherSettings, Scatterer, Window, Windows, scatterers, turbid_media};
pub use run::{Findings, Phase, Run, RunState, Shard, Slice, Unsliceable, batch_paths};
pub use stop::{Activity, FIRST_BATCH_GRACE, Interrupt, StopAnswer, StopSignal};
pub use tally::readings::{
    ClassStep, ClassSum, DEPTH_BINS, GROUPS, Group, Leak, MIN_LIT_GROUPS, Readings, SensorReading,
    Trail,
};
pub use tally::{Cells, Counts, Layout, Loss, Stage, TAILS};
pub use trial::{Objection, PhotonPilot, Trial};
pub use walk::emitters::invisible;
pub use walk::{
    Carries, Collision, Departure, Detection, Emergence, Event, MetEmission, Observer, Path,
    ROULETTE_BELOW, Segment, Unobserved, Vertex, WAVELENGTH, walk,
};
