//! The light of a lamp as luminance over a plane, fitted to its rays.
//!
//! Position and direction are a point of a unit cube whose volume is etendue: x and y over a rectangle, the square of the sine of the
//! angle to the normal, and the azimuth. Density of flux in the cube is then luminance. It is the mean of several trees, each
//! constant in its boxes, which smooths their borders (bagging: L. Breiman, Machine Learning 24 (1996) 123).

mod grow;
mod tree;

use crate::rng::{Dimension, Numbers, Sampler, stream};
use crate::scene::source::fitted::grow::{Coordinates, Placed, grow};
use crate::scene::source::fitted::tree::DensityTree;
use crate::scene::source::rays::{EmittedRay, RaySet};
use glam::{DMat3, DVec2, DVec3};
use lumiduct_base::math::{Aabb, Frame, cosine_hemisphere, turns};
use std::f64::consts::PI;

/// Trees for each side.
const TREES: u64 = 8;
/// Determinant of the equations for a common point of rays, relative to the cube of their trace, below which the rays are parallel in the
/// precision of ray files.
const PARALLEL: f64 = 1e-10;
/// Rays that are kept to find what lies between the plane and their starts.
const LOOKS: usize = 1024;

/// Luminance over both sides of a rectangle across z, for a flux of 1.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedLight {
    /// Middle of the rectangle, mm.
    middle: DVec3,
    /// Half of its sides along x and y, mm.
    half: DVec2,
    /// Light toward +z, and toward -z.
    sides: [SideLight; 2],
    /// Of some rays, where they cross the plane and where they start, mm.
    gaps: Vec<[DVec3; 2]>,
    quality: FitQuality,
}

/// What is known of the errors of a fit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FitQuality {
    /// Number of equal rays with the same variance of sums.
    pub rays: f64,
    /// Boxes of one tree.
    pub boxes: usize,
    /// Standard error of the luminance of a box, as the rays are a sample: relative, root mean square over the flux, 1.
    pub sampling: f64,
    /// How much luminance varies within boxes over position and over direction: relative, root mean square over the flux, 1.
    pub variation: [f64; 2],
    /// Share of the rays' flux that is not in the fit, as it does not cross the plane near the starts of the rays, 1.
    pub left_out: f64,
}

/// The light toward one side.
#[derive(Debug, Clone, PartialEq)]
struct SideLight {
    /// Share of the flux, 1.
    share: f64,
    /// None if there is no light.
    trees: Vec<DensityTree>,
}

