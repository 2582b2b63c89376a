//! A simple polygon, prepared for many point tests.

use crate::scene::shape::ChartRect;
use glam::DVec2;
use lumiduct_base::math::planar::{clip_to_rectangle, edges, is_convex, signed_area, triangulate};

/// A simple polygon with counter-clockwise vertices, convex or not.
///
/// A point on the border belongs to the side where it would be after a shift by an infinitesimal
/// step along +x and a much smaller one along +y. The side of an edge is computed from the same
/// numbers in the same order for every polygon, so two polygons with a common edge leave no gap and
/// do not overlap, to the last bit.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    vertices: Vec<DVec2>,
    bounds: ChartRect,
    edges: Vec<PolygonEdge>,
    outline: PolygonOutline,
    triangles: Vec<[DVec2; 3]>,
    /// Cumulative areas of the triangles, mm².
    areas: Vec<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PolygonOutline {
    Convex,
    Free,
}

/// An edge from its lower end to its higher one; a horizontal edge points to -x.
#[derive(Debug, Clone, Copy, PartialEq)]
struct PolygonEdge {
    low: DVec2,
    high: DVec2,
    /// Side of the polygon's interior.
    interior: PolygonSide,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum PolygonSide {
    Left,
    Right,
}

impl Polygon {
    /// The polygon of at least three counter-clockwise `vertices`, mm; repeated neighbours are dropped.
    pub(crate) fn new(mut vertices: Vec<DVec2>) -> Self {
        vertices.dedup();
        if vertices.first() == vertices.last() {
            vertices.pop();
        }
        let bounds = ChartRect {
            min: vertices.iter().fold(DVec2::INFINITY, |min, v| min.min(*v)),
            max: vertices.iter().fold(DVec2::NEG_INFINITY, |max, v| max.max(*v)),
        };
        let triangles = triangulate(&vertices);
        let mut sum = 0.0;
        let areas = triangles
            .iter()
            .map(|triangle| {
                sum += signed_area(triangle).max(0.0);
                sum
            })
            .collect();
        let edges = edges(&vertices).map(|(a, b)| PolygonEdge::new(a, b)).collect();
        let outline =
            if is_convex(&vertices) { PolygonOutline::Convex } else { PolygonOutline::Free };
        Self { vertices, bounds, edges, outline, triangles, areas }
    }

    /// The vertices, counter-clockwise.
    pub(crate) fn vertices(&self) -> &[DVec2] {
        &self.vertices
    }

    /// Triangles that fill the polygon.
    pub(crate) fn triangles(&self) -> &[[DVec2; 3]] {
        &self.triangles
    }

    /// Whether the polygon contains a point.
    #[inline]
    pub(crate) fn contains(&self, p: DVec2) -> bool {
        match self.outline {
            PolygonOutline::Convex => self.edges.iter().all(|edge| edge.side(p) == edge.interior),
            PolygonOutline::Free => {
                p.cmpge(self.bounds.min).all()
                    && p.cmple(self.bounds.max).all()
                    && self.edges.iter().filter(|edge| edge.is_right_of(p)).count() % 2 == 1
            }
        }
    }

    /// The smallest rectangle around the polygon, mm.
    pub(crate) fn bounds(&self) -> ChartRect {
        self.bounds
    }

    /// Area, mm².
    pub(crate) fn area(&self) -> f64 {
        signed_area(&self.vertices)
    }

    /// Area within a rectangle, mm².
    pub(crate) fn area_in(&self, rect: ChartRect) -> f64 {
        signed_area(&clip_to_rectangle(&self.vertices, rect.min, rect.max))
    }

