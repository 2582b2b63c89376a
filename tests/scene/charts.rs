//! The charts of faces, over which sensors have their cells.

use glam::DVec2;
use lumiduct_core::scene::shape::ChartRect;
use lumiduct_input::{Settings, load};

const DUCT: &str = r#"
lumiduct = 1
title = "duct"
[finishes]
film = { specular = { reflectance = 0.99 } }
[sheets.duct.tube]
profile = { PROFILE }
path = [{ straight_mm = 20, end_scale = 0.6 }, { bend_deg = 60, radius_mm = 12, toward_deg = 30 }, { straight_mm = 5 }]
finish = "film"
[sources.lamp.disk]
radius_mm = 1
flux_lm = 1
at = { position_mm = [0, 0, -1] }
"#;

/// Tapers and bends stretch the charts of their walls, which are filled all the same.
#[test]
fn cells_of_tapers_and_bends_are_whole() {
    for (profile, walls) in [
        ("rectangle = { width_mm = 10, height_mm = 6 }", &["wall_plus_x", "wall_minus_y"][..]),
        ("circle = { radius_mm = 4 }", &["wall"]),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("duct.toml");
        std::fs::write(&path, DUCT.replace("PROFILE", profile)).unwrap();
        let scene = load(&path, &Settings::default()).unwrap().scene;
        for wall in walls {
            let face = scene.face_named(&format!("duct.{wall}")).unwrap();
            let rect = scene.face_rect(face).unwrap();
            let step = (rect.max - rect.min) / DVec2::new(6.0, 9.0);
            for cell in 0..54 {
                let place = DVec2::new(f64::from(cell % 6), f64::from(cell / 6));
                let min = rect.min + step * place;
                let filled = scene.face_charted_in(face, ChartRect { min, max: min + step });
                assert!((filled / (step.x * step.y) - 1.0).abs() < 1e-9, "{wall} {cell}: {filled}");
            }
        }
    }
}
