//! Forward, backward and gathered values agree, in scenes with one feature each: every finish,
//! source, sensor and kind of guide, rims and corners, known fields, and known biases.
//!
//! Forward is the reference: it shares neither adjoints nor windows with the others. Seeds are
//! fixed.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]
#![allow(
    clippy::print_stdout,
    reason = "a line for each value, shown by --nocapture and on failure"
)]

mod calibration;
mod colour;
mod connections;
mod consistency;
mod daylight;
mod finishes;
mod furnace;
mod guides;
mod laws;
mod merge;
mod mix;
mod passages;
mod patterns;
mod reliefs;
mod rims;
mod sensors;
mod settings;
mod sources;
mod techniques;
#[path = "../traced/mod.rs"]
mod traced;
mod trial;
mod volumes;
