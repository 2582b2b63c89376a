//! From mean intensities over the cells of a sphere of directions to a table of luminous intensities.
//!
//! Of all tables without negative values, this is the one whose interpolation most likely gives the cell means: the maximum of the
//! likelihood of Poisson counts, by expectation maximisation (Shepp & Vardi, IEEE Trans. Med. Imaging 1 (1982) 113). From the means yᵢ over
//! cells of solid angles Ωᵢ, in which nodes have shares aᵢⱼ, the values xⱼ follow by xⱼ ← xⱼ Σᵢ Ωᵢ aᵢⱼ yᵢ / Σₖ aᵢₖ xₖ / Σᵢ Ωᵢ aᵢⱼ. A
//! distribution that is linear between the nodes is recovered from cells without noise; a dark node between bright ones keeps some
//! 0.3 % of their intensity. Every step keeps the flux. Errors are those of a fit by least squares, which is linear in the cells.

use crate::luminaire::error::LuminaireError;
use crate::luminaire::intensities::{Intensities, PlaneSymmetry};
use lumiduct_base::math::{linear_over_ring, solve_rows};
use ndarray::{Array2, ArrayView2};

/// Fewest cells of a segment of the table: with fewer its nodes would not be determined.
const CELLS_PER_SEGMENT: usize = 2;
/// Most segments of a table in either angle: finer than any goniometer, and the time of a fit grows with their third power.
const MOST_SEGMENTS: usize = 720;

/// Mean luminous intensities over the cells of a sphere of directions: rings of equal steps of γ from 0° to 180°, by sectors of
/// equal steps of C from 0° to 360°.
#[derive(Debug, Clone, Copy)]
pub struct CellMeans<'a> {
    /// Rings by sectors, cd.
    pub candela: ArrayView2<'a, f64>,
    /// Standard errors of independent cells, same layout, cd.
    pub std_errors: ArrayView2<'a, f64>,
}

/// The layout of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TableLayout {
    /// Its symmetry: planes that it takes as equal are averaged.
    pub symmetry: PlaneSymmetry,
    /// Segments in γ, from 0° to 180°.
    pub angle_segments: usize,
    /// Segments in C, from 0° to 360°; not used under rotational symmetry.
    pub plane_segments: usize,
}

impl TableLayout {
    /// The layout with the smallest steps for so many rings and sectors, without symmetry if there are sectors.
    pub fn finest([rings, sectors]: [usize; 2]) -> Self {
        let segments = |cells: usize| {
            let per_segment = (CELLS_PER_SEGMENT..=cells).find(|own| cells.is_multiple_of(*own));
            per_segment.map_or(1, |own| cells / own)
        };
        let symmetry = if sectors == 1 { PlaneSymmetry::Rotational } else { PlaneSymmetry::None };
        let [angle_segments, plane_segments] = [rings, sectors].map(segments);
        Self { symmetry, angle_segments, plane_segments }
    }

    /// Whether this many rings and sectors make such a table.
    ///
    /// # Errors
    ///
    /// [`LuminaireError::NoDistribution`] if a step of the table has no whole number of cells or fewer than
    /// two, or if the symmetry has no planes at the ends of its range.
    pub fn expect_cells(&self, [rings, sectors]: [usize; 2]) -> Result<(), LuminaireError> {
        let &Self { symmetry, angle_segments, plane_segments } = self;
        expect_segments(rings, angle_segments, "γ")?;
        if symmetry == PlaneSymmetry::Rotational {
            return Ok(());
        }
        expect_segments(sectors, plane_segments, "C")?;
        let divisor = match symmetry {
            PlaneSymmetry::Rotational | PlaneSymmetry::None => 1,
            PlaneSymmetry::AboutC0 => 2,
            PlaneSymmetry::AboutC90 | PlaneSymmetry::Quadrants => 4,
        };
        if !plane_segments.is_multiple_of(divisor) {
            let problem = format!(
                "{plane_segments} planes over 360 deg; the symmetry ({}) needs a multiple of {divisor}",
                symmetry.name()
            );
            return Err(LuminaireError::NoDistribution(problem));
        }
        Ok(())
    }
}

