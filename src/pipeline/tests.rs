//! Runs that are saved and resumed, and the stages of runs of known length.

use super::*;
use crate::pipeline::checkpoint::Checkpoint;
use lumiduct_core::plan::GatherPlan;
use lumiduct_core::scene::SensorId;

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

/// Small batches, or passes of 800 paths at first with wide windows, whose bias is soon seen.
pub(super) fn settings(estimator: Request, paths: u64) -> Settings {
    Settings {
        estimator: Some(estimator),
        gather: GatherPlan {
            depth: Some(0),
            radius_mm: Some(1.0),
            angle_deg: Some(20.0),
            records: Some(300),
            photons: Some(500),
            schedule: None,
        },
        paths: Some(paths),
        batch_paths: Some(40),
        ..Settings::default()
    }
}

#[test]
fn a_run_resumes_at_every_pause_to_the_same_end_the_last_pause_included() {
    for estimator in [Request::Forward, Request::Gather] {
        resumes_at_every_pause(&settings(estimator, 15_000), Stop::Paths);
    }
}

#[test]
fn a_stage_begins_only_with_paths_for_ten_passes() {
    let folder = tempfile::tempdir().unwrap();
    let mut later_stages = 0;
    let usual = [10_000, 13_000, 16_000, 20_000, 30_000, 60_000].map(|paths| ([500, 300], paths));
    // Twelve passes are left of the first size, and eight of the second.
    let rounded = [15_300, 16_000, 16_400].map(|paths| ([800, 150], paths));
    for ([photons, records], paths) in usual.into_iter().chain(rounded) {
        let own = settings(Request::Gather, paths);
        let [photons, records] = [photons, records].map(Some);
        let own = Settings { gather: GatherPlan { photons, records, ..own.gather }, ..own };
        let (traced, _) = pauses(&job(folder.path(), &own), None);
        let stages = &traced.findings.of_sensor(SensorId::new(0)).unwrap().stages;
        for stage in stages.iter().filter(|stage| stage.number > 0) {
            let passes = stage.counts.first().batch_count();
            assert!(passes >= 10, "{passes} passes of stage {} of {paths} paths", stage.number);
            later_stages += 1;
        }
    }
    assert!(later_stages > 0);
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
