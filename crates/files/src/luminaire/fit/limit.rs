//! A table without overshoot beside edges of the light.
//!
//! A table cannot hold an edge between its angles, and the most likely one overshoots about it. It differs from the smoothest table, in
//! which every cell spreads its flux over its nodes by their shares, in that cells spread it otherwise. Of these differences each
//! cell keeps the share that leaves all nodes within limits (Zalesak, J. Comput. Phys. 31 (1979) 335, for cells by Löhner et al.,
//! Int. J. Numer. Methods Fluids 7 (1987) 1093), where nodes would otherwise be beyond them. So no flux is lost. A value may go
//! beyond the cells around it as far as all sides support it, so that what is linear between the nodes keeps its peaks; all of them
//! count with two standard errors.

use crate::luminaire::fit::nodes::{NodeGrid, NodeShares, Planes};
use ndarray::{Array2, ArrayView2};

/// Standard errors of the cells that limits contain.
const SIGMAS: f64 = 2.0;

/// Cells in one angle, with weights in a value.
type Weighted = Vec<(usize, f64)>;

/// The cells on one side of a node, in one angle.
struct NodeSide {
    /// The nearest one.
    nearest: Weighted,
    /// The two nearest, for what is linear up to the node.
    extrapolated: Weighted,
}

/// Means over cells, and the nodes of a table of them.
#[derive(Clone, Copy)]
pub(crate) struct CellsOfTable<'a> {
    /// Means, rings by sectors, cd.
    pub(crate) candela: &'a Array2<f64>,
    /// Their standard errors, cd.
    pub(crate) std_errors: ArrayView2<'a, f64>,
    pub(crate) grid: &'a NodeGrid,
    pub(crate) planes: &'a Planes,
}

/// What is nearest to the most likely values within the limits, from the smoothest ones; planes by angles. Each node has the
/// solid angle of its shares of all cells.
pub(crate) fn limited(
    likely: &Array2<f64>,
    smoothest: Array2<f64>,
    solid_angles: &Array2<f64>,
    cells: CellsOfTable<'_>,
) -> Array2<f64> {
    let CellsOfTable { candela, grid, .. } = cells;
    let [least, most] = limits(cells);
    // Flux over the solid angle of the cell that a cell moves to each of its nodes.
    let moved = |cell: [usize; 2]| {
        let own = grid.mean(likely, cell);
        let held = candela[cell];
        grid.pairs(cell).map(move |(node, share)| {
            let to = if own > 0.0 { share * likely[node] / own } else { share };
            (node, held * (to - share))
        })
    };
    let sums = |sign: f64| {
        grid.collected(|cell| moved(cell).map(move |(node, own)| (node, (sign * own).max(0.0))))
            / solid_angles
    };
    // What a node can have of all that is added to it, and of all that is taken, 1.
    let [mut added, mut taken] = [1.0, 1.0].map(|room| Array2::from_elem(grid.shape, room));
    let [to_add, to_take] = [sums(1.0), sums(-1.0)];
    loop {
        let kept = |cell: [usize; 2]| {
            let room = moved(cell).map(|(node, own)| {
                if own == 0.0 { 1.0 } else { (if own > 0.0 { &added } else { &taken })[node] }
            });
            room.fold(1.0, f64::min)
        };
        let changes = grid.collected(|cell| {
            let kept = kept(cell);
            moved(cell).map(move |(node, own)| (node, kept * own))
        });
        let values = &smoothest + changes / solid_angles;
        // Whatever the other nodes keep, these shares hold a limit.
        let above = hold(&values - &most, &mut added, &(&most - &smoothest), &to_add);
        let below = hold(&least - &values, &mut taken, &(&smoothest - &least), &to_take);
        if !above && !below {
            return values;
        }
    }
}

/// Where a node exceeds its limit, reduces the share of its changes that it keeps, so that the limit holds. Returns whether any share
/// was reduced.
fn hold(
    excess: Array2<f64>,
    room: &mut Array2<f64>,
    left: &Array2<f64>,
    wanted: &Array2<f64>,
) -> bool {
    let mut is_held = false;
    for (node, excess) in excess.indexed_iter() {
        let share = (left[node].max(0.0) / wanted[node]).min(1.0);
        if *excess > 0.0 && share < room[node] {
            room[node] = share;
            is_held = true;
        }
    }
    is_held
}

