//! Axes of faces are those of their maps.

use glam::DVec2;
use lumiduct_core::scene::{FaceId, Scene};
use lumiduct_input::{Settings, load};

/// Every kind of shape and of chart, all off the axes of the scene.
const FACES: &str = r#"
lumiduct = 1
title = "axes"
[media.glass]
index = 1.5
[finishes]
film = { specular = { reflectance = 0.9 } }
[solids.rod.cylinder]
radius_mm = 2
length_mm = 10
medium = "glass"
at = { position_mm = [3, -1, 2], axis = [1, 2, -1] }
[solids.bar.box]
size_mm = [4, 3, 20]
medium = "glass"
at = { position_mm = [30, 0, 0], axis = [1, 0, 1] }
[solids.bent.sweep]
profile = { rectangle = { width_mm = 4, height_mm = 2 } }
path = [{ straight_mm = 8 }, { bend_deg = 60, radius_mm = 9, toward_deg = 90 }, { straight_mm = 5 }]
medium = "glass"
at = { position_mm = [-30, 0, 0] }
[solids.dome.sphere]
radius_mm = 5
medium = "glass"
at = { position_mm = [0, 40, 0], axis = [0, 1, 1] }
[solids.head.lens]
diameter_mm = 4
thickness_mm = 1.6
exit_radius_mm = -2.5
medium = "glass"
at = { position_mm = [0, -40, 0], axis = [1, 1, 0] }
[sheets.funnel.tube]
profile = { circle = { radius_mm = 4 } }
path = [{ straight_mm = 10, end_scale = 0.5 }, { bend_deg = 90, radius_mm = 8, toward_deg = 30 }]
finish = "film"
at = { position_mm = [60, 0, 0] }
[sheets.ring.annulus]
inner_radius_mm = 3
outer_radius_mm = 6
finish = "film"
at = { position_mm = [80, 0, 0], axis = [0, 1, 0] }
[sources.led.point]
at = { position_mm = [0, 0, 100] }
flux_lm = 1
[sensors]
free = { plane = { rectangle = { width_mm = 3, height_mm = 2 }, cells = [3, 2] }, at = { position_mm = [0, 0, 50], axis = [1, 0, 1], roll_deg = 20 } }
"#;

fn faces() -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("axes.toml");
    std::fs::write(&path, FACES).unwrap();
    load(&path, &Settings::default()).unwrap().scene
}

#[test]
fn axes_are_those_of_the_chart() {
    let scene = faces();
    for (index, face) in scene.faces.iter().enumerate() {
        let axes = scene.face_axes(FaceId::new(index)).unwrap();
        let (size, name) = ((axes.rect.max - axes.rect.min).length(), &face.name);
        let wanted = DVec2::ZERO.clamp(axes.rect.min, axes.rect.max);
        assert!(axes.at.distance(wanted) < 1e-6 * size, "{name}: {axes:?}");
        assert!(axes.u.dot(axes.v).abs() + axes.u.dot(axes.normal).abs() < 1e-9, "{name}");
        // A step inward from the origin, where the face continues.
        let patches = scene.face_patches(FaceId::new(index));
        let middle = 0.5 * (axes.rect.min + axes.rect.max);
        let inward = middle - axes.at;
        let inward = DVec2::new(1f64.copysign(inward.x), 1f64.copysign(inward.y));
        let step = 1e-4 * size;
        let point = axes.origin + step * (inward.x * axes.u + inward.y * axes.v);
        let moved = patches
            .iter()
            .map(|patch| (patch.chart(point) - axes.at) * inward)
            .min_by(|a, b| a.length().total_cmp(&b.length()))
            .unwrap();
        assert!(moved.cmpgt(DVec2::splat(0.3 * step)).all(), "{name}: {moved} of {step}");
    }
}

#[test]
fn directions_and_placements_at_flat_faces_have_the_axes_of_maps() {
    let scene = faces();
    let mut flat = 0;
    for index in 0..scene.faces.len() {
        let face = FaceId::new(index);
        let (Some(axes), Some(plane)) = (scene.face_axes(face), scene.face_plane(face)) else {
            continue;
        };
        let name = &scene.faces[index].name;
        flat += 1;
        assert!(axes.normal.distance(plane.z) < 1e-12, "{name}");
        assert!(axes.u.distance(plane.x) < 1e-9, "{name}: u {} x {}", axes.u, plane.x);
        assert!(axes.v.distance(plane.y) < 1e-9, "{name}: v {} y {}", axes.v, plane.y);
    }
    assert!(flat > 10);
}
