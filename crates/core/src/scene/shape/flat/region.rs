//! The part of a plane that a flat surface covers.

use crate::scene::shape::ChartRect;
use crate::scene::shape::flat::polygon::Polygon;
use crate::scene::shape::wedge::Wedge;
use glam::DVec2;
use lumiduct_base::math::planar::disk_overlap;
use lumiduct_base::math::{circle, disk, planar};
use std::f64::consts::{PI, TAU};

/// A part of a plane, lengths in mm.
#[derive(Debug, Clone, PartialEq)]
#[repr(u8)]
pub enum Region {
    /// Between two radii; a disk when `inner` is 0.
    Annulus {
        /// Inner radius, mm.
        inner: f64,
        /// Outer radius, mm.
        outer: f64,
    },
    /// The part of an annulus within a wedge of azimuths; see `Region::sector`.
    Sector {
        /// Inner radius, mm.
        inner: f64,
        /// Outer radius, mm.
        outer: f64,
        /// The azimuths.
        wedge: Wedge,
    },
    /// An ellipse about the origin.
    Ellipse {
        /// Half axis along x, mm.
        half_x: f64,
        /// Half axis along y, mm.
        half_y: f64,
    },
    /// A rectangle about the origin.
    Rectangle {
        /// Half the size along x, mm.
        half_x: f64,
        /// Half the size along y, mm.
        half_y: f64,
    },
    /// A simple polygon, not necessarily around the origin.
    Polygon(Polygon),
    /// A region with a hole in it.
    Holed(Box<Holed>),
}

/// A region with a hole, which lies within its outline.
#[derive(Debug, Clone, PartialEq)]
pub struct Holed {
    outline: Region,
    hole: Region,
}

impl Holed {
    /// The region without its hole.
    pub(crate) fn outline(&self) -> &Region {
        &self.outline
    }

    /// The hole.
    pub(crate) fn hole(&self) -> &Region {
        &self.hole
    }
}

impl Region {
    /// Corners of the outer outline, counter-clockwise; `round` corners for a whole turn.
    pub(crate) fn rim(&self, round: usize) -> Vec<DVec2> {
        let turn = |part: usize, angle: f64| circle(angle / TAU * part as f64 / round as f64);
        match self {
            Self::Annulus { outer, .. } => (0..round).map(|i| *outer * turn(i, TAU)).collect(),
            Self::Sector { outer, inner, wedge } => {
                let arc = |radius: f64| (0..=round).map(move |i| radius * turn(i, wedge.angle()));
                arc(*outer).chain(arc(*inner).rev()).collect()
            }
            Self::Ellipse { half_x, half_y } => {
                let half = DVec2::new(*half_x, *half_y);
                (0..round).map(|i| half * turn(i, TAU)).collect()
            }
            Self::Rectangle { half_x, half_y } => {
                let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
                corners.map(|(x, y)| DVec2::new(x * half_x, y * half_y)).to_vec()
            }
            Self::Polygon(polygon) => polygon.vertices().to_vec(),
            Self::Holed(holed) => holed.outline.rim(round),
        }
    }

    /// A region without a hole that lies within it.
    pub fn holed(outline: Self, hole: Self) -> Self {
        Self::Holed(Box::new(Holed { outline, hole }))
    }

    /// The annulus between two radii from +x counter-clockwise to `angle`, rad; the whole annulus
    /// from a full turn on.
    pub(crate) fn sector(inner: f64, outer: f64, angle: f64) -> Self {
        match Wedge::new(angle) {
            Some(wedge) => Self::Sector { inner, outer, wedge },
            None => Self::Annulus { inner, outer },
        }
    }

    /// A simple polygon with at least three counter-clockwise vertices, mm.
    pub(crate) fn polygon(vertices: Vec<DVec2>) -> Self {
        Self::Polygon(Polygon::new(vertices))
    }

    #[inline(always)]
    pub(in crate::scene) fn contains(&self, p: DVec2) -> bool {
        match self {
            Self::Annulus { inner, outer } => {
                let r2 = p.length_squared();
                r2 <= outer * outer && r2 >= inner * inner
            }
            Self::Rectangle { half_x, half_y } => p.x.abs() <= *half_x && p.y.abs() <= *half_y,
            Self::Sector { .. } | Self::Ellipse { .. } | Self::Polygon(_) | Self::Holed(_) => {
                self.contains_out_of_line(p)
            }
        }
    }

    #[inline(never)]
    fn contains_out_of_line(&self, p: DVec2) -> bool {
        let within = |inner: f64, outer: f64| {
            let r2 = p.length_squared();
            r2 <= outer * outer && r2 >= inner * inner
        };
        match self {
            Self::Annulus { inner, outer } => within(*inner, *outer),
            Self::Sector { inner, outer, wedge } => within(*inner, *outer) && wedge.contains(p),
            Self::Ellipse { half_x, half_y } => {
                let (x, y) = (p.x / half_x, p.y / half_y);
                x * x + y * y <= 1.0
            }
            Self::Rectangle { half_x, half_y } => p.x.abs() <= *half_x && p.y.abs() <= *half_y,
            Self::Polygon(polygon) => polygon.contains(p),
            Self::Holed(holed) => holed.outline.contains(p) && !holed.hole.contains(p),
        }
    }