/// A table with the errors of its values.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedIntensities {
    /// The table. It has the flux of the cells, apart from that of negative ones.
    pub intensities: Intensities,
    /// Standard errors of its values, planes by angles, cd.
    pub std_errors: Array2<f64>,
    /// Flux of the table above that of the cells, because negative cell means are taken as zero, as a share of the latter, 1.
    pub added_share: f64,
}

/// Fits a table to cell means.
///
/// # Errors
///
/// As [`TableLayout::expect_cells`]; [`LuminaireError::NoDistribution`] if a value is not finite.
pub fn fit(
    means: &CellMeans<'_>,
    layout: &TableLayout,
) -> Result<FittedIntensities, LuminaireError> {
    let (rings, sectors) = means.candela.dim();
    layout.expect_cells([rings, sectors])?;
    if let Some(value) = means.candela.iter().find(|value| !value.is_finite()) {
        return Err(LuminaireError::NoDistribution(format!("a cell has {value} cd")));
    }
    let step = 180.0 / layout.angle_segments as f64;
    let angles_deg = (0..=layout.angle_segments).map(|place| step * place as f64).collect();
    let planes = Planes::of(layout);
    let values = most_likely(means, layout, &planes);
    let candela = values.into_iter().collect();
    let intensities =
        Intensities::new(layout.symmetry, planes.degrees.clone(), angles_deg, candela)?;
    let flux = flux_of(means);
    let added = intensities.flux() - flux;
    Ok(FittedIntensities {
        std_errors: std_errors(means, layout, &planes)?,
        intensities,
        added_share: if flux > 0.0 { added / flux } else { 0.0 },
    })
}

/// Flux of the cells, lm.
fn flux_of(means: &CellMeans<'_>) -> f64 {
    let (rings, sectors) = means.candela.dim();
    let rows = means.candela.rows().into_iter().enumerate();
    let flux = |(ring, row): (usize, ndarray::ArrayView1<'_, f64>)| {
        row.sum() * std::f64::consts::TAU / sectors as f64
            * linear_over_ring(ring_edges(ring, rings), [1.0; 2])
    };
    rows.map(flux).sum()
}

/// Edges of a ring, rad.
pub(crate) fn ring_edges(ring: usize, rings: usize) -> [f64; 2] {
    [ring, ring + 1].map(|edge| std::f64::consts::PI * edge as f64 / rings as f64)
}

/// The planes of a table.
struct Planes {
    /// Within the range of the symmetry, deg.
    degrees: Vec<f64>,
    /// For each of the whole circle, the one within the range that equals it.
    of_circle: Vec<usize>,
}

impl Planes {
    fn of(layout: &TableLayout) -> Self {
        let count = match layout.symmetry {
            PlaneSymmetry::Rotational => 1,
            PlaneSymmetry::None
            | PlaneSymmetry::Quadrants
            | PlaneSymmetry::AboutC0
            | PlaneSymmetry::AboutC90 => layout.plane_segments,
        };
        let folded = |place: usize| layout.symmetry.folded(360.0 * place as f64 / count as f64);
        let mut degrees: Vec<f64> = (0..count).map(folded).collect();
        degrees.sort_by(f64::total_cmp);
        degrees.dedup_by(|a, b| (*a - *b).abs() < SAME_PLANE);
        let find = |plane: f64| degrees.partition_point(|own| *own < plane - SAME_PLANE);
        let of_circle = (0..count).map(|place| find(folded(place))).collect();
        Self { degrees, of_circle }
    }
}

