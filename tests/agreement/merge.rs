//! Forward, backward and gather merged: the same values as each alone, in guides, with every finish that does not scatter,
//! every source and every sensor.

use crate::finishes::{tube, window};
use crate::sensors::scene;
use crate::sources::rod;
use crate::trial::{Gathering, Way, agree, findings, load};
use glam::DVec3;
use lumiduct_core::rng::Sampler;
use lumiduct_core::scene::{Arrival, Arrivals, SensorId, SensorKind, SourceId};
use lumiduct_core::transport::{Layout, Orders, batch_paths};

/// Forward, backward, and merged at depths 0, 2 and 8.
fn all_agree(what: &str, text: &str) {
    let [shallow, middle, deep] = [0, 2, 8]
        .map(|depth| Way::Merged(Gathering { radius_mm: 0.4, ..Gathering::to_depth(depth) }));
    agree(what, text, &[Way::Forward, Way::Backward, Way::Mixed, shallow, middle, deep]);
}

/// Forward, and merged at depths 0 and 2.
fn shallow_agree(what: &str, text: &str) {
    let [shallow, middle] = [0, 2].map(|depth| Way::Merged(Gathering::to_depth(depth)));
    agree(what, text, &[Way::Forward, shallow, middle]);
}

/// A guide with a lamp before its entry, a sensor on its exit and one behind.
fn guide(guide: &str, counts: &str) -> String {
    format!(
        r#"
[media.acrylic]
index = 1.49
absorption_per_mm = 0.002
[finishes.mirror]
specular = {{ reflectance = 0.9 }}
{guide}
[sources.led.disk]
radius_mm = 1
flux_lm = 10
at = {{ face = "pipe.entry", gap_mm = 0.2 }}
[sensors]
exit = {{ plane = {{ cells = [2, 1] }}, on = "pipe.exit", counts = "{counts}" }}
cell = {{ plane = {{ rectangle = {{ width_mm = 3, height_mm = 3 }} }}, at = {{ face = "pipe.exit", gap_mm = 4, offset_mm = [1, 0] }}, aim = ["pipe.exit"] }}
"#
    )
}

#[test]
fn mirror_tubes() {
    let tube = "[sheets.pipe.tube]\nprofile = { circle = { radius_mm = 1.5 } }\npath = [{ straight_mm = 10 }]\nfinish = \"mirror\"";
    all_agree("mirror tube", &guide(tube, "incident"));
}

#[test]
fn rods() {
    let rod = "[solids.pipe.cylinder]\nradius_mm = 1.5\nlength_mm = 10\nmedium = \"acrylic\"";
    all_agree("rod", &guide(rod, "leaving"));
}

#[test]
fn bends() {
    let bend = "[solids.pipe.sweep]\nprofile = { circle = { radius_mm = 1.5 } }\npath = [{ straight_mm = 3 }, { bend_deg = 90, radius_mm = 6 }, { straight_mm = 3 }]\nmedium = \"acrylic\"";
    all_agree("bend", &guide(bend, "leaving"));
}

#[test]
fn right_angles() {
    let corner = "[solids.pipe.sweep]\nprofile = { rectangle = { width_mm = 3, height_mm = 3 } }\npath = [{ straight_mm = 3 }, { corner_deg = 90, fold_mirror = true }, { straight_mm = 3 }]\nmedium = \"acrylic\"";
    all_agree("right angle", &guide(corner, "leaving"));
}

#[test]
fn meshes_with_interpolated_normals() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/meshes/lightguide.glb");
    let mesh = format!("[solids.pipe.mesh]\nfile = '{file}'\nunit = \"m\"\nmedium = \"acrylic\"");
    // The overlap of a window is computed triangle by triangle, so there are few records.
    let few = Gathering { radius_mm: 0.4, records: 60, photons: 2000, ..Gathering::to_depth(1) };
    agree("mesh", &guide(&mesh, "leaving"), &[Way::Forward, Way::Merged(few)]);
}

