//! Invariances: results do not depend on the unit and the place of a scene, the skew of a ray is
//! conserved over bounces, and so is the sum of all light in any scene.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking, and so do its helpers")]

mod jumps;
mod traced;

use lumiduct_core::measure::{self, Measures};
use lumiduct_core::plan::Request;
use lumiduct_core::rng::Sampler;
use lumiduct_core::scene::{DrawnWavelength, SourceId};
use lumiduct_core::transport::{Event, Path as LightPath, Run, walk};
use lumiduct_input::{self as input, Job, Settings};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use traced::measures;

/// Paths of a run: a single path that diverges shows as 1e-5 of the flux.
const PATHS: u64 = 100_000;
/// Curved walls spread rounding by a factor at every bounce, so the last digit diverts one of the
/// longest paths now and then: this is the largest share of them. Noise alone would be some
/// hundreds of paths.
const ASTRAY: f64 = 5e-5;
/// Paths that rounding may send elsewhere, in a comparison of a few thousand.
const FEW_PATHS: f64 = 2.0;
/// Most bounces where paths with rows of bounces are compared with the same step by step.
const BOUNCES: u32 = 300;
/// Segments over all shipped scenes, none of which may leak, and those of a scene with a mesh,
/// which takes ten times as long per segment.
const SEGMENTS: u64 = 100_000_000;
const MESH_SEGMENTS: u64 = 5_000_000;

/// A folder of scenes that is removed after the test.
struct Scenes(tempfile::TempDir);

impl Scenes {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// Loads a scene that lacks its head.
    fn load(&self, text: &str) -> Job {
        let path = self.0.path().join("scene.toml");
        std::fs::write(&path, format!("lumiduct = 1\ntitle = \"Invariance\"\n{text}")).unwrap();
        load(&path, &[])
    }
}

fn load(path: &Path, overrides: &[&str]) -> Job {
    let overrides = overrides.iter().map(|one| (*one).to_owned()).collect();
    // Photons reach all parts of a scene.
    let estimator = Some(Request::Forward);
    let settings = Settings { overrides, paths: Some(PATHS), estimator, ..Settings::default() };
    match input::load(path, &settings) {
        Ok(job) => job,
        Err(error) => panic!("{}: {error}", path.display()),
    }
}

/// Fluxes and lines of the balance are the same, whatever the size of the scene.
fn assert_same(what: &str, expected: &Measures, found: &Measures) {
    let mut compared = 0;
    for (name, measure) in expected.values.iter().filter(|(_, measure)| measure.unit == "lm") {
        let other = &found.values[name.as_str()];
        let off = (measure.value - other.value).abs();
        assert!(off <= ASTRAY, "{what}: {name} {measure} {other}, off by {off:e}");
        compared += 1;
    }
    assert!(compared > 10, "{what}: only {compared} measures");
    assert!(found.values["exit.flux"].value > 0.1, "{what}: the exit is dark");
}

/// A position `z` mm along the axis of a scene with its lengths times `scale`, at `place` (mm).
fn along(scale: f64, place: [f64; 3], z: f64) -> String {
    format!("[{}, {}, {}]", place[0], place[1], place[2] + z * scale)
}

/// A bent, tapered rod that absorbs, behind a lens, with its lengths times `scale` and at `place` (mm).
fn rod(scale: f64, place: [f64; 3]) -> String {
    let at = |z: f64| along(scale, place, z);
    format!(
        r#"
[media]
pmma = {{ index = 1.49, absorption_per_mm = {absorption} }}

[solids.lens.lens]
diameter_mm = {diameter}
thickness_mm = {thickness}
entry = {{ convex_radius_mm = {curvature} }}
medium = "pmma"
at = {{ position_mm = {lens} }}

[solids.rod.sweep]
profile = {{ circle = {{ radius_mm = {radius} }} }}
path = [{{ straight_mm = {leg}, end_scale = 0.8 }}, {{ bend_deg = 70, radius_mm = {bend} }}, {{ straight_mm = {leg} }}]
medium = "pmma"
at = {{ position_mm = {start} }}

[sources.led.disk]
radius_mm = {led}
at = {{ position_mm = {source} }}
flux_lm = 1

[sensors]
exit = {{ plane = {{ cells = [4, 4] }}, on = "rod.exit", counts = "leaving" }}
"#,
        absorption = 0.001 / scale,
        diameter = 4.0 * scale,
        thickness = 1.2 * scale,
        curvature = 3.0 * scale,
        radius = 1.5 * scale,
        leg = 10.0 * scale,
        bend = 8.0 * scale,
        led = 0.5 * scale,
        source = at(-1.0),
        lens = at(0.0),
        start = at(1.5),
    )
}