/// Planes closer than this are the same, deg.
const SAME_PLANE: f64 = 1e-9;
/// Steps of the maximisation. The slowest deviation alternates in both angles: with two cells a segment it loses 1/16 in each step.
const STEPS: usize = 200;
/// Share of the peak below which a value is zero, 1.
const ROUNDING: f64 = 1e-9;

/// The most likely values, planes by angles.
fn most_likely(means: &CellMeans<'_>, layout: &TableLayout, planes: &Planes) -> Array2<f64> {
    let (rings, sectors) = means.candela.dim();
    let of_ring: Vec<NodeShares> = (0..rings).map(|ring| ring_mean(ring, rings, layout)).collect();
    let of_sector: Vec<NodeShares> = (0..sectors)
        .map(|sector| {
            let mean = sector_mean(sector, sectors, planes.of_circle.len());
            NodeShares { nodes: mean.nodes.map(|node| planes.of_circle[node]), ..mean }
        })
        .collect();
    let shape = (planes.degrees.len(), layout.angle_segments + 1);
    // Sums over cells of their solid angles times a factor of each, by the shares of the nodes.
    let collected = |factor: &dyn Fn(usize, usize) -> f64| {
        let mut sums = Array2::zeros(shape);
        for (ring, along) in of_ring.iter().enumerate() {
            for (sector, across) in of_sector.iter().enumerate() {
                let weight = along.weight * factor(ring, sector);
                for ((angle, plane), share) in along.pairs(across) {
                    sums[[plane, angle]] += weight * share;
                }
            }
        }
        // All planes meet at the poles.
        for pole in [0, layout.angle_segments] {
            let sum = sums.column(pole).sum();
            sums.column_mut(pole).fill(sum);
        }
        sums
    };
    let solid_angles = collected(&|_, _| 1.0);
    let mean = |ring: usize, sector: usize| means.candela[[ring, sector]].max(0.0);
    let mut values = collected(&mean) / &solid_angles;
    for _ in 0..STEPS {
        let ratio = |ring: usize, sector: usize| {
            let pairs = of_ring[ring].pairs(&of_sector[sector]);
            let own: f64 =
                pairs.map(|((angle, plane), share)| share * values[[plane, angle]]).sum();
            if own > 0.0 { mean(ring, sector) / own } else { 0.0 }
        };
        let factors = collected(&ratio) / &solid_angles;
        values *= &factors;
    }
    // Dark nodes beside bright ones shrink with every step and never reach zero.
    let peak = values.iter().copied().fold(0.0, f64::max);
    values.mapv_inplace(|value| if value < ROUNDING * peak { 0.0 } else { value });
    values
}

/// Standard errors of the values by least squares, planes by angles.
fn std_errors(
    means: &CellMeans<'_>,
    layout: &TableLayout,
    planes: &Planes,
) -> Result<Array2<f64>, LuminaireError> {
    let (rings, sectors) = means.candela.dim();
    let shape = (planes.degrees.len(), layout.angle_segments + 1);
    // An unknown error would make all of them not a number.
    if !means.std_errors.iter().all(|error| error.is_finite()) {
        return Ok(Array2::from_elem(shape, f64::INFINITY));
    }
    let along = weights(shape.1, rings, |ring| ring_mean(ring, rings, layout))?;
    let circle = planes.of_circle.len();
    let of_circle = weights(circle, sectors, |sector| sector_mean(sector, sectors, circle))?;
    let mut across = Array2::zeros((shape.0, sectors));
    for plane in 0..shape.0 {
        let equal: Vec<usize> =
            (0..circle).filter(|place| planes.of_circle[*place] == plane).collect();
        for place in &equal {
            across.row_mut(plane).scaled_add(1.0 / equal.len() as f64, &of_circle.row(*place));
        }
    }
    let squared = |all: &Array2<f64>| all.mapv(|own| own * own);
    let by_angle = squared(&along).dot(&means.std_errors.mapv(|error| error * error));
    let mut variances = squared(&across).dot(&by_angle.t());
    // At the poles all sectors count alike.
    for pole in [0, layout.angle_segments] {
        let mean = by_angle.row(pole).sum() / (sectors * sectors) as f64;
        variances.column_mut(pole).fill(mean);
    }
    Ok(variances.mapv(f64::sqrt))
}

