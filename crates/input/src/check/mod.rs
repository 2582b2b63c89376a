//! Rules of a scene that span several keys and need only the file.
//!
//! Geometry, and whether a named face exists, is decided when the scene is built.

use crate::check::scene::Scene;
use crate::keys::Places;
use crate::problems::Problems;
use crate::spec::SceneSpec;

mod daylight;
mod finishes;
mod media;
mod names;
mod placements;
mod references;
mod run;
mod scene;
mod sensors;
mod shapes;
mod sources;
mod surfaces;

pub(crate) use names::{check_length, check_name, check_title};
pub(crate) use run::check_demands;

/// Notes duplicate names, and references to missing things.
pub fn check_names(spec: &SceneSpec, places: &Places, problems: &mut Problems) {
    let scene = Scene { spec, places };
    check_title(&spec.title, problems);
    names::check(places, problems);
    references::check(scene, problems);
}

/// Notes every broken rule about the keys of one table.
pub fn check_rules(spec: &SceneSpec, places: &Places, problems: &mut Problems) {
    let scene = Scene { spec, places };
    media::check(scene, problems);
    finishes::check(scene, problems);
    placements::check(scene, problems);
    shapes::check(scene, problems);
    sources::check(scene, problems);
    daylight::check(scene, problems);
    sensors::check(scene, problems);
    run::check(scene, problems);
}