/// A hexagonal mirror duct with a corner and a rough end plate, likewise.
fn duct(scale: f64, place: [f64; 3]) -> String {
    let at = |z: f64| along(scale, place, z);
    format!(
        r#"
[finishes]
mirror = {{ specular = {{ reflectance = 0.95 }} }}
rough = {{ gaussian = {{ sigma_deg = 5, reflectance = 0.4, transmittance = 0.5 }} }}

[sheets.duct.tube]
profile = {{ regular_polygon = {{ sides = 6, across_flats_mm = {flats} }} }}
path = [{{ straight_mm = {leg} }}, {{ corner_deg = 60 }}, {{ straight_mm = {leg} }}]
finish = "mirror"
at = {{ position_mm = {start} }}

[sheets.plate.disk]
radius_mm = {plate}
finish = "rough"
at = {{ position_mm = {middle} }}

[sources.led.rectangle]
width_mm = {led}
height_mm = {led}
at = {{ position_mm = {start} }}
flux_lm = 1

[sensors]
exit = {{ plane = {{ cells = [4, 4] }}, on = "duct.exit", counts = "leaving" }}
"#,
        flats = 10.0 * scale,
        leg = 20.0 * scale,
        plate = 3.0 * scale,
        led = 5.0 * scale,
        start = at(0.0),
        middle = at(8.0),
    )
}

#[test]
fn answers_do_not_depend_on_the_size_of_a_scene() {
    let scenes = Scenes::new();
    for scene in [rod, duct] {
        let expected = measures(&scenes.load(&scene(1.0, [0.0; 3])));
        for scale in [1e3, 1e-3, 25.4] {
            let found = measures(&scenes.load(&scene(scale, [0.0; 3])));
            assert_same(&format!("{scale} times"), &expected, &found);
        }
    }
}

#[test]
fn answers_do_not_depend_on_the_place_of_a_scene() {
    let scenes = Scenes::new();
    for scene in [rod, duct] {
        let expected = measures(&scenes.load(&scene(1.0, [0.0; 3])));
        for place in [[10_000.0, -10_000.0, 10_000.0], [1234.567, 0.0, -9876.543]] {
            let found = measures(&scenes.load(&scene(1.0, place)));
            assert_same(&format!("at {place:?}"), &expected, &found);
        }
    }
}

/// A cylinder of radius 2 mm in two media with the border at z = 4 mm, and light that leaves through every face.
fn two_media(far: &str) -> String {
    format!(
        r#"
[media]
dense = {{ index = 1.6, absorption_per_mm = 0.01 }}
thin = {{ index = 1.2 }}
[solids.far.cylinder]
radius_mm = 2
medium = "thin"
{far}
[solids.near.cylinder]
radius_mm = 2
length_mm = 4
medium = "dense"
priority = 1
[sources.lamp.point]
flux_lm = 1
at = {{ position_mm = [0.7, 0.2, 1.0] }}
"#
    )
}

#[test]
fn light_that_escapes_where_walls_coincide_left_the_solid_of_higher_priority() {
    let scenes = Scenes::new();
    let apart = two_media("length_mm = 6\nat = { position_mm = [0, 0, 4] }");
    let apart = measures(&scenes.load(&apart));
    // The wall of the far solid, and its entry, coincide with faces of the near one.
    let inside = measures(&scenes.load(&two_media("length_mm = 10")));
    for face in ["near.wall", "near.entry", "far.wall", "far.exit"] {
        let name = format!("balance.escaped.{face}");
        let [expected, found] = [&apart, &inside].map(|own| own.values[&name].value);
        assert!(expected > 0.005, "{name}: {expected}");
        assert!((found - expected).abs() < ASTRAY, "{name}: {found}, not {expected}");
    }
}

