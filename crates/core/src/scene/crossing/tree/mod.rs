//! A tree of boxes, eight to a node, tested all at once.
//!
//! It is collapsed from the binary tree of obvhs: a node takes the eight boxes that remain when its largest ones have been opened again
//! and again (Wald, Benthin & Boulos, "Getting rid of packets", IEEE Symposium on Interactive Ray Tracing 2008, 49). Boxes are f32, rounded
//! outward, and cull only.

mod arrange;
mod surfaces;

pub(crate) use surfaces::SurfaceTree;

use crate::scene::Ray;
use smallvec::SmallVec;
use std::{fmt, mem};
use wide::f32x8;

/// Boxes in a node.
pub(crate) const WIDTH: usize = 8;
/// Most surfaces in a leaf.
pub(crate) const LEAF: usize = 4;
/// In a leaf of fewer surfaces: no further one.
pub(crate) const NONE: u32 = u32::MAX;
/// Least size of a component of a direction, 1: with 0, a moved origin on a side would give 0 · ∞. A coordinate over it is finite in f32.
const LEAST_COMPONENT: f32 = 1e-25;

/// Boxes are taken to be larger by this many f32 ulp of the largest coordinate. Rounding of the ray's origin and of its padding takes half an ulp
/// each, that of the slab test four.
const PADDING_ULP: f64 = 10.0;

/// A tree over boxes, with numbers for its leaves.
#[derive(Clone)]
pub(crate) struct Tree {
    nodes: Vec<WideNode>,
    root: WideChild,
}

/// The indices of up to four boxes in a leaf, then [`NONE`].
pub(crate) type Leaf = [u32; LEAF];

/// The boxes of eight children: least and greatest coordinates along each axis.
#[derive(Clone)]
struct WideNode {
    bounds: [[f32x8; 2]; 3],
    children: [WideChild; WIDTH],
}

/// A node or a leaf by its number, which for a leaf has the highest bit set.
#[derive(Clone, Copy, PartialEq)]
struct WideChild(u32);

/// What a child is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum TreeBranch {
    /// A node with this number, greater than that of its parent.
    Node(usize),
    /// A leaf with this number.
    Leaf(usize),
}

impl WideChild {
    const NONE: Self = Self(u32::MAX);
    const LEAF_BIT: u32 = 1 << 31;

    fn node(number: usize) -> Self {
        Self(number as u32)
    }

    fn leaf(number: usize) -> Self {
        Self(number as u32 | Self::LEAF_BIT)
    }

    #[inline(always)]
    fn branch(self) -> TreeBranch {
        match self.0 & Self::LEAF_BIT {
            0 => TreeBranch::Node(self.0 as usize),
            bit => TreeBranch::Leaf((self.0 ^ bit) as usize),
        }
    }
}

impl fmt::Debug for Tree {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "Tree({} nodes)", self.nodes.len())
    }
}

impl Tree {
    /// Calls `visit` with the number of every leaf that the ray meets before `limit`, at least 0, and the smallest distance that
    /// `visit` has returned; of the boxes in a node, nearer ones come first. Boxes are taken to be larger by [`padding`]. Only those
    /// children of a node are visited whose bits `among` has set.
    #[inline(always)]
    pub(crate) fn visit(
        &self,
        (ray, padding): (&Ray, f32),
        limit: f64,
        among: impl Fn(usize) -> u32,
        mut visit: impl FnMut(usize) -> f64,
    ) {
        let slabs = Slabs::of(ray, padding);
        let mut limit = round_up(limit);
        let mut child = self.root;
        let mut open: SmallVec<[(f32, WideChild); 64]> = SmallVec::new();
        loop {
            match child.branch() {
                TreeBranch::Leaf(leaf) => limit = limit.min(round_up(visit(leaf))),
                TreeBranch::Node(own) => {
                    let node = &self.nodes[own];
                    let (near, met) = slabs.meet(node, limit);
                    let mut met = met & among(own);
                    if let Some(slot) = take_bit(&mut met) {
                        let (from, mut next) = (open.len(), (near[slot], node.children[slot]));
                        while let Some(slot) = take_bit(&mut met) {
                            let mut other = (near[slot], node.children[slot]);
                            if other.0 < next.0 {
                                mem::swap(&mut other, &mut next);
                            }
                            // Of the others the nearest comes last.
                            let mut place = open.len();
                            open.push(other);
                            while place > from && open[place - 1].0 < other.0 {
                                open.swap(place, place - 1);
                                place -= 1;
                            }
                        }
                        child = next.1;
                        continue;
                    }
                }
            }
            child = loop {
                match open.pop() {
                    Some((near, child)) if near <= limit => break child,
                    Some(_) => {}
                    None => return,
                }
            };
        }
    }

