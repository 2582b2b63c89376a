//! Meshes of the scenes.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use lumiduct_files::mesh::{LengthUnit, read};
use lumiduct_input::{Settings, load};
use std::f64::consts::{PI, TAU};
use std::path::Path;

#[test]
fn the_light_guide_of_the_scenes_is_sound() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/meshes/lightguide.glb");
    let mesh = read(&path, LengthUnit::Metre).unwrap();
    assert_eq!(mesh.mesh.faces, ["entry", "wall", "exit"]);
    let health = mesh.health();
    assert!(health.is_sound(), "{health:?}");
    assert_eq!((health.shells, health.opposed_normals.count, &health.facets), (1, 0, &None));
    // A bent rod has the volume of a straight one (Pappus): π r² L, less what 96 facets cut off.
    let share = health.signed_volume_mm3 / (PI * 4.0 * 40.0);
    assert!((share - (TAU / 96.0).sin() / (TAU / 96.0)).abs() < 1e-4, "{share}");
}

/// A mesh with two different layers on one face.
#[test]
fn light_from_outside_meets_the_layers_of_a_mesh_in_the_opposite_order() {
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/glass_lightguide_mesh.toml");
    let stack = "finishes.layers={ stack = { layers = [{ index = 2.1, thickness_nm = 60 }, { index = 1.38, thickness_nm = 100 }], wavelength_nm = 550 } }";
    let faces = "solids.guide.mesh.faces={ entry = \"layers\" }";
    let overrides = [stack, faces].map(str::to_owned).to_vec();
    let job = load(&scene, &Settings { overrides, ..Settings::default() }).unwrap();
    let face = job.scene.faces.iter().find(|face| face.name == "guide.entry").unwrap();
    let [outside, inside] =
        [face.front, face.back].map(|finish| &job.scene.finishes[finish.unwrap().index()].finish);
    assert_ne!(outside, inside);
    assert_eq!(inside.from_behind().as_ref(), Some(outside));
}
