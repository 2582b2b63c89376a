//! Outlines of the elements of patterns.

use lumiduct_core::scene::FaceFacets;
use lumiduct_core::scene::pattern::ElementOutline;
use lumiduct_input::{Settings, load};

/// A plate with dots, and a rod with a row of them along its round wall, over the seam of its coordinates.
const SCENE: &str = r#"
lumiduct = 1
title = "dots"
[media.glass]
index = 1.5
[finishes.white.lambertian]
reflectance = 0.9
[solids.rod.cylinder]
radius_mm = 5
length_mm = 40
medium = "glass"
[solids.plate.box]
size_mm = [8, 8, 2]
medium = "glass"
at = { position_mm = [20, 0, 3], axis = [1, 1, 0] }
[patterns.end]
on = "plate.exit"
finish = "white"
element = { circle = { diameter_mm = 1 } }
layout = { grid = { pitch_mm = 2, across_pitch_mm = 2 } }
[patterns.wall]
on = "rod.wall"
finish = "white"
element = { circle = { diameter_mm = [[0, 1], [40, 2]] } }
layout = { row = { pitch_mm = 4, along_mm = [5, 35] } }
[patterns.stripes]
on = "rod.wall"
finish = "white"
element = { rectangle = { width_mm = 20, length_mm = 0.5 } }
layout = { row = { positions_mm = [38] } }
"#;

#[test]
fn corners_of_elements_lie_on_their_face_as_far_from_the_middle_as_the_element_reaches() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dots.toml");
    std::fs::write(&path, SCENE).unwrap();
    let scene = load(&path, &Settings::default()).unwrap().scene;
    for pattern in &scene.patterns {
        let FaceFacets { facets, one_in } = scene.element_outlines(pattern, 5);
        let places: Vec<_> = pattern.field.places().step_by(one_in).collect();
        assert_eq!(facets.rims.len(), places.len(), "{}", pattern.name);
        assert!((2..=5).contains(&places.len()) || pattern.name == "stripes");
        let [patch] = scene.face_patches(pattern.face) else { panic!("one patch") };
        for (rim, (place, middle)) in facets.rims.iter().zip(places) {
            let half = 0.5 * pattern.field.outline.size(place);
            assert!(rim.len() > 4 && rim.first() == rim.last());
            for p in rim.iter().map(|i| facets.points[*i]) {
                assert!(patch.shape.bounds().grown(1e-9).contains(p), "{}: {p}", pattern.name);
                let mut from = patch.chart(p) - middle;
                if let Some(period) = pattern.field.period {
                    from.x -= period * (from.x / period).round();
                }
                let reach = match pattern.field.outline {
                    ElementOutline::Circle { .. } => from.length() / half.x,
                    _ => (from / half).abs().max_element(),
                };
                assert!((reach - 1.0).abs() < 1e-9, "{}: {reach}", pattern.name);
            }
        }
    }
}