    /// The children of each node, with their places there.
    pub(crate) fn nodes(
        &self,
    ) -> impl DoubleEndedIterator<Item = impl Iterator<Item = (usize, TreeBranch)>> + ExactSizeIterator
    {
        self.nodes.iter().map(|node| {
            let all = node.children.iter().enumerate();
            all.filter(|(_, child)| **child != WideChild::NONE)
                .map(|(slot, child)| (slot, child.branch()))
        })
    }
}

/// A ray, prepared for boxes: Kay & Kajiya, "Ray tracing complex scenes", SIGGRAPH Comput. Graph. 20 (1986) 269.
struct Slabs {
    /// Its origin, moved ahead by the padding of the boxes, along each axis.
    ahead: [f32x8; 3],
    /// The same, moved back.
    behind: [f32x8; 3],
    inverse: [f32x8; 3],
    /// The side of a box that the ray meets first along each axis.
    first: [usize; 3],
}

impl Slabs {
    #[inline]
    fn of(ray: &Ray, padding: f32) -> Self {
        let (origin, dir) = (ray.origin().as_vec3().to_array(), ray.dir().as_vec3().to_array());
        let inverse = dir.map(|own| 1.0 / own.abs().max(LEAST_COMPONENT).copysign(own));
        let moved = |sign: f32| {
            [0, 1, 2].map(|axis: usize| {
                f32x8::splat(origin[axis] + sign * padding.copysign(inverse[axis]))
            })
        };
        Self {
            ahead: moved(1.0),
            behind: moved(-1.0),
            inverse: inverse.map(f32x8::splat),
            first: inverse.map(|own| usize::from(own < 0.0)),
        }
    }

    /// Distances to the boxes of a node, and a bit for each that is met before a limit.
    #[inline]
    fn meet(&self, node: &WideNode, limit: f32) -> ([f32; WIDTH], u32) {
        // Written out: closures over arrays are not inlined.
        let [x, y, z] = &node.bounds;
        let ([ax, ay, az], [bx, by, bz]) = (self.ahead, self.behind);
        let ([ix, iy, iz], [sx, sy, sz]) = (self.inverse, self.first);
        let near_x = (x[sx] - ax) * ix;
        let near_y = (y[sy] - ay) * iy;
        let near_z = (z[sz] - az) * iz;
        let far_x = (x[1 - sx] - bx) * ix;
        let far_y = (y[1 - sy] - by) * iy;
        let far_z = (z[1 - sz] - bz) * iz;
        let near = near_x.fast_max(near_y).fast_max(near_z.fast_max(f32x8::ZERO));
        let far = far_x.fast_min(far_y).fast_min(far_z.fast_min(f32x8::splat(limit)));
        (near.to_array(), near.simd_le(far).to_bitmask())
    }
}

/// By how much boxes must be taken to be larger if they and the origins of rays have coordinates up to `largest_coordinate`.
pub(crate) fn padding(largest_coordinate: f64) -> f32 {
    (PADDING_ULP * f64::from(f32::EPSILON) * largest_coordinate) as f32
}

/// The place of the lowest bit of eight or fewer, which is taken away.
#[inline(always)]
pub(crate) fn take_bit(bits: &mut u32) -> Option<usize> {
    let lowest = bits.trailing_zeros() as usize;
    *bits &= bits.wrapping_sub(1);
    (lowest < WIDTH).then_some(lowest)
}

