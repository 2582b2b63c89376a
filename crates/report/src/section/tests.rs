use super::*;
use lumiduct_input::{Settings, load};

/// A scene with a medium `pc` and a finish `film`.
pub(crate) fn scene_of(text: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cut.toml");
    let head = "lumiduct = 1\ntitle = \"cut\"\n[media.pc]\nindex = 1.586\n[finishes]\nfilm = { specular = { reflectance = 0.99 } }\n";
    let end = "[sensors]\nexit = { plane = { cells = [1, 1] }, on = \"rod.exit\", counts = \"leaving\" }\n";
    let has = |table: &str| text.contains(table);
    let led =
        "[sources.led.disk]\nradius_mm = 0.5\nat = { position_mm = [0, 0, -1] }\nflux_lm = 1\n";
    let light = if has("[sources") { "" } else { led };
    let end = if has("[sensors") { "" } else { end };
    std::fs::write(&path, format!("{head}{text}{light}{end}")).unwrap();
    load(&path, &Settings::default()).unwrap().scene
}

const ROD: &str = "[solids.rod.cylinder]\nradius_mm = 2\nlength_mm = 40\nmedium = \"pc\"\n";

fn view(scene: &Scene, wished: SectionView) -> View {
    View::of(scene, &wished).unwrap()
}

fn expect_on_plane(scene: &Scene, view: &View, places: &[[f64; 3]]) {
    for place in places {
        let away = view.plane.point_to_local(DVec3::from(*place) - scene.origin).z;
        assert!(away.abs() < 1e-6, "{place:?} is {away} mm beside the cut {:?}", view.plane);
    }
}

/// Where a place of the user's coordinates is in the picture.
fn drawn_at(scene: &Scene, view: &View, place: [f64; 3]) -> [f64; 2] {
    view.shown(view.seen(DVec3::from(place) - scene.origin))
}

fn expect_near(found: [f64; 2], wanted: [f64; 2]) {
    assert!(DVec2::from(found).distance(wanted.into()) < 1e-6, "{found:?} is not {wanted:?}");
}

#[test]
fn a_straight_guide_is_cut_along_its_axis_wherever_it_stands() {
    let scene = scene_of(&format!("{ROD}at = {{ position_mm = [30, -7, 5] }}\n"));
    let view = view(&scene, SectionView::default());
    expect_on_plane(&scene, &view, &[[30.0, -7.0, 5.0], [30.0, -7.0, 45.0]]);
    // It is horizontal, with its coordinates increasing from left to right.
    let [start, end] = [5.0, 45.0].map(|z| drawn_at(&scene, &view, [30.0, -7.0, z]));
    assert!((start[0] - 5.0).abs() < 1e-6 && (end[0] - 45.0).abs() < 1e-6, "{start:?} {end:?}");
    assert!((start[1] - end[1]).abs() < 1e-6);
}

#[test]
fn a_slanting_guide_is_cut_along_its_axis() {
    let scene = scene_of(&format!("{ROD}at = {{ position_mm = [1, 2, 3], axis = [1, 2, 2] }}\n"));
    let view = view(&scene, SectionView::default());
    let along =
        |length: f64| [1.0 + length / 3.0, 2.0 + 2.0 * length / 3.0, 3.0 + 2.0 * length / 3.0];
    expect_on_plane(&scene, &view, &[along(0.0), along(20.0), along(40.0)]);
    // Both walls are cut: the height of the outline across the axis is the thickness of the rod.
    let [start, end] =
        [0.0, 40.0].map(|length| DVec2::from(drawn_at(&scene, &view, along(length))));
    let across = (end - start).perp().normalize();
    let outlines = view.outlines(&scene);
    let wall = outlines.iter().filter(|outline| outline.name == "rod.wall");
    let heights: Vec<f64> =
        wall.flat_map(|own| &own.points).map(|at| (DVec2::from(*at) - start).dot(across)).collect();
    let [low, high] =
        [f64::min, f64::max].map(|pick| heights.iter().copied().reduce(pick).unwrap());
    assert!((low + 2.0).abs() < 0.01 && (high - 2.0).abs() < 0.01, "{low} to {high}");
}

