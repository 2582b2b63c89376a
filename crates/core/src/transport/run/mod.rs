//! A run: batches in waves, its state, slices and shards, and its findings.

mod findings;
mod prepare;
mod rounds;
mod shard;
mod slices;
mod state;

pub use findings::Findings;
pub use prepare::batch_paths;
pub use rounds::{Phase, Run};
pub use shard::Shard;
pub use slices::{Slice, Unsliceable};
pub use state::RunState;
