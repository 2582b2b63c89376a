//! The triangles of a mesh that a ray crosses one way, out of it or into it.
//!
//! A tree of boxes with the cones of the normals in them: boxes whose triangles all face the other way are passed over. Its leaves hold
//! the triangles, four at most: all that a crossing needs lies in one place of memory, for which a search waits once. So triangles
//! are numbered by their places in the leaves, of which some are empty.

use crate::scene::Ray;
use crate::scene::crossing::tree::{LEAF, Leaf, NONE, Tree, TreeBranch, take_bit};
use crate::scene::mesh::TriangleLine;
use crate::scene::mesh::facing::{FacedWay, NodeCones, NormalCone};
use crate::scene::mesh::four::{FourTriangles, LineOfFour};
use crate::scene::shape::Toward;
use glam::DVec3;
use lumiduct_base::mesh::{TriangleMesh, area_vector};

/// A triangle whose smallest height, over its largest coordinate, is less has no normal that rounding could not turn, 1.
const LEAST_HEIGHT: f64 = 1e-9;

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
        let cones = cones(&tree, |leaf| {
            let own = leaves[leaf].iter().take_while(|triangle| **triangle != NONE);
            NormalCone::around(own.map(|triangle| cone(mesh, *triangle as usize)))
        });
        Self { tree, cones, fours }
    }

    /// The vertices of a triangle, mm.
    #[inline(always)]
    pub(super) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.fours[triangle / LEAF].corners(triangle % LEAF)
    }

    /// Calls `visit` with every triangle that a line crosses in this direction, in the part of it before `limit`, and the smallest
    /// distance that `visit` has returned, mm; with the line go its ray and the padding of boxes.
    #[inline(always)]
    pub(super) fn visit(
        &self,
        (ray, line, padding): (&Ray, &TriangleLine, f32),
        toward: Toward,
        limit: f64,
        mut visit: impl FnMut(usize) -> f64,
    ) {
        let facing = FacedWay::new(ray.dir(), toward);
        let line = LineOfFour::new(line, toward);
        let among = |node: usize| self.cones[node].faced(&facing);
        self.tree.visit((ray, padding), limit, among, |leaf| {
            let mut crossed = line.crossed(&self.fours[leaf]);
            let mut limit = f64::INFINITY;
            while let Some(lane) = take_bit(&mut crossed) {
                limit = limit.min(visit(leaf * LEAF + lane));
            }
            limit
        });
    }
}

/// The directions that the normal of a triangle may have.
fn cone(mesh: &TriangleMesh, triangle: usize) -> NormalCone {
    let corners = mesh.corners(triangle);
    let [a, b, c] = corners;
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    let largest = corners.iter().map(|corner| corner.abs().max_element()).fold(0.0, f64::max);
    // Twice the area is the longest side times the smallest height.
    let double_area = area_vector(corners);
    let is_certain = double_area.length() > LEAST_HEIGHT * largest * longest;
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
                        let from = (&ray, &line, padding(100.0));
                        mesh.visit_crossings(from, toward, f64::INFINITY, |triangle, crossing| {
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
