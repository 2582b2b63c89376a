//! Whether a solid with relief has the shape given by its elements, tested without its surfaces.

use crate::{BODIES, LAMP, load};
use glam::{DVec2, DVec3};
use lumiduct_core::rng::{Dimension, Sampler};
use lumiduct_core::scene::shape::ChartRect;
use lumiduct_core::scene::{Inside, Ray, Scene, SolidId, StartSide, StartSurfaces};
use std::f64::consts::PI;

/// A direction not aligned with any axis.
fn direction(sampler: &mut Sampler) -> DVec3 {
    lumiduct_base::math::uniform_sphere(sampler.pair(Dimension::EmitDirection))
}

/// A point of a box, mm.
fn point(sampler: &mut Sampler, min: DVec3, max: DVec3) -> DVec3 {
    let [x, y] = sampler.pair(Dimension::EmitPosition);
    let z = sampler.one(Dimension::EmitPosition);
    min + DVec3::new(x, y, z) * (max - min)
}

/// Follows lines through a solid: every segment between two surfaces is inside or outside as
/// `holds` says of its middle, relative to the middle of the wall's start. The volume by points
/// equals that in the scene.
fn assert_is(name: &str, relief: &str, min: DVec3, max: DVec3, holds: impl Fn(DVec3) -> bool) {
    let job = load(&format!("{BODIES}{relief}{LAMP}"), 1);
    let scene: &Scene = &job.scene;
    let index = scene.solids.iter().position(|solid| solid.name == name).unwrap();
    let solid = SolidId::new(index);
    let holds = |p: DVec3| holds(p + scene.origin);
    let (min, max) = (min - scene.origin, max - scene.origin);
    let (lines, mut crossed) = (6000, 0);
    for line in 0..lines {
        let mut sampler = Sampler::for_path(77, 0, line);
        let start = point(&mut sampler, min, max);
        let mut ray = Ray::new(start, direction(&mut sampler));
        let mut inside = scene.inside_at(&ray, StartSide::Ahead);
        assert_eq!(inside.contains(solid), holds(start), "{relief}: {start}");
        let mut on = StartSurfaces::default();
        while let Some(hits) = scene.find_next(&ray, &on, &inside) {
            // Rounding dominates shorter segments.
            if hits.distance() > 1e-9 {
                let middle = ray.at(0.5 * hits.distance());
                let within = (middle - min).cmpgt(DVec3::ZERO).all()
                    && (max - middle).cmpgt(DVec3::ZERO).all();
                assert!(
                    !within || inside.contains(solid) == holds(middle),
                    "{relief}: {middle} on {ray:?}"
                );
            }
            hits.cross(&mut inside);
            on = StartSurfaces::hits(&hits);
            ray = ray.advanced(hits.distance());
            crossed += 1;
        }
        assert!(inside == Inside::default(), "{relief}: {ray:?} never comes out");
    }
    assert!(2 * crossed > lines, "only {crossed} crossings");
    let expected = scene.solids[index].volume.unwrap();
    let found = volume(min, max, &holds);
    assert!(
        (found / expected - 1.0).abs() < 2e-4,
        "{relief}: volume {found}, in the scene {expected}"
    );
}

/// Volume by a fine lattice of points, mm³.
fn volume(min: DVec3, max: DVec3, holds: &impl Fn(DVec3) -> bool) -> f64 {
    let n = 220;
    let size = max - min;
    let mut inside = 0u64;
    for i in 0..n * n * n {
        let cell = DVec3::new(f64::from(i % n), f64::from(i / n % n), f64::from(i / n / n));
        // Shifted from layer to layer, so that no plane of the solid meets a whole layer of points.
        let shift = DVec3::new(0.618 * cell.y, 0.755 * cell.z, 0.570 * cell.x).map(f64::fract);
        inside += u64::from(holds(min + (cell + shift) / f64::from(n) * size));
    }
    size.element_product() * inside as f64 / f64::from(n * n * n)
}

fn in_plate(p: DVec3) -> bool {
    p.x.abs() < 6.0 && p.y.abs() < 2.0 && p.z > 0.0 && p.z < 30.0
}

const MIN: DVec3 = DVec3::new(-6.5, -4.5, -0.3);
const MAX: DVec3 = DVec3::new(6.5, 4.5, 30.4);

fn in_rod(p: DVec3) -> bool {
    (p - DVec3::new(40.0, 0.0, 0.0)).truncate().length() < 3.0 && p.z > 0.0 && p.z < 30.0
}

