//! Faces: the named parts of solids and sheets, and the smooth pieces they are made of.

use crate::scene::relief::{ReliefWall, Trim};
use crate::scene::shape::{ChartRect, Crossing, CrossingQuery, RayStart, Shape, Toward};
use crate::scene::sweep::WallChart;
use crate::scene::{FaceId, FinishId, Ray, SolidId};
use glam::{DVec2, DVec3};
use lumiduct_base::math::Frame;
use std::ops::Range;
use std::sync::Arc;

/// The owner of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    /// The boundary of a solid; its front is outside.
    Solid(SolidId),
    /// An open, two-sided sheet.
    Sheet,
    /// No material: the open end of a tube, or a virtual sensor.
    Port,
}

/// A named part of a solid or sheet, such as `pipe.exit`.
#[derive(Debug, Clone)]
pub struct Face {
    /// Dotted name.
    pub name: String,
    /// Its owner.
    pub owner: Owner,
    /// Finish met from the front; `None` is the smooth interface of the two media, not declared.
    pub front: Option<FinishId>,
    /// Finish met from the back.
    pub back: Option<FinishId>,
    /// Patterns on it, by their numbers.
    pub patterns: Vec<usize>,
    /// Its pieces.
    pub extent: PieceRange,
}

impl Face {
    /// The finish that it declares for light travelling toward one of its sides.
    #[inline]
    pub(crate) fn finish_against(&self, toward: Toward) -> Option<FinishId> {
        match toward {
            // Light travelling toward the front meets the back.
            Toward::Front => self.back,
            Toward::Back => self.front,
        }
    }
}

/// The location of the pieces of a face.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum PieceRange {
    /// In the scene's table of patches.
    Patches(Range<usize>),
    /// In the scene's table of ports.
    Ports(Range<usize>),
    /// In meshes.
    Mesh(MeshPieces),
}

/// The location of a face of a solid of triangles.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MeshPieces {
    /// A mesh of the scene, and the face there.
    pub own: Option<(usize, usize)>,
    /// Copies of a mesh, by their numbers among all copies of the scene, and the face of their mesh.
    pub copies: Vec<(Range<usize>, usize)>,
}

/// Points used to find the area of a surface cut off at a round wall.
const AREA_POINTS: u32 = 400;
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;

/// A smooth piece of a face.
#[derive(Debug, Clone)]
pub struct Patch {
    /// The surface.
    pub shape: Shape,
    /// The face it belongs to.
    pub face: FaceId,
    /// The owner of the face.
    pub owner: Owner,
    /// Tangent-continuous patches share this number.
    pub smooth: u32,
    /// Maps the shape's chart to that of the whole sweep; `None` where they are the same.
    pub chart: Option<WallChart>,
    /// Limits in addition to the edges of its shape; usually none.
    pub trim: Option<Arc<Trim>>,
}

impl Patch {
    /// Calls `visit` for every crossing of the ray's whole line with the patch, in any order.
    #[inline]
    pub(crate) fn crossings(&self, ray: &Ray, start: RayStart, mut visit: impl FnMut(Crossing)) {
        self.shape.crossings(ray, start, |crossing| {
            if self.keeps(ray, &crossing) {
                visit(crossing);
            }
        });
    }

    /// The first crossing of the ray's line that is `wanted`.
    #[inline(always)]
    pub(crate) fn first_crossing(
        &self,
        ray: &Ray,
        start: RayStart,
        wanted: &CrossingQuery,
    ) -> Option<Crossing> {
        match &self.trim {
            None => self.shape.first_crossing(ray, start, wanted),
            Some(_) => self.first_kept(&ray.lent(), start, wanted),
        }
    }

