//! What is known of a scene besides the way of light through it: axes, cuts and outlines.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod axes;
mod guides;
mod outlines;
