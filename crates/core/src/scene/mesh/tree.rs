//! The triangles of a mesh that a ray crosses one way, out of it or into it.
//!
//! A tree of boxes with the cones of the normals in them: boxes whose triangles all face the other way are passed over. Its leaves hold
//! the triangles, four at most: all that a crossing needs lies in one place of memory, for which a search waits once. A triangle's
//! number is its place in the leaves, so some numbers have no triangle.

use crate::scene::Ray;
use crate::scene::crossing::tree::{LEAF, Leaf, NONE, Tree, TreeBranch, take_bit};
use crate::scene::mesh::TriangleLine;
use crate::scene::mesh::facing::{FacedWay, NodeCones, NormalCone};
use crate::scene::mesh::four::{FourTriangles, LineOfFour};
use crate::scene::shape::Toward;
use glam::DVec3;
use lumiduct_base::mesh::{MAX_SHOWN_TRIANGLES, TriangleMesh, area_vector};

/// The normal of a triangle whose smallest height, over the largest coordinate of its mesh, is less may be turned by rounding, 1.
///
/// Seen from a distance D the vertices are off by some 5e-16 D. That turns a triangle of height h only if the line is within
/// 5e-16 D/h of its plane, which is less than the margin of the cones (2e-3) for D up to 4e5 mesh sizes.
const LEAST_HEIGHT: f64 = 1e-7;

const _: () = assert!(
    MAX_SHOWN_TRIANGLES * LEAF as u64 <= u32::MAX as u64,
    "numbers of triangles fit, even with one in each leaf"
);

/// A line to be followed through a tree.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight<'s> {
    /// The ray that it starts with.
    pub(super) ray: &'s Ray,
    /// The line.
    pub(super) line: &'s TriangleLine,
    /// By how much boxes are taken to be larger.
    pub(super) padding: f32,
}

/// A tree over the triangles of a mesh.
#[derive(Debug, Clone)]
pub(super) struct MeshTree {
    tree: Tree,
    /// Cones of the normals of the children of each node.
    cones: Vec<NodeCones>,
    /// The triangles of each leaf.
    fours: Vec<FourTriangles>,
}

impl MeshTree {
    /// The triangles of a mesh in the leaves of a tree over their boxes.
    pub(super) fn new(tree: Tree, leaves: &[Leaf], mesh: &TriangleMesh) -> Self {
        let fours = leaves.iter().map(|leaf| FourTriangles::of(mesh, leaf)).collect();
        let least_height = LEAST_HEIGHT * mesh.bounds().largest_coordinate();
        let cones = cones(&tree, |leaf| {
            let own = leaves[leaf].iter().take_while(|triangle| **triangle != NONE);
            NormalCone::around(
                own.map(|triangle| cone(mesh.corners(*triangle as usize), least_height)),
            )
        });
        Self { tree, cones, fours }
    }

    /// The vertices of a triangle, mm.
    #[inline(always)]
    pub(super) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.fours[triangle / LEAF].corners(triangle % LEAF)
    }

    /// Calls `visit` with every triangle that a line crosses in this direction, in the part of it before `limit` and the smallest
    /// distance that `visit` has returned; distances are in the coordinates of the mesh.
    #[inline(always)]
    pub(super) fn visit(
        &self,
        sight: Sight<'_>,
        toward: Toward,
        limit: f64,
        mut visit: impl FnMut(usize) -> f64,
    ) {
        let facing = FacedWay::new(sight.ray.dir(), toward);
        let line = LineOfFour::new(sight.line, toward);
        let among = |node: usize| self.cones[node].faced(&facing);
        self.tree.visit((sight.ray, sight.padding), limit, among, |leaf| {
            let mut crossed = line.crossed(&self.fours[leaf]);
            let mut limit = f64::INFINITY;
            while let Some(lane) = take_bit(&mut crossed) {
                limit = limit.min(visit(leaf * LEAF + lane));
            }
            limit
        });
    }
}

