//! Everything a path can meet, and the media and finishes that it is made of.

use crate::optics::{Finish, Medium};
use crate::plan::Polarisation;
use crate::scene::crossing::convex::Convex;
use crate::scene::mesh::MeshBody;
use crate::scene::pattern::Pattern;
use crate::scene::relief::Relief;
use crate::scene::{
    Accel, Face, Inside, LightGroups, MediumId, Patch, PlainLeg, PrimId, Sensor, SolidId, Source,
    SourceId, SourceSpectra,
};
use glam::DVec3;
use lumiduct_base::math::Aabb;
use lumiduct_base::units::FluxUnit;
use std::sync::Arc;

/// Relative to the size of the scene: faces closer than this are the same face.
pub(crate) const COINCIDENCE: f64 = 1e-12;

/// A solid: a closed set of faces around a medium.
#[derive(Debug, Clone)]
pub struct Solid {
    /// Name in the scene file.
    pub name: String,
    /// Its material.
    pub medium: MediumId,
    /// Where solids overlap, the one of higher priority applies.
    pub priority: i32,
    /// Box around it, mm.
    pub bounds: Aabb,
    /// Volume, mm³, where it is known in closed form.
    pub volume: Option<f64>,
}

/// A finish with its name.
#[derive(Debug, Clone)]
pub struct NamedFinish {
    /// Name in the scene file, or a description of an inline one.
    pub name: String,
    /// Its scattering function.
    pub finish: Finish,
}

/// Everything a path can meet, ready to be traced. Made by [`Builder`](crate::scene::Builder).
#[derive(Debug, Clone)]
pub struct Scene {
    /// The user's coordinates of the internal origin, mm.
    pub origin: DVec3,
    /// Box around everything, sources and sensors included, mm.
    pub bounds: Aabb,
    /// Whether fluxes are luminous or radiant.
    pub unit: FluxUnit,
    /// What becomes of the polarisation of light on its way.
    pub polarisation: Polarisation,
    /// All media; the surroundings are [`Scene::surroundings`].
    pub media: Vec<Medium>,
    /// The medium outside every solid.
    pub surroundings: MediumId,
    /// All finishes.
    pub finishes: Vec<NamedFinish>,
    /// All solids.
    pub solids: Vec<Solid>,
    /// All faces: of solids, of sheets, and open ports.
    pub faces: Vec<Face>,
    /// Holes, dots and patches on faces.
    pub patterns: Vec<Pattern>,
    /// Dimples, grooves and the like on walls of solids.
    pub reliefs: Vec<Arc<Relief>>,
    /// Analytic pieces of solids and sheets.
    pub patches: Vec<Patch>,
    /// Bodies of triangles; their triangles are numbered after the patches.
    pub meshes: Vec<MeshBody>,
    /// Copies of meshes; those of one mesh follow one another.
    pub copies: Vec<MeshBody>,
    /// Number of the first triangle of the copies among all surfaces.
    pub(super) first_of_copies: usize,
    /// Pieces of open ports and virtual sensors, which light passes.
    pub ports: Vec<Patch>,
    /// All sources.
    pub sources: Vec<Source>,
    /// The different spectra of the sources.
    pub spectra: SourceSpectra,
    /// Sources that are measured together.
    pub light: LightGroups,
    /// All sensors.
    pub sensors: Vec<Sensor>,
    /// Faces closer than this are the same, mm.
    pub tolerance: f64,
    pub(super) accel: Accel,
    /// Solids that are convex, where all patches are scanned.
    pub(super) convex: Vec<Convex>,
    /// The patches of everything else.
    pub(super) loose: Vec<PrimId>,
    /// For each patch, where rows of mirror bounces are known in closed form.
    pub(super) legs: Vec<Option<Box<PlainLeg>>>,
}

impl Scene {
    /// All bodies of triangles.
    pub fn mesh_bodies(&self) -> impl Iterator<Item = &MeshBody> {
        self.meshes.iter().chain(&self.copies)
    }

    /// One of [`Self::mesh_bodies`].
    #[inline(always)]
    pub(super) fn mesh_body(&self, index: usize) -> &MeshBody {
        self.meshes.get(index).unwrap_or_else(|| &self.copies[index - self.meshes.len()])
    }

    /// Whether the boxes around all that light starts on or meets lie within a sphere, mm.
    pub fn lies_within(&self, middle: DVec3, radius: f64) -> bool {
        let patches = self.patches.iter().map(|patch| patch.shape.bounds());
        let meshes = self.mesh_bodies().map(MeshBody::bounds);
        let near = self.sources.iter().filter(|source| !source.emitter.is_far());
        let sources = near.map(|source| source.emitter.bounds());
        patches.chain(meshes).chain(sources).all(|bounds| {
            let [low, high] = [bounds.min, bounds.max].map(|corner| corner - middle);
            low.abs().max(high.abs()).length() <= radius
        })
    }

    /// Whether any medium fluoresces.
    pub fn fluoresces(&self) -> bool {
        self.media.iter().any(|medium| medium.fluorescence().is_some())
    }

    /// Luminous flux of a path after fluorescence over the mean luminous flux of a path at its start, 1: the most of any
    /// wavelength of a source, on average over the emission, and at least 1.
    pub(crate) fn luminous_gain(&self) -> f64 {
        let draws = || self.sources.iter().filter_map(|source| source.spectrum.as_deref());
        let gains = self.media.iter().filter_map(Medium::fluorescence).flat_map(|own| {
            draws().flat_map(|from| {
                let absorbed = from.places().filter(|nm| own.absorption_law().at(*nm) > 0.0);
                absorbed.map(|nm| from.relative_flux(nm) * own.luminous_yield(nm))
            })
        });
        gains.fold(1.0, f64::max)
    }

    /// Radiant flux of all sources, W; 0 without spectra.
    pub(crate) fn source_watts(&self) -> f64 {
        let watts = |source: &Source| {
            source.spectrum.as_ref().map_or(0.0, |own| source.flux / own.spectrum().efficacy())
        };
        self.sources.iter().map(watts).sum()
    }

    /// Flux of all sources, lm or W.
    pub fn source_flux(&self) -> f64 {
        self.sources.iter().map(|source| source.flux).sum()
    }

    /// Flux of some sources, lm or W.
    pub(crate) fn flux_of(&self, sources: &[SourceId]) -> f64 {
        sources.iter().map(|source| self.sources[source.index()].flux).sum()
    }

    /// The effective medium at a point inside the given solids.
    pub(crate) fn medium_in(&self, inside: &Inside) -> MediumId {
        self.medium_of(inside.iter())
    }

    /// The medium of the highest priority; the surroundings if there is no solid.
    #[inline]
    pub(super) fn medium_of(&self, solids: impl Iterator<Item = SolidId>) -> MediumId {
        let mut best: Option<&Solid> = None;
        for id in solids {
            let solid = &self.solids[id.index()];
            if best.is_none_or(|best| solid.priority > best.priority) {
                best = Some(solid);
            }
        }
        best.map_or(self.surroundings, |solid| solid.medium)
    }
}
