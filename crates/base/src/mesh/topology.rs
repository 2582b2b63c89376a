//! Which triangles share an edge, and which are connected.

use crate::mesh::TriangleMesh;

/// A triangle's side of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HalfEdge {
    /// The smaller index of the two vertices.
    pub low: u32,
    /// The larger one.
    pub high: u32,
    /// The triangle.
    pub triangle: u32,
    /// The corner of the triangle at which its traversal of the edge begins.
    pub corner: u8,
}

impl HalfEdge {
    /// Its place among all: by edge, triangle and corner, in one number that is compared at once.
    fn order(&self) -> u128 {
        let edge = u128::from(self.low) << 32 | u128::from(self.high);
        edge << 64 | u128::from(self.triangle) << 8 | u128::from(self.corner)
    }

    /// Whether the triangle walks from `low` to `high`.
    pub(crate) fn is_upward(&self, triangles: &[[u32; 3]]) -> bool {
        triangles[self.triangle as usize][usize::from(self.corner)] == self.low
    }

    /// The corner of the triangle that is not on the edge.
    pub fn opposite_corner(&self) -> usize {
        usize::from(self.corner + 2) % 3
    }

    /// The corners of the triangle at `low` and at `high`.
    pub(crate) fn corners(&self, triangles: &[[u32; 3]]) -> [usize; 2] {
        let (from, to) = (usize::from(self.corner), usize::from(self.corner + 1) % 3);
        if self.is_upward(triangles) { [from, to] } else { [to, from] }
    }
}

/// All half edges, sorted so that those of one edge are adjacent: `half_edges.chunk_by(same_edge)`.
/// Triangles that use a vertex twice have none, as they collapse to a line or a point.
pub fn half_edges(triangles: &[[u32; 3]]) -> Vec<HalfEdge> {
    let whole = || triangles.iter().enumerate().filter(|(_, triangle)| !is_collapsed(triangle));
    let sides = || {
        whole().flat_map(|(index, triangle)| {
            [0, 1, 2].map(|corner: u8| {
                let ends = [corner, (corner + 1) % 3].map(|end| triangle[usize::from(end)]);
                let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
                HalfEdge { low, high, triangle: index as u32, corner }
            })
        })
    };
    // Counted by the smaller vertex first: a comparison of all with all takes several times as long.
    let vertices = whole().flat_map(|(_, triangle)| triangle).max().map_or(0, |last| last + 1);
    let mut places = vec![0; vertices as usize];
    for side in sides() {
        places[side.low as usize] += 1;
    }
    let mut count = 0;
    for place in &mut places {
        (*place, count) = (count, count + *place);
    }
    let mut all = vec![HalfEdge { low: 0, high: 0, triangle: 0, corner: 0 }; count];
    for side in sides() {
        let place = &mut places[side.low as usize];
        all[*place] = side;
        *place += 1;
    }
    for of_vertex in all.chunk_by_mut(|one, other| one.low == other.low) {
        of_vertex.sort_unstable_by_key(HalfEdge::order);
    }
    all
}

/// Whether two half edges join the same vertices.
pub fn same_edge(one: &HalfEdge, other: &HalfEdge) -> bool {
    one.low == other.low && one.high == other.high
}

/// Whether every edge of a mesh has two triangles, which face the same side.
pub fn is_closed(mesh: &TriangleMesh) -> bool {
    let is_inner = |edge: &[HalfEdge]| match edge {
        [one, other] => one.is_upward(&mesh.triangles) != other.is_upward(&mesh.triangles),
        _ => false,
    };
    half_edges(&mesh.triangles).chunk_by(same_edge).all(is_inner)
}

/// Whether a triangle uses a vertex twice.
pub(crate) fn is_collapsed([a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}

/// Disjoint sets of items numbered from 0 (Tarjan, J. ACM 22 (1975) 215; path halving).
#[derive(Debug, Clone)]
pub struct Groups {
    parent: Vec<u32>,
}

impl Groups {
    /// `count` items, each in its own group.
    pub fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    /// Joins the groups of two items.
    pub fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.root(one), self.root(other));
        // The smaller index leads, so that the result does not depend on the order of the calls.
        self.parent[one.max(other) as usize] = one.min(other);
    }

    /// The group of each item, numbered from 0 in order of appearance.
    pub fn numbered(mut self) -> Vec<u32> {
        let mut number = vec![0; self.parent.len()];
        let mut next = 0;
        for thing in 0..self.parent.len() as u32 {
            let root = self.root(thing);
            // A root is the smallest of its group, so it comes first.
            if root == thing {
                number[thing as usize] = next;
                next += 1;
            } else {
                number[thing as usize] = number[root as usize];
            }
        }
        number
    }

    fn root(&mut self, mut thing: u32) -> u32 {
        while self.parent[thing as usize] != thing {
            let above = self.parent[thing as usize];
            self.parent[thing as usize] = self.parent[above as usize];
            thing = above;
        }
        thing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shared_edge_is_walked_both_ways_by_oriented_triangles() {
        let triangles = [[0, 1, 2], [2, 1, 3], [4, 4, 1]];
        let half_edges = half_edges(&triangles);
        assert_eq!(half_edges.len(), 6);
        let shared = half_edges.chunk_by(same_edge).find(|edge| edge.len() == 2).unwrap();
        assert_eq!((shared[0].low, shared[0].high), (1, 2));
        assert!(shared[0].is_upward(&triangles) && !shared[1].is_upward(&triangles));
        assert_eq!(shared[0].opposite_corner(), 0);
        assert_eq!(shared[1].opposite_corner(), 2);
        assert_eq!(shared[1].corners(&triangles), [1, 0]);
    }

    #[test]
    fn groups_are_numbered_by_their_first_member() {
        let mut groups = Groups::new(6);
        groups.join(5, 1);
        groups.join(3, 5);
        groups.join(4, 2);
        assert_eq!(groups.numbered(), [0, 1, 2, 1, 2, 1]);
    }
}
