//! What is in the room.
pub mod mesh;
mod ray;
pub mod shape;
pub use ray::Ray;
