//! The cells of a sensor as strata for the starts of gather paths.
//!
//! Strata are drawn equally often, whatever their size, so that the cells at a rim are as well known as others. Where the
//! cells of a surface cannot be drawn from one by one, because it has several pieces or its chart stretches it, or where there
//! are too many, the whole is the only stratum. This module does not know paths.

use crate::scene::shape::{ChartRect, Flat, Region, Shape};
use crate::scene::start::area::{AreaPoint, FaceArea};
use crate::scene::sweep::WallChart;
use crate::scene::{Goniometer, Grid, Patch, PrimId, Seeing, SurfaceSensor};
use glam::{DVec2, DVec3};
use lumiduct_base::math::uniform_sphere;
use std::f64::consts::PI;

/// Most strata of a sensor: batches have fewer paths than this, so that more would bring nothing.
const MOST_STRATA: usize = 1 << 17;

/// The strata of the starts on a sensor.
#[derive(Debug)]
pub struct Strata<'s> {
    division: SensorDivision<'s>,
    /// Views or pixels of every part, if the sensor has any.
    views: Option<usize>,
}

/// How a sensor is divided.
#[derive(Debug)]
enum SensorDivision<'s> {
    /// Not at all.
    Whole,
    /// Every part is a rectangle of the numbers from which points of the surface are made.
    Numbers(Vec<ChartRect>),
    /// Every part is a cell of a plane, as far as it lies on the surface.
    Plane(&'s Flat, Option<PrimId>, Vec<PlaneCell>),
    /// The directions of a goniometer, by the number of its cells.
    Directions(usize),
}

/// The part of a cell that lies on a flat surface.
#[derive(Debug, Clone, Copy)]
struct PlaneCell {
    /// The rectangle in which its points lie, mm.
    rect: ChartRect,
    rim: Rim,
}

/// How the rim of a surface cuts a cell.
#[derive(Debug, Clone, Copy)]
enum Rim {
    /// Not at all.
    Outside,
    /// Across: at every x of its rectangle an ellipse about the origin with these half axes, mm, limits its y.
    Ellipse(DVec2),
    /// In another way: points of the rectangle beyond it are rejected.
    Other,
}

impl<'s> Strata<'s> {
    /// The strata of a surface sensor with this area.
    pub(super) fn of_surface(sensor: &SurfaceSensor, area: &FaceArea<'s>) -> Self {
        let division = match area.only_patch() {
            Some((patch, prim)) if (2..=MOST_STRATA).contains(&sensor.grid.cells()) => {
                divide(sensor, patch, prim)
            }
            Some(_) | None => None,
        };
        let views = match &sensor.seeing {
            Seeing::All => None,
            Seeing::Views(views) => Some(views.directions.len()),
            Seeing::Pixels(pixels) => Some(pixels.count()),
        };
        let all = Self { division: division.unwrap_or(SensorDivision::Whole), views };
        match all.parts() {
            0 => Self { division: SensorDivision::Whole, views },
            _ => all,
        }
    }

    /// The strata of a goniometer.
    pub(super) fn of_sphere(goniometer: &Goniometer) -> Self {
        Self { division: SensorDivision::Directions(goniometer.cells()), views: None }
    }

    /// Their number, at least 1.
    pub fn count(&self) -> usize {
        self.parts() * self.views.unwrap_or(1)
    }

    /// Parts into which the surface is divided, or cells of a goniometer.
    fn parts(&self) -> usize {
        match &self.division {
            SensorDivision::Whole => 1,
            SensorDivision::Numbers(all) => all.len(),
            SensorDivision::Plane(_, _, all) => all.len(),
            SensorDivision::Directions(cells) => *cells,
        }
    }

    /// The view or the pixel of a stratum, if the sensor has any.
    pub(super) fn view(&self, stratum: usize) -> Option<usize> {
        self.views.map(|_| stratum / self.parts())
    }

    /// A point of a stratum for uniform `u` with the reciprocal of its density where all parts are drawn from equally
    /// often, mm²; `None` where the surface has none.
    pub(super) fn point(
        &self,
        area: &FaceArea<'s>,
        stratum: usize,
        u: [f64; 2],
    ) -> Option<(AreaPoint, f64)> {
        let parts = self.parts();
        let (at, area) = match &self.division {
            SensorDivision::Whole | SensorDivision::Directions(_) => (area.sample(u)?, area.area()),
            SensorDivision::Numbers(all) => {
                let rect = &all[stratum % parts];
                (area.sample(numbers_within(rect, u))?, area.area() * rect.area())
            }
            SensorDivision::Plane(flat, prim, all) => {
                let own = &all[stratum % parts];
                let (uv, area) = own.draw(flat.region(), u)?;
                let point = flat.frame().point_to_world(uv.extend(0.0));
                (AreaPoint { point, normal: flat.frame().z, uv, prim: *prim }, area)
            }
        };
        Some((at, area * parts as f64))
    }
}

