//! Counts: cells, colour, scalars by their layout, losses, and sums over batches.

mod adjusted;
pub(crate) mod cell_stimuli;
mod cells;
pub(crate) mod colour;
pub(crate) mod controls;
mod counts;
mod layout;
pub mod readings;
pub mod sensor_reading;
pub mod sums;
pub(crate) mod work;

pub use cells::Cells;
pub use counts::Stage;
pub(crate) use counts::merged;
pub use counts::{Counts, Series};
pub use layout::Layout;
pub(crate) use layout::{CONTROLS, Loss, TAILS};
