//! The arrangement of boxes as a tree: binary by obvhs, then collapsed to eight boxes a node.

use crate::scene::crossing::tree::{LEAF, Leaf, NONE, Tree, WIDTH, WideChild, WideNode};
use glam::Vec3;
use lumiduct_base::math::Aabb;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb as Box32;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use smallvec::{SmallVec, smallvec};
use std::time::Duration;
use wide::f32x8;

/// Most boxes that obvhs arranges at once: for each it takes 270 bytes while it works. More are first divided into eighths, again and again.
pub(super) const MOST_AT_ONCE: usize = 1 << 15;

/// The middle of a box, in f32, and its surface.
#[derive(Clone, Copy)]
struct BoxPlace {
    center: Vec3,
    surface: u32,
}

/// A tree that grows.
struct Arrangement<B> {
    tree: Tree,
    leaves: Vec<Leaf>,
    bounds: B,
}

impl Tree {
    /// A tree over one or more boxes, and what its leaves hold.
    pub(crate) fn over(count: usize, bounds: impl Fn(usize) -> Aabb) -> (Self, Vec<Leaf>) {
        let place = |surface: u32| {
            let center = bounds(surface as usize).center().as_vec3();
            BoxPlace { center, surface }
        };
        let mut places: Vec<BoxPlace> = (0..count as u32).map(place).collect();
        let tree = Self { nodes: Vec::new(), root: WideChild::NONE };
        let mut all = Arrangement { tree, leaves: Vec::new(), bounds };
        (all.tree.root, _) = all.add(&mut places);
        (all.tree, all.leaves)
    }
}

impl<B: Fn(usize) -> Aabb> Arrangement<B> {
    /// Adds the boxes at some places; the child that has them, and the box around it.
    fn add(&mut self, places: &mut [BoxPlace]) -> (WideChild, Box32) {
        if places.len() <= MOST_AT_ONCE {
            return self.add_piece(places);
        }
        let own = self.tree.nodes.len();
        self.tree.nodes.push(WideNode::empty());
        let mut all = Box32::INVALID;
        for (slot, part) in eighths(places).into_iter().enumerate() {
            let (child, bounds) = self.add(part);
            self.tree.nodes[own].set(slot, child, &bounds);
            all = all.union(&bounds);
        }
        (WideChild::node(own), all)
    }

    /// The same for as many boxes as are arranged at once.
    fn add_piece(&mut self, places: &[BoxPlace]) -> (WideChild, Box32) {
        let boxes: Vec<Box32> =
            places.iter().map(|place| to_f32((self.bounds)(place.surface as usize))).collect();
        let params =
            BvhBuildParams { max_prims_per_leaf: LEAF as u32, ..BvhBuildParams::medium_build() };
        let binary = build_bvh2(&boxes, params, &mut Duration::default());
        // Nodes of the binary tree whose children are still to be found, with their places.
        let mut open = Vec::new();
        let leaves = &mut self.leaves;
        let mut child = |nodes: &mut Vec<WideNode>, open: &mut Vec<(u32, usize)>, place: u32| {
            let node = &binary.nodes[place as usize];
            if node.is_leaf() {
                let first = node.first_index as usize;
                let own = &binary.primitive_indices[first..first + node.prim_count as usize];
                assert!(own.len() <= LEAF, "obvhs keeps the limit");
                let mut leaf = [NONE; LEAF];
                for (slot, place) in leaf.iter_mut().zip(own) {
                    *slot = places[*place as usize].surface;
                }
                leaves.push(leaf);
                return WideChild::leaf(leaves.len() - 1);
            }
            open.push((place, nodes.len()));
            nodes.push(WideNode::empty());
            WideChild::node(nodes.len() - 1)
        };
        let root = child(&mut self.tree.nodes, &mut open, 0);
        while let Some((place, own)) = open.pop() {
            for (slot, place) in opened(&binary, place).into_iter().enumerate() {
                let child = child(&mut self.tree.nodes, &mut open, place);
                self.tree.nodes[own].set(slot, child, binary.nodes[place as usize].aabb());
            }
        }
        (root, *binary.nodes[0].aabb())
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
        Self { bounds, children: [WideChild::NONE; WIDTH] }
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

/// The smallest box in f32 around one in f64.
fn to_f32(bounds: Aabb) -> Box32 {
    let (min, max) = (bounds.min.as_vec3a(), bounds.max.as_vec3a());
    Box32::new(
        glam::Vec3A::new(min.x.next_down(), min.y.next_down(), min.z.next_down()),
        glam::Vec3A::new(max.x.next_up(), max.y.next_up(), max.z.next_up()),
    )
}
