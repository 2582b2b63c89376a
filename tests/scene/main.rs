//! Properties of a scene other than light paths: axes, cuts and outlines.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod axes;
mod charts;
mod guides;
mod outlines;
