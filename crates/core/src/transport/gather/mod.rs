//! The gather estimator: records at the ends of gather paths, and photons that are streamed past them.

mod ball;
mod collect;
mod coverage;
pub mod estimate;
pub(crate) mod estimator;
pub mod index;
pub(crate) mod merge;
mod merged;
mod pass;
pub mod records;
pub mod settings;
pub(crate) mod stages;
mod stream;
pub mod surfaces;
pub(crate) mod window;

pub use merge::{Scatterer, scatterers, turbid_media};
pub use settings::GatherSettings;
pub use stages::{Stage, Windows};
pub use window::Window;