#[test]
fn finishes() {
    shallow_agree("bare metal", &tube("{ metal = { n = 0.79, k = 5.85 } }"));
    let mixed = "{ mixture = [{ weight = 2, finish = { specular = { reflectance = 0.9 } } }, { weight = 1, finish = { specular = { reflectance = 0.3 } } }, { weight = 1, finish = { absorber = {} } }] }";
    shallow_agree("mixture", &tube(mixed));
    let (clear, dim) = (
        "{ specular = { reflectance = 0.2, transmittance = 0.7 } }",
        "{ specular = { reflectance = 0.5, transmittance = 0.2 } }",
    );
    shallow_agree("splitter", &window(clear, clear));
    shallow_agree("two sides of a splitter", &window(clear, dim));
}

/// A rod with several sources in turn, each by its kind and keys.
fn sources_agree(sources: &[(&str, &str)]) {
    for (what, source) in sources {
        let source = source.replacen("]\n", "]\nflux_lm = 10\n", 1);
        shallow_agree(what, &rod(&format!("[sources.{source}")));
    }
}

#[test]
fn sources_on_faces() {
    sources_agree(&[
        ("optical contact", "lamp.disk]\nradius_mm = 2\nat = { face = \"rod.entry\" }"),
        ("air", "lamp.disk]\nradius_mm = 2\ncontact = \"air\"\nat = { face = \"rod.entry\" }"),
        ("shining in", "lamp.face]\nof = \"rod.wall\"\nside = \"back\"\ncontact = \"air\""),
    ]);
}

#[test]
fn sources_with_shape() {
    sources_agree(&[
        ("glowing solid", "lamp.volume]\nof = \"rod\""),
        (
            "cylinder",
            "lamp.cylinder]\nradius_mm = 1\nlength_mm = 2\nat = { position_mm = [0.5, 0, -2.5] }",
        ),
    ]);
}

#[test]
fn sources_of_other_laws_that_overlap() {
    sources_agree(&[
        (
            "cone",
            "lamp.disk]\nradius_mm = 2\nemission = { cone_half_angle_deg = 25 }\ntilt_deg = 15\nat = { position_mm = [0, 0, -1] }",
        ),
        (
            "two overlapping lamps",
            "lamp.disk]\nradius_mm = 2\nat = { position_mm = [0, 0, -1] }\n[sources.wide.disk]\nradius_mm = 4\nflux_lm = 20\nemission = { cosine_power = 6 }\nat = { position_mm = [0.5, 0, -1] }",
        ),
    ]);
}

/// The scene of sensors with a splitter instead of a diffuser.
fn specular_scene(sensors: &str) -> String {
    let white = "white = { lambertian = { reflectance = 0.4, transmittance = 0.4 } }";
    let text = scene(sensors);
    assert!(text.contains(white));
    text.replace(white, "white = { specular = { reflectance = 0.4, transmittance = 0.4 } }")
}

