//! Rows of bounces taken at once change no light of a scene.

use crate::traced::measures;
use crate::{BOUNCES, FEW_PATHS, Scenes, is_flux, load, shipped};
use lumiduct_core::measure;
use lumiduct_core::plan::{GatherPlan, Request};
use lumiduct_core::transport::forward::Forward;
use lumiduct_core::transport::stop::{Pace, StopSignal};
use lumiduct_core::transport::{Event, Findings, Observer, Path as LightPath};
use lumiduct_input::{self as input, Job, Settings};
use std::ops::ControlFlow;
use std::path::PathBuf;

/// Looks at nothing, and ends no path by roulette.
struct Onlooker {
    allows_jumps: bool,
}

impl Observer for Onlooker {
    fn roulette_below(&self) -> f64 {
        0.0
    }

    fn allows_jumps(&self) -> bool {
        self.allows_jumps
    }

    fn see(&mut self, _: &LightPath, _: Event<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Compares the light of a scene with and without rows: the segments saved.
fn saved_without_change(what: &str, job: &Job) -> u64 {
    let forward = Forward::new(&job.scene, 1, BOUNCES, 512);
    let signal = StopSignal::default();
    let found = |allows_jumps| {
        let pace = Pace::new(&signal);
        let batches = (0..4).map(|batch| {
            forward.batch_observed(batch, &mut Onlooker { allows_jumps }, &pace).unwrap()
        });
        let readings = batches.reduce(|sum, next| sum.merge(&next)).unwrap();
        measure::measure(&job.scene, &Findings::forward(readings))
    };
    let (stepped, jumped) = (found(false), found(true));
    let room = FEW_PATHS / (4.0 * 512.0) * job.scene.source_flux();
    for (name, measure) in stepped.values.iter().filter(|(_, own)| is_flux(&own.unit)) {
        let other = &jumped.values[name.as_str()];
        let off = (measure.value - other.value).abs();
        assert!(off <= room, "{what}: {name} {measure} {other}");
    }
    for (own, other) in stepped.sensor_paths.iter().zip(&jumped.sensor_paths) {
        // One path in eight has a class.
        let flux = stepped.values[&format!("{}.flux", own.sensor)].value;
        let room = 8.0 * room / flux;
        for class in own.classes.iter().filter(|class| class.share > room) {
            let same = other
                .classes
                .iter()
                .find(|one| (&one.steps, one.extent) == (&class.steps, class.extent));
            let off = same.map(|one| (one.share - class.share).abs());
            assert!(off.is_some_and(|off| off <= room), "{what}: {class:?} {same:?}");
        }
    }
    stepped.segments - jumped.segments
}

#[test]
fn rows_of_bounces_taken_at_once_change_no_light_of_a_shipped_scene() {
    let saved_in =
        |path: PathBuf| saved_without_change(&path.display().to_string(), &load(&path, &[]));
    let saved: u64 = shipped().into_iter().map(saved_in).sum();
    assert!(saved > 100_000, "{saved} segments");
}

/// A tube with holes and black dots along all of it, and a rod over a polygon.
const PATTERNS_AND_POLYGON: &str = r#"
[finishes]
mirror = { specular = { reflectance = 0.97 } }
[sheets.duct.tube]
profile = { circle = { radius_mm = 3 } }
path = [{ straight_mm = 60 }, { straight_mm = 70 }]
finish = "mirror"
[patterns.holes]
on = "duct.wall"
finish = "open"
element = { circle = { diameter_mm = 2 } }
layout = { row = { pitch_mm = 10, along_mm = [5, 120], around_deg = 350 } }
wall_mm = 0.2
[patterns.dots]
on = "duct.wall"
finish = "black"
element = { rectangle = { width_mm = 1, length_mm = 1 } }
layout = { row = { pitch_mm = 7, along_mm = [64, 125], around_deg = 100 } }
[media.glass]
index = 1.5
[solids.rod.sweep]
profile = { polygon = { points_mm = [[20, 0], [24, 1], [24, 4], [21, 5]] } }
path = [{ straight_mm = 80 }]
medium = "glass"
[sources.lamp.disk]
radius_mm = 2.5
flux_lm = 1
at = { position_mm = [0, 0, 0.1] }
[sources.led.disk]
radius_mm = 1
flux_lm = 1
at = { position_mm = [22, 2.5, -0.1] }
[sensors]
holes = { plane = { cells = [1, 6] }, on = "duct.wall", counts = "leaving", side = "front" }
shadow = { plane = {}, on = "duct.wall", counts = "incident", side = "front" }
exit = { plane = {}, on = "duct.exit", counts = "incident" }
end = { plane = {}, on = "rod.exit", counts = "leaving" }
"#;

#[test]
fn rows_end_at_the_elements_of_patterns() {
    let saved =
        saved_without_change("holes and polygon", &Scenes::new().load(PATTERNS_AND_POLYGON));
    assert!(saved > 10_000, "{saved} segments");
}

/// A plate with a mirrored end, seen through the other. A path from the mirror takes rows along one edge, and from the sides
/// along another.
const PLATE: &str = r#"
[finishes.end]
specular = { reflectance = 0.95 }
[media.glass]
index = 1.5
[solids.plate.box]
size_mm = [50, 3, 100]
medium = "glass"
faces = { exit = "end" }
[sources.led.disk]
radius_mm = 1.4
at = { position_mm = [0, 0, -0.1] }
flux_lm = 100
emission = { cone_half_angle_deg = 40 }
[sensors.cell]
plane = { rectangle = { width_mm = 4, height_mm = 2 } }
at = { position_mm = [12, 0, -3], axis = [0, 0, 1] }
aim = ["plate.entry"]
"#;

/// A sensor whose sphere crosses a guide at some height, so that no row of bounces is taken at once.
fn watch(z: f64, radius: f64) -> String {
    format!(
        r#"
[sensors.watch]
goniometer = {{ c_step_deg = 360, gamma_step_deg = 90, radius_mm = {radius} }}
at = {{ position_mm = [0, 0, {z}], axis = [0, 0, 1] }}
"#
    )
}

/// Compares gathered flux where photons and gather paths jump with the same step by step; returns how many times the segments
/// steps take.
fn assert_same_records_met(text: &str, watch: &str, gather: GatherPlan) -> f64 {
    let files = Scenes::new();
    let found = |more: &str| {
        let copy = files.0.path().join("copy.toml");
        std::fs::write(&copy, text.to_owned() + more).unwrap();
        let settings = Settings {
            overrides: vec!["sensors.cell.estimator=gather".into()],
            paths: Some(64_000),
            estimator: Some(Request::Forward),
            gather,
            ..Settings::default()
        };
        measures(&input::load(&copy, &settings).unwrap())
    };
    let (jumped, stepped) = (found(""), found(watch));
    let [own, other] = [&jumped, &stepped].map(|all| &all.values["cell.flux"]);
    for (own, other) in [(own.value, other.value), (own.std_error, other.std_error)] {
        assert!(own > 0.0 && (own / other - 1.0).abs() < 1e-6, "{own} {other}");
    }
    stepped.segments as f64 / jumped.segments as f64
}

#[test]
fn photons_and_gather_paths_that_jump_meet_the_same_records() {
    let gather = |depth, radius_mm, angle_deg| GatherPlan {
        depth: Some(depth),
        radius_mm: Some(radius_mm),
        angle_deg: Some(angle_deg),
        records: Some(3000),
        photons: Some(3000),
        ..GatherPlan::default()
    };
    for scene in ["remote_cell_sun", "remote_cell_rod"] {
        let path = PathBuf::from("scenes").join(scene).with_extension("toml");
        let text = std::fs::read_to_string(&path).unwrap();
        let saved = assert_same_records_met(&text, &watch(10.0, 15.0), gather(5, 1.5, 0.2));
        assert!(saved > 1.5, "{scene}: {saved}");
    }
    let plate = format!("lumiduct = 1\ntitle = \"Plate\"\n{PLATE}");
    let saved = assert_same_records_met(&plate, &watch(50.0, 24.0), gather(12, 0.9, 4.0));
    assert!(saved > 1.05, "plate: {saved}");
}