impl PlaneCell {
    /// The part of a cell on a region; `None` if there is none.
    fn new(region: &Region, rect: ChartRect, covered: f64) -> Option<Self> {
        if covered == 0.0 {
            return None;
        }
        if covered == 1.0 {
            return Some(Self { rect, rim: Rim::Outside });
        }
        let half = match region {
            Region::Annulus { inner: 0.0, outer } => DVec2::splat(*outer),
            Region::Ellipse { half_x, half_y } => DVec2::new(*half_x, *half_y),
            Region::Annulus { .. }
            | Region::Sector { .. }
            | Region::Rectangle { .. }
            | Region::Polygon(_)
            | Region::Holed(_) => {
                let rect = rect.intersection(&region.bounds());
                return Some(Self { rect, rim: Rim::Other });
            }
        };
        // The widest part of the ellipse in the cell is nearest to its axis.
        let nearest = 0.0f64.clamp(rect.min.y, rect.max.y);
        let widest = half.x * (1.0 - (nearest / half.y).powi(2)).max(0.0).sqrt();
        let min = rect.min.with_x(rect.min.x.max(-widest));
        let max = rect.max.with_x(rect.max.x.min(widest));
        let rect = ChartRect { min, max };
        (region.area_in(rect) > 0.0).then_some(Self { rect, rim: Rim::Ellipse(half) })
    }

    /// A point for uniform `u` with the reciprocal of its density, mm².
    fn draw(&self, region: &Region, u: [f64; 2]) -> Option<(DVec2, f64)> {
        let at = self.rect.at(u);
        match self.rim {
            Rim::Outside => Some((at, self.rect.area())),
            Rim::Other => region.contains(at).then(|| (at, self.rect.area())),
            // Uniform in x and along the chord there. A uniform density would need a root, which takes longer than to trace a path
            // through a tube.
            Rim::Ellipse(half) => {
                let [low, high] = self.chord(half, at.x);
                let width = self.rect.max.x - self.rect.min.x;
                let at = at.with_y(low + u[1] * (high - low));
                (high > low).then_some((at, width * (high - low)))
            }
        }
    }

    /// The limits of y at an x, mm.
    fn chord(&self, half: DVec2, x: f64) -> [f64; 2] {
        let y = half.y * (1.0 - (x / half.x).powi(2)).max(0.0).sqrt();
        let low = self.rect.min.y.max(-y);
        [low, self.rect.max.y.min(y).max(low)]
    }
}

/// The cells of a grid, row by row numbered, in Z-order (Morton 1966): strata close in this order are close in both directions.
pub(super) fn in_z_order((columns, rows): (usize, usize)) -> Vec<usize> {
    let spread = |number: usize| {
        (0..32).fold(0u64, |code, bit| code | (number as u64 >> bit & 1) << (2 * bit))
    };
    let mut cells: Vec<usize> = (0..columns * rows).collect();
    cells.sort_by_cached_key(|cell| spread(cell % columns) | spread(cell / columns) << 1);
    cells
}

fn divide<'s>(
    sensor: &SurfaceSensor,
    patch: &'s Patch,
    prim: Option<PrimId>,
) -> Option<SensorDivision<'s>> {
    let cells = in_z_order(sensor.grid.shape()).into_iter();
    let numbers = |all: Vec<ChartRect>| Some(SensorDivision::Numbers(all));
    match (&sensor.grid, NumbersOfChart::new(patch)) {
        (Grid::Cartesian { .. }, Some(chart)) => {
            let unit = ChartRect { min: DVec2::ZERO, max: DVec2::ONE };
            let of_cell = |cell| chart.of(sensor.grid.cell_rect(cell)).intersection(&unit);
            return numbers(cells.map(of_cell).filter(|rect| !rect.is_empty()).collect());
        }
        (Grid::Polar { .. }, Some(_)) => return None,
        (_, None) => {}
    }
    let flat = patch.shape.as_flat().filter(|_| patch.chart.is_none() && patch.trim.is_none())?;
    match (&sensor.grid, flat.region()) {
        (Grid::Cartesian { .. }, region) => {
            let of_cell =
                |cell| PlaneCell::new(region, sensor.grid.cell_rect(cell), sensor.covered[cell]);
            Some(SensorDivision::Plane(flat, prim, cells.filter_map(of_cell).collect()))
        }
        (Grid::Polar { radius, rings, sectors }, Region::Annulus { inner, outer }) => {
            let share = |r: f64| {
                ((r * r - inner * inner) / (outer * outer - inner * inner)).clamp(0.0, 1.0)
            };
            let ring = |ring: usize| share(radius * ring as f64 / *rings as f64);
            let turn = |sector: usize| sector as f64 / *sectors as f64;
            let of_cell = |cell: usize| {
                let (r, s) = (cell / sectors, cell % sectors);
                let min = DVec2::new(ring(r), turn(s));
                ChartRect { min, max: DVec2::new(ring(r + 1), turn(s + 1)) }
            };
            numbers(cells.map(of_cell).filter(|rect| !rect.is_empty()).collect())
        }
        (Grid::Polar { .. }, _) => None,
    }
}

