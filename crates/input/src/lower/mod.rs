//! From the spec of the file to the scene that is traced.
//!
//! Things placed at faces of other things are built after them. Every function notes problems and
//! continues, so that all problems of a scene are reported together; what cannot be built is left
//! out.

mod consistency;
mod contacts;
mod context;
mod daylight;
mod finishes;
mod flux;
mod lenses;
mod light_groups;
mod meshes;
mod patterns;
mod place;
pub(crate) mod plan;
mod reliefs;
mod sensors;
mod sheets;
mod slips;
mod solids;
mod sources;
mod starts;
mod surfaces;
mod tubes;
mod weathers;

use crate::keys::{Key, Places};
use crate::lower::context::Context;
use crate::problems::Problems;
use crate::spec::SceneSpec;
use crate::spec::finish::ScatteringSpec;
use crate::spec::placement::PlacementSpec;
use crate::spec::source::SourceSpec;
use glam::DVec3;
use indexmap::IndexMap;
use lumiduct_base::digest::Digest;
use lumiduct_base::units::FluxUnit;
use lumiduct_core::optics::{Medium, VolumeScattering};
use lumiduct_core::plan::{Check, RunPlan};
use lumiduct_core::scene::{Builder, MediumId, Scene};

/// The result of lowering a scene file.
#[derive(Debug)]
pub(crate) struct Lowered {
    pub(crate) scene: Scene,
    pub(crate) run: RunPlan,
    pub(crate) checks: Vec<Check>,
    /// Identifies the contents of the mesh files.
    pub(crate) meshes: Digest,
}

/// Lowers a validated spec. `None` when a problem left nothing to trace.
pub(crate) fn lower(spec: &SceneSpec, places: &Places, problems: &mut Problems) -> Option<Lowered> {
    let air = Medium::new(crate::spec::AIR, 1.0, 0.0);
    let mut context = Context {
        spec,
        places,
        problems,
        builder: Builder::new(origin(spec), air, flux_unit(spec)),
        meshes: Digest::default(),
        media: IndexMap::from([(crate::spec::AIR.to_owned(), MediumId::new(0))]),
        finishes: IndexMap::new(),
        behind: IndexMap::new(),
        faces: IndexMap::new(),
        members: Vec::new(),
    };
    context.lower_media();
    context.lower_finishes();
    context.lower_bodies();
    context.lower_reliefs();
    context.lower_patterns();
    context.lower_sources();
    context.lower_light_groups();
    context.lower_sensors();
    let mut run = plan::run(spec);
    let checks = spec.check.iter().map(plan::check).collect();
    let meshes = context.meshes;
    if !context.problems.is_free_of_errors() {
        return None;
    }
    let mut scene = context.builder.build();
    run.sensor_estimators = plan::sensor_estimators(spec, &scene);
    starts::settle_starts(&mut scene);
    starts::note_joints(spec, &scene, &context.faces, context.problems);
    starts::check_starts(spec, &scene, context.problems);
    consistency::check_overlaps(spec, &scene, context.problems);
    consistency::check_open_faces(spec, &scene, context.problems);
    contacts::check_contacts(spec, &scene, context.problems);
    slips::check_slips(spec, &scene, context.problems);
    plan::check_measures(spec, &scene, context.problems);
    context.problems.is_free_of_errors().then_some(Lowered { scene, run, checks, meshes })
}

/// The middle of the positions in the file: internal coordinates are relative to it, so that a
/// scene far from the user's origin keeps its precision.
fn origin(spec: &SceneSpec) -> DVec3 {
    let solids = spec.solids.values().map(|solid| solid.common().at.as_ref());
    let sheets = spec.sheets.values().map(|sheet| sheet.common().at());
    let free: Vec<DVec3> = solids.chain(sheets).filter_map(position).collect();
    if free.is_empty() { DVec3::ZERO } else { free.iter().sum::<DVec3>() / free.len() as f64 }
}

/// The position of a thing placed in free space.
fn position(at: Option<&PlacementSpec>) -> Option<DVec3> {
    match at {
        None => Some(DVec3::ZERO),
        Some(PlacementSpec::InSpace(space)) => Some(DVec3::from(space.position_mm)),
        Some(PlacementSpec::AtFace(_)) => None,
    }
}

/// Lumens, unless a source is given in watts.
fn flux_unit(spec: &SceneSpec) -> FluxUnit {
    let is_radiant = |source: &SourceSpec| source.common().is_some_and(|c| c.flux_w.is_some());
    if spec.sources.values().any(is_radiant) { FluxUnit::Watt } else { FluxUnit::Lumen }
}

impl Context<'_> {
    fn lower_media(&mut self) {
        for (name, medium) in &self.spec.media {
            let clear = Medium::new(name, medium.index, medium.absorption_per_mm);
            let made = match medium.scattering {
                Some(ScatteringSpec { per_mm, anisotropy }) => {
                    clear.with_scattering(VolumeScattering::new(per_mm, anisotropy))
                }
                None => clear,
            };
            self.media.insert(name.clone(), self.builder.add_medium(made));
        }
        // Validated: the surroundings are a known medium.
        if let Some(&surroundings) = self.media.get(&self.spec.surroundings) {
            self.builder.set_surroundings(surroundings);
        }
    }

    /// Builds solids and sheets, each after the body it is placed at.
    fn lower_bodies(&mut self) {
        let mut waiting: Vec<Body> =
            self.spec.solids.keys().map(|name| Body::Solid(name.clone())).collect();
        waiting.extend(self.spec.sheets.keys().map(|name| Body::Sheet(name.clone())));
        while !waiting.is_empty() {
            let (ready, blocked): (Vec<Body>, Vec<Body>) =
                waiting.iter().cloned().partition(|body| {
                    let support = self.support(body);
                    !waiting.iter().any(|other| Some(other.name()) == support.as_deref())
                });
            if ready.is_empty() {
                for body in &blocked {
                    self.problems
                        .error(
                            &body.key(self.spec).field("at"),
                            "stands at a face of a thing that stands at its own",
                        )
                        .hint("give one of them a position_mm");
                }
                return;
            }
            for body in &ready {
                match body {
                    Body::Solid(name) => self.lower_solid(name),
                    Body::Sheet(name) => self.lower_sheet(name),
                }
            }
            waiting = blocked;
        }
    }

    /// The name of the thing at whose face a body is placed.
    fn support(&self, body: &Body) -> Option<String> {
        let at = match body {
            Body::Solid(name) => self.spec.solids[name.as_str()].common().at.as_ref(),
            Body::Sheet(name) => self.spec.sheets[name.as_str()].common().at(),
        };
        match at {
            Some(PlacementSpec::AtFace(at)) => at.face.split('.').next().map(str::to_owned),
            Some(PlacementSpec::InSpace(_)) | None => None,
        }
    }
}

/// A solid or sheet by name.
#[derive(Debug, Clone, PartialEq)]
enum Body {
    Solid(String),
    Sheet(String),
}

impl Body {
    fn name(&self) -> &str {
        match self {
            Self::Solid(name) | Self::Sheet(name) => name,
        }
    }

    fn key(&self, spec: &SceneSpec) -> Key {
        match self {
            Self::Solid(name) => Key::of(&["solids", name, spec.solids[name.as_str()].kind()]),
            Self::Sheet(name) => Key::of(&["sheets", name, spec.sheets[name.as_str()].kind()]),
        }
    }
}