const ROD_MIN: DVec3 = DVec3::new(36.0, -4.5, -0.3);
const ROD_MAX: DVec3 = DVec3::new(44.5, 4.5, 30.4);

#[test]
fn dimples_and_bumps_on_a_plate_are_balls_taken_out_and_put_on() {
    let grid = "layout = { staggered = { across_pitch_mm = 3, pitch_mm = 4 } }";
    // Rows at 3, 7, ..., columns at ±1.5 and ±4.5 less the shift.
    let centers: Vec<DVec3> = (0..7)
        .flat_map(|row| {
            let shift = if row % 2 == 1 { 1.5 } else { 0.0 };
            (0..3).map(move |column| {
                let x = -3.75 + shift + 3.0 * f64::from(column);
                DVec3::new(x, 0.0, 3.0 + 4.0 * f64::from(row))
            })
        })
        .collect();
    for (side, sign) in [("plus", 1.0), ("minus", -1.0)] {
        // On the lower wall u runs in the opposite direction.
        let ball = |p: DVec3, height: f64, radius: f64| {
            centers.iter().any(|c| {
                let c = DVec3::new(-sign * c.x, sign * (2.0 + height), c.z);
                p.distance(c) < radius
            })
        };
        let dimples = format!(
            "[reliefs.a]\non = \"plate.wall_{side}_y\"\nelement = {{ dimple = {{ radius_mm = 1.2, depth_mm = 0.7 }} }}\n{grid}\n"
        );
        assert_is("plate", &dimples, MIN, MAX, |p| in_plate(p) && !ball(p, 0.5, 1.2));
        // Half a ball, by its diameter.
        let bumps = format!(
            "[reliefs.a]\non = \"plate.wall_{side}_y\"\nelement = {{ bump = {{ diameter_mm = 2.4, height_mm = 1.2 }} }}\n{grid}\n"
        );
        assert_is("plate", &bumps, MIN, MAX, |p| in_plate(p) || ball(p, 0.0, 1.2));
    }
}

#[test]
fn the_chart_of_a_wall_lacks_the_openings_of_its_dimples() {
    let relief = "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = { dimple = { radius_mm = 1.2, depth_mm = 0.7 } }\n\
        layout = { staggered = { across_pitch_mm = 3, pitch_mm = 4 } }\n";
    let scene = load(&format!("{BODIES}{relief}{LAMP}"), 1).scene;
    let wall = scene.face_named("plate.wall_plus_y").unwrap();
    let whole = scene.face_rect(wall).unwrap();
    // 21 circles with the radius² 1.2² - 0.5².
    let expected = 12.0 * 30.0 - 21.0 * PI * (1.44 - 0.25);
    assert!((scene.face_charted_in(wall, whole) - expected).abs() < 1e-6);
    let step = (whole.max - whole.min) / DVec2::new(5.0, 7.0);
    let parts = (0..35).map(|cell| {
        let min = whole.min + step * DVec2::new(f64::from(cell % 5), f64::from(cell / 5));
        let part = scene.face_charted_in(wall, ChartRect { min, max: min + step });
        assert!((-1e-9..=step.x * step.y * (1.0 + 1e-9)).contains(&part), "{part}");
        part
    });
    assert!((parts.sum::<f64>() - expected).abs() < 1e-6);
}

/// A wedge with its middle at z, with a height and two cotangents, above or below a plane at
/// distance d from it.
fn in_wedge(from: f64, away: f64, height: f64, [before, after]: [f64; 2]) -> bool {
    let edge = 0.5 * height * (before - after);
    let left = height - away;
    away >= 0.0 && left > 0.0 && from - edge > -left * before && from - edge < left * after
}

#[test]
fn grooves_and_ridges_are_wedges() {
    let places: Vec<f64> = (0..7).map(|row| 3.0 + 4.0 * f64::from(row)).collect();
    let row = "layout = { row = { pitch_mm = 4 } }";
    let slopes = |angles: [f64; 2]| {
        angles.map(|a: f64| if a == 90.0 { 0.0 } else { 1.0 / a.to_radians().tan() })
    };
    for (keys, angles, half) in [
        ("angle_deg = 90", [45.0, 45.0], 6.0),
        ("flank_angles_deg = [30, 60]", [30.0, 60.0], 6.0),
        ("flank_angles_deg = [90, 40], length_mm = 5", [90.0, 40.0], 2.5),
    ] {
        let wedges = |p: DVec3, away: f64| {
            p.x.abs() < half && places.iter().any(|z| in_wedge(p.z - z, away, 1.1, slopes(angles)))
        };
        let groove = format!(
            "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = {{ groove = {{ depth_mm = 1.1, {keys} }} }}\n{row}\n"
        );
        assert_is("plate", &groove, MIN, MAX, |p| in_plate(p) && !wedges(p, 2.0 - p.y));
        let ridge = format!(
            "[reliefs.a]\non = \"plate.wall_minus_y\"\nelement = {{ ridge = {{ height_mm = 1.1, {keys} }} }}\n{row}\n"
        );
        assert_is("plate", &ridge, MIN, MAX, |p| in_plate(p) || wedges(p, -2.0 - p.y));
    }
}

