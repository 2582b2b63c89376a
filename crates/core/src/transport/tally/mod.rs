//! Counts: cells, scalars by their layout, losses, and sums over batches.

mod cells;
mod layout;
pub mod readings;
pub mod sums;
pub(crate) mod work;

pub use cells::Cells;
pub use layout::{Layout, Loss, TAILS};
