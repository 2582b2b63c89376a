//! The cells and the nodes of a table, and how the mean over a cell follows from nodes.

use crate::luminaire::intensities::PlaneSymmetry;
use lumiduct_base::math::linear_over_ring;
use ndarray::Array2;

/// Planes closer than this are the same, deg.
const SAME_PLANE: f64 = 1e-9;
/// Shares closer than this are the same, 1.
const SAME_SHARE: f64 = 1e-9;

/// Edges of a ring, rad.
pub(crate) fn ring_edges(ring: usize, rings: usize) -> [f64; 2] {
    [ring, ring + 1].map(|edge| std::f64::consts::PI * edge as f64 / rings as f64)
}

/// The planes of a table.
pub(crate) struct Planes {
    /// Within the range of the symmetry, deg.
    pub(crate) degrees: Vec<f64>,
    /// For each of the whole circle, the one within the range that equals it.
    pub(crate) of_circle: Vec<usize>,
}

impl Planes {
    /// Those of a table with so many segments over the circle.
    pub(crate) fn of(symmetry: PlaneSymmetry, segments: usize) -> Self {
        let count = match symmetry {
            PlaneSymmetry::Rotational => 1,
            PlaneSymmetry::None
            | PlaneSymmetry::Quadrants
            | PlaneSymmetry::AboutC0
            | PlaneSymmetry::AboutC90 => segments,
        };
        let folded = |place: usize| symmetry.folded(360.0 * place as f64 / count as f64);
        let mut degrees: Vec<f64> = (0..count).map(folded).collect();
        degrees.sort_by(f64::total_cmp);
        degrees.dedup_by(|a, b| (*a - *b).abs() < SAME_PLANE);
        let find = |plane: f64| degrees.partition_point(|own| *own < plane - SAME_PLANE);
        let of_circle = (0..count).map(|place| find(folded(place))).collect();
        Self { degrees, of_circle }
    }
}

/// The mean over a cell of what is linear between two nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NodeShares {
    pub(crate) nodes: [usize; 2],
    pub(crate) shares: [f64; 2],
    /// Weight of the cell in the fit.
    pub(crate) weight: f64,
}

impl NodeShares {
    /// Whether it has the same shares of the same nodes.
    fn is_equal(&self, other: &Self) -> bool {
        let share_of = |of: &Self, node: usize| -> f64 {
            of.nodes.iter().zip(of.shares).filter(|(own, _)| **own == node).map(|own| own.1).sum()
        };
        let nodes = self.nodes.iter().chain(&other.nodes);
        nodes.copied().all(|node| (share_of(self, node) - share_of(other, node)).abs() < SAME_SHARE)
    }

    /// The nodes of a cell, [other, own], and their shares.
    pub(crate) fn pairs(&self, other: &Self) -> impl Iterator<Item = ([usize; 2], f64)> {
        let places = [(0, 0), (0, 1), (1, 0), (1, 1)];
        let (own, across) = (*self, *other);
        places.into_iter().map(move |(along, over)| {
            ([across.nodes[over], own.nodes[along]], own.shares[along] * across.shares[over])
        })
    }
}

/// The mean over a ring of a table with so many segments in γ.
pub(crate) fn ring_mean(ring: usize, rings: usize, segments: usize) -> NodeShares {
    let per_segment = rings / segments;
    let edges = ring_edges(ring, rings);
    let solid_angle = linear_over_ring(edges, [1.0; 2]);
    let place = ring % per_segment;
    let ends = [place, place + 1].map(|edge| edge as f64 / per_segment as f64);
    let next = linear_over_ring(edges, ends) / solid_angle;
    let segment = ring / per_segment;
    NodeShares { nodes: [segment, segment + 1], shares: [1.0 - next, next], weight: solid_angle }
}

/// The mean over a sector, with planes over the whole circle.
pub(crate) fn sector_mean(sector: usize, sectors: usize, planes: usize) -> NodeShares {
    let per_segment = sectors / planes;
    let next = ((sector % per_segment) as f64 + 0.5) / per_segment as f64;
    let segment = sector / per_segment;
    let nodes = [segment, (segment + 1) % planes];
    NodeShares { nodes, shares: [1.0 - next, next], weight: 1.0 }
}

/// All cells, and the nodes of a table that is linear between them.
pub(crate) struct NodeGrid {
    /// For each ring, its nodes in γ.
    pub(crate) of_ring: Vec<NodeShares>,
    /// For each sector, its planes within the range of the symmetry.
    pub(crate) of_sector: Vec<NodeShares>,
    /// Planes by angles.
    pub(crate) shape: (usize, usize),
}

impl NodeGrid {
    /// Of so many rings and sectors, and segments in γ.
    pub(crate) fn new([rings, sectors]: [usize; 2], segments: usize, planes: &Planes) -> Self {
        let of_circle = &planes.of_circle;
        let of_sector = |sector: usize| {
            let mean = sector_mean(sector, sectors, of_circle.len());
            NodeShares { nodes: mean.nodes.map(|node| of_circle[node]), ..mean }
        };
        Self {
            of_ring: (0..rings).map(|ring| ring_mean(ring, rings, segments)).collect(),
            of_sector: (0..sectors).map(of_sector).collect(),
            shape: (planes.degrees.len(), segments + 1),
        }
    }

    /// The nodes of a cell, [plane, angle], and their shares.
    pub(crate) fn pairs(
        &self,
        [ring, sector]: [usize; 2],
    ) -> impl Iterator<Item = ([usize; 2], f64)> {
        self.of_ring[ring].pairs(&self.of_sector[sector])
    }

    /// The mean over a cell of a table, planes by angles.
    pub(crate) fn mean(&self, values: &Array2<f64>, cell: [usize; 2]) -> f64 {
        self.pairs(cell).map(|(node, share)| share * values[node]).sum()
    }

    /// The sectors in groups of those that have the same mean in every table.
    pub(crate) fn equal_sectors(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (sector, own) in self.of_sector.iter().enumerate() {
            match groups.iter_mut().find(|group| self.of_sector[group[0]].is_equal(own)) {
                Some(group) => group.push(sector),
                None => groups.push(vec![sector]),
            }
        }
        groups
    }

    /// All cells: ring and sector.
    pub(crate) fn cells(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let sectors = self.of_sector.len();
        (0..self.of_ring.len()).flat_map(move |ring| (0..sectors).map(move |sector| [ring, sector]))
    }

    /// Sums over cells of their solid angles times a factor of each node, planes by angles.
    pub(crate) fn collected<I: Iterator<Item = ([usize; 2], f64)>>(
        &self,
        factors: impl Fn([usize; 2]) -> I,
    ) -> Array2<f64> {
        let mut sums = Array2::zeros(self.shape);
        for cell in self.cells() {
            let weight = self.of_ring[cell[0]].weight;
            for (node, factor) in factors(cell) {
                sums[node] += weight * factor;
            }
        }
        // All planes meet at the poles.
        for pole in [0, self.shape.1 - 1] {
            let sum = sums.column(pole).sum();
            sums.column_mut(pole).fill(sum);
        }
        sums
    }

    /// The same with one factor for all nodes of a cell, by their shares.
    pub(crate) fn shared(&self, factor: impl Fn([usize; 2]) -> f64) -> Array2<f64> {
        self.collected(|cell| {
            let factor = factor(cell);
            self.pairs(cell).map(move |(node, share)| (node, factor * share))
        })
    }
}