/// The mean over a ring.
fn ring_mean(ring: usize, rings: usize, layout: &TableLayout) -> NodeShares {
    let per_segment = rings / layout.angle_segments;
    let edges = ring_edges(ring, rings);
    let solid_angle = linear_over_ring(edges, [1.0; 2]);
    let place = ring % per_segment;
    let ends = [place, place + 1].map(|edge| edge as f64 / per_segment as f64);
    let next = linear_over_ring(edges, ends) / solid_angle;
    let segment = ring / per_segment;
    NodeShares { nodes: [segment, segment + 1], shares: [1.0 - next, next], weight: solid_angle }
}

/// The mean over a sector, with planes over the whole circle.
fn sector_mean(sector: usize, sectors: usize, planes: usize) -> NodeShares {
    let per_segment = sectors / planes;
    let next = ((sector % per_segment) as f64 + 0.5) / per_segment as f64;
    let segment = sector / per_segment;
    let nodes = [segment, (segment + 1) % planes];
    NodeShares { nodes, shares: [1.0 - next, next], weight: 1.0 }
}

fn expect_segments(cells: usize, segments: usize, what: &str) -> Result<(), LuminaireError> {
    if segments > MOST_SEGMENTS {
        let problem = format!("{segments} steps in {what}, expected at most {MOST_SEGMENTS}");
        return Err(LuminaireError::NoDistribution(problem));
    }
    if segments == 0 || !cells.is_multiple_of(segments) || cells / segments < CELLS_PER_SEGMENT {
        let problem = format!(
            "{segments} steps in {what} from {cells} cells; each step needs a whole number of cells, at least {CELLS_PER_SEGMENT}"
        );
        return Err(LuminaireError::NoDistribution(problem));
    }
    Ok(())
}

/// The mean over a cell of what is linear between two nodes.
#[derive(Debug, Clone, Copy)]
struct NodeShares {
    nodes: [usize; 2],
    shares: [f64; 2],
    /// Weight of the cell in the fit.
    weight: f64,
}

impl NodeShares {
    /// The nodes of a cell, (own, other), and their shares.
    fn pairs(&self, other: &Self) -> impl Iterator<Item = ((usize, usize), f64)> {
        let places = [(0, 0), (0, 1), (1, 0), (1, 1)];
        let (own, across) = (*self, *other);
        places.into_iter().map(move |(along, over)| {
            ((own.nodes[along], across.nodes[over]), own.shares[along] * across.shares[over])
        })
    }
}

/// Weights of cells in the values at nodes, nodes by cells: (A W Aᵀ)⁻¹ A W, where A has the shares of the nodes in the cells.
fn weights(
    nodes: usize,
    cells: usize,
    mean: impl Fn(usize) -> NodeShares,
) -> Result<Array2<f64>, LuminaireError> {
    let mut rows = vec![vec![0.0; nodes + cells]; nodes];
    for cell in 0..cells {
        let NodeShares { nodes: ends, shares, weight } = mean(cell);
        for (own, share) in ends.into_iter().zip(shares) {
            rows[own][nodes + cell] += share * weight;
            for (other, further) in ends.into_iter().zip(shares) {
                rows[own][other] += share * further * weight;
            }
        }
    }
    let undetermined =
        || LuminaireError::NoDistribution("the cells do not determine the table".to_owned());
    solve_rows(&mut rows, 0.0).ok_or_else(undetermined)?;
    Ok(Array2::from_shape_fn((nodes, cells), |(node, cell)| rows[node][nodes + cell]))
}

#[cfg(test)]
mod tests;
