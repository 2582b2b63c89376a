//! Light through a scene: photon paths, the one bounce loop, estimators, and the readings they leave.
//!
//! This layer knows no file format and no report. What it produces is one serialisable value, [`Readings`].

mod backward;
mod ball;
mod blind;
mod cells;
mod coverage;
pub mod emitters;
pub mod estimate;
mod findings;
pub mod follow;
pub mod forward;
mod gather;
mod layout;
mod merge;
mod mix;
mod path;
mod pilot;
pub mod readings;
pub mod record_index;
pub mod records;
mod rounds;
pub mod scatter;
pub mod settings;
mod shard;
mod stages;
pub mod stop;
pub mod sums;
mod tracks;
mod walk;
mod watch;
mod window;
mod work;

pub use blind::{BLIND_PATHS, blind_sensors};
pub use cells::Cells;
pub use emitters::invisible;
pub use findings::{Findings, Gathered};
pub use layout::{Layout, Loss, TAILS};
pub use merge::{Scatterer, scatterers, turbid_media};
pub use path::{Path, WAVELENGTH};
pub use pilot::{Choice, Objection, Trial};
pub use readings::{
    ClassSum, DEPTH_BINS, GROUPS, Group, Leak, Readings, SensorReading, Step, Trail,
};
pub use rounds::{Phase, Run, Slice, State, Unsliceable, batch_paths};
pub use settings::GatherSettings;
pub use shard::Shard;
pub use stages::{Stage, Windows};
pub use stop::{Activity, FIRST_BATCH_GRACE, Interrupt, StopAnswer, StopSignal};
pub use tracks::{Track, TrackEnd, tracks};
pub use walk::{
    Carries, Collision, Departure, Event, ROULETTE_BELOW, Segment, Vertex, Visitor, walk,
};
pub use window::Window;