impl FittedLight {
    /// Fits rays at a height along z, mm, without it where they, as lines, come closest to one point.
    ///
    /// # Errors
    ///
    /// Says what about the rays makes a fit impossible.
    pub fn new(rays: &RaySet, height: Option<f64>) -> Result<Self, &'static str> {
        let height = height.or_else(|| waist(rays)).ok_or("its rays are parallel")?;
        let starts = rays.bounds(&Frame::WORLD);
        let starts = starts.grown(1e-3 * starts.diagonal());
        let crossings = || rays.iter().filter_map(|ray| PlaneRay::of(ray, height, &starts));
        let places = Aabb::of(crossings().map(|crossing| crossing.place.extend(height)));
        let half = 0.5 * (places.max - places.min).truncate();
        if places.is_empty() || half.min_element() <= 0.0 {
            return Err("its rays cross the plane in a point or a line");
        }
        let mut light = Self {
            middle: places.center(),
            half,
            sides: [SideLight::DARK; 2],
            gaps: Vec::new(),
            quality: FitQuality { rays: rays.effective_count(), ..FitQuality::default() },
        };
        let mut placed: [Vec<Placed>; 2] = Default::default();
        for crossing in crossings() {
            let at = light.coordinates(crossing.place, crossing.dir).map(|one| one as f32);
            let ray = Placed { at, flux: crossing.flux, is_held: false };
            placed[side(crossing.dir)].push(ray);
        }
        let flux = |rays: &[Placed]| rays.iter().map(|ray| f64::from(ray.flux)).sum::<f64>();
        let used = flux(&placed[0]) + flux(&placed[1]);
        for (side, placed) in light.sides.iter_mut().zip(&mut placed) {
            let share = flux(placed) / used;
            if share > 0.0 {
                *side = SideLight { share, trees: light.quality.grow_all(placed, share) };
            }
        }
        let all: f64 = rays.iter().map(|ray| f64::from(ray.flux)).sum();
        light.quality.left_out = (1.0 - used / all).max(0.0);
        light.quality.sampling = (light.quality.boxes as f64 / light.quality.rays).sqrt();
        let one_in = rays.len().div_ceil(LOOKS);
        let looks = rays.iter().step_by(one_in).filter_map(|ray| {
            let crossing = PlaneRay::of(ray, height, &starts)?;
            Some([crossing.place.extend(height), ray.position.as_dvec3()])
        });
        light.gaps = looks.collect();
        Ok(light)
    }

    /// What is known of its errors.
    pub fn quality(&self) -> &FitQuality {
        &self.quality
    }

    /// Middle of the rectangle in the frame of the rays, mm.
    pub fn middle(&self) -> DVec3 {
        self.middle
    }

    /// Half of the sides of the rectangle, mm.
    pub fn half(&self) -> DVec2 {
        self.half
    }

    /// Of up to 1024 rays, where they cross the plane and where they start in their frame, mm.
    pub fn gaps(&self) -> &[[DVec3; 2]] {
        &self.gaps
    }

    /// A start, mm, and a direction in the frame of the rays, in proportion to the flux.
    pub(crate) fn sample(&self, sampler: &mut Sampler<impl Numbers>) -> [DVec3; 2] {
        let [x, y] = sampler.pair(Dimension::EmitPosition);
        let [square, turns] = sampler.pair(Dimension::EmitDirection);
        let front = self.sides[0].share;
        let is_back = square >= front;
        let within = if is_back { (square - front) / (1.0 - front) } else { square / front };
        let trees = &self.sides[usize::from(is_back)].trees;
        let tree = turns * trees.len() as f64;
        let u = [x, y, within, tree.fract()].map(below_one);
        let [x, y, square, turns] = trees[tree as usize].sample(u);
        let across = self.half * (2.0 * DVec2::new(x, y) - DVec2::ONE);
        let mut dir = cosine_hemisphere([below_one(square), turns]);
        if is_back {
            dir.z = -dir.z;
        }
        [self.middle + across.extend(0.0), dir]
    }

    /// Luminance at a place on the rectangle toward a direction, both in the frame of the rays, 1/(mm² sr).
    pub(crate) fn luminance(&self, place: DVec3, dir: DVec3) -> f64 {
        let at = self.coordinates(place.truncate(), dir);
        let SideLight { share, trees } = &self.sides[side(dir)];
        let density: f64 = trees.iter().map(|tree| tree.density(&at)).sum();
        let etendue = 4.0 * self.half.x * self.half.y * PI;
        share * density / (TREES as f64 * etendue)
    }

    /// The point of the cube for a place on the plane, mm, and a direction.
    fn coordinates(&self, place: DVec2, dir: DVec3) -> Coordinates {
        let across = 0.5 * ((place - self.middle.truncate()) / self.half + DVec2::ONE);
        let dir = dir.truncate();
        [across.x, across.y, dir.length_squared(), turns(dir)]
    }
}

impl FitQuality {
    /// Grows the trees of a side with this share of the flux, and notes their errors.
    fn grow_all(&mut self, rays: &mut [Placed], share: f64) -> Vec<DensityTree> {
        let mut boxes = 0;
        let mut squares = [0.0; 2];
        let trees = (0..TREES).map(|tree| {
            for (index, ray) in (0u64..).zip(&mut *rays) {
                let mut sampler = Sampler::for_path(tree, stream::HELD_BACK, index);
                ray.is_held = sampler.one(Dimension::Resampling) < 0.5;
            }
            let grown = grow(rays, tree);
            boxes += grown.boxes();
            let own = grown.variation();
            squares = [0, 1].map(|kind| squares[kind] + own[kind]);
            DensityTree::new(&grown)
        });
        let trees = trees.collect();
        self.boxes += boxes.div_ceil(TREES as usize);
        self.variation = [0, 1].map(|kind| {
            let square = share * squares[kind] / TREES as f64;
            (self.variation[kind].powi(2) + square.max(0.0)).sqrt()
        });
        trees
    }
}

impl SideLight {
    const DARK: Self = Self { share: 0.0, trees: Vec::new() };
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
    /// `None` outside of the box of starts.
    fn of(ray: &EmittedRay, height: f64, starts: &Aabb) -> Option<Self> {
        let (start, dir) = (ray.position.as_dvec3(), ray.direction.as_dvec3().normalize());
        let place = (start + (height - start.z) / dir.z * dir).truncate();
        let is_near = place.cmpge(starts.min.truncate()) & place.cmple(starts.max.truncate());
        is_near.all().then_some(Self { place, dir, flux: ray.flux })
    }
}

/// The side toward which a direction goes: 0 for +z, 1 for -z.
fn side(dir: DVec3) -> usize {
    usize::from(dir.z < 0.0)
}

fn below_one(number: f64) -> f64 {
    number.min(1.0_f64.next_down())
}

/// The height of the point with the least mean square distance from the rays as lines, mm; `None` for parallel ones.
fn waist(rays: &RaySet) -> Option<f64> {
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
    has_point.then(|| (matrix.inverse() * sum).z)
}

#[cfg(test)]
mod tests;
