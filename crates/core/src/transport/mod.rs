//! Light through a scene: photon paths, the one bounce loop, estimators, and their readings.
//!
//! This layer does not know file formats or reports. Its output is one serialisable value,
//! [`Readings`]. Folders from the bottom up: `stop`, `tally`, `walk`, `forward`, `gather`,
//! `backward`, `choose`, `run`.

mod backward;
mod choose;
pub mod forward;
pub mod gather;
mod run;
pub mod stop;
pub mod tally;
pub mod walk;

pub use choose::{BLIND_PATHS, Choice, Objection, Trial, blind_sensors};
pub use forward::{Track, TrackEnd, tracks};
pub use gather::{GatherSettings, Scatterer, Stage, Window, Windows, scatterers, turbid_media};
pub use run::{Findings, Gathered, Phase, Run, Shard, Slice, State, Unsliceable, batch_paths};
pub use stop::{Activity, FIRST_BATCH_GRACE, Interrupt, StopAnswer, StopSignal};
pub use tally::readings::{
    ClassSum, DEPTH_BINS, GROUPS, Group, Leak, Readings, SensorReading, Step, Trail,
};
pub use tally::{Cells, Layout, Loss, TAILS};
pub use walk::emitters::invisible;
pub use walk::{
    Carries, Collision, Departure, Detection, Emergence, Event, MetEmission, Observer, Path,
    ROULETTE_BELOW, Segment, Unobserved, Vertex, WAVELENGTH, walk,
};
