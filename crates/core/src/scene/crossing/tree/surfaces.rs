//! A tree over surfaces of any kind.

use crate::scene::Ray;
use crate::scene::crossing::tree::{Leaf, NONE, Tree, padding};
use lumiduct_base::math::Aabb;

/// A tree over the boxes of surfaces.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceTree {
    tree: Tree,
    leaves: Vec<Leaf>,
    padding: f32,
}

impl SurfaceTree {
    /// A tree over one or more surfaces with these boxes; coordinates, those of rays too, are up to `largest_coordinate`, mm.
    pub(crate) fn over(
        count: usize,
        bounds: impl Fn(usize) -> Aabb,
        largest_coordinate: f64,
    ) -> Self {
        let (tree, leaves) = Tree::over(count, bounds);
        Self { tree, leaves, padding: padding(largest_coordinate) }
    }

    /// Calls `visit` with the index of every surface whose box, taken a little larger, the ray meets before the smallest distance that
    /// `visit` has returned.
    #[inline]
    pub(crate) fn visit(&self, ray: &Ray, mut visit: impl FnMut(usize) -> f64) {
        let all = |_| u32::MAX;
        self.tree.visit((ray, self.padding), f64::INFINITY, all, |leaf| {
            let own = self.leaves[leaf].iter().take_while(|surface| **surface != NONE);
            own.map(|surface| visit(*surface as usize)).fold(f64::INFINITY, f64::min)
        });
    }
}
