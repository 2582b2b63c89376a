//! Light through a scene: photon paths, the one bounce loop, estimators, and the readings they leave.
//!
//! This layer knows no file format and no report. What it produces is one serialisable value, [`Readings`].

mod cells;
mod forward;
mod layout;
mod path;
mod readings;
mod rounds;
mod tracks;
mod walk;
mod watch;

pub use cells::Cells;
pub use layout::{Layout, TAILS};
pub use path::{Path, WAVELENGTH};
pub use readings::{
    ClassSum, DEPTH_BINS, GROUPS, Group, Leak, Readings, SensorReading, Step, Trail,
};
pub use rounds::{Interrupt, Run};
pub use tracks::{Track, TrackEnd, tracks};
pub use walk::{Departure, Event, ROULETTE_BELOW, Segment, Vertex, Visitor, walk};
