//! Runs that are saved and resumed.

use super::*;
use crate::pipeline::checkpoint::Checkpoint;
use lumiduct_core::plan::GatherPlan;

/// The short rod of the tests, with a sensor that can be estimated by photons and gathered.
pub(super) const SCENE: &str = concat!(
    "lumiduct = 1\ntitle = \"rod\"\n",
    include_str!("../../tests/rod.toml"),
    r#"
[sensors.exit]
plane = { disk = { radius_mm = 2 } }
at = { face = "rod.exit", gap_mm = 0.1 }
"#
);

pub(super) fn job(folder: &Path, settings: &Settings) -> Job {
    let scene = folder.join("rod.toml");
    std::fs::write(&scene, SCENE).unwrap();
    prepare(&scene, settings).unwrap()
}

/// Traces a job from a checkpoint, and returns its state at every pause.
fn pauses(job: &Job, checkpoint: Option<Checkpoint>) -> (Traced, Vec<Checkpoint>) {
    let mut saved = Vec::new();
    let mut save = |pause: &Pause<'_>| {
        saved.push(pause.checkpoint());
        Ok(())
    };
    let traced =
        trace_from(job, checkpoint, &mut save, &Interrupt::default(), &mut |_| ()).unwrap();
    (traced, saved)
}

fn resumes_at_every_pause(settings: &Settings, expected: Stop) {
    let folder = tempfile::tempdir().unwrap();
    let job = job(folder.path(), settings);
    let (whole, saved) = pauses(&job, None);
    assert_eq!(whole.stop, expected);
    assert!(saved.len() > 1);
    for (index, checkpoint) in saved.into_iter().enumerate() {
        let (rest, _) = pauses(&job, Some(checkpoint));
        assert_eq!(rest.stop, whole.stop, "from pause {index}");
        assert!(rest.findings == whole.findings, "from pause {index}");
    }
}

#[test]
fn a_run_resumes_at_every_pause_to_the_same_end_the_last_pause_included() {
    let forward = Settings {
        estimator: Some(Request::Forward),
        paths: Some(15_000),
        batch_paths: Some(40),
        ..Settings::default()
    };
    resumes_at_every_pause(&forward, Stop::Paths);
    let gather = Settings {
        estimator: Some(Request::Gather),
        gather: GatherPlan {
            depth: Some(0),
            radius_mm: Some(1.0),
            angle_deg: Some(20.0),
            records: Some(300),
            photons: Some(500),
            schedule: None,
        },
        ..forward
    };
    resumes_at_every_pause(&gather, Stop::Paths);
}

#[test]
fn a_run_to_a_target_resumes_at_every_pause_to_the_same_end() {
    let settings = Settings {
        estimator: Some(Request::Forward),
        target: Some(0.01),
        target_measure: Some("exit.flux".into()),
        batch_paths: Some(50),
        ..Settings::default()
    };
    resumes_at_every_pause(&settings, Stop::Target);
}
