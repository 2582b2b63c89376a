//! What is in the room.
mod ray;
pub mod shape;
pub mod sweep;
pub use ray::Ray;
