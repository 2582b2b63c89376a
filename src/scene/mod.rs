//! What is in the room.
mod ray;
pub mod shape;
pub use ray::Ray;
