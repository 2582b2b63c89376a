//! A density over the unit cube of four dimensions that is constant in the boxes of a tree.

use crate::scene::source::fitted::grow::{BoxCut, Coordinates, Grown};

/// A tree of boxes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DensityTree {
    /// The first is the root.
    nodes: Vec<BoxNode>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum BoxNode {
    /// A cut; the lower part is the node `lower`, the upper one the next. `lower_share` of the light of the node is in the
    /// lower part.
    Cut { axis: u32, lower: u32, at: f64, lower_share: f64 },
    /// A box, and the density in it, relative to that of an even one.
    Even(f64),
}

impl DensityTree {
    /// The tree of a cube that has light.
    pub(super) fn new(grown: &Grown) -> Self {
        let mut tree = Self { nodes: vec![BoxNode::Even(0.0)] };
        tree.set(0, grown, [0.0; 4], [1.0; 4], grown.share);
        tree
    }

    fn set(&mut self, node: usize, grown: &Grown, from: Coordinates, to: Coordinates, all: f64) {
        let Some(cut) = &grown.cut else {
            let volume: f64 = (0..4).map(|axis| to[axis] - from[axis]).product();
            self.nodes[node] = BoxNode::Even(grown.share / (all * volume));
            return;
        };
        let BoxCut { axis, at, parts, .. } = cut.as_ref();
        let lower = self.nodes.len();
        self.nodes.extend([BoxNode::Even(0.0); 2]);
        let lower_share = if grown.share > 0.0 { parts[0].share / grown.share } else { 0.5 };
        self.nodes[node] =
            BoxNode::Cut { axis: *axis as u32, lower: lower as u32, at: *at, lower_share };
        let (mut lower_to, mut upper_from) = (to, from);
        lower_to[*axis] = *at;
        upper_from[*axis] = *at;
        self.set(lower, &parts[0], from, lower_to, all);
        self.set(lower + 1, &parts[1], upper_from, to, all);
    }

    /// Density at a place, relative to that of an even one.
    pub(super) fn density(&self, at: &Coordinates) -> f64 {
        let mut node = 0;
        loop {
            match self.nodes[node] {
                BoxNode::Even(density) => return density,
                BoxNode::Cut { axis, lower, at: cut, .. } => {
                    node = lower as usize + usize::from(at[axis as usize] >= cut);
                }
            }
        }
    }

    /// A place in proportion to the density, from one of the cube: the order along each axis of a box is kept, so that
    /// stratified points stay stratified.
    pub(super) fn sample(&self, mut u: Coordinates) -> Coordinates {
        let (mut from, mut to) = ([0.0; 4], [1.0; 4]);
        let mut node = 0;
        while let BoxNode::Cut { axis, lower, at, lower_share } = self.nodes[node] {
            let axis = axis as usize;
            let is_upper = u[axis] >= lower_share;
            let within = if is_upper {
                from[axis] = at;
                (u[axis] - lower_share) / (1.0 - lower_share)
            } else {
                to[axis] = at;
                u[axis] / lower_share
            };
            u[axis] = within.min(1.0_f64.next_down());
            node = lower as usize + usize::from(is_upper);
        }
        std::array::from_fn(|axis| from[axis] + u[axis] * (to[axis] - from[axis]))
    }
}
