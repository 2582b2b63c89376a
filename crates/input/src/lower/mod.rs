//! From the spec of the file to the scene that is traced, in one pass that also checks it.
//!
//! There is a file per topic. A function takes a spec with its key, notes everything that is wrong with it,
//! and returns what it makes of it, or `None`. If one thing failed, others that need it are left out without
//! another problem. So all problems of a file are reported together, and none twice. Things placed at faces
//! of other things are built after them.

mod bodies;
mod coatings;
mod consistency;
mod contacts;
pub(crate) mod context;
mod daylight;
mod emissions;
mod emitters;
mod finishes;
mod fluorescence;
mod flux;
mod haze;
mod laws;
mod lenses;
mod light_groups;
mod luminaire_exports;
mod luminaires;
mod media;
mod mesh_parts;
mod meshes;
pub(crate) mod names;
pub(crate) mod patterns;
mod place;
pub(crate) mod plan;
mod rays;
mod reliefs;
mod scatter;
mod sensor_keys;
mod sensors;
mod shares;
mod sheets;
mod slips;
mod solids;
mod sources;
mod spectra;
mod starts;
mod sun;
mod surfaces;
mod tubes;
mod weathers;

use crate::export::Exports;
use crate::keys::Places;
use crate::lower::context::{Context, Scope};
use crate::problems::Problems;
use crate::spec::SceneSpec;
use lumiduct_base::digest::Digest;
use lumiduct_core::optics::Medium;
use lumiduct_core::plan::{Check, RunPlan};
use lumiduct_core::scene::{Builder, Scene};

/// The result of lowering a scene file.
#[derive(Debug)]
pub(crate) struct Lowered {
    pub(crate) scene: Scene,
    pub(crate) run: RunPlan,
    pub(crate) checks: Vec<Check>,
    /// Identifies the contents of the mesh files.
    pub(crate) meshes: Digest,
    /// Luminaire files that goniometers are to write.
    pub(crate) exports: Exports,
}

/// Checks and lowers the spec of a file. `None` if anything is wrong, or if no scene is wanted.
pub(crate) fn lower(
    spec: &SceneSpec,
    places: &Places,
    scope: Scope,
    problems: &mut Problems,
) -> Option<Lowered> {
    problems.expect_echoes();
    names::check_title(&spec.title, problems);
    names::check(places, problems);
    let air = Medium::new(crate::spec::AIR, 1.0, 0.0);
    let mut builder = Builder::new(bodies::origin(spec), air, flux::unit(spec));
    builder.set_polarisation(spec.run.polarisation);
    let mut context = Context::new(spec, places, scope, builder, problems);
    context.lower_media();
    context.lower_finishes();
    context.lower_bodies();
    context.lower_reliefs();
    context.lower_patterns();
    context.check_directions_of_sky();
    context.lower_sources();
    context.lower_light_groups();
    context.lower_sensors();
    context.check_measures();
    let Context { builder, faces, meshes, exports, finish_tables, problems, .. } = context;
    plan::checks(&spec.check, problems);
    if scope == Scope::Keys || !problems.is_free_of_errors() {
        return None;
    }
    let mut scene = builder.build();
    let run = plan::run(spec, &scene);
    starts::settle_starts(&mut scene);
    starts::note_joints(spec, &scene, &faces, problems);
    starts::note_fits(&scene, problems);
    starts::check_starts(spec, &scene, problems);
    consistency::check_overlaps(spec, &scene, problems);
    consistency::check_open_faces(spec, &scene, problems);
    mesh_parts::check_parts(spec, &scene, problems);
    contacts::check_contacts(spec, &scene, problems);
    slips::check_slips(spec, &scene, problems);
    luminaire_exports::note_distances(&scene, &exports, problems);
    fluorescence::expect_energy(&scene, problems);
    spectra::note_tables(spec, places, &scene, problems);
    spectra::note_library(spec, &scene, problems);
    spectra::note_finish_tables(&finish_tables, &scene, problems);
    let checks = spec.check.clone();
    problems.is_free_of_errors().then_some(Lowered { scene, run, checks, meshes, exports })
}
