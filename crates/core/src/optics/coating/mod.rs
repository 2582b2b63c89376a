//! Coatings by their layers: reflectance and transmittance of stacks of thin films between two media.
//!
//! Films are homogeneous, plane and coherent. This folder does not know finishes or
//! paths. The method is that of characteristic matrices: Abelès, Ann. Phys. (Paris) 12 (1950) 596 and 706; Macleod,
//! Thin-Film Optical Filters, 4th ed. 2010, chapter 2; Born & Wolf, Principles of Optics, 7th ed., section 1.6.

mod complex;
mod matrix;
mod mueller;
mod stack;

pub(crate) use mueller::bare_face;
pub use stack::{LayerStack, ThinLayer};
