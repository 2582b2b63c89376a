//! What is handed to the user: pictures and text.

pub mod number;
pub mod png;
