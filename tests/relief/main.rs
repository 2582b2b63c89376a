//! Reliefs on walls of solids: their geometry, their effect on light, and that no light is lost
//! between a wall and its elements.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]
#![allow(clippy::print_stdout, reason = "figures, shown by --nocapture and on failure")]

mod geometry;
mod light;
#[path = "../traced/mod.rs"]
mod traced;

use lumiduct_core::plan::Request;
use lumiduct_input::{Job, Settings};

/// A scene from its text without the head, for this many photons.
fn load(text: &str, paths: u64) -> Job {
    let estimator = Some(Request::Forward);
    traced::load(text, &Settings { paths: Some(paths), estimator, ..Settings::default() })
}

/// An arbitrary lamp and sensor, which every scene needs.
const LAMP: &str = r#"
[sources.lamp.disk]
radius_mm = 0.1
flux_lm = 1
at = { position_mm = [0, 0, -50] }
[sensors]
out = { plane = { rectangle = { width_mm = 1, height_mm = 1 } }, at = { position_mm = [0, 0, 150] } }
"#;

/// A plate of 12 x 4 x 30 mm from z = 0, and a rod of radius 3 mm, length 30 mm, away from the
/// coordinate axes.
const BODIES: &str = r#"
[media.glass]
index = 1.5
[solids.plate.box]
size_mm = [12, 4, 30]
medium = "glass"
[solids.rod.cylinder]
radius_mm = 3
length_mm = 30
medium = "glass"
at = { position_mm = [40, 0, 0] }
"#;