    pub(in crate::scene) fn bounds(&self) -> ChartRect {
        let half = match self {
            Self::Annulus { outer, .. } => DVec2::splat(*outer),
            Self::Sector { inner, outer, wedge } => return sector_bounds(*inner, *outer, wedge),
            Self::Ellipse { half_x, half_y } | Self::Rectangle { half_x, half_y } => {
                DVec2::new(*half_x, *half_y)
            }
            Self::Polygon(polygon) => return polygon.bounds(),
            Self::Holed(holed) => return holed.outline.bounds(),
        };
        ChartRect { min: -half, max: half }
    }

    /// The largest p · e over its points, mm; for a sector, that of the whole disk.
    pub(super) fn reach(&self, e: DVec2) -> f64 {
        match self {
            Self::Annulus { outer, .. } | Self::Sector { outer, .. } => outer * e.length(),
            Self::Ellipse { half_x, half_y } => (e * DVec2::new(*half_x, *half_y)).length(),
            Self::Rectangle { half_x, half_y } => half_x * e.x.abs() + half_y * e.y.abs(),
            Self::Polygon(polygon) => {
                polygon.vertices().iter().map(|p| p.dot(e)).fold(f64::NEG_INFINITY, f64::max)
            }
            Self::Holed(holed) => holed.outline.reach(e),
        }
    }

    pub(super) fn area(&self) -> f64 {
        match self {
            Self::Annulus { inner, outer } => PI * (outer * outer - inner * inner),
            Self::Sector { inner, outer, wedge } => {
                0.5 * wedge.angle() * (outer * outer - inner * inner)
            }
            Self::Ellipse { half_x, half_y } => PI * half_x * half_y,
            Self::Rectangle { half_x, half_y } => 4.0 * half_x * half_y,
            Self::Polygon(polygon) => polygon.area(),
            Self::Holed(holed) => holed.outline.area() - holed.hole.area(),
        }
    }

    #[inline]
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec2 {
        // Uniform in r² between two radii.
        let radius = |inner: f64, outer: f64| {
            (inner * inner + u[0] * (outer * outer - inner * inner)).sqrt()
        };
        match self {
            Self::Annulus { inner, outer } => radius(*inner, *outer) * circle(u[1]),
            Self::Sector { inner, outer, wedge } => {
                radius(*inner, *outer) * DVec2::from_angle(u[1] * wedge.angle())
            }
            Self::Ellipse { half_x, half_y } => disk(u).truncate() * DVec2::new(*half_x, *half_y),
            Self::Rectangle { half_x, half_y } => {
                DVec2::new((2.0 * u[0] - 1.0) * half_x, (2.0 * u[1] - 1.0) * half_y)
            }
            Self::Polygon(polygon) => polygon.sample(u),
            Self::Holed(_) => self.sample_by_area(u),
        }
    }

    pub(in crate::scene) fn area_in(&self, rect: ChartRect) -> f64 {
        let rect = rect.intersection(&self.bounds());
        if rect.is_empty() {
            return 0.0;
        }
        let corners = rect.corners();
        match self {
            Self::Annulus { inner, outer } => {
                disk_overlap(*outer, &corners) - disk_overlap(*inner, &corners)
            }
            Self::Sector { inner, outer, wedge } => {
                sector_overlap(*outer, wedge, &corners) - sector_overlap(*inner, wedge, &corners)
            }
            Self::Ellipse { half_x, half_y } => {
                let half = DVec2::new(*half_x, *half_y);
                half_x * half_y * disk_overlap(1.0, &corners.map(|corner| corner / half))
            }
            Self::Rectangle { .. } => rect.area(),
            Self::Polygon(polygon) => polygon.area_in(rect),
            Self::Holed(holed) => holed.outline.area_in(rect) - holed.hole.area_in(rect),
        }
    }

    /// The point below which a share u of the area lies: to the left, and in a narrow strip
    /// beneath. Slow; for regions that have no other method.
    fn sample_by_area(&self, u: [f64; 2]) -> DVec2 {
        let ChartRect { min, max } = self.bounds();
        let left_of = |x: f64| self.area_in(ChartRect { min, max: DVec2::new(x, max.y) });
        let x = halve(min.x, max.x, u[0] * self.area(), left_of);
        let strip = STRIP * (max.x - min.x);
        let (from, to) = (DVec2::new(x - strip, min.y), x + strip);
        let below = |y: f64| self.area_in(ChartRect { min: from, max: DVec2::new(to, y) });
        DVec2::new(x, halve(min.y, max.y, u[1] * below(max.y), below))
    }
}