/// The least and the largest values that the cells around each node support, planes by angles.
fn limits(cells: CellsOfTable<'_>) -> [Array2<f64>; 2] {
    let CellsOfTable { candela, std_errors, grid, planes } = cells;
    let sectors = candela.ncols();
    let last = grid.shape.1 - 1;
    let circle = planes.of_circle.len();
    let [mut least, mut most] =
        [f64::INFINITY, 0.0].map(|value| Array2::from_elem(grid.shape, value));
    for (place, plane) in planes.of_circle.iter().enumerate() {
        for angle in 0..=last {
            let along = in_range(angle, &grid.of_ring, last);
            let is_pole = angle == 0 || angle == last;
            let across = if is_pole || circle == 1 {
                vec![whole_circle(sectors)]
            } else {
                on_circle(place, &grid.of_sector, circle)
            };
            // What a weighted sum may be, less and plus its noise.
            let range = |rings: &Weighted, sectors: &Weighted| -> [f64; 2] {
                let pairs =
                    rings.iter().flat_map(|ring| sectors.iter().map(move |own| (ring, own)));
                let cells = pairs.map(|(ring, own)| ([ring.0, own.0], ring.1 * own.1));
                let sums = cells.fold([0.0, 0.0], |[value, variance], (cell, weight): (_, f64)| {
                    [value + weight * candela[cell], variance + (weight * std_errors[cell]).powi(2)]
                });
                let noise = SIGMAS * sums[1].sqrt();
                [sums[0] - noise, sums[0] + noise]
            };
            let pairs = || along.iter().flat_map(|ring| across.iter().map(move |own| (ring, own)));
            let nearest = pairs().map(|(ring, own)| range(&ring.nearest, &own.nearest));
            let around = nearest.fold([f64::INFINITY, 0.0], |all: [f64; 2], own| {
                [all[0].min(own[0]), all[1].max(own[1])]
            });
            let beyond = pairs().map(|(ring, own)| range(&ring.extrapolated, &own.extrapolated));
            // All sides support no more than the least of their values, and no less than the largest.
            let supported = beyond
                .fold([f64::NEG_INFINITY, f64::INFINITY], |all: [f64; 2], own| {
                    [all[0].max(own[0]), all[1].min(own[1])]
                });
            let [from, to] = [around[0].min(supported[0]), around[1].max(supported[1])];
            let node = [*plane, angle];
            least[node] = f64::min(least[node], from.max(0.0));
            most[node] = f64::max(most[node], to);
        }
    }
    [least, most]
}

/// The mean over all sectors, on all sides.
fn whole_circle(sectors: usize) -> NodeSide {
    let all: Weighted = (0..sectors).map(|sector| (sector, 1.0 / sectors as f64)).collect();
    NodeSide { nearest: all.clone(), extrapolated: all }
}

/// The sides of a node from which nothing goes on beyond the ends.
fn in_range(node: usize, cells: &[NodeShares], segments: usize) -> Vec<NodeSide> {
    let first = node * (cells.len() / segments);
    let before = (node > 0).then(|| side(cells, [first - 1, first - 2], SegmentEnd::End));
    let after = (node < segments).then(|| side(cells, [first, first + 1], SegmentEnd::Start));
    before.into_iter().chain(after).collect()
}

/// Both sides of a node on a circle.
fn on_circle(node: usize, cells: &[NodeShares], segments: usize) -> Vec<NodeSide> {
    let first = node * (cells.len() / segments);
    let end = if node == 0 { cells.len() } else { first };
    vec![
        side(cells, [end - 1, end - 2], SegmentEnd::End),
        side(cells, [first, first + 1], SegmentEnd::Start),
    ]
}

/// Where a node is on its segment.
#[derive(Clone, Copy)]
enum SegmentEnd {
    Start,
    End,
}

/// The two cells of a segment nearest to one of its nodes. Their means are linear in the share of the node, and at a share of 1 they
/// are its value.
fn side(cells: &[NodeShares], [near, next]: [usize; 2], node: SegmentEnd) -> NodeSide {
    let [own, other] = [near, next].map(|cell| cells[cell].shares[node as usize]);
    let further = (1.0 - own) / (own - other);
    NodeSide {
        nearest: vec![(near, 1.0)],
        extrapolated: vec![(near, 1.0 + further), (next, -further)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::luminaire::intensities::PlaneSymmetry;

    fn limits_without_errors(
        candela: &Array2<f64>,
        grid: &NodeGrid,
        planes: &Planes,
    ) -> [Array2<f64>; 2] {
        let errors = Array2::zeros(candela.dim());
        limits(CellsOfTable { candela, std_errors: errors.view(), grid, planes })
    }

    #[test]
    fn linear_distributions_are_at_their_limits() {
        let planes = Planes::of(PlaneSymmetry::None, 4);
        let grid = NodeGrid::new([16, 8], 8, &planes);
        let table = Array2::from_shape_fn((4, 9), |(plane, angle)| match angle {
            0 => 30.0,
            8 => 70.0,
            _ => 50.0 + 20.0 * ((plane * 3 + angle * 5) % 7) as f64,
        });
        let mut cells = Array2::zeros((16, 8));
        grid.cells().for_each(|cell| cells[cell] = grid.mean(&table, cell));
        let [least, most] = limits_without_errors(&cells, &grid, &planes);
        for (node, value) in table.indexed_iter() {
            assert!(least[node] <= value + 1e-9 && most[node] >= value - 1e-9, "{node:?}");
        }
    }

    #[test]
    fn an_edge_supports_nothing_beyond_the_cells_beside_it() {
        let planes = Planes::of(PlaneSymmetry::Rotational, 1);
        let grid = NodeGrid::new([16, 1], 8, &planes);
        for lit in [6, 7] {
            let cells =
                Array2::from_shape_fn((16, 1), |(ring, _)| if ring < lit { 100.0 } else { 0.0 });
            let [least, most] = limits_without_errors(&cells, &grid, &planes);
            let shown = |limit: &Array2<f64>| limit.row(0).to_vec();
            assert!(most.iter().all(|value| *value < 100.0 + 1e-9), "{:?}", shown(&most));
            assert!(shown(&least)[..3].iter().all(|value| *value == 100.0), "{:?}", shown(&least));
            assert!(shown(&most)[5..].iter().all(|value| *value == 0.0), "{:?}", shown(&most));
        }
    }
}
