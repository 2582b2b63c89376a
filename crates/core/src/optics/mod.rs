//! What interfaces and media do to light: pure local physics, in a local frame.
//!
//! This layer does not know scenes, paths or sensors. Media and finishes take a wavelength, so that
//! dispersion needs no other interface.

mod adjoint;
mod angle_table;
mod bsdf;
mod evaluate;
pub mod film;
pub mod fresnel;
mod gaussian;
mod grain;
mod haze;
mod incidence;
mod medium;
mod microfacet;
mod scatter;
mod shares;
mod sky;
mod smooth;
mod spread;
pub mod sun;
#[cfg(test)]
pub(crate) mod testing;
mod volume;

pub use adjoint::{Faces, scatter_radiance, scatter_toward};
pub use angle_table::AngleTable;
pub use bsdf::Bsdf;
pub use evaluate::evaluate;
pub use film::{FilmFace, FilmMake, Grain, PrismFilm};
pub use gaussian::Gaussian;
pub use haze::{Haze, HazeBase, HazeLaw, HazeSides, integrated_scatter};
pub use incidence::{Incidence, Lobe, Scattered, Shares, Side};
pub use medium::Medium;
pub use microfacet::{Facets, Microfacet};
pub use shares::{chances, shares};
pub use sky::{CIE_TYPES, SkyBound, SkyModel};
pub use spread::Spread;
pub use volume::VolumeScattering;
