//! Paths: the one bounce loop, its events, and gather paths with the sources they meet.

mod bounce;
pub mod emitters;
mod event;
pub mod follow;
mod jump;
pub(crate) mod path;
pub mod scatter;

pub use bounce::walk;
pub use event::{Carries, Collision, Conversion, Departure, Detection, Jump, Segment};
pub use event::{Emergence, Event, MetEmission, Observer, ROULETTE_BELOW};
pub use event::{Stepping, Unobserved, Vertex};
pub use path::Path;