/// The next f32 above a value, so that culling never removes a hit.
#[inline]
fn round_up(value: f64) -> f32 {
    (value as f32).next_up()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Dimension, Sampler};
    use crate::scene::crossing::tree::arrange::MOST_AT_ONCE;
    use glam::DVec3;
    use lumiduct_base::math::{Aabb, uniform_sphere};
    use std::collections::BTreeSet;

    const SIZE: f64 = 100.0;

    /// Boxes of many sizes, some without volume, with corners on a grid so that rays can lie in their sides.
    fn boxes(count: u64) -> Vec<Aabb> {
        let of = |index: u64| {
            let mut sampler = Sampler::for_path(5, 1, index);
            let mut corner = || {
                let [x, y] = sampler.pair(Dimension::EmitPosition);
                DVec3::new(x, y, sampler.one(Dimension::EmitPosition))
            };
            let (from, size) = (corner(), corner());
            let from = (SIZE * from).floor();
            Aabb { min: from, max: from + (30.0 * size * size * size).floor() }
        };
        (0..count).map(of).collect()
    }

    /// Rays from grid points in all directions, along axes and in planes of axes.
    fn rays() -> impl Iterator<Item = Ray> {
        (0..2000_u64).map(|index| {
            let mut sampler = Sampler::for_path(6, 1, index);
            let [x, y] = sampler.pair(Dimension::EmitPosition);
            let origin = (SIZE * DVec3::new(x, y, sampler.one(Dimension::EmitPosition))).floor();
            let mut dir = uniform_sphere(sampler.pair(Dimension::EmitDirection));
            let zero = if index % 2 == 0 { 0.0 } else { -0.0 };
            match index % 5 {
                0 => dir.x = zero,
                1 => (dir.y, dir.z) = (zero, zero),
                2 => (dir.x, dir.y) = (zero, zero),
                _ => {}
            }
            Ray::new(origin, dir)
        })
    }

    /// Distance at which a ray comes into a box, by the definition.
    fn entry(bounds: &Aabb, ray: &Ray) -> Option<f64> {
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (at, dir) = (ray.origin()[axis], ray.dir()[axis]);
            let [low, high] = [bounds.min[axis] - at, bounds.max[axis] - at];
            if dir == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            near = near.max((low / dir).min(high / dir));
            far = far.min((low / dir).max(high / dir));
        }
        (near <= far).then_some(near)
    }

    #[test]
    fn every_box_that_a_ray_meets_is_visited() {
        // The last two are too many to be arranged at once, and eighths of the last are, too.
        let many = [MOST_AT_ONCE as u64 + 1, 9 * MOST_AT_ONCE as u64];
        for count in [1, 2, 8, 9, 700].into_iter().chain(many) {
            let boxes = boxes(count);
            let tree = SurfaceTree::over(boxes.len(), |index| boxes[index], 2.0 * SIZE);
            for ray in rays().step_by(1 + boxes.len() / 1000) {
                let mut visited = BTreeSet::new();
                tree.visit(&ray, |index| {
                    assert!(visited.insert(index), "twice");
                    f64::INFINITY
                });
                for (index, bounds) in boxes.iter().enumerate() {
                    let is_met = entry(bounds, &ray).is_some();
                    assert!(!is_met || visited.contains(&index), "{count} {ray:?} {bounds:?}");
                }
            }
        }
    }

    #[test]
    fn boxes_up_to_a_limit_are_visited_and_few_beyond() {
        let boxes = boxes(2000);
        let tree = SurfaceTree::over(boxes.len(), |index| boxes[index], 2.0 * SIZE);
        let (mut all, mut near) = (0, 0);
        for ray in rays() {
            let first =
                boxes.iter().filter_map(|own| entry(own, &ray)).fold(f64::INFINITY, f64::min);
            let mut found = f64::INFINITY;
            tree.visit(&ray, |index| {
                near += 1;
                found = found.min(entry(&boxes[index], &ray).unwrap_or(f64::INFINITY));
                found
            });
            assert_eq!(found, first, "{ray:?}");
            tree.visit(&ray, |_| {
                all += 1;
                f64::INFINITY
            });
        }
        assert!(2 * near < all, "{near} of {all}");
    }
}
