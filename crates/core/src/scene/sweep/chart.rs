//! From the chart of one surface to the chart of the whole sweep: u around the profile, v along the path.

use crate::scene::shape::{ChartRect, Shape};
use glam::{DVec2, DVec3, Vec2Swizzles};

/// The map from the chart of a part's shape to the chart of its sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WallChart {
    /// Shifted and scaled: `offset + scale * (u, v)`.
    Along {
        /// Position of the shape's (0, 0), mm.
        offset: DVec2,
        /// Factors along u and v.
        scale: DVec2,
    },
    /// The shape's v goes around and its u along: `offset + scale * (v, u)`.
    Across {
        /// Position of the shape's (0, 0), mm.
        offset: DVec2,
        /// Factors along the sweep's u and v.
        scale: DVec2,
    },
    /// A flat trapezoid whose parallel sides are sections.
    Trapezoid {
        /// The rectangle it fills, mm.
        target: ChartRect,
        /// Its corners.
        trapezoid: Trapezoid,
    },
    /// A flat sector about a bend axis.
    Sector {
        /// The rectangle it fills, mm.
        target: ChartRect,
        /// Its radii and angle.
        sector: Sector,
    },
}

/// The corners of a trapezoid with sides at y = 0 and y = `height`, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Trapezoid {
    /// First and last x of the side at y = 0.
    pub(super) bottom: [f64; 2],
    /// First and last x of the side at y = `height`.
    pub(super) top: [f64; 2],
    pub(super) height: f64,
}

/// A sector of a ring, from the x axis counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// Radius where the profile's edge starts and where it ends, mm.
    pub(super) radii: [f64; 2],
    /// Azimuth of the end of the sector, rad.
    pub(super) angle: f64,
    pub(super) sense: Sense,
}

/// Direction in which a sector's azimuth counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sense {
    /// Along the path.
    Forward,
    /// Against the path.
    Backward,
}

impl WallChart {
    /// The sweep's (u, v) of the shape's (u, v), mm.
    pub(crate) fn of(&self, at: DVec2) -> DVec2 {
        match self {
            Self::Along { offset, scale } => offset + scale * at,
            Self::Across { offset, scale } => offset + scale * DVec2::new(at.y, at.x),
            Self::Trapezoid { target, trapezoid } => target.at_share(trapezoid.share_of(at)),
            Self::Sector { target, sector } => target.at_share(sector.share_of(at)),
        }
    }

    /// Unit tangent of `shape` at a point along which the sweep's v grows at constant u.
    pub(crate) fn along(&self, shape: &Shape, p: DVec3) -> DVec3 {
        match self {
            Self::Along { .. } => shape.along(p),
            Self::Across { .. } => shape.normal(p).cross(shape.along(p)),
            Self::Trapezoid { trapezoid, .. } => {
                let up = shape.along(p);
                let lean = trapezoid.lean(shape.chart(p));
                (up + lean * up.cross(shape.normal(p))).normalize()
            }
            // The chart of a sector is centred on the bend axis.
            Self::Sector { sector, .. } => {
                let (up, at) = (shape.along(p), shape.chart(p));
                let outward = at.x * up.cross(shape.normal(p)) + at.y * up;
                let sense = match sector.sense {
                    Sense::Forward => 1.0,
                    Sense::Backward => -1.0,
                };
                sense * shape.normal(p).cross(outward).normalize()
            }
        }
    }

    /// The rectangle of the sweep's chart that `shape` covers, mm.
    pub(crate) fn bounds(&self, shape: &Shape) -> ChartRect {
        match self {
            Self::Along { .. } | Self::Across { .. } => {
                let own = shape.chart_bounds();
                spanned([self.of(own.min), self.of(own.max)])
            }
            Self::Trapezoid { target, .. } | Self::Sector { target, .. } => *target,
        }
    }