#[test]
fn pyramids_and_pits_have_four_sides() {
    let row = "layout = { row = { positions_mm = [5, 14], across_mm = 1.5 } }";
    let keys = "width_mm = 3, length_mm = 5";
    let pyramid = |p: DVec3, away: f64| {
        [5.0, 14.0].iter().any(|z| {
            let left = 1.0 - away / 1.3;
            away >= 0.0 && (p.x + 1.5).abs() < 1.5 * left && (p.z - z).abs() < 2.5 * left
        })
    };
    let raised = format!(
        "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = {{ pyramid = {{ {keys}, height_mm = 1.3 }} }}\n{row}\n"
    );
    assert_is("plate", &raised, MIN, MAX, |p| in_plate(p) || pyramid(p, p.y - 2.0));
    let sunk = format!(
        "[reliefs.a]\non = \"plate.wall_plus_y\"\nelement = {{ pit = {{ {keys}, depth_mm = 1.3 }} }}\n{row}\n"
    );
    assert_is("plate", &sunk, MIN, MAX, |p| in_plate(p) && !pyramid(p, 2.0 - p.y));
}

#[test]
fn a_rod_takes_balls_saw_cuts_and_rings() {
    let axis = DVec3::new(40.0, 0.0, 0.0);
    let row = "layout = { row = { positions_mm = [4, 9, 20], around_deg = 30 } }";
    let out = DVec3::new(30f64.to_radians().cos(), 30f64.to_radians().sin(), 0.0);
    let places = [4.0, 9.0, 20.0];
    let ball = |p: DVec3, from_axis: f64, radius: f64| {
        places.iter().any(|z| p.distance(axis + from_axis * out + z * DVec3::Z) < radius)
    };
    let on = "[reliefs.a]\non = \"rod.wall\"\nelement = ";
    let dimple = format!("{on}{{ dimple = {{ radius_mm = 2, depth_mm = 0.9 }} }}\n{row}\n");
    assert_is("rod", &dimple, ROD_MIN, ROD_MAX, |p| in_rod(p) && !ball(p, 3.0 + 1.1, 2.0));
    let bump = format!("{on}{{ bump = {{ radius_mm = 1.8, height_mm = 0.8 }} }}\n{row}\n");
    assert_is("rod", &bump, ROD_MIN, ROD_MAX, |p| in_rod(p) || ball(p, 3.0 - 1.0, 1.8));
    let groove =
        format!("{on}{{ groove = {{ depth_mm = 1.2, flank_angles_deg = [35, 90] }} }}\n{row}\n");
    let slopes = [1.0 / 35f64.to_radians().tan(), 0.0];
    assert_is("rod", &groove, ROD_MIN, ROD_MAX, |p| {
        let away = 3.0 - (p - axis).dot(out);
        in_rod(p) && !places.iter().any(|z| in_wedge(p.z - z, away, 1.2, slopes))
    });
    let row = "layout = { row = { positions_mm = [4, 9, 20] } }";
    let rings = |p: DVec3, sign: f64, slopes: [f64; 2]| {
        let away = sign * ((p - axis).truncate().length() - 3.0);
        places.iter().any(|z| in_wedge(p.z - z, away, 1.0, slopes))
    };
    for (keys, slopes) in
        [("angle_deg = 90", [1.0, 1.0]), ("flank_angles_deg = [90, 45]", [0.0, 1.0])]
    {
        let sunk =
            format!("{on}{{ groove = {{ depth_mm = 1, {keys}, course = \"ring\" }} }}\n{row}\n");
        assert_is("rod", &sunk, ROD_MIN, ROD_MAX, |p| in_rod(p) && !rings(p, -1.0, slopes));
        let raised =
            format!("{on}{{ ridge = {{ height_mm = 1, {keys}, course = \"ring\" }} }}\n{row}\n");
        assert_is("rod", &raised, ROD_MIN, ROD_MAX, |p| in_rod(p) || rings(p, 1.0, slopes));
    }
}