/// Largest change of x dy - y dx about the z axis over the vertices of some paths, mm, with the
/// number of vertices of the shortest path. The scene's solids and sheets are at the origin.
fn drift_of_skew(job: &Job) -> (f64, usize) {
    const LOOKS: u64 = 50;
    let (mut drift, mut shortest) = (0.0f64, usize::MAX);
    for look in 0..LOOKS {
        let mut sampler = Sampler::for_path(1, 0, look);
        let source = &job.scene.sources[0];
        let emitted = source.emit(&job.scene, DrawnWavelength::REFERENCE, &mut sampler);
        let skew = |point: glam::DVec3, dir: glam::DVec3| point.x * dir.y - point.y * dir.x;
        let at_start = skew(emitted.ray.origin(), emitted.ray.dir());
        let path = LightPath::emitted(&job.scene, SourceId::new(0), emitted);
        let mut bounces = 0;
        walk(
            &job.scene,
            path,
            job.run.bounce_limit,
            &mut sampler,
            &mut |_: &LightPath, event: Event<'_>| {
                if let Event::Arrive(vertex) = event {
                    bounces += 1;
                    drift = drift.max((skew(vertex.point, vertex.dir) - at_start).abs());
                }
                ControlFlow::Continue(())
            },
        );
        shortest = shortest.min(bounces);
    }
    (drift, shortest)
}

#[test]
fn the_skew_of_a_ray_survives_a_thousand_bounces() {
    // A mirror tube of 5 mm radius at 80 degrees, a rod of 1 mm radius at 50 degrees inside: both totally reflect.
    let tube =
        ["sheets.duct.tube.path.0.straight_mm=3000", "finishes.mirror.specular.reflectance=1"];
    let tube = [tube[0], tube[1], "sources.led.disk.tilt_deg=80"];
    let rod = [
        "solids.rod.sweep.path.0.straight_mm=4000",
        "sources.led.face.emission=collimated",
        "sources.led.face.tilt_deg=45",
    ];
    for (scene, overrides, radius) in [("mt_01", tube, 5.0), ("sr_03", rod, 1.0)] {
        let job = load(&scenes("validation").join(scene).with_extension("toml"), &overrides);
        let (drift, bounces) = drift_of_skew(&job);
        assert!(bounces >= 1000, "{scene}: only {bounces} bounces");
        assert!(drift <= 1e-12 * radius, "{scene}: drift {drift:e} mm over {bounces} bounces");
    }
}

#[test]
fn no_shipped_scene_leaks_in_a_hundred_million_segments_and_every_balance_closes() {
    let shipped = shipped();
    assert!(shipped.len() >= 6, "{} scenes", shipped.len());
    let mut segments = 0;
    for path in &shipped {
        let job = load(path, &[]);
        let mut run = Run::new(&job.scene, &job.run);
        let enough = if path.to_string_lossy().contains("mesh") {
            MESH_SEGMENTS
        } else {
            SEGMENTS.div_ceil(shipped.len() as u64 - 1)
        };
        run.next_wave();
        while run.findings().photons.segments < enough {
            run.next_wave();
        }
        let measures = measure::measure(&job.scene, &run.findings());
        segments += measures.segments;
        let (balance, name) = (&measures.balance, path.display());
        assert_eq!(balance.leaked.value, 0.0, "{name} leaks {}", balance.leaked);
        let open = balance.residual.value.abs() / job.scene.source_flux();
        assert!(open <= 1e-9, "{name}: the balance is open by {open:e}");
    }
    assert!(segments >= SEGMENTS, "{segments} segments");
}

fn is_flux(unit: &str) -> bool {
    matches!(unit, "lm" | "W")
}

fn shipped() -> Vec<PathBuf> {
    let files = std::fs::read_dir(scenes("")).unwrap().map(|entry| entry.unwrap().path());
    files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect()
}

fn scenes(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(folder)
}