/// The directions that the normal of a triangle may have; all if its smallest height is less than this, mm.
fn cone(corners: [DVec3; 3], least_height: f64) -> NormalCone {
    let [a, b, c] = corners;
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let double_area = area_vector(corners);
    // Twice the area is the longest side times the smallest height.
    let is_certain = double_area.length() > least_height * longest;
    double_area.try_normalize().filter(|_| is_certain).map_or(NormalCone::ALL, NormalCone::of)
}

/// Cones of the children of each node, from those of the leaves.
fn cones(tree: &Tree, of_leaf: impl Fn(usize) -> NormalCone) -> Vec<NodeCones> {
    let mut of_nodes = vec![NormalCone::ALL; tree.nodes().len()];
    let mut cones = vec![NodeCones::new(); tree.nodes().len()];
    // Numbers of nodes are greater than those of their parents.
    for (own, children) in tree.nodes().enumerate().rev() {
        let mut all = Vec::new();
        for (slot, branch) in children {
            let cone = match branch {
                TreeBranch::Node(node) => of_nodes[node],
                TreeBranch::Leaf(leaf) => of_leaf(leaf),
            };
            cones[own].set(slot, &cone);
            all.push(cone);
        }
        of_nodes[own] = NormalCone::around(all.into_iter());
    }
    cones
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Dimension, Sampler};
    use crate::scene::crossing::tree::padding;
    use crate::scene::mesh::Mesh;
    use lumiduct_base::math::{Frame, uniform_sphere};
    use lumiduct_base::mesh::bodies::{Normals, block, icosphere, rod};

    /// Lines at the vertices, edges and middles of triangles, from near and far, and along the axes.
    fn lines_at([a, b, c]: [DVec3; 3], index: u64) -> [Ray; 4] {
        let mut sampler = Sampler::for_path(61, 0, index);
        let away = uniform_sphere(sampler.pair(Dimension::EmitPosition));
        let axis = [DVec3::X, DVec3::NEG_Y, DVec3::Z][index as usize % 3];
        let line = |target: DVec3, away: DVec3| Ray::new(target + away, -away);
        [
            line(a, 0.1 * away),
            line(0.5 * (a + b), 50.0 * away),
            line(0.3 * a + 0.3 * b + 0.4 * c, 7.0 * away),
            line(0.5 * (b + c), 9.0 * axis),
        ]
    }

    #[test]
    fn exactly_the_crossings_of_one_way_are_visited() {
        // Turned, so that no coordinate is round, and as they are, for lines within planes and along edges.
        let turned = Frame::from_axis(DVec3::new(12.3, -4.5, 6.7), DVec3::new(0.3, -0.5, 0.8));
        let bodies = [
            rod(2.0, 40.0, 24, Normals::None),
            rod(2.0, 40.0, 96, Normals::Smooth),
            icosphere(3.0, 3, Normals::None),
            block(DVec3::new(1.0, 2.0, 3.0)),
        ];
        let mut crossings = 0;
        for (body, at) in bodies.iter().flat_map(|body| [(body, turned), (body, Frame::WORLD)]) {
            let mesh = Mesh::new(body, &at);
            let step = 1 + mesh.triangle_count() / 200;
            for (index, triangle) in mesh.triangles().step_by(step).enumerate() {
                for ray in lines_at(mesh.corners(triangle), index as u64) {
                    let line = TriangleLine::of(&ray);
                    for toward in [Toward::Front, Toward::Back] {
                        let mut found = Vec::new();
                        let sight = Sight { ray: &ray, line: &line, padding: padding(100.0) };
                        mesh.visit_crossings(sight, toward, f64::INFINITY, |triangle, crossing| {
                            assert_eq!(Some(crossing), mesh.crossing_of(triangle, &line));
                            assert_eq!(crossing.toward, toward);
                            found.push(triangle);
                            f64::INFINITY
                        });
                        crossings += found.len();
                        for triangle in mesh.triangles() {
                            let crossing = mesh.crossing_of(triangle, &line);
                            let counts =
                                crossing.is_some_and(|own| own.toward == toward && own.t >= 0.0);
                            assert!(!counts || found.contains(&triangle), "{ray:?} {crossing:?}");
                        }
                    }
                }
            }
        }
        assert!(crossings > 5000, "{crossings}");
    }
}
