//! Paths: the one bounce loop, what happens on it, and gather paths with what they see of the sources.

mod bounce;
pub mod emitters;
mod event;
pub mod follow;
mod path;
pub mod scatter;

pub use bounce::walk;
pub use event::{Carries, Collision, Departure, Event, ROULETTE_BELOW, Segment, Vertex, Visitor};
pub use path::{Path, WAVELENGTH};
