//! A density over the unit cube of four dimensions that is constant in the leaves of a tree.

use crate::scene::source::fitted::split::{
    BoxSplit, Coordinates, CubeBox, CubeRay, FluxSums, partition,
};

/// A tree of boxes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DensityTree {
    /// The first is the root.
    nodes: Vec<BoxNode>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum BoxNode {
    /// The lower part is the node `lower`, the upper one the next. `lower_share` of the light of the node is in the lower part.
    Split { axis: u32, lower: u32, at: f64, lower_share: f64 },
    /// The density in a box, relative to that of an even cube.
    Leaf(f64),
}

/// Errors of the density in a leaf of a tree, as mean squares over the light.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct LeafErrors {
    /// Number of leaves with light.
    pub(super) leaves: usize,
    /// Relative variance because the rays are a sample, 1.
    pub(super) sampling: f64,
    /// Relative deviations within leaves along position and along direction, 1.
    pub(super) variation: [f64; 2],
}

impl DensityTree {
    /// The density of rays with light in a cube that is split, and its errors.
    pub(super) fn new(split: Option<&BoxSplit>, rays: &mut [CubeRay]) -> (Self, LeafErrors) {
        let mut tree = Self { nodes: vec![BoxNode::Leaf(0.0)] };
        let mut errors = LeafErrors::default();
        let flux = rays.iter().map(|ray| f64::from(ray.flux)).sum();
        tree.fill(0, split, &CubeBox::WHOLE, rays, &mut errors, flux);
        (tree, errors)
    }

    /// Fills a node and all below it; returns their share of `all` flux, 1.
    fn fill(
        &mut self,
        node: usize,
        split: Option<&BoxSplit>,
        cube: &CubeBox,
        rays: &mut [CubeRay],
        errors: &mut LeafErrors,
        all: f64,
    ) -> f64 {
        let Some(BoxSplit { axis, at, parts, .. }) = split else {
            let mut sums = FluxSums::default();
            rays.iter().for_each(|ray| sums.add(ray));
            let share = sums.flux / all;
            self.nodes[node] = BoxNode::Leaf(share / cube.volume());
            errors.add_leaf(rays, cube, sums, share);
            return share;
        };
        let lower = self.nodes.len();
        self.nodes.extend([BoxNode::Leaf(0.0); 2]);
        let boxes = cube.split(*axis, *at);
        let (below, above) = partition(rays, *axis, *at);
        let mut share = |part: usize, rays: &mut [CubeRay]| {
            self.fill(lower + part, parts[part].as_deref(), &boxes[part], rays, errors, all)
        };
        let shares = [share(0, below), share(1, above)];
        let both = shares[0] + shares[1];
        let lower_share = if both > 0.0 { shares[0] / both } else { 0.5 };
        self.nodes[node] =
            BoxNode::Split { axis: *axis as u32, lower: lower as u32, at: *at, lower_share };
        both
    }

    /// Density at a place, relative to that of an even cube.
    pub(super) fn density(&self, at: &Coordinates) -> f64 {
        let mut node = 0;
        loop {
            match self.nodes[node] {
                BoxNode::Leaf(density) => return density,
                BoxNode::Split { axis, lower, at: split, .. } => {
                    node = lower as usize + usize::from(at[axis as usize] >= split);
                }
            }
        }
    }

    /// A place in proportion to the density, from one of the cube: the order along each axis of a box is kept, so that
    /// stratified points stay stratified.
    pub(super) fn sample(&self, mut u: Coordinates) -> Coordinates {
        let (mut from, mut to) = ([0.0; 4], [1.0; 4]);
        let mut node = 0;
        while let BoxNode::Split { axis, lower, at, lower_share } = self.nodes[node] {
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

impl LeafErrors {
    /// The relative deviations are found from the difference of the halves of a leaf, less the contribution of sampling noise: of a density that is
    /// linear along an axis, the mean square is 4/3 of the square of that difference.
    fn add_leaf(&mut self, rays: &[CubeRay], cube: &CubeBox, sums: FluxSums, share: f64) {
        if sums.rays == 0 {
            return;
        }
        self.leaves += 1;
        self.sampling += share * sums.squares / (sums.flux * sums.flux);
        let pairs = sums.flux * sums.flux - sums.squares;
        if pairs <= 1e-9 * sums.squares {
            return;
        }
        let middle: Coordinates =
            std::array::from_fn(|axis| 0.5 * (cube.from[axis] + cube.to[axis]));
        let mut differences = [0.0; 4];
        for ray in rays {
            for (axis, difference) in differences.iter_mut().enumerate() {
                let is_upper = f64::from(ray.at[axis]) >= middle[axis];
                *difference += f64::from(if is_upper { ray.flux } else { -ray.flux });
            }
        }
        let squares = differences.map(|own| share * 4.0 / 3.0 * (own * own - sums.squares) / pairs);
        self.variation[0] += squares[0] + squares[1];
        self.variation[1] += squares[2] + squares[3];
    }
}
