//! From the text of a scene to the measures of its run.

#![allow(dead_code, reason = "not every test needs both")]

use lumiduct_core::measure::{self, Measures};
use lumiduct_core::transport::Run;
use lumiduct_input::{self as input, Job, Settings};

/// A scene from its text without the head.
pub(crate) fn load(text: &str, settings: &Settings) -> Job {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("scene.toml");
    std::fs::write(&path, format!("lumiduct = 1\ntitle = \"Test\"\n{text}")).unwrap();
    input::load(&path, settings).unwrap_or_else(|error| panic!("{error}"))
}

/// The measures of a whole run.
pub(crate) fn measures(job: &Job) -> Measures {
    let mut run = Run::new(&job.scene, &job.run);
    while !run.is_complete() {
        run.next_wave();
    }
    measure::measure(&job.scene, &run.findings())
}
