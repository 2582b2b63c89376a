//! A tree of boxes, eight to a node, tested all at once.
//!
//! It is collapsed from the binary tree of obvhs: a node takes the eight boxes that remain when its largest ones have been opened again
//! and again (Wald, Benthin & Boulos, "Getting rid of packets", IEEE Symposium on Interactive Ray Tracing 2008, 49). Boxes are f32, padded
//! outward, and cull only.

use crate::scene::Ray;
use glam::Vec3;
use lumiduct_base::math::Aabb;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb as Box32;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use smallvec::{SmallVec, smallvec};
use std::fmt;
use std::time::Duration;
use wide::f32x8;

/// Boxes in a node.
const WIDTH: usize = 8;
/// Boxes grow by this many f32 ulp of the largest coordinate: rounding of the box, of the ray's origin, and of the slab test.
const PADDING_ULP: f64 = 8.0;
/// Most boxes that obvhs arranges at once: for each it takes 270 bytes while it works. More are first divided into eighths, again and again.
const MOST_AT_ONCE: usize = 1 << 15;
/// Least size of a component of a direction, 1: with 0, an origin on a padded side would give 0 · ∞. A coordinate over it is finite in f32.
const LEAST_COMPONENT: f32 = 1e-25;

/// A tree over the boxes of surfaces.
#[derive(Clone)]
pub(crate) struct Tree {
    nodes: Vec<WideNode>,
    root: WideChild,
    /// Surfaces in the order of the leaves.
    surfaces: Vec<u32>,
}

/// The boxes of eight children: least and greatest coordinates along each axis.
#[derive(Clone)]
struct WideNode {
    bounds: [[f32x8; 2]; 3],
    children: [WideChild; WIDTH],
}

/// A node, or some surfaces.
#[derive(Clone, Copy, Default)]
struct WideChild {
    /// Place of the node, or of the first surface.
    first: u32,
    /// Number of surfaces; 0 for a node.
    count: u32,
}

/// The middle of a box, in f32, and its surface.
#[derive(Clone, Copy)]
struct BoxPlace {
    center: Vec3,
    surface: u32,
}

impl fmt::Debug for Tree {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "Tree({} nodes)", self.nodes.len())
    }
}

impl Tree {
    /// A tree over one or more surfaces with these boxes; rays start at coordinates up to `largest_coordinate`, mm.
    pub(crate) fn over(
        count: usize,
        bounds: impl Fn(usize) -> Aabb,
        largest_coordinate: f64,
    ) -> Self {
        let padding = PADDING_ULP * f64::from(f32::EPSILON) * largest_coordinate;
        let place = |surface: u32| {
            let center = bounds(surface as usize).center().as_vec3();
            BoxPlace { center, surface }
        };
        let mut places: Vec<BoxPlace> = (0..count as u32).map(place).collect();
        let mut tree = Self { nodes: Vec::new(), root: WideChild::default(), surfaces: Vec::new() };
        let padded = |place: &BoxPlace| to_f32(bounds(place.surface as usize).grown(padding));
        (tree.root, _) = tree.add(&mut places, &padded);
        tree
    }

    /// Adds the boxes at some places; the child that has them, and the box around it.
    fn add(
        &mut self,
        places: &mut [BoxPlace],
        padded: &impl Fn(&BoxPlace) -> Box32,
    ) -> (WideChild, Box32) {
        if places.len() <= MOST_AT_ONCE {
            return self.add_piece(places, padded);
        }
        let own = self.nodes.len();
        self.nodes.push(WideNode::empty());
        let mut all = Box32::INVALID;
        for (slot, part) in eighths(places).into_iter().enumerate() {
            let (child, bounds) = self.add(part, padded);
            self.nodes[own].set(slot, child, &bounds);
            all = all.union(&bounds);
        }
        (WideChild { first: own as u32, count: 0 }, all)
    }

