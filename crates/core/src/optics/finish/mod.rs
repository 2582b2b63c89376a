//! Finishes: what a face does to light. Each finish has a file that answers every question of
//! `model` about it; `bsdf` asks the one that a face has, and `faces` joins the two of a face.

mod absorber;
pub(crate) mod bsdf;
mod coated;
pub(crate) mod faces;
mod gaussian_dielectric;
mod gaussian_sheet;
pub(crate) mod haze;
mod lambertian;
mod metal;
pub(crate) mod microfacet;
mod mixture;
pub(crate) mod model;
mod open;
mod prism_film;
mod smooth;
mod specular;
mod tabulated;
#[cfg(test)]
mod testing;