#[test]
fn sensors() {
    shallow_agree(
        "planes",
        &specular_scene(
            r#"
cells = { plane = { rectangle = { width_mm = 8, height_mm = 8 }, cells = [2, 2] }, at = { position_mm = [0, 0, 20], axis = [0, 0, -1] } }
both = { plane = { disk = { radius_mm = 4 } }, at = { position_mm = [0, 0, 3], axis = [0, 0, -1] }, side = "both" }
inside = { plane = { rectangle = { width_mm = 12, height_mm = 6 } }, at = { position_mm = [0, 0, 14], axis = [0.2, 0, -1] } }
splitter = { plane = { cells = [2, 1] }, on = "pane.surface", counts = "leaving", side = "both" }
side = { plane = { cells = [2, 1] }, on = "tube.wall", counts = "incident", side = "front" }
in = { plane = {}, on = "block.entry", counts = "leaving", side = "back" }
"#,
        ),
    );
    shallow_agree(
        "directions",
        &specular_scene(
            r#"
far = { goniometer = { c_step_deg = 180, gamma_step_deg = 30 } }
aimed = { goniometer = { c_step_deg = 180, gamma_step_deg = 30 }, aim = ["tube.exit"] }
near = { goniometer = { c_step_deg = 180, gamma_step_deg = 30, radius_mm = 40 } }
near_aimed = { goniometer = { c_step_deg = 180, gamma_step_deg = 30, radius_mm = 40 }, aim = ["block.exit"] }
view = { luminance = { rectangle = { width_mm = 4, height_mm = 4 }, cells = [2, 1], acceptance_half_angle_deg = 12, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 10, phi_deg = 180 }] }, at = { position_mm = [0, 0, 20], axis = [0, 0, -1] } }
face = { luminance = { cells = [1, 1], acceptance_half_angle_deg = 12, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 40, phi_deg = 90 }] }, on = "block.exit", counts = "leaving" }
image = { image = { disk = { radius_mm = 3 }, pixels = [4, 3], pixel_deg = 8 }, at = { position_mm = [0, 0, 22], axis = [0, 0, -1] } }
"#,
        ),
    );
}

/// A mirror tube of radius 5 with a source in its entry, and a sensor.
fn tube_with(length_mm: u32, source: &str, sensor: &str) -> String {
    format!(
        r#"
[finishes.mirror]
specular = {{ reflectance = 0.99 }}
[sheets.tube.tube]
profile = {{ circle = {{ radius_mm = 5 }} }}
path = [{{ straight_mm = {length_mm} }}]
finish = "mirror"
[sources.lamp.disk]
flux_lm = 10
{source}
at = {{ position_mm = [0, 0, 0] }}
[sensors]
seen = {sensor}
"#
    )
}

/// Relative variances of the flux by the estimate of second order after the same paths: forward, backward, gather, merged.
fn variances(text: &str, gathering: Gathering) -> [f64; 4] {
    const PASSES: u64 = 64;
    let of = |way: Way| {
        let mut job = load(text, way);
        // Points gain more in larger batches: none is larger than a pass.
        job.run.batch_paths = Some(batch_paths(&job.scene, &job.run));
        let found = findings(&job, way);
        let layout = Layout::new(&job.scene);
        let slot = layout.sensor_flux(SensorId::new(0), SourceId::new(0));
        let (readings, paths) = match way {
            Way::Forward => (&found.photons, PASSES * gathering.photons),
            // Of passes, of second order.
            Way::Backward | Way::Mixed | Way::Gather(_) | Way::Merged(_) => {
                (found.others[0].stages[0].counts.first(), PASSES * gathering.records)
            }
        };
        let flux = readings.scalar(slot);
        if flux.mean() == 0.0 {
            // No light was found.
            return f64::INFINITY;
        }
        (flux.std_error() / flux.mean()).powi(2) * readings.paths() as f64 / paths as f64
    };
    [Way::Forward, Way::Backward, Way::Gather(gathering), Way::Merged(gathering)].map(of)
}

/// Which of forward, backward and gather has the least noise.
#[derive(Debug, PartialEq)]
enum Best {
    Forward,
    Backward,
    Gather,
}

/// The noise of the merged estimate is about that of the best one, whichever it is.
fn noise_is_that_of(best: Best, text: &str, gathering: Gathering) {
    /// 64 passes give a variance to 18 %: this is 2.3 standard errors of a ratio above 1.
    const MOST: f64 = 1.6;
    let [forward, backward, gather, merged] = variances(text, gathering);
    println!("forward {forward:.2e} backward {backward:.2e} gather {gather:.2e} mis {merged:.2e}");
    let (least, own) = if forward < backward.min(gather) {
        (forward, Best::Forward)
    } else if backward < gather {
        (backward, Best::Backward)
    } else {
        (gather, Best::Gather)
    };
    assert_eq!(own, best);
    assert!(merged < MOST * least, "{merged} against {least} of {best:?}");
}