    #[inline(never)]
    fn first_kept(&self, ray: &Ray, start: RayStart, wanted: &CrossingQuery) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        self.shape.crossings(ray, start, |crossing| {
            let is_nearer = first.is_none_or(|first| crossing.t < first.t);
            if is_nearer && wanted.includes(&crossing) && self.keeps(ray, &crossing) {
                first = Some(crossing);
            }
        });
        first
    }

    fn keeps(&self, ray: &Ray, crossing: &Crossing) -> bool {
        self.trim.as_ref().is_none_or(|trim| trim.keeps(ray.at(crossing.t)))
    }

    /// A point, uniform over the area for uniform `u`; `None` where something else occupies the
    /// position.
    pub(crate) fn sample(&self, u: [f64; 2]) -> Option<DVec3> {
        let point = self.shape.sample(u);
        self.trim.as_ref().is_none_or(|trim| trim.keeps(point)).then_some(point)
    }

    /// Area, mm²; to about a percent for a surface cut off at a round wall.
    pub(crate) fn area(&self) -> f64 {
        let whole = self.shape.area();
        let Some(trim) = &self.trim else { return whole };
        if trim.is_of_element() {
            // A golden-ratio lattice.
            let point = |i: u32| {
                let u = (f64::from(i) + 0.5) / f64::from(AREA_POINTS);
                self.sample([u, (f64::from(i) / GOLDEN_RATIO).fract()])
            };
            let kept = (0..AREA_POINTS).filter(|i| point(*i).is_some()).count();
            return whole * kept as f64 / f64::from(AREA_POINTS);
        }
        whole - trim.area_in(self.chart_bounds())
    }

    /// Unrolled coordinates on the face, mm.
    pub fn chart(&self, p: DVec3) -> DVec2 {
        let uv = self.shape.chart(p);
        self.chart.as_ref().map_or(uv, |chart| chart.of(uv))
    }

    /// Unit tangent at a point along which v of the chart grows at constant u: along the guide.
    pub(crate) fn along(&self, p: DVec3) -> DVec3 {
        self.chart.as_ref().map_or_else(|| self.shape.along(p), |chart| chart.along(&self.shape, p))
    }

    /// The rectangle that the chart covers, mm.
    pub(crate) fn chart_bounds(&self) -> ChartRect {
        self.chart
            .as_ref()
            .map_or_else(|| self.shape.chart_bounds(), |chart| chart.bounds(&self.shape))
    }

    /// Area of the part whose chart lies in `rect`, mm².
    pub(crate) fn area_in(&self, rect: ChartRect) -> f64 {
        self.untrimmed_in(rect) - self.trimmed_in(rect)
    }

    /// Area of the chart in `rect` that the patch fills, mm².
    pub(crate) fn charted_in(&self, rect: ChartRect) -> f64 {
        let charted = self.chart.as_ref().map_or_else(
            || self.shape.charted_in(rect),
            |chart| chart.charted_in(&self.shape, rect),
        );
        match self.trimmed_in(rect) {
            0.0 => charted,
            trimmed => charted * (1.0 - trimmed / self.untrimmed_in(rect)),
        }
    }

    fn untrimmed_in(&self, rect: ChartRect) -> f64 {
        self.chart
            .as_ref()
            .map_or_else(|| self.shape.area_in(rect), |chart| chart.area_in(&self.shape, rect))
    }

    fn trimmed_in(&self, rect: ChartRect) -> f64 {
        let own = rect.intersection(&self.chart_bounds());
        match &self.trim {
            Some(trim) if !own.is_empty() => trim.area_in(own),
            Some(_) | None => 0.0,
        }
    }
}

/// A smooth piece of a face to be added.
#[derive(Debug, Clone)]
pub struct FacePiece {
    /// The surface.
    pub shape: Shape,
    /// Tangent-continuous pieces share this number within their solid or sheet.
    pub smooth: u32,
    /// Maps the shape's chart to that of the whole sweep; `None` where they are the same.
    pub chart: Option<WallChart>,
    /// Limits in addition to the edges of its shape.
    pub trim: Option<Arc<Trim>>,
}

impl FacePiece {
    /// A piece that is a face of its own.
    pub fn whole(shape: Shape) -> Self {
        Self { shape, smooth: 0, chart: None, trim: None }
    }
}

impl ReliefWall {
    /// The wall of a patch: a flat one, or a round one all around with its front outside.
    pub fn of(patch: &Patch) -> Option<Self> {
        if let Some(flat) = patch.shape.as_flat() {
            let Frame { origin, x, y, z } = *flat.frame();
            let at = patch.chart(origin);
            let [by_x, by_y] = [x, y].map(|step| patch.chart(origin + step) - at);
            let (u, v) = (by_x.x * x + by_y.x * y, by_x.y * x + by_y.y * y);
            let (u, v) = (u.try_normalize()?, v.try_normalize()?);
            return Some(Self {
                origin: origin - at.x * u - at.y * v,
                x: u,
                y: v,
                z,
                radius: None,
            });
        }
        let wall = patch.shape.as_cylinder().filter(|wall| wall.is_whole())?;
        let start = patch.shape.sample([0.25, 0.5]);
        let (at, out) = (patch.chart(start), patch.shape.normal(start));
        let (along, radius) = (patch.along(start), wall.radius());
        // u grows counter-clockwise about the axis.
        let (sin, cos) = (at.x / radius).sin_cos();
        let around = along.cross(out);
        let (x, y) = (cos * out - sin * around, sin * out + cos * around);
        let origin = start - radius * out - at.y * along;
        Some(Self { origin, x, y, z: along, radius: Some(radius) })
    }
}