/// Half the width of a strip whose area is treated as a length, as a share of the whole.
const STRIP: f64 = 1e-6;

/// Where an increasing function reaches a value, to the last digits.
fn halve(mut low: f64, mut high: f64, value: f64, of: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..f64::MANTISSA_DIGITS {
        let middle = 0.5 * (low + high);
        if of(middle) < value { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

fn sector_bounds(inner: f64, outer: f64, wedge: &Wedge) -> ChartRect {
    let (x, y) = (wedge.range(DVec2::X), wedge.range(DVec2::Y));
    let [near, far] = [inner, outer]
        .map(|radius| (radius * DVec2::new(x[0], y[0]), radius * DVec2::new(x[1], y[1])));
    ChartRect { min: near.0.min(far.0), max: near.1.max(far.1) }
}

/// Area that a convex polygon shares with the part of a disk within a wedge, mm².
fn sector_overlap(radius: f64, wedge: &Wedge, polygon: &[DVec2]) -> f64 {
    // Points with an azimuth up to `angle`, which is at most half a turn.
    let narrow = |polygon: &[DVec2], angle: f64| {
        let end = DVec2::from_angle(angle);
        let above_start = planar::clip(polygon, DVec2::NEG_Y, 0.0);
        disk_overlap(radius, &planar::clip(&above_start, end.perp(), 0.0))
    };
    if wedge.angle() <= PI {
        return narrow(polygon, wedge.angle());
    }
    // The upper half plane, and the rest of the wedge rotated by half a turn.
    let turned: Vec<DVec2> = polygon.iter().map(|p| -*p).collect();
    narrow(polygon, PI) + narrow(&turned, wedge.angle() - PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn regions() -> Vec<(Region, f64)> {
        let notched = [(0.0, 0.0), (2.0, -1.0), (2.5, 2.0), (1.0, 0.5), (-1.0, 2.0)];
        let mut regions = vec![
            (Region::Annulus { inner: 1.0, outer: 2.0 }, 3.0 * PI),
            (Region::Ellipse { half_x: 2.4, half_y: 0.7 }, PI * 2.4 * 0.7),
            (Region::Rectangle { half_x: 1.0, half_y: 2.0 }, 8.0),
            (Region::polygon(notched.map(DVec2::from).to_vec()), 4.125),
            (
                Region::holed(
                    Region::Rectangle { half_x: 2.0, half_y: 1.5 },
                    Region::Annulus { inner: 0.0, outer: 1.1 },
                ),
                12.0 - PI * 1.21,
            ),
        ];
        for angle in [0.4, 1.5, PI, 3.5, 5.0, TAU] {
            regions.push((Region::sector(0.8, 2.2, angle), 0.5 * angle * (2.2f64.powi(2) - 0.64)));
        }
        regions
    }

    #[test]
    fn cells_add_up_to_the_area_and_agree_with_a_count_of_points() {
        let (n, fine) = (7u32, 60u32);
        let edge = |i: u32| -2.6 + 5.2 * f64::from(i) / f64::from(n);
        for (region, area) in regions() {
            assert!((region.area() - area).abs() < 1e-13, "{region:?}");
            let mut sum = 0.0;
            for cell in 0..n * n {
                let (i, j) = (cell / n, cell % n);
                let rect = ChartRect {
                    min: DVec2::new(edge(i), edge(j)),
                    max: DVec2::new(edge(i + 1), edge(j + 1)),
                };
                let part = region.area_in(rect);
                let inside = (0..fine * fine)
                    .filter(|k| {
                        let u = DVec2::new(f64::from(k / fine) + 0.5, f64::from(k % fine) + 0.5);
                        region.contains(rect.min + u / f64::from(fine) * (rect.max - rect.min))
                    })
                    .count();
                let counted = rect.area() * inside as f64 / f64::from(fine * fine);
                assert!((part - counted).abs() < 0.02 * rect.area(), "{region:?} {rect:?} {part}");
                sum += part;
            }
            assert!((sum - area).abs() < 1e-12, "{region:?} {sum}");
        }
    }

    #[test]
    fn samples_lie_inside_and_their_cells_have_the_share_of_their_area() {
        for (region, area) in regions() {
            let (n, bounds) = (40_000u32, region.bounds());
            let middle = 0.5 * (bounds.min + bounds.max);
            let quarter = ChartRect { min: bounds.min, max: middle };
            let mut inside = 0u32;
            for i in 0..n {
                let u = [
                    (f64::from(i) + 0.5) / f64::from(n),
                    (f64::from(i) * 0.618_033_988_749_894_9).fract(),
                ];
                let p = region.sample(u);
                assert!(region.contains(p * (1.0 - 1e-12)) || region.contains(p * (1.0 + 1e-12)));
                inside += u32::from(p.cmple(middle).all());
            }
            let share = region.area_in(quarter) / area;
            let found = f64::from(inside) / f64::from(n);
            assert!((found - share).abs() < 2e-3, "{region:?}: {found}, {share}");
        }
    }
}