    /// Area of `shape` whose (u, v) in the sweep's chart lie in `rect`, mm².
    pub(crate) fn area_in(&self, shape: &Shape, rect: ChartRect) -> f64 {
        match self {
            Self::Along { offset, scale } => shape.area_in(unscaled(rect, *offset, *scale)),
            Self::Across { offset, scale } => {
                shape.area_in(turned(unscaled(rect, *offset, *scale)))
            }
            Self::Trapezoid { target, trapezoid } => trapezoid.area_of(target.share_in(rect)),
            Self::Sector { target, sector } => sector.area_of(target.share_in(rect)),
        }
    }

    /// Area of the sweep's chart in `rect` that `shape` fills, mm².
    pub(crate) fn charted_in(&self, shape: &Shape, rect: ChartRect) -> f64 {
        match self {
            Self::Along { offset, scale } => {
                let own = unscaled(rect, *offset, *scale);
                shape.charted_in(own) * scale.element_product().abs()
            }
            Self::Across { offset, scale } => {
                let own = turned(unscaled(rect, *offset, *scale));
                shape.charted_in(own) * scale.element_product().abs()
            }
            Self::Trapezoid { target, .. } | Self::Sector { target, .. } => {
                target.intersection(&rect).area()
            }
        }
    }
}

impl ChartRect {
    /// The point at a share of the rectangle's width and height.
    fn at_share(&self, share: DVec2) -> DVec2 {
        self.min + share * (self.max - self.min)
    }

    /// The part of this rectangle that lies in another one, as shares of width and height; may be
    /// empty.
    fn share_in(&self, other: ChartRect) -> ChartRect {
        let size = self.max - self.min;
        let common = self.intersection(&other);
        ChartRect { min: (common.min - self.min) / size, max: (common.max - self.min) / size }
    }
}

impl Trapezoid {
    /// First x and width at a share of the height, mm.
    fn side(&self, share: f64) -> (f64, f64) {
        let [from, to] =
            [0, 1].map(|end| self.bottom[end] + share * (self.top[end] - self.bottom[end]));
        (from, to - from)
    }

    fn share_of(&self, at: DVec2) -> DVec2 {
        let share = at.y / self.height;
        let (from, width) = self.side(share);
        DVec2::new((at.x - from) / width, share)
    }

    /// Growth of x with y along a line of constant share of the width, 1.
    fn lean(&self, at: DVec2) -> f64 {
        let share = self.share_of(at).x;
        let [from, to] = [0, 1].map(|end| self.top[end] - self.bottom[end]);
        (from + share * (to - from)) / self.height
    }

    fn area_of(&self, share: ChartRect) -> f64 {
        let (_, mean_width) = self.side(0.5 * (share.min.y + share.max.y));
        share.area() * mean_width * self.height
    }
}

impl Sector {
    fn share_of(&self, at: DVec2) -> DVec2 {
        // Measured from the middle, the azimuth of a sector has no jump.
        let middle = DVec2::from_angle(0.5 * self.angle);
        let turned = middle.perp_dot(at).atan2(middle.dot(at)) / self.angle;
        let along = match self.sense {
            Sense::Forward => 0.5 + turned,
            Sense::Backward => 0.5 - turned,
        };
        let [first, last] = self.radii;
        DVec2::new((at.length() - first) / (last - first), along)
    }

    fn area_of(&self, share: ChartRect) -> f64 {
        let [first, last] = self.radii;
        let mean_radius = first + 0.5 * (share.min.x + share.max.x) * (last - first);
        share.area() * (last - first).abs() * mean_radius * self.angle
    }
}

/// The rectangle that an offset and factors map to `rect`.
fn unscaled(rect: ChartRect, offset: DVec2, scale: DVec2) -> ChartRect {
    spanned([rect.min, rect.max].map(|p| (p - offset) / scale))
}

/// The rectangle with u and v exchanged.
fn turned(rect: ChartRect) -> ChartRect {
    ChartRect { min: rect.min.yx(), max: rect.max.yx() }
}

/// The rectangle between two opposite corners in any order.
fn spanned([a, b]: [DVec2; 2]) -> ChartRect {
    ChartRect { min: a.min(b), max: a.max(b) }
}
