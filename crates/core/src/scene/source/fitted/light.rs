//! Luminance on a plane, as a density in position and direction.

use crate::rng::{Dimension, Numbers, Sampler};
use crate::scene::source::fitted::split::Coordinates;
use crate::scene::source::fitted::tree::DensityTree;
use glam::{DVec2, DVec3};
use lumiduct_base::math::{cosine_hemisphere, turns};
use std::f64::consts::PI;

/// Luminance on both sides of a rectangle across z, for a flux of 1.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedLight {
    /// Middle of the rectangle, mm.
    pub(super) middle: DVec3,
    /// Half of its sides along x and y, mm.
    pub(super) half: DVec2,
    /// Light toward +z, and toward -z.
    pub(super) sides: [SideLight; 2],
    /// For a sample of the rays, where they cross the plane and where they start, mm.
    pub(super) crossings_and_starts: Vec<[DVec3; 2]>,
    pub(super) quality: FitQuality,
}

/// What is known of the errors of a fit.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FitQuality {
    /// Effective number of rays, as of `RaySet`.
    pub effective_rays: f64,
    /// Number of trees whose mean is the density of a side.
    pub trees: usize,
    /// Leaves with light of a tree, both sides together, in the mean.
    pub leaves: usize,
    /// Standard error of luminance in one leaf because the rays are a sample, relative, root mean square over the flux, 1.
    pub sampling: f64,
    /// Variation of luminance within leaves over position and over direction, relative, root mean square over the flux, 1.
    pub variation: [f64; 2],
    /// Share of the rays' flux that is not in the fit, as it does not cross the plane where the rays start, 1.
    pub left_out: f64,
}

/// The light toward one side.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct SideLight {
    /// Share of the flux, 1.
    pub(super) share: f64,
    /// The density is their mean; none without light.
    pub(super) trees: Vec<DensityTree>,
}

impl FittedLight {
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

    /// For up to 1024 of the rays, where they cross the plane and where they start, in their frame, mm.
    pub fn crossings_and_starts(&self) -> &[[DVec3; 2]] {
        &self.crossings_and_starts
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

    /// Luminance at a place on the rectangle toward a direction, both in the frame of the rays, 1/(mm² sr): the density
    /// over the etendue of a side (docs/theory.md, eq. 33).
    pub(crate) fn luminance(&self, place: DVec3, dir: DVec3) -> f64 {
        let SideLight { share, trees } = &self.sides[side(dir)];
        if trees.is_empty() {
            return 0.0;
        }
        let at = self.coordinates(place.truncate(), dir);
        let density: f64 = trees.iter().map(|tree| tree.density(&at)).sum();
        let etendue = 4.0 * self.half.x * self.half.y * PI;
        share * density / (trees.len() as f64 * etendue)
    }

    /// The point of the cube for a place on the plane, mm, and a direction.
    pub(super) fn coordinates(&self, place: DVec2, dir: DVec3) -> Coordinates {
        let across = 0.5 * ((place - self.middle.truncate()) / self.half + DVec2::ONE);
        let dir = dir.truncate();
        [across.x, across.y, dir.length_squared(), turns(dir)]
    }
}

/// The side toward which a direction goes: 0 for +z, 1 for -z.
pub(super) fn side(dir: DVec3) -> usize {
    usize::from(dir.z < 0.0)
}

fn below_one(number: f64) -> f64 {
    number.min(1.0_f64.next_down())
}
