//! How a scene is cut for its pictures.

use glam::DVec3;
use lumiduct_core::scene::{Guides, Scene};
use lumiduct_input::{Settings, load};

fn guides_of(text: &str) -> (Scene, Guides) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("guides.toml");
    let head = "lumiduct = 1\ntitle = \"guides\"\n[media.pc]\nindex = 1.586\n[finishes]\nfilm = { specular = { reflectance = 0.99 } }\n";
    std::fs::write(&path, format!("{head}{text}")).unwrap();
    let scene = load(&path, &Settings::default()).unwrap().scene;
    let guides = scene.guides();
    (scene, guides)
}

/// Pipes of 3 mm along z with their middles at these x, a panel and a board of 120 mm, and an LED.
fn pipes_and_panel(places: &[f64]) -> String {
    let mut text = String::from(
        r#"
[sheets.panel.annulus]
inner_radius_mm = 20
outer_radius_mm = 60
finish = "black"
at = { position_mm = [0, 0, 24.5] }
[sheets.board.disk]
radius_mm = 60
finish = "black"
at = { position_mm = [0, 0, -0.9] }
[sources.led.rectangle]
width_mm = 0.3
height_mm = 0.3
at = { position_mm = [0, 0, -0.5] }
flux_lm = 1
[sensors]
exit = { plane = {}, on = "pipe0.exit", counts = "leaving" }
"#,
    );
    for (index, x) in places.iter().enumerate() {
        text += &format!(
            "[solids.pipe{index}.cylinder]\nradius_mm = 1.5\nlength_mm = 25\nmedium = \"pc\"\nat = {{ position_mm = [{x}, 0, 0] }}\n"
        );
    }
    text
}

#[test]
fn a_cut_goes_along_a_pipe_whatever_panel_stands_around_it() {
    let (scene, guides) = guides_of(&pipes_and_panel(&[0.0]));
    assert!(guides.plane.z.z.abs() < 1e-12, "{:?}", guides.plane);
    assert!((guides.plane.origin + scene.origin).truncate().length() < 1e-9);
    let size = guides.bounds.max - guides.bounds.min;
    assert!(size.x < 3.1 && size.y < 3.1 && (25.0..26.0).contains(&size.z), "{size}");
}

#[test]
fn a_cut_goes_through_both_of_two_pipes() {
    let (scene, guides) = guides_of(&pipes_and_panel(&[0.0, 5.0]));
    assert!((guides.plane.z.y.abs() - 1.0).abs() < 1e-12, "{:?}", guides.plane);
    assert!((guides.plane.origin + scene.origin).y.abs() < 1e-9);
    assert!((guides.bounds.max - guides.bounds.min).x > 7.9);
}

#[test]
fn a_cut_holds_the_bends_of_a_duct_in_a_room() {
    // Elbows in the plane of z and a direction 30 degrees off x; the room is much larger.
    let (scene, guides) = guides_of(
        r#"
[sheets.room.tube]
profile = { rectangle = { width_mm = 5000, height_mm = 5000 } }
path = [{ straight_mm = 2700 }]
finish = "film"
at = { position_mm = [0, 0, -1500], axis = [0, 0, -1] }
[sheets.duct.tube]
profile = { circle = { radius_mm = 175 } }
path = [
    { straight_mm = 300 },
    { corner_deg = 30, toward_deg = 30 },
    { straight_mm = 900 },
    { corner_deg = 30, toward_deg = 210 },
    { straight_mm = 300 },
]
finish = "film"
at = { axis = [0, 0, -1], x_axis = [1, 0, 0] }
[sources.sky.sky]
model = "overcast"
horizontal_illuminance_lx = 10_000
aim = "duct.entry"
"#,
    );
    let duct = scene.bodies().into_iter().find(|body| body.name == "duct").unwrap();
    for end in ["duct.entry", "duct.exit"] {
        let face = scene.face_plane(scene.face_named(end).unwrap()).unwrap();
        let off = guides.plane.point_to_local(face.origin).z;
        assert!(off.abs() < 1e-9 && face.z.dot(guides.plane.z).abs() < 1e-12, "{end}: {off}");
    }
    assert!(guides.plane.z.x.abs() > 0.1 && guides.plane.z.y.abs() > 0.1);
    assert_eq!(guides.bounds, duct.bounds);
}

#[test]
fn a_pane_is_cut_from_one_side_to_the_other_and_a_ball_through_its_middle() {
    let (scene, guides) = guides_of(
        r#"
[solids.slab.box]
size_mm = [30, 20, 4]
medium = "pc"
[sources.led.point]
at = { position_mm = [0, 0, 10] }
flux_lm = 1
"#,
    );
    assert!(guides.plane.z.z.abs() < 1e-12, "{:?}", guides.plane);
    assert!((guides.plane.origin + scene.origin).length() < 1e-12);
    let (scene, guides) = guides_of(
        r#"
[solids.ball.sphere]
radius_mm = 3
medium = "pc"
at = { position_mm = [7, 8, 9] }
[sources.led.point]
at = { position_mm = [-20, 0, 10] }
flux_lm = 1
"#,
    );
    assert!((guides.plane.origin + scene.origin).distance(DVec3::new(7.0, 8.0, 9.0)) < 1e-9);
    // The lamp is too far away to belong to the ball.
    assert!((guides.bounds.max - guides.bounds.min).max_element() < 6.1);
}
