//! The effect of reliefs on light: exact deflections, uniform fields that stay uniform, the same
//! guide built in another way, no leaks.

use crate::traced::measures;
use crate::{BODIES, LAMP, load};
use glam::DVec3;
use lumiduct_core::measure;
use lumiduct_core::rng::Sampler;
use lumiduct_core::scene::shape::Toward;
use lumiduct_core::scene::{DrawnWavelength, FaceId, Owner, SourceId};
use lumiduct_core::transport::{Event, Path, Run, walk};
use lumiduct_input::Job;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::ops::ControlFlow;

const BOUNCES: u32 = 100_000;

/// Follows photons of all sources.
fn follow(job: &Job, count: u64, mut see: impl FnMut(&Event<'_>) -> ControlFlow<()>) {
    let sources = job.scene.sources.len();
    for index in 0..count {
        let id = SourceId::new(index as usize % sources);
        let mut sampler = Sampler::for_path(11, 0, index);
        let emitted = job.scene.sources[id.index()].emit(
            &job.scene,
            DrawnWavelength::REFERENCE,
            &mut sampler,
        );
        let path = Path::emitted(&job.scene, id, emitted);
        walk(&job.scene, path, BOUNCES, &mut sampler, &mut |_: &Path, event: Event<'_>| {
            see(&event)
        });
    }
}

#[test]
fn a_flank_of_45_degrees_turns_a_beam_along_the_guide_down_by_total_reflection() {
    for (wall, down) in [("plus_y", -1.0), ("minus_y", 1.0)] {
        let job = load(
            &format!(
                r#"{BODIES}
[reliefs.grooves]
on = "plate.wall_{wall}"
element = {{ groove = {{ depth_mm = 1, angle_deg = 90 }} }}
layout = {{ row = {{ positions_mm = [20] }} }}
[sources.beam.rectangle]
width_mm = 10
height_mm = 0.8
flux_lm = 1
emission = "collimated"
at = {{ position_mm = [0, {}, 2] }}
[sensors]
out = {{ plane = {{ rectangle = {{ width_mm = 1, height_mm = 1 }} }}, at = {{ position_mm = [0, 0, 150] }} }}
"#,
                -1.5 * down
            ),
            1,
        );
        let mut turned = 0;
        follow(&job, 2000, |event| {
            let Event::Depart(vertex, departure) = event else { return ControlFlow::Continue(()) };
            let acting = vertex.interface.acting;
            assert_eq!(job.scene.faces[acting.face.index()].name, "plate.grooves");
            let apart = (departure.dir - down * DVec3::Y).length();
            assert!(apart < 1e-12, "{} is off by {apart:e}", departure.dir);
            // The flank toward the start, at 45 degrees from (y, z) = (±2, 19).
            let at = vertex.point + job.scene.origin;
            assert!((at.z - 19.0 - (2.0 - at.y.abs())).abs() < 1e-12, "{at}");
            assert_eq!(departure.throughput, 1.0);
            turned += 1;
            ControlFlow::Break(())
        });
        assert_eq!(turned, 2000);
    }
}

/// A room with glowing walls, of 1 lm/mm² each, around the plate and the rod.
fn furnace(relief: &str) -> Job {
    load(
        &format!(
            r#"
[media]
glass = {{ index = 1.5 }}
[solids]
room = {{ box = {{ size_mm = [26, 16, 34], medium = "air", at = {{ position_mm = [6, 0, -2] }} }} }}
plate = {{ box = {{ size_mm = [12, 4, 30], medium = "glass", priority = 1 }} }}
rod = {{ cylinder = {{ radius_mm = 3, length_mm = 30, medium = "glass", priority = 1, at = {{ position_mm = [13, 0, 0] }} }} }}
{relief}
[sources]
below = {{ face = {{ of = "room.entry", side = "back", flux_lm = 416 }} }}
above = {{ face = {{ of = "room.exit", side = "back", flux_lm = 416 }} }}
walls = {{ face = {{ of = "room.wall", side = "back", flux_lm = 2856 }} }}
[sensors]
out = {{ plane = {{ rectangle = {{ width_mm = 1, height_mm = 1 }} }}, at = {{ position_mm = [0, 0, 150] }} }}
"#
        ),
        1,
    )
}

