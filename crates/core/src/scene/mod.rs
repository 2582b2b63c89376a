//! What is in the room: media, finishes, solids, sheets, sources and sensors, and what a ray meets next.
//!
//! Every solid is closed and has a medium and a priority; a path knows which solids it is in. Sheets are open and
//! two-sided. Both are made of smooth patches (and triangles of meshes) with named faces. Coordinates are millimetres
//! about the middle of the scene ([`Scene::origin`] leads back to the user's).
//!
//! This layer knows neither paths nor photons, and no file format.

mod accel;
mod area;
mod arrivals;
mod axes;
mod build;
mod convex;
mod emission;
mod face;
mod facets;
mod grid;
mod guide;
mod ids;
mod inside;
mod interface;
mod intersect;
mod light_group;
pub mod mesh;
mod on;
pub mod pattern;
mod pieces;
mod pixels;
mod ray;
pub mod relief;
mod section;
mod sensor;
pub mod shape;
mod sky;
mod source;
pub mod sweep;

pub use accel::Accel;
pub use area::{AreaPoint, FaceArea};
pub use arrivals::{Arrival, Arrivals, Begins};
pub use axes::FaceAxes;
pub use build::{Builder, FaceSpec, Piece};
pub use emission::{Emission, EmitterKind};
pub use face::{Extent, Face, MeshBody, Owner, Patch};
pub use facets::{FaceFacets, Facets, Fineness, shape_facets};
pub use grid::Grid;
pub use guide::{Guides, NamedBody};
pub use ids::{FaceId, FinishId, MediumId, PrimId, SensorId, SmoothId, SolidId, SourceId};
pub use inside::Inside;
pub use interface::{Interface, Meeting, Visibility};
pub use intersect::{Hits, Just, PrimHit};
pub use light_group::{LightGroup, LightGroups};
pub use on::On;
pub use pieces::Surface;
pub use pixels::Pixels;
pub use ray::Ray;
pub use section::Outline;
pub use sensor::{
    Counts, Goniometer, Passage, Place, Seeing, Sensor, SensorKind, Sides, SurfaceSensor, Views,
};
pub use sky::Sky;
pub use source::{EmitSide, Emitted, Emitter, Source, Start, SunAngles};

use convex::Convex;
use pattern::Pattern;
use relief::Relief;

use crate::optics::{Bsdf, Medium};
use glam::DVec3;
use lumiduct_base::math::Aabb;
use lumiduct_base::units::FluxUnit;
use std::sync::Arc;

/// Relative to the size of the scene: faces closer than this are one face.
pub const COINCIDENCE: f64 = 1e-12;

/// A solid: a closed set of faces around a medium.
#[derive(Debug, Clone)]
pub struct Solid {
    /// Name in the scene file.
    pub name: String,
    /// What it is made of.
    pub medium: MediumId,
    /// Where solids overlap, the one of higher priority counts.
    pub priority: i32,
    /// Box around it, mm.
    pub bounds: Aabb,
    /// Volume, mm³, where it is known in closed form.
    pub volume: Option<f64>,
}

/// A finish with its name.
#[derive(Debug, Clone)]
pub struct Finish {
    /// Name in the scene file, or a description of an inline one.
    pub name: String,
    /// What it does.
    pub bsdf: Bsdf,
}

/// Everything a path can meet, ready to be traced. Made by [`Builder`].
#[derive(Debug, Clone)]
pub struct Scene {
    /// The user's coordinates of the internal origin, mm.
    pub origin: DVec3,
    /// Box around everything, sources and sensors included, mm.
    pub bounds: Aabb,
    /// Whether fluxes are luminous or radiant.
    pub unit: FluxUnit,
    /// All media; the surroundings are [`Scene::surroundings`].
    pub media: Vec<Medium>,
    /// The medium outside every solid.
    pub surroundings: MediumId,
    /// All finishes.
    pub finishes: Vec<Finish>,
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
    /// Pieces of open ports and virtual sensors: light passes.
    pub ports: Vec<Patch>,
    /// All sources.
    pub sources: Vec<Source>,
    /// Sources that are measured together.
    pub light: LightGroups,
    /// All sensors.
    pub sensors: Vec<Sensor>,
    /// Faces closer than this are one, mm.
    pub tolerance: f64,
    accel: Accel,
    /// Solids that are convex, where all patches are scanned.
    convex: Vec<Convex>,
    /// The patches of everything else.
    loose: Vec<PrimId>,
}

impl Scene {
    /// Sum of the flux of all sources, lm or W.
    pub fn source_flux(&self) -> f64 {
        self.sources.iter().map(|source| source.flux).sum()
    }

    /// The medium that counts at a point inside the given solids.
    pub fn medium_in(&self, inside: &Inside) -> MediumId {
        self.medium_of(inside.iter())
    }

    /// The medium of the highest priority; the surroundings without any solid.
    #[inline]
    fn medium_of(&self, solids: impl Iterator<Item = SolidId>) -> MediumId {
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
