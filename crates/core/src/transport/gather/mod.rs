//! The gather estimator: records at the ends of gather paths, and photons that are streamed past them.

mod account;
mod ball;
mod bias;
mod block;
mod collect;
pub mod contribution;
mod coverage;
mod cut_cone;
pub(crate) mod estimator;
mod filter;
pub mod index;
pub mod kernel;
pub(crate) mod merged;
mod pass;
pub mod records;
pub mod settings;
mod shares;
mod sounding;
pub(crate) mod stages;
pub(crate) mod stream;
pub mod surfaces;
pub(crate) mod trial;
mod watched;

pub(crate) use account::account;
pub(crate) use bias::estimate;
pub use settings::GatherSettings;
pub use stages::Orders;
pub(crate) use trial::trial;