/// Numbers from which points of a patch are made, by the chart of its face, where one grows evenly with each coordinate.
struct NumbersOfChart {
    /// Position of the numbers (0, 0), mm.
    origin: DVec2,
    /// Growth along u and v of the chart with the number that moves it, mm.
    growth: DVec2,
    /// Whether the first number moves along u, or along v.
    first: Along,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Along {
    U,
    V,
}

impl NumbersOfChart {
    fn new(patch: &Patch) -> Option<Self> {
        let is_even = match &patch.shape {
            Shape::Flat(flat) => matches!(flat.region(), Region::Rectangle { .. }),
            Shape::Cylinder(wall) => wall.is_uncut(),
            Shape::Cone(_)
            | Shape::Torus(_)
            | Shape::Sphere(_)
            | Shape::Paraboloid(_)
            | Shape::ParabolicCylinder(_)
            | Shape::CompoundParabola(_) => false,
        };
        let first = match &patch.chart {
            None | Some(WallChart::Along { .. }) => Along::U,
            Some(WallChart::Across { .. }) => Along::V,
            Some(WallChart::Trapezoid { .. } | WallChart::Sector { .. }) => return None,
        };
        if !is_even {
            return None;
        }
        let at = |u| patch.chart(patch.shape.sample(u));
        let from = at([0.25, 0.25]);
        let [by_first, by_second] = [[0.75, 0.25], [0.25, 0.75]].map(|u| 2.0 * (at(u) - from));
        let growth = match first {
            Along::U => DVec2::new(by_first.x, by_second.y),
            Along::V => DVec2::new(by_second.x, by_first.y),
        };
        Some(Self { origin: from - 0.25 * growth, growth, first })
    }

    /// The rectangle of the numbers whose points lie in a rectangle of the chart.
    fn of(&self, rect: ChartRect) -> ChartRect {
        let ends = [rect.min, rect.max].map(|end| (end - self.origin) / self.growth);
        let [one, other] = match self.first {
            Along::U => ends,
            Along::V => ends.map(|end| DVec2::new(end.y, end.x)),
        };
        ChartRect { min: one.min(other), max: one.max(other) }
    }
}

/// A direction drawn from the middle of a goniometer.
pub(super) struct DrawnDirection {
    pub(super) cell: usize,
    pub(super) out: DVec3,
    /// The reciprocal of its density, sr.
    pub(super) solid_angle: f64,
}

/// A direction uniform over the sphere, or over a cell where all of them are drawn from equally often.
pub(super) fn direction(
    goniometer: &Goniometer,
    cell: Option<usize>,
    u: [f64; 2],
) -> DrawnDirection {
    match cell {
        None => {
            let out = uniform_sphere(u);
            DrawnDirection { cell: goniometer.cell(out), out, solid_angle: 4.0 * PI }
        }
        Some(cell) => {
            let local = uniform_sphere(numbers_in_cell(goniometer, cell, u));
            let solid_angle = goniometer.solid_angle(cell) * goniometer.cells() as f64;
            DrawnDirection { cell, out: goniometer.frame.to_world(local), solid_angle }
        }
    }
}

/// The numbers from which `uniform_sphere` makes a direction in a cell of a goniometer.
fn numbers_in_cell(goniometer: &Goniometer, cell: usize, u: [f64; 2]) -> [f64; 2] {
    let (ring, sector) = (cell / goniometer.c_cells, cell % goniometer.c_cells);
    // (1 - cos γ)/2 = sin²(γ/2); C grows against the azimuth.
    let share =
        |ring: usize| (0.5 * PI * ring as f64 / goniometer.gamma_cells as f64).sin().powi(2);
    let turn = |sector: usize| 1.0 - sector as f64 / goniometer.c_cells as f64;
    let min = DVec2::new(share(ring), turn(sector + 1));
    numbers_within(&ChartRect { min, max: DVec2::new(share(ring + 1), turn(sector)) }, u)
}

/// The numbers from which an image draws a direction in one of its pixels, uniform for uniform `u`.
pub(super) fn numbers_in_pixel(image: &Grid, pixel: usize, u: [f64; 2]) -> [f64; 2] {
    let (columns, rows) = image.shape();
    let place = DVec2::new((pixel % columns) as f64, (pixel / columns) as f64);
    let count = DVec2::new(columns as f64, rows as f64);
    numbers_within(&ChartRect { min: place / count, max: (place + 1.0) / count }, u)
}

/// Numbers in a rectangle of them.
fn numbers_within(rect: &ChartRect, u: [f64; 2]) -> [f64; 2] {
    // Rounding must not reach 1.
    rect.at(u).min(DVec2::splat(1.0f64.next_down())).to_array()
}
