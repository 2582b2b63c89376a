//! What interfaces and media do to light: pure local physics.
//!
//! This layer does not know scenes, paths or sensors. Directions and normals are in the coordinates of the
//! scene. Media take a wavelength, so that dispersion needs no other interface; finishes take the refractive
//! indices of both sides, and the wavelength.

mod angle_table;
mod bsdf;
mod coating;
mod dispersion;
pub mod film;
mod finish;
mod fluorescence;
pub mod fresnel;
mod gaussian;
mod haze;
mod incidence;
mod medium;
mod sky;
mod stokes;
pub mod sun;
mod volume;

pub use angle_table::AngleTable;
pub use bsdf::sheet::{
    DirectedTable, MeasuredSheet, SheetChecks, SheetPart, SheetSide, SheetTables,
};
pub use bsdf::table::BsdfTable;
pub use coating::{LayerStack, ThinLayer};
pub use dispersion::{CoefficientLaw, IndexLaw, REFERENCE_WAVELENGTH};
pub use film::{FilmFace, FilmMake, Grain, PrismFilm};
pub use finish::Finish;
pub use finish::faces::Faces;
pub(crate) use finish::faces::scatter_at_faces;
pub use finish::haze::{Haze, HazeBase, HazeSides, integrated_scatter};
pub use finish::microfacet::{FacetKind, Microfacet};
pub use finish::model::{FinishModel, Spread};
pub use finish::spectral::{ScatterLaw, SpectralFinish, SpectralShare};
pub use fluorescence::Fluorescence;
pub use gaussian::Gaussian;
pub use haze::profile::HazeLaw;
pub use incidence::{Incidence, Lobe, Scattered, Shares, Side};
pub use medium::{Medium, Turbidity};
#[cfg(test)]
pub(crate) use sky::CIE_TYPES;
pub(crate) use sky::SkyBound;
pub use sky::SkyModel;
pub use stokes::{FaceMueller, Stokes};
pub use volume::VolumeScattering;
