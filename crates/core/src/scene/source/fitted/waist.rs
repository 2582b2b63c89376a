//! The waist of a bundle of rays.

use crate::scene::RaySet;
use glam::{DMat3, DVec3};

/// Determinant of the equations for the waist, relative to the cube of their trace, below which the rays are parallel in the precision of
/// ray files.
const PARALLEL: f64 = 1e-10;

/// The point with the least mean square distance from the rays, extended to lines, mm; `None` for parallel ones.
pub(super) fn waist(rays: &RaySet) -> Option<DVec3> {
    // Σ w (1 - d dᵀ) (c - p) = 0 for the point c; w is the flux, p a point of a ray and d its direction.
    let (mut matrix, mut sum) = (DMat3::ZERO, DVec3::ZERO);
    for ray in rays.iter() {
        let dir = ray.direction.as_dvec3().normalize();
        let across = DMat3::IDENTITY - DMat3::from_cols(dir.x * dir, dir.y * dir, dir.z * dir);
        let weighted = f64::from(ray.flux) * across;
        matrix += weighted;
        sum += weighted * ray.position.as_dvec3();
    }
    let trace = matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    let has_point = matrix.determinant() > PARALLEL * trace.powi(3);
    has_point.then(|| matrix.inverse() * sum)
}