    /// A point of the polygon, uniform over its area for uniform `u`.
    pub(crate) fn sample(&self, u: [f64; 2]) -> DVec2 {
        let target = u[0] * self.areas.last().copied().unwrap_or(0.0);
        let i = self.areas.partition_point(|&area| area <= target).min(self.areas.len() - 1);
        let below = if i == 0 { 0.0 } else { self.areas[i - 1] };
        let first = ((target - below) / (self.areas[i] - below)).clamp(0.0, 1.0);
        let [a, b, c] = self.triangles[i];
        // Uniform in the triangle: the share of the height is the square root.
        let height = first.sqrt();
        a + height * (1.0 - u[1]) * (b - a) + height * u[1] * (c - a)
    }
}

impl PolygonEdge {
    fn new(from: DVec2, to: DVec2) -> Self {
        if from.y < to.y || (from.y == to.y && from.x > to.x) {
            Self { low: from, high: to, interior: PolygonSide::Left }
        } else {
            Self { low: to, high: from, interior: PolygonSide::Right }
        }
    }

    #[inline]
    fn side(&self, p: DVec2) -> PolygonSide {
        // On the line itself: right, the side of the shift along +x.
        if (self.high - self.low).perp_dot(p - self.low) > 0.0 {
            PolygonSide::Left
        } else {
            PolygonSide::Right
        }
    }

    /// Whether a ray from `p` along +x crosses the edge.
    #[inline]
    fn is_right_of(&self, p: DVec2) -> bool {
        self.low.y <= p.y && p.y < self.high.y && self.side(p) == PolygonSide::Left
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ell() -> Polygon {
        Polygon::new(
            [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)]
                .map(DVec2::from)
                .to_vec(),
        )
    }

    #[test]
    fn an_l_has_no_points_in_its_notch_and_a_square_is_convex() {
        assert_eq!(ell().outline, PolygonOutline::Free);
        assert!(ell().contains(DVec2::new(0.5, 1.5)) && ell().contains(DVec2::new(1.5, 0.5)));
        assert!(!ell().contains(DVec2::new(1.5, 1.5)) && !ell().contains(DVec2::new(2.5, 0.5)));
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from).to_vec();
        assert_eq!(Polygon::new(square).outline, PolygonOutline::Convex);
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(21), ..ProptestConfig::default() })]

        /// Points on the common edges (as near as f64 allows) and at the vertices belong to exactly one of the pieces
        /// that fill the plane around them.
        #[test]
        fn polygons_with_common_edges_share_no_point_and_miss_none(
            x in proptest::array::uniform5(-1.0..1.0f64), along in 0.0..1.0f64, which in 0..8usize,
        ) {
            let [p, q, r, s] = [(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)].map(DVec2::from);
            let (m, n) = (DVec2::new(x[0], x[1]), DVec2::new(x[2] + 2.1, x[1]));
            // A notch at m and n: the lower piece is not convex, the others fill it.
            let pieces = [vec![p, q, n, m], vec![q, r, n], vec![r, s, m, n], vec![s, p, m]]
                .map(Polygon::new);
            let ends = [(p, m), (q, n), (r, n), (s, m), (m, n), (m, m), (n, n), (n, m)][which];
            let point = ends.0.lerp(ends.1, along);
            let owners = pieces.iter().filter(|piece| piece.contains(point)).count();
            let on_rim = which < 4 && along == 0.0;
            prop_assert!(owners == 1 || on_rim, "{owners} at {point}");
        }

        #[test]
        fn samples_of_an_l_fall_into_cells_by_their_area(cells in 1..6u32) {
            let (shape, n, size) = (ell(), 60_000u32, 2.0 / f64::from(cells));
            let mut counts = vec![0u32; (cells * cells) as usize];
            for i in 0..n {
                // A rank-1 lattice: nearly uniform, and reproducible.
                let u = [(f64::from(i) + 0.5) / f64::from(n), (f64::from(i) * 0.618_033_988_749_894_9).fract()];
                let at = (shape.sample(u) / size).floor().clamp(DVec2::ZERO, DVec2::splat(f64::from(cells - 1)));
                counts[(at.y as u32 * cells + at.x as u32) as usize] += 1;
            }
            for (i, &count) in (0u32..).zip(&counts) {
                let min = DVec2::new(f64::from(i % cells), f64::from(i / cells)) * size;
                let share = shape.area_in(ChartRect { min, max: min + size }) / shape.area();
                prop_assert!((f64::from(count) / f64::from(n) - share).abs() < 2e-3);
            }
        }
    }
}