#[test]
fn an_even_field_stays_even_on_every_face_with_relief() {
    let reliefs = r#"
[reliefs.dimples]
on = "plate.wall_plus_y"
element = { dimple = { radius_mm = 1.2, depth_mm = 1 } }
layout = { grid = { across_pitch_mm = 3, pitch_mm = 3 } }
[reliefs.ridges]
on = "plate.wall_minus_y"
element = { ridge = { height_mm = 1, flank_angles_deg = [40, 60] } }
layout = { row = { pitch_mm = 2.5 } }
[reliefs.bumps]
on = "rod.wall"
element = { bump = { radius_mm = 1, height_mm = 0.9 } }
layout = { row = { positions_mm = [3, 7, 11], around_deg = 20 } }
[reliefs.rings]
on = "rod.wall"
element = { groove = { depth_mm = 1, angle_deg = 80, course = "ring" } }
layout = { row = { pitch_mm = 2.5, along_mm = [14, 29] } }
"#;
    let job = furnace(reliefs);
    let scene = &job.scene;
    let fluxes: Vec<f64> = scene.sources.iter().map(|source| source.flux).collect();
    let count = 240_000u64;
    // Sum and sum of squares of the light that arrives at a face from outside.
    let mut sums = vec![[0.0f64; 2]; scene.faces.len()];
    for index in 0..count {
        let id = SourceId::new(index as usize % fluxes.len());
        let mut sampler = Sampler::for_path(12, 0, index);
        let emitted =
            scene.sources[id.index()].emit(scene, DrawnWavelength::REFERENCE, &mut sampler);
        let worth = fluxes[id.index()] * fluxes.len() as f64 / count as f64;
        let mut seen = BTreeMap::new();
        let path = Path::emitted(scene, id, emitted);
        walk(scene, path, BOUNCES, &mut sampler, &mut |_: &Path, event: Event<'_>| {
            assert!(!matches!(event, Event::Leaked(..)));
            if let Event::Arrive(vertex) = event {
                let hit = vertex.interface.acting;
                if hit.toward == Toward::Back {
                    *seen.entry(hit.face.index()).or_insert(0.0) += worth * vertex.throughput;
                }
            }
            ControlFlow::Continue(())
        });
        for (face, flux) in seen {
            sums[face][0] += flux;
            sums[face][1] += flux * flux;
        }
    }
    let mut compared = 0;
    for (index, face) in scene.faces.iter().enumerate() {
        let is_glass = matches!(face.owner, Owner::Solid(solid) if solid.index() > 0);
        if !is_glass {
            continue;
        }
        // In a uniform field every mm² receives the same, whatever its orientation: here 1 lm,
        // including light that has passed through glass.
        let area = scene.face_area(FaceId::new(index));
        // The area of bumps on a round wall is known only to a percent.
        let area_error = if face.name == "rod.bumps" { 0.01 * area } else { 0.0 };
        let [sum, squares] = sums[index];
        let sigmas = (sum - area) / squares.sqrt().hypot(area_error);
        println!("{}: {sum:.3} lm on {area:.3} mm², {sigmas:+.2} sigmas", face.name);
        assert!(sigmas.abs() < 4.0, "{}: {sum} of {area}, {sigmas} sigmas", face.name);
        compared += 1;
    }
    assert!(compared >= 13, "{compared}");
}

/// A plate of 6 x 3 x 20 mm with V-grooves of 90 degrees in its upper wall, as a relief and as the sweep of a profile with teeth.
fn toothed() -> [String; 2] {
    let relief = r#"
[solids.plate.box]
size_mm = [6, 3, 20]
medium = "glass"
[reliefs.grooves]
on = "plate.wall_plus_y"
element = { groove = { depth_mm = 0.5, angle_deg = 90 } }
layout = { row = { positions_mm = [2, 4, 6, 8, 10, 12, 14, 16, 18] } }
"#;
    let mut points = vec!["[0, -1.5]".to_owned(), "[20, -1.5]".into(), "[20, 1.5]".into()];
    for z in (1..10).rev().map(|i| 2.0 * f64::from(i)) {
        points.extend(
            [(0.5, 1.5), (0.0, 1.0), (-0.5, 1.5)].map(|(d, y)| format!("[{}, {y}]", z + d)),
        );
    }
    points.push("[0, 1.5]".into());
    // The profile's x along the guide, its y up; swept across, toward -x.
    let sweep = format!(
        r#"
[solids.plate.sweep]
profile = {{ polygon = {{ points_mm = [{}] }} }}
path = [{{ straight_mm = 6 }}]
medium = "glass"
at = {{ position_mm = [3, 0, 0], axis = [-1, 0, 0], x_axis = [0, 0, 1] }}
"#,
        points.join(", ")
    );
    [relief.to_owned(), sweep].map(|plate| {
        format!(
            r#"
[media.glass]
index = 1.49
absorption_per_mm = 0.01
{plate}
[sources.lamp.rectangle]
width_mm = 5
height_mm = 2
flux_lm = 10
at = {{ position_mm = [0, 0, -0.2] }}
[sensors]
up = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 20 }}, cells = [1, 4] }}, at = {{ position_mm = [0, 2, 10], axis = [0, -1, 0], x_axis = [1, 0, 0] }} }}
down = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 20 }}, cells = [1, 4] }}, at = {{ position_mm = [0, -2, 10], axis = [0, 1, 0], x_axis = [1, 0, 0] }} }}
end = {{ plane = {{ rectangle = {{ width_mm = 6, height_mm = 3 }} }}, at = {{ position_mm = [0, 0, 20.5], axis = [0, 0, -1] }} }}
far = {{ goniometer = {{ c_step_deg = 90, gamma_step_deg = 30 }} }}
"#
        )
    })
}

