//! The fit of a luminance to rays.

use crate::rng::{Dimension, Sampler, stream};
use crate::scene::source::fitted::light::{FitQuality, FittedLight, SideLight, side};
use crate::scene::source::fitted::split::{CubeRay, split_cube};
use crate::scene::source::fitted::tree::DensityTree;
use crate::scene::source::fitted::waist::waist;
use crate::scene::{EmittedRay, RaySet};
use glam::{DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame};

/// Trees for each side.
const TREES: usize = 8;
/// Rays, as an effective number, that a fit needs.
const FEWEST_RAYS: f64 = 100.0;
/// Rays sampled to find faces between the plane and their starts.
const LOOKS: usize = 1024;

/// Why no luminance can be fitted to rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoFit {
    /// There are less than 100, as an effective number, which is given.
    TooFew(f64),
    /// They are parallel, so that they have no waist.
    Parallel,
    /// None crosses the plane, at this height in mm, where the rays start.
    NoneNear(f64),
    /// They cross the plane in one point, or on one line.
    NoArea,
}

impl FittedLight {
    /// Fits the luminance on the plane at a height along z, mm; `None` selects the waist of the rays.
    ///
    /// # Errors
    ///
    /// Says what about the rays makes a fit impossible.
    pub fn new(rays: &RaySet, height: Option<f64>) -> Result<Self, NoFit> {
        let effective_rays = rays.effective_count();
        if effective_rays < FEWEST_RAYS {
            return Err(NoFit::TooFew(effective_rays));
        }
        let height = height.or_else(|| Some(waist(rays)?.z)).ok_or(NoFit::Parallel)?;
        let starts = rays.bounds(&Frame::WORLD);
        let starts = starts.grown(1e-3 * starts.diagonal());
        let crossing = |ray: &EmittedRay| PlaneRay::of(ray, height, &starts);
        let places = Aabb::of(rays.iter().filter_map(crossing).map(|ray| ray.place.extend(height)));
        if places.is_empty() {
            return Err(NoFit::NoneNear(height));
        }
        let half = 0.5 * (places.max - places.min).truncate();
        if half.min_element() <= 0.0 {
            return Err(NoFit::NoArea);
        }
        let one_in = rays.len().div_ceil(LOOKS);
        let looks = rays
            .iter()
            .step_by(one_in)
            .filter_map(|ray| Some([crossing(ray)?.place.extend(height), ray.position.as_dvec3()]));
        let mut light = Self {
            middle: places.center(),
            half,
            sides: Default::default(),
            crossings_and_starts: looks.collect(),
            quality: FitQuality { effective_rays, trees: TREES, ..FitQuality::default() },
        };
        let mut of_sides: [Vec<CubeRay>; 2] = Default::default();
        for PlaneRay { place, dir, flux } in rays.iter().filter_map(crossing) {
            let at = light.coordinates(place, dir).map(|one| one as f32);
            of_sides[side(dir)].push(CubeRay { at, flux, is_held_out: false });
        }
        let fluxes =
            of_sides.each_ref().map(|rays| rays.iter().map(|ray| f64::from(ray.flux)).sum::<f64>());
        let used = fluxes[0] + fluxes[1];
        let mut squares = [0.0; 3];
        for ((lit, rays), flux) in light.sides.iter_mut().zip(&mut of_sides).zip(fluxes) {
            if flux > 0.0 {
                lit.share = flux / used;
                lit.fit(rays, &mut light.quality.leaves, &mut squares);
            }
        }
        let [sampling, place, direction] = squares.map(|square| square.max(0.0).sqrt());
        light.quality.sampling = sampling;
        light.quality.variation = [place, direction];
        let all: f64 = rays.iter().map(|ray| f64::from(ray.flux)).sum();
        light.quality.left_out = (1.0 - used / all).max(0.0);
        Ok(light)
    }
}

impl SideLight {
    /// Fits its trees, and adds their leaves, and the mean squares of the errors in one leaf, of sampling and of variation over
    /// position and over direction.
    fn fit(&mut self, rays: &mut [CubeRay], leaves: &mut usize, squares: &mut [f64; 3]) {
        let mut sum = 0;
        for tree in 0..TREES {
            for (index, ray) in (0u64..).zip(&mut *rays) {
                let mut sampler = Sampler::for_path(tree as u64, stream::HELD_OUT, index);
                ray.is_held_out = sampler.one(Dimension::Resampling) < 0.5;
            }
            let split = split_cube(rays, tree as u64);
            let (density, errors) = DensityTree::new(split.as_deref(), rays);
            sum += errors.leaves;
            let [place, direction] = errors.variation;
            for (square, own) in squares.iter_mut().zip([errors.sampling, place, direction]) {
                *square += self.share * own / TREES as f64;
            }
            self.trees.push(density);
        }
        *leaves += sum.div_ceil(TREES);
    }
}

/// Where a ray crosses the plane.
#[derive(Debug, Clone, Copy)]
struct PlaneRay {
    /// x and y, mm.
    place: DVec2,
    /// Unit vector.
    dir: DVec3,
    flux: f32,
}

impl PlaneRay {
    /// `None` outside of the x and y of the box of starts.
    fn of(ray: &EmittedRay, height: f64, starts: &Aabb) -> Option<Self> {
        let (start, dir) = (ray.position.as_dvec3(), ray.direction.as_dvec3().normalize());
        let place = (start + (height - start.z) / dir.z * dir).truncate();
        let is_near = place.cmpge(starts.min.truncate()) & place.cmple(starts.max.truncate());
        is_near.all().then_some(Self { place, dir, flux: ray.flux })
    }
}
