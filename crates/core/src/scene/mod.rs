//! Contents of the scene: media, finishes, solids, sheets, sources and sensors, and what a ray
//! meets next.
//!
//! Every solid is closed and has a medium and a priority; a path knows which solids it is in.
//! Sheets are open and two-sided. Both are made of smooth patches (and triangles of meshes) with
//! named faces. Coordinates are millimetres about the middle of the scene ([`Scene::origin`]
//! converts to the user's coordinates).
//!
//! This layer does not know paths, photons or file formats.

mod accel;
mod along;
mod area;
mod arrivals;
mod axes;
mod build;
mod convex;
mod element;
mod emission;
mod emit;
mod face;
mod facets;
mod grid;
mod guide;
mod hit;
mod ids;
mod inside;
mod interface;
mod intersect;
mod light_group;
pub mod mesh;
mod model;
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
pub use build::{Builder, FaceSpec};
pub use emission::Emission;
pub use face::{Extent, Face, MeshBody, Owner, Patch, Piece};
pub use facets::{FaceFacets, Facets, Fineness, shape_facets};
pub use grid::Grid;
pub use guide::{Guides, NamedBody};
pub use hit::{Hits, Just, PrimHit};
pub use ids::{FaceId, FinishId, MediumId, PrimId, SensorId, SmoothId, SolidId, SourceId};
pub use inside::Inside;
pub use interface::{Interface, Meeting, Visibility};
pub use light_group::{LightGroup, LightGroups};
pub use model::{COINCIDENCE, Finish, Scene, Solid};
pub use on::On;
pub use pieces::Surface;
pub use pixels::Pixels;
pub use ray::Ray;
pub use section::Outline;
pub use sensor::{
    Counts, Goniometer, Passage, Place, Seeing, Sensor, SensorKind, Sides, SurfaceSensor, Views,
};
pub use sky::{EmitterKind, Sky};
pub use source::{EmitSide, Emitted, Emitter, Source, Start, SunAngles};
