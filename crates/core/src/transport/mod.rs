//! Light through a scene: photon paths, the one bounce loop, estimators, and their readings.
//!
//! This layer does not know file formats or reports. Its output is one serialisable value,
//! [`Findings`]. From the bottom up: `tally`, `stop`, `walk`; `photon_pilot`; `batches`; `task`, `trial` and `estimate`,
//! what every estimator gets and gives; `window`; `connect`; `abilities`; `forward`, `backward` and `gather`; `estimators`, the
//! one seam in front of them; `choose`, `run`.

mod abilities;
mod backward;
mod batches;
mod choose;
pub(crate) mod connect;
mod estimate;
pub(crate) mod estimators;
pub mod forward;
pub mod gather;
mod photon_pilot;
mod run;
pub mod stop;
pub mod tally;
mod task;
mod trial;
pub mod walk;
mod window;

pub use choose::{BLIND_PATHS, EstimatorChoice, blind_sensors};
pub use connect::vertex::turbid_media;
pub use connect::weights::{Sharing, Technique};
pub(crate) use estimate::Estimate;
pub use estimate::Resolution;
pub use estimate::{Account, AccountEntry, Bias};
pub use forward::{CountedRay, RayCollection, Track, TrackEnd, counted_rays, tracks};
pub use gather::{GatherSettings, Orders};
pub use photon_pilot::PhotonPilot;
pub use run::{Findings, Phase, Run, RunState, Shard, Slice, Unsliceable, batch_paths};
pub use stop::{Activity, FIRST_BATCH_GRACE, Interrupt, StopAnswer, StopSignal};
pub use tally::Stage;
pub(crate) use tally::cell_stimuli::NoisyStimuli;
pub(crate) use tally::colour::{BIN_WIDTH, FIRST_BIN, SPECTRUM_BINS, Stimulus};
pub(crate) use tally::readings::MIN_LIT_GROUPS;
pub use tally::readings::{GROUPS, Group, Leak, Readings};
pub use tally::sensor_reading::ClassSum;
pub(crate) use tally::sensor_reading::Trail;
pub use tally::{Cells, Counts, Layout};
pub(crate) use tally::{Loss, TAILS};
pub use trial::{Objection, Trial};
pub use walk::emitters::invisible;
pub use walk::{Carries, Collision, Conversion, Departure, Detection, Jump, Segment};
pub use walk::{
    Emergence, Event, MetEmission, Observer, Path, ROULETTE_BELOW, Stepping, Unobserved, Vertex,
    walk,
};
pub use window::Window;