#[test]
fn a_row_of_grooves_is_the_same_as_a_profile_with_teeth() {
    let [relief, sweep] = toothed().map(|text| measures(&load(&text, 200_000)));
    let mut compared = 0;
    for (name, found) in &relief.values {
        let is_light = ["up.", "down.", "end.", "far."].iter().any(|start| name.starts_with(start));
        let is_plain = [".flux", ".ring.", ".cell."].iter().any(|part| name.contains(part));
        if !is_light || !is_plain {
            continue;
        }
        let expected = &sweep.values[name.as_str()];
        // The same random numbers give the same paths: only rounding differs, which may divert one
        // of them.
        let apart = (found.value - expected.value).abs() / expected.std_error.max(1e-9);
        assert!(apart < 0.1, "{name}: {found}, with teeth {expected}");
        compared += 1;
    }
    assert!(compared >= 8, "{compared}");
    assert!(relief.values["up.flux"].value > 1.0);
}

/// Asserts no leak and a closed balance after this many segments.
fn assert_tight(what: &str, job: &Job, segments: u64) {
    let mut run = Run::new(&job.scene, &job.run);
    run.next_wave();
    while run.findings().photons.segments < segments {
        run.next_wave();
    }
    let found = measure::measure(&job.scene, &run.findings());
    let open = found.balance.residual.value.abs() / job.scene.source_flux();
    println!("{what}: {} segments, open by {open:e}", found.segments);
    assert_eq!(found.balance.leaked.value, 0.0, "{what} leaks {}", found.balance.leaked);
    assert!(open <= 1e-9, "{what}: the balance is open by {open:e}");
}

#[test]
fn ten_thousand_dimples_leak_nothing() {
    let job = load(
        r#"
[media.glass]
index = 1.49
[solids.plate.box]
size_mm = [50, 4, 50]
medium = "glass"
[reliefs.dimples]
on = "plate.wall_minus_y"
element = { dimple = { radius_mm = 0.25, depth_mm = { from_mm = 0.05, to_mm = 0.2 } } }
layout = { grid = { across_pitch_mm = 0.5, pitch_mm = 0.5 } }
[sources.lamp.rectangle]
width_mm = 40
height_mm = 3
flux_lm = 1
at = { face = "plate.entry", gap_mm = 0.1 }
[sensors]
top = { plane = { cells = [4, 4] }, on = "plate.wall_plus_y", counts = "leaving" }
"#,
        20_000,
    );
    assert_eq!(job.scene.reliefs[0].field.count(), 10_000);
    assert_tight("dimples", &job, 3_000_000);
}

