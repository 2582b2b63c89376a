//! A set of rays: the light of a lamp as measured or computed elsewhere.

use crate::scene::Ray;
use glam::Vec3;
use lumiduct_base::math::{Aabb, Frame};

/// Rays in a frame of their own. Single precision is what ray files have.
#[derive(Debug, Clone, PartialEq)]
pub struct RaySet {
    rays: Vec<EmittedRay>,
    /// Flux up to and including each ray, in the unit of the rays.
    up_to: Vec<f64>,
}

/// One ray of a set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmittedRay {
    /// Start, mm.
    pub position: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Flux, in any unit.
    pub flux: f32,
}

impl RaySet {
    /// Rays with their relative fluxes; those of no flux are left out. `None` if none has any.
    pub fn new(rays: impl IntoIterator<Item = EmittedRay>) -> Option<Self> {
        let rays: Vec<EmittedRay> = rays.into_iter().filter(|ray| ray.flux > 0.0).collect();
        let mut sum = 0.0;
        let up_to: Vec<f64> = rays
            .iter()
            .map(|ray| {
                sum += f64::from(ray.flux);
                sum
            })
            .collect();
        (sum > 0.0).then_some(Self { rays, up_to })
    }

    /// Number of equal rays with the same variance of sums: (Σ flux)² / Σ flux² (Kish, Survey Sampling, 1965, section 11.7).
    pub fn effective_count(&self) -> f64 {
        let squares: f64 = self.rays.iter().map(|ray| f64::from(ray.flux).powi(2)).sum();
        self.up_to[self.rays.len() - 1].powi(2) / squares
    }

    /// The ray at a share of the flux in [0, 1), in the order of the set.
    pub(crate) fn at(&self, frame: &Frame, share: f64) -> Ray {
        let last = self.rays.len() - 1;
        let flux = share * self.up_to[last];
        let EmittedRay { position, direction, .. } =
            self.rays[self.up_to.partition_point(|up_to| *up_to <= flux).min(last)];
        Ray::new(
            frame.point_to_world(position.as_dvec3()),
            frame.to_world(direction.as_dvec3().normalize()),
        )
    }

    /// Number of rays.
    pub(crate) fn len(&self) -> usize {
        self.rays.len()
    }

    /// The rays.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &EmittedRay> {
        self.rays.iter()
    }

    /// Box around all starts in a frame, mm.
    pub fn bounds(&self, frame: &Frame) -> Aabb {
        Aabb::of(self.rays.iter().map(|ray| frame.point_to_world(ray.position.as_dvec3())))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn ray(x: f32, flux: f32) -> EmittedRay {
        EmittedRay { position: Vec3::new(x, 0.0, 0.0), direction: Vec3::Z, flux }
    }

    #[test]
    fn shares_fall_on_rays_in_proportion_to_their_flux() {
        let set = RaySet::new([ray(0.0, 1.0), ray(1.0, 0.0), ray(2.0, 3.0)]).unwrap();
        // 16 / 10.
        assert!((set.effective_count() - 1.6).abs() < 1e-12);
        let start = |share| set.at(&Frame::WORLD, share).origin().x;
        assert_eq!([0.0, 0.249, 0.25, 0.999_999].map(start), [0.0, 0.0, 2.0, 2.0]);
        assert_eq!(RaySet::new([ray(0.0, 0.0)]), None);
        assert_eq!(RaySet::new([]), None);
    }

    #[test]
    fn a_frame_moves_and_turns_the_rays() {
        let set = RaySet::new([ray(1.0, 1.0)]).unwrap();
        let frame = Frame::from_axis_and_x(DVec3::new(5.0, 0.0, 0.0), DVec3::X, DVec3::Z).unwrap();
        let placed = set.at(&frame, 0.5);
        assert!(placed.origin().distance(DVec3::new(5.0, 0.0, 1.0)) < 1e-12);
        assert!(placed.dir().distance(DVec3::X) < 1e-12);
        assert_eq!(set.bounds(&frame).min, placed.origin());
    }
}