/// A cell of 1 mm² 30 deg off the axis, 300 mm behind a tube of 400 mm.
const CELL: &str = "{ plane = { rectangle = { width_mm = 1, height_mm = 1 } }, at = { position_mm = [150, 0, 659.8], axis = [-0.5, 0, -0.8660254] }, aim = [\"tube.exit\"] }";

#[test]
fn noise_where_gather_is_best() {
    let sun = "radius_mm = 5\nemission = { cone_half_angle_deg = 0.27 }\ntilt_deg = 30";
    let gathering =
        Gathering { depth: 8, radius_mm: 1.0, angle_deg: 0.15, records: 1000, photons: 5000 };
    noise_is_that_of(Best::Gather, &tube_with(400, sun, CELL), gathering);
}

#[test]
fn noise_where_backward_is_best() {
    // About as many as a batch of backward has: Sobol points gain more in larger sets.
    let gathering =
        Gathering { depth: 2, radius_mm: 0.5, angle_deg: 1.0, records: 4096, photons: 2000 };
    noise_is_that_of(Best::Backward, &tube_with(100, "radius_mm = 2.5", CELL), gathering);
}

#[test]
fn noise_where_forward_is_best() {
    let exit = "{ plane = { disk = { radius_mm = 5 } }, at = { position_mm = [0, 0, 101], axis = [0, 0, -1] }, aim = [\"tube.exit\"] }";
    let gathering =
        Gathering { depth: 2, radius_mm: 0.25, angle_deg: 3.0, records: 1000, photons: 5000 };
    noise_is_that_of(Best::Forward, &tube_with(100, "radius_mm = 0.5", exit), gathering);
}

/// The weights rest on chances of the two sides that are only roughly known. The variance of `mis` is 1.94 times that of
/// `forward` at the facets and 0.94 times at the film.
#[test]
fn noise_at_prism_film_and_narrow_facets() {
    const MOST: f64 = 3.0;
    let exit = "{ plane = { disk = { radius_mm = 5 } }, at = { position_mm = [0, 0, 61], axis = [0, 0, -1] }, aim = [\"tube.exit\"] }";
    let gathering =
        Gathering { depth: 2, radius_mm: 0.25, angle_deg: 3.0, records: 1000, photons: 5000 };
    for finish in [
        "ggx = { roughness = 0.03, reflectance = 0.95 }",
        "prism_film = { index = 1.59, pitch_mm = 0.36, base_mm = 0.2 }",
    ] {
        let text = tube_with(60, "radius_mm = 0.5", exit);
        let text = text.replace("specular = { reflectance = 0.99 }", finish);
        let [forward, .., merged] = variances(&text, gathering);
        println!("{finish}: forward {forward:.2e} mis {merged:.2e}");
        assert!(merged < MOST * forward, "{finish}: {merged} against {forward}");
    }
}

/// Compares the flux in each window with an exact value, lm, merged where each of the three
/// estimators has a good share. Light fills all directions uniformly, and the windows are so small that the bias of E1 is 1e-4
/// (2.4e-3 with twice the radius and angle).
fn flux_is(what: &str, pane: &str, depth: u32, expected: f64) {
    let text = format!(
        r#"
[finishes]
mirror = {{ specular = {{ reflectance = 1 }} }}
splitter = {{ specular = {{ reflectance = 0.4, transmittance = 0.6 }} }}
[sheets.tube.tube]
profile = {{ circle = {{ radius_mm = 5 }} }}
path = [{{ straight_mm = 12 }}]
finish = "mirror"
{pane}
[sources.lamp.disk]
radius_mm = 5
flux_lm = 10
[sensors]
exit = {{ plane = {{}}, on = "tube.exit", counts = "incident", side = "both" }}
"#
    );
    // Etendues of 0.12 mm² sr for photons and gather paths, of 0.02 cos θ for windows.
    let way = Way::Merged(Gathering {
        depth,
        radius_mm: 0.5,
        angle_deg: 5.0,
        records: 2000,
        photons: 2000,
    });
    let job = load(&text, way);
    let found = findings(&job, way);
    let slot = Layout::new(&job.scene).sensor_flux(SensorId::new(0), SourceId::new(0));
    let Orders { second, fourth, sixth } = Orders::of(&found.others[0].stages[0].counts);
    for (readings, most) in [(second, 0.01), (fourth, 0.01), (sixth, 0.02)] {
        let flux = readings.scalar(slot);
        println!("{what}, depth {depth}: {} ± {}", flux.mean(), flux.std_error());
        assert!(flux.std_error() < most * expected, "{what}: {flux:?}");
        let z = flux.sigmas_from(expected);
        assert!(z.abs() < 4.0, "{what}, depth {depth}: {flux:?}, not {expected}");
    }
}