#[test]
fn elements_that_touch_and_rods_with_all_of_them_leak_nothing() {
    for relief in [
        // A saw without a flat between its teeth, and pyramids side by side.
        "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = { groove = { depth_mm = 0.5, angle_deg = 90 } }\nlayout = { row = { pitch_mm = 1 } }\n[reliefs.b]\non = \"plate.wall_minus_y\"\nelement = { pyramid = { width_mm = 1, length_mm = 1, height_mm = 0.5 } }\nlayout = { grid = { across_pitch_mm = 1, pitch_mm = 1 } }",
        "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = { ridge = { height_mm = 0.5, angle_deg = 90 } }\nlayout = { row = { pitch_mm = 1 } }\n[reliefs.b]\non = \"plate.wall_minus_y\"\nelement = { pit = { width_mm = 1, length_mm = 1, depth_mm = 0.5 } }\nlayout = { grid = { across_pitch_mm = 1, pitch_mm = 1 } }",
        "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = { bump = { radius_mm = 0.5, height_mm = 0.5 } }\nlayout = { hexagonal = { pitch_mm = 1 } }\n[reliefs.b]\non = \"plate.wall_minus_y\"\nelement = { groove = { depth_mm = 0.4, angle_deg = 60, length_mm = 3 } }\nlayout = { grid = { across_pitch_mm = 4, pitch_mm = 1 } }",
    ] {
        let lamp = LAMP.replace("-50", "-1").replace("0.1", "1");
        let job = load(&format!("{BODIES}{relief}{lamp}"), 10_000);
        assert_tight("plate", &job, 1_000_000);
    }
    for relief in [
        "{ dimple = { radius_mm = 0.5, depth_mm = 0.4 } }\nlayout = { staggered = { across_pitch_mm = 1.5707963267949, pitch_mm = 1.5 } }",
        "{ bump = { radius_mm = 0.5, height_mm = 0.4 } }\nlayout = { grid = { across_pitch_mm = 1.5707963267949, pitch_mm = 1.5 } }",
        "{ groove = { depth_mm = 0.5, angle_deg = 90 } }\nlayout = { row = { pitch_mm = 1, around_deg = 30 } }",
        "{ groove = { depth_mm = 0.5, angle_deg = 90, course = \"ring\" } }\nlayout = { row = { pitch_mm = 1 } }",
        "{ ridge = { height_mm = 0.5, flank_angles_deg = [90, 45], course = \"ring\" } }\nlayout = { row = { pitch_mm = 0.5 } }",
    ] {
        let lamp = LAMP.replace("[0, 0, -50]", "[40, 0, -1]").replace("0.1", "1");
        let on = "[reliefs.a]\non = \"rod.wall\"\nelement = ";
        let job = load(&format!("{BODIES}{on}{relief}\n{lamp}"), 10_000);
        assert_tight("rod", &job, 1_000_000);
    }
}

#[test]
fn the_map_of_a_wall_knows_what_elements_take_of_it() {
    let text = |more: &str, map: &str| {
        format!(
            "{BODIES}{more}{}",
            LAMP.replace(
                "out =",
                &format!(
                    "wall = {{ plane = {{ cells = [3, 5] }}, {map}, counts = \"leaving\" }}\nout ="
                )
            )
        )
    };
    let area = |text: &str| {
        load(text, 1)
            .scene
            .sensors
            .iter()
            .find_map(|sensor| match &sensor.kind {
                lumiduct_core::scene::SensorKind::Surface(surface) if sensor.name == "wall" => {
                    Some(surface.areas.iter().sum::<f64>())
                }
                _ => None,
            })
            .unwrap()
    };
    let dimples = "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = { dimple = { radius_mm = 1.2, depth_mm = 0.7 } }\nlayout = { grid = { across_pitch_mm = 3, pitch_mm = 4 } }\n";
    let rim2 = 0.7 * (2.4 - 0.7);
    let found = area(&text(dimples, "on = \"plate.wall_plus_y\""));
    assert!((found - (360.0 - 28.0 * PI * rim2)).abs() < 1e-9, "{found}");
    let grooves = "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = { groove = { depth_mm = 1, angle_deg = 90 } }\nlayout = { row = { pitch_mm = 4 } }\n";
    let found = area(&text(grooves, "on = \"plate.wall_plus_y\""));
    assert!((found - (360.0 - 7.0 * 12.0 * 2.0)).abs() < 1e-6, "{found}");
    // The sides that the grooves end in.
    let found = area(&text(grooves, "on = \"plate.wall_plus_x\""));
    assert!((found - (120.0 - 7.0)).abs() < 1e-9, "{found}");
    let rings = "[reliefs.a]\non = \"rod.wall\"\nelement = { groove = { depth_mm = 1, angle_deg = 90, course = \"ring\" } }\nlayout = { row = { pitch_mm = 4 } }\n";
    let found = area(&text(rings, "on = \"rod.wall\""));
    assert!((found - 2.0 * PI * 3.0 * (30.0 - 14.0)).abs() < 1e-9, "{found}");
    // A ball on a round wall: across the seam it counts once, and the closed form is that of the
    // curve v² + 4Rc sin²(φ/2) = a².
    let balls = "[reliefs.a]\non = \"rod.wall\"\nelement = { dimple = { radius_mm = 1.2, depth_mm = 0.7 } }\nlayout = { row = { pitch_mm = 4, around_deg = 0 } }\n";
    let found = area(&text(balls, "on = \"rod.wall\""));
    let (c, n) = (3.5f64, 200_000);
    let taken: f64 = (0..n)
        .map(|i| {
            let phi = (f64::from(i) + 0.5) / f64::from(n) * PI;
            let v2 = rim2 - 4.0 * 3.0 * c * (0.5 * phi).sin().powi(2);
            2.0 * 3.0 * 2.0 * v2.max(0.0).sqrt() * PI / f64::from(n)
        })
        .sum();
    assert!((found - (2.0 * PI * 90.0 - 7.0 * taken)).abs() < 2e-3, "{found}, {taken}");
}