    /// The same for as many boxes as are arranged at once.
    fn add_piece(
        &mut self,
        places: &[BoxPlace],
        padded: &impl Fn(&BoxPlace) -> Box32,
    ) -> (WideChild, Box32) {
        let boxes: Vec<Box32> = places.iter().map(padded).collect();
        let binary = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
        let before = self.surfaces.len() as u32;
        let surface = |place: &u32| places[*place as usize].surface;
        self.surfaces.extend(binary.primitive_indices.iter().map(surface));
        // Nodes of the binary tree whose children are still to be found, with their places.
        let mut open = Vec::new();
        let child = |nodes: &mut Vec<WideNode>, open: &mut Vec<(u32, usize)>, place: u32| {
            let node = &binary.nodes[place as usize];
            if node.is_leaf() {
                return WideChild { first: before + node.first_index, count: node.prim_count };
            }
            open.push((place, nodes.len()));
            nodes.push(WideNode::empty());
            WideChild { first: nodes.len() as u32 - 1, count: 0 }
        };
        let root = child(&mut self.nodes, &mut open, 0);
        while let Some((place, own)) = open.pop() {
            for (slot, place) in opened(&binary, place).into_iter().enumerate() {
                let child = child(&mut self.nodes, &mut open, place);
                self.nodes[own].set(slot, child, binary.nodes[place as usize].aabb());
            }
        }
        (root, *binary.nodes[0].aabb())
    }

    /// Calls `visit` with the index of every surface whose box the ray meets before `limit`, at least 0, and the smallest distance that
    /// `visit` has returned; of the boxes in a node, nearer ones come first.
    #[inline]
    pub(crate) fn visit(&self, ray: &Ray, limit: f64, mut visit: impl FnMut(usize) -> f64) {
        let slabs = Slabs::of(ray);
        let mut limit = round_up(limit);
        let mut open: SmallVec<[(f32, WideChild); 64]> = smallvec![(0.0, self.root)];
        while let Some((near, child)) = open.pop() {
            if near > limit {
                continue;
            }
            if child.count > 0 {
                let first = child.first as usize;
                for surface in &self.surfaces[first..first + child.count as usize] {
                    limit = limit.min(round_up(visit(*surface as usize)));
                }
                continue;
            }
            let node = &self.nodes[child.first as usize];
            let (near, mut met) = slabs.meet(node, limit);
            let from = open.len();
            while met != 0 {
                let slot = met.trailing_zeros() as usize;
                met &= met - 1;
                // The nearest comes last.
                let mut place = open.len();
                open.push((near[slot], node.children[slot]));
                while place > from && open[place - 1].0 < near[slot] {
                    open.swap(place, place - 1);
                    place -= 1;
                }
            }
        }
    }
}

/// Halves, quarters and eighths of some boxes, each divided at the median along the longest axis of their middles.
fn eighths(places: &mut [BoxPlace]) -> SmallVec<[&mut [BoxPlace]; WIDTH]> {
    let mut parts: SmallVec<[&mut [BoxPlace]; WIDTH]> = smallvec![places];
    while parts.len() < WIDTH {
        parts = parts.into_iter().flat_map(halves).collect();
    }
    parts
}

fn halves(places: &mut [BoxPlace]) -> [&mut [BoxPlace]; 2] {
    let none = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    let [low, high] = places
        .iter()
        .fold(none, |[low, high], place| [low.min(place.center), high.max(place.center)]);
    let axis = (high - low).max_position();
    let middle = places.len() / 2;
    // Equal middles in the order of their surfaces, so that the tree is the same every time.
    places.select_nth_unstable_by(middle, |one, other| {
        one.center[axis].total_cmp(&other.center[axis]).then(one.surface.cmp(&other.surface))
    });
    places.split_at_mut(middle).into()
}

/// The nodes of a binary tree that replace one with two children.
fn opened(binary: &Bvh2, place: u32) -> SmallVec<[u32; WIDTH]> {
    let mut found: SmallVec<[u32; WIDTH]> = smallvec![place];
    let node = |place: u32| &binary.nodes[place as usize];
    while found.len() < WIDTH {
        let inner = (0..found.len()).filter(|slot| !node(found[*slot]).is_leaf());
        let area = |slot: &usize| node(found[*slot]).aabb().half_area();
        let Some(largest) = inner.max_by(|one, other| area(one).total_cmp(&area(other))) else {
            break;
        };
        let first = node(found[largest]).first_index;
        found[largest] = first;
        found.push(first + 1);
    }
    found
}