#[test]
fn shares_of_a_tube_add_up_in_every_order() {
    for depth in [0, 1, 2] {
        flux_is("tube", "", depth, 10.0);
        let pane = "[sheets.pane.disk]\nradius_mm = 5\nfinish = \"splitter\"\nat = { position_mm = [0, 0, 8] }";
        flux_is("tube with a splitter", pane, depth, 6.0);
    }
}

#[test]
fn light_that_a_sensor_counts_knows_how_likely_its_gather_path_was() {
    let text = specular_scene(
        r#"
free = { plane = { disk = { radius_mm = 4 } }, at = { position_mm = [0, 0, 3], axis = [0, 0.1, -1] }, side = "both" }
leaving = { plane = {}, on = "block.exit", counts = "leaving" }
far = { goniometer = { c_step_deg = 180, gamma_step_deg = 30 } }
far_aimed = { goniometer = { c_step_deg = 180, gamma_step_deg = 30 }, aim = ["tube.wall"] }
near = { goniometer = { c_step_deg = 180, gamma_step_deg = 30, radius_mm = 40 } }
near_aimed = { goniometer = { c_step_deg = 180, gamma_step_deg = 30, radius_mm = 40 }, aim = ["block.exit"] }
aimed = { plane = { rectangle = { width_mm = 4, height_mm = 4 } }, at = { position_mm = [12, 0, 2], axis = [-1, 0, 0.5] }, aim = ["tube.wall", "tube.exit"] }
views = { luminance = { rectangle = { width_mm = 4, height_mm = 4 }, cells = [2, 1], acceptance_half_angle_deg = 12, directions = [{ theta_deg = 0, phi_deg = 0 }, { theta_deg = 10, phi_deg = 180 }] }, at = { position_mm = [0, 0, 20], axis = [0, 0, -1] } }
out = { luminance = { cells = [1, 1], acceptance_half_angle_deg = 12, directions = [{ theta_deg = 40, phi_deg = 90 }] }, on = "block.exit", counts = "leaving" }
image = { image = { disk = { radius_mm = 3 }, pixels = [4, 3], pixel_deg = 8 }, at = { position_mm = [0, 0, 22], axis = [0.3, 0, -1] } }
"#,
    );
    let scene = load(&text, Way::Forward).scene;
    for (index, sensor) in scene.sensors.iter().enumerate() {
        let arrivals = Arrivals::new(&scene, SensorId::new(index));
        let normal = match &sensor.kind {
            SensorKind::Surface(surface) => surface.frame.map_or(DVec3::Z, |frame| frame.z),
            SensorKind::Goniometer(_) => DVec3::ZERO,
        };
        let draws = (0..200).map(|path| arrivals.draw(&mut Sampler::for_path(1, 0, path)));
        let drawn: Vec<Arrival> = draws.flatten().collect();
        assert!(drawn.len() > 20, "{}: {} starts", sensor.name, drawn.len());
        for Arrival { ray, extent, .. } in drawn {
            let told = arrivals.extent(&ray, normal);
            assert!((told / extent - 1.0).abs() < 1e-6, "{}: {told}, {extent}", sensor.name);
        }
    }
}