#[test]
fn a_bent_pipe_is_cut_along_its_whole_centre_line() {
    let scene = scene_of(
        "[solids.rod.sweep]\nprofile = { circle = { radius_mm = 1 } }\nmedium = \"pc\"\n\
         path = [{ straight_mm = 10 }, { bend_deg = 90, radius_mm = 8, toward_deg = 90 }, { straight_mm = 10 }]\n",
    );
    let view = view(&scene, SectionView::default());
    // Around the middle of the bend at y = 8, z = 10.
    let middle = 8.0 * std::f64::consts::FRAC_1_SQRT_2;
    let places =
        [[0.0; 3], [0.0, 0.0, 10.0], [0.0, 8.0 - middle, 10.0 + middle], [0.0, 18.0, 18.0]];
    expect_on_plane(&scene, &view, &places);
    let [low, high] = [view.window.min, view.window.max].map(|corner| view.shown(corner));
    for place in places {
        let at = DVec2::from(drawn_at(&scene, &view, place));
        assert!(at.cmpgt(low.into()).all() && at.cmplt(high.into()).all(), "{at} is cut off");
    }
}

#[test]
fn a_plane_and_a_direction_are_those_that_are_asked_for() {
    let scene = scene_of(&format!("{ROD}at = {{ position_mm = [30, -7, 5] }}\n"));
    let plane = Some(CutPlane { across: 1, at_mm: Some(-6.5) });
    let up = Some(DVec3::NEG_Z);
    let own = view(&scene, SectionView { plane, up, zoom: None });
    expect_on_plane(&scene, &own, &[[0.0, -6.5, 0.0], [9.0, -6.5, 9.0]]);
    assert_eq!((own.plane.x, own.plane.y), (DVec3::X, DVec3::NEG_Z));
    expect_near(drawn_at(&scene, &own, [31.0, 0.0, 6.0]), [31.0, -6.0]);
    let words = own.words(&scene, 50, &own.outlines(&scene), &own.places(&scene, &[]));
    assert!(words.starts_with("cut at y = −6.5 mm; 50 paths"), "{words}");
    // Without a place it passes through the middle of what is shown.
    let plane = Some(CutPlane { across: 2, at_mm: None });
    let own = view(&scene, SectionView { plane, ..SectionView::default() });
    expect_on_plane(&scene, &own, &[[30.0, -7.0, 25.0]]);
    let up = Some(DVec3::Z);
    let wrong = View::of(&scene, &SectionView { plane, up, zoom: None }).err().unwrap().to_string();
    assert!(wrong.contains("--up z") && wrong.contains("across"), "{wrong}");
}

#[test]
fn a_zoom_shows_one_thing_with_its_surroundings() {
    let scene = scene_of(ROD);
    let zoomed = |name: &str| {
        View::of(&scene, &SectionView { zoom: Some(name.into()), ..SectionView::default() })
    };
    let view = zoomed("rod.exit").unwrap();
    expect_on_plane(&scene, &view, &[[0.0, 0.0, 40.0]]);
    expect_near(view.shown(0.5 * (view.window.min + view.window.max)), [40.0, 0.0]);
    // The face is 4 mm high: a quarter of that is added on every side, and the picture is not a
    // strip.
    let size = view.window.max - view.window.min;
    assert!((size - DVec2::new(4.0, 6.0)).abs().max_element() < 1e-6, "{size}");
    let wrong = zoomed("rod.exitt").err().unwrap().to_string();
    assert!(wrong.contains("rod.exitt") && wrong.contains("rod.exit, rod.wall"), "{wrong}");
}

#[test]
fn what_is_beyond_the_picture_is_named() {
    let lamp =
        "[sources.lamp.disk]\nradius_mm = 1\nat = { position_mm = [0, 0, -300] }\nflux_lm = 1\n";
    let scene = scene_of(&format!("{ROD}{lamp}"));
    let view = view(&scene, SectionView::default());
    let words = view.words(&scene, 50, &view.outlines(&scene), &view.places(&scene, &[]));
    assert!(words.ends_with("; outside: lamp"), "{words}");
}

#[test]
fn light_from_above_is_drawn_from_above() {
    let lamp = "[sources.lamp.disk]\nradius_mm = 1\nat = { position_mm = [0, 0, 41], axis = [0, 0, -1] }\nflux_lm = 1\n";
    let view = view(&scene_of(&format!("{ROD}{lamp}")), SectionView::default());
    assert_eq!(view.plane.y, DVec3::Z);
}