impl WideNode {
    /// Boxes that no ray meets.
    fn empty() -> Self {
        let bounds = [[f32::INFINITY, f32::NEG_INFINITY].map(f32x8::splat); 3];
        Self { bounds, children: [WideChild::default(); WIDTH] }
    }

    fn set(&mut self, slot: usize, child: WideChild, bounds: &Box32) {
        self.children[slot] = child;
        for axis in 0..3 {
            for (side, corner) in [bounds.min, bounds.max].into_iter().enumerate() {
                self.bounds[axis][side].as_mut_array()[slot] = corner[axis];
            }
        }
    }
}

/// A ray, prepared for boxes: Kay & Kajiya, "Ray tracing complex scenes", SIGGRAPH Comput. Graph. 20 (1986) 269.
struct Slabs {
    origin: [f32x8; 3],
    inverse: [f32x8; 3],
    /// The side of a box that the ray meets first along each axis.
    first: [usize; 3],
}

impl Slabs {
    #[inline]
    fn of(ray: &Ray) -> Self {
        let (origin, dir) = (ray.origin().as_vec3().to_array(), ray.dir().as_vec3().to_array());
        let inverse = dir.map(|own| 1.0 / own.abs().max(LEAST_COMPONENT).copysign(own));
        Self {
            origin: origin.map(f32x8::splat),
            inverse: inverse.map(f32x8::splat),
            first: inverse.map(|own| usize::from(own < 0.0)),
        }
    }

    /// Distances to the boxes of a node, and a bit for each that is met before a limit.
    #[inline]
    fn meet(&self, node: &WideNode, limit: f32) -> ([f32; WIDTH], u32) {
        // Written out: closures over arrays are not inlined.
        let [x, y, z] = &node.bounds;
        let ([ox, oy, oz], [ix, iy, iz], [sx, sy, sz]) = (self.origin, self.inverse, self.first);
        let near_x = (x[sx] - ox) * ix;
        let near_y = (y[sy] - oy) * iy;
        let near_z = (z[sz] - oz) * iz;
        let far_x = (x[1 - sx] - ox) * ix;
        let far_y = (y[1 - sy] - oy) * iy;
        let far_z = (z[1 - sz] - oz) * iz;
        let near = near_x.fast_max(near_y).fast_max(near_z.fast_max(f32x8::ZERO));
        let far = far_x.fast_min(far_y).fast_min(far_z.fast_min(f32x8::splat(limit)));
        (near.to_array(), near.simd_le(far).to_bitmask())
    }
}

/// The next f32 above a value, so that culling never removes a hit.
#[inline]
fn round_up(value: f64) -> f32 {
    (value as f32).next_up()
}

fn to_f32(bounds: Aabb) -> Box32 {
    let (min, max) = (bounds.min.as_vec3a(), bounds.max.as_vec3a());
    Box32::new(
        glam::Vec3A::new(min.x.next_down(), min.y.next_down(), min.z.next_down()),
        glam::Vec3A::new(max.x.next_up(), max.y.next_up(), max.z.next_up()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Dimension, Sampler};
    use glam::DVec3;
    use lumiduct_base::math::uniform_sphere;
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
            let tree = Tree::over(boxes.len(), |index| boxes[index], 2.0 * SIZE);
            for ray in rays().step_by(1 + boxes.len() / 1000) {
                let mut visited = BTreeSet::new();
                tree.visit(&ray, f64::INFINITY, |index| {
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
        let tree = Tree::over(boxes.len(), |index| boxes[index], 2.0 * SIZE);
        let (mut all, mut near) = (0, 0);
        for ray in rays() {
            let first =
                boxes.iter().filter_map(|own| entry(own, &ray)).fold(f64::INFINITY, f64::min);
            let mut found = f64::INFINITY;
            tree.visit(&ray, f64::INFINITY, |index| {
                near += 1;
                found = found.min(entry(&boxes[index], &ray).unwrap_or(f64::INFINITY));
                found
            });
            assert_eq!(found, first, "{ray:?}");
            tree.visit(&ray, f64::INFINITY, |_| {
                all += 1;
                f64::INFINITY
            });
        }
        assert!(2 * near < all, "{near} of {all}");
    }
}
