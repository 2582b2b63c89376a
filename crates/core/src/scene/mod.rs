//! Contents of the scene: media, finishes, solids, sheets, sources and sensors, and what a ray
//! meets next.
//!
//! Every solid is closed and has a medium and a priority; a path knows which solids it is in.
//! Sheets are open and two-sided. Both are made of smooth patches (and triangles of meshes) with
//! named faces. Coordinates are millimetres about the middle of the scene ([`Scene::origin`]
//! converts to the user's coordinates).
//!
//! This layer does not know paths, photons or file formats.

mod axes;
mod build;
mod cell_places;
mod crossing;
mod face;
mod find_legs;
mod ids;
mod meet;
pub mod mesh;
mod model;
pub mod pattern;
mod picture;
mod plain_leg;
mod ray;
pub mod relief;
mod sensor;
pub mod shape;
mod source;
mod spectra;
mod start;
pub mod sweep;
mod wavelengths;

pub use build::{Builder, FaceSpec};
pub(crate) use crossing::accel::Accel;
pub use crossing::hit::StartSide;
pub use crossing::hit::{Hits, PrimHit};
pub use crossing::inside::Inside;
pub use crossing::on::StartSurfaces;
pub use face::{Face, FacePiece, MeshPieces, Owner, Patch, PieceRange};
pub use ids::LightGroupId;
pub(crate) use ids::SmoothId;
pub use ids::{FaceId, FinishId, MediumId, PrimId, SensorId, SolidId, SourceId};
pub(crate) use meet::interface::MeetingPoint;
pub use meet::interface::{Interface, Visibility};
pub use meet::pieces::Surface;
pub(crate) use model::COINCIDENCE;
pub use model::{NamedFinish, Scene, Solid};
pub use picture::facets::{FaceFacets, Fineness, Triangulation, shape_facets};
pub use picture::guide::Guides;
pub use plain_leg::RowReach;
pub(crate) use plain_leg::{AnglesOfRow, BounceRow, MetWall, PlainLeg};
pub use ray::Ray;
pub use sensor::grid::Grid;
pub use sensor::pixels::Pixels;
pub use sensor::{
    CountedLight, Goniometer, Passage, Place, Seeing, Sensor, SensorKind, Sides, SurfaceSensor,
    Views,
};
pub use source::emission::Emission;
pub use source::fitted::{FitQuality, FittedLight, NoFit};
pub use source::light_group::{LightGroup, LightGroups};
pub use source::measured::MeasuredEmission;
pub use source::opening::LuminousOpening;
pub use source::rays::{EmittedRay, RaySet};
pub use source::sky::{EmitterKind, Sky};
pub use source::{EmitSide, Emitted, Emitter, Source, StartSolids, SunAngles};
pub use spectra::SourceSpectra;
pub use start::area::{AreaPoint, FaceArea};
pub use start::arrivals::{Arrival, Arrivals, Begins};
pub use start::polar::{PolarLaw, PolarSquares};
pub use start::strata::Strata;
pub use wavelengths::{DrawnWavelength, Wavelengths};
