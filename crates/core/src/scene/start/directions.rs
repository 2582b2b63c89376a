//! Directions of light at a point of a sensor, drawn toward an aim or within views.

use crate::rng::{Numbers, Sampler};
use crate::scene::start::area::{AreaPoint, FaceArea};
use crate::scene::{CountedLight, Ray, Views};
use glam::DVec3;
use smallvec::SmallVec;

/// A direction drawn at a point of a sensor.
pub(super) struct Drawn {
    pub(super) dir: DVec3,
    /// |cos θ| over the density of the direction, sr.
    pub(super) projected: f64,
    /// The views or the pixel that accept it.
    pub(super) views: SmallVec<[usize; 1]>,
}

/// |cos θ| over the density with which points drawn from the aim lie in the ray's direction, sr.
pub(super) fn projected_toward(aim: &FaceArea<'_>, ray: &Ray, normal: DVec3) -> f64 {
    ray.dir().dot(normal).abs() / aim.density_toward(ray)
}

/// The direction toward a point drawn from the aim: density `p(y) dist²/cos θ_y`, whichever point
/// of the aim lies in that direction.
pub(super) fn toward(aim: &FaceArea<'_>, start: &AreaPoint, target: DVec3) -> Option<Drawn> {
    let offset = target - start.point;
    if offset == DVec3::ZERO {
        return None;
    }
    let ray = Ray::new(start.point, offset);
    let projected = projected_toward(aim, &ray, start.normal);
    projected.is_finite().then(|| Drawn { dir: ray.dir(), projected, views: SmallVec::new() })
}

/// A direction in the acceptance cone of a view, or of any, shared by all cones that contain it.
pub(super) fn view_direction(
    (views, view): (&Views, Option<usize>),
    counts: CountedLight,
    start: &AreaPoint,
    sampler: &mut Sampler<impl Numbers>,
) -> Drawn {
    let (seen, accepting) = views.draw(view, sampler);
    let dir = away(seen, counts);
    let projected = views_projected(views, accepting.len(), dir.dot(start.normal));
    Drawn { dir, projected, views: accepting }
}

/// |cos θ| over the density of a direction that this many views accept, sr.
pub(super) fn views_projected(views: &Views, accepting: usize, cos: f64) -> f64 {
    cos.abs() / views.density(accepting)
}

/// Converts between a direction against the light and a view's direction away from the face.
pub(super) fn away(dir: DVec3, counts: CountedLight) -> DVec3 {
    match counts {
        CountedLight::Incident => dir,
        CountedLight::Leaving => -dir,
    }
}
