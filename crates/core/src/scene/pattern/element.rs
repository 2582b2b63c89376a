//! One element of a relief: a part of a sphere, a wedge or a pyramid, sunk into a wall or raised from it.
//!
//! Its outline on the wall is in unrolled coordinates about its middle: u across or around, v
//! along. It knows neither its position nor its surfaces in space.

use crate::scene::pattern::along::TableAlong;
use glam::DVec2;

/// An element with relief.
#[derive(Debug, Clone, PartialEq)]
pub struct Element {
    /// Its form.
    pub form: ElementForm,
    /// Whether it is sunk or raised.
    pub way: Way,
    /// Radius of the round wall that it lies on, mm; `None` for a flat one.
    pub round: Option<f64>,
}

/// Direction of an element from its wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Into the solid: the inside of the element is outside the solid.
    Into,
    /// Out of the solid: the inside of the element is inside the solid.
    OutOf,
}

impl Way {
    /// -1 into the solid, 1 out of it.
    pub fn sign(self) -> f64 {
        match self {
            Self::Into => -1.0,
            Self::OutOf => 1.0,
        }
    }
}

/// The form of an element. Heights are depths where it goes into the solid.
#[derive(Debug, Clone, PartialEq)]
pub enum ElementForm {
    /// A part of a ball, at most half of it.
    Cap {
        /// Its width.
        size: CapSize,
        /// Extent from the wall, mm.
        height: TableAlong,
    },
    /// Two flanks that meet in an edge across the guide.
    Wedge {
        /// Extent from the wall, mm.
        height: TableAlong,
        /// Cotangents of the angles between the wall and its flanks, starting with the one toward
        /// the start of the guide.
        slopes: [f64; 2],
        /// Extent across the guide.
        span: WedgeSpan,
    },
    /// Four sides that meet in a point.
    Pyramid {
        /// Width across the guide, mm.
        width: f64,
        /// Length along the guide, mm.
        length: f64,
        /// Extent from the wall, mm.
        height: TableAlong,
    },
}

/// Width of a cap.
#[derive(Debug, Clone, PartialEq)]
pub enum CapSize {
    /// Radius of its sphere, mm.
    Sphere(TableAlong),
    /// Diameter of its opening in a flat wall, mm; along the guide in a round one.
    Opening(TableAlong),
}

/// Extent of a wedge across the guide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WedgeSpan {
    /// From side to side of a face of this width, mm, or straight across a round wall.
    Through(f64),
    /// This length, mm, between its own ends.
    Within(f64),
    /// All around a round wall.
    Ring,
}

/// A cap of a certain size, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cap {
    /// Radius of its sphere.
    pub radius: f64,
    /// Extent from the wall.
    pub height: f64,
    /// Half of its opening along the guide.
    pub rim: f64,
}

impl Cap {
    pub(crate) fn new(size: &CapSize, height: &TableAlong, place: f64) -> Self {
        let height = height.at(place);
        match size {
            CapSize::Sphere(radius) => {
                let radius = radius.at(place);
                let rim = (height * (2.0 * radius - height)).max(0.0).sqrt();
                Self { radius, height, rim }
            }
            CapSize::Opening(diameter) => {
                let rim = 0.5 * diameter.at(place);
                Self { radius: 0.5 * (rim * rim + height * height) / height, height, rim }
            }
        }
    }

    /// Distance of the centre of the sphere from the axis of a round wall, mm.
    pub(crate) fn center_from_axis(&self, wall: f64, way: Way) -> f64 {
        wall - way.sign() * (self.radius - self.height)
    }
}

impl Element {
    /// Extent of the elements of a row from the wall, mm.
    pub fn height(&self, place: f64) -> f64 {
        match &self.form {
            ElementForm::Cap { height, .. }
            | ElementForm::Wedge { height, .. }
            | ElementForm::Pyramid { height, .. } => height.at(place),
        }
    }

    /// Extent of a wedge across the guide; `None` for other elements.
    pub fn span(&self) -> Option<WedgeSpan> {
        match &self.form {
            ElementForm::Wedge { span, .. } => Some(*span),
            ElementForm::Cap { .. } | ElementForm::Pyramid { .. } => None,
        }
    }

    /// The cap of the elements of a row, if they are caps.
    pub fn cap(&self, place: f64) -> Option<Cap> {
        match &self.form {
            ElementForm::Cap { size, height } => Some(Cap::new(size, height, place)),
            ElementForm::Wedge { .. } | ElementForm::Pyramid { .. } => None,
        }
    }

    /// Width and length that the elements of a row need on the wall, mm: their footprint, and on a
    /// round wall also their extent below it.
    pub fn size(&self, place: f64) -> DVec2 {
        match &self.form {
            ElementForm::Cap { .. } => {
                let widest = self.half_width(place, 0.0).max(self.half_width_inside(place));
                DVec2::new(2.0 * widest, self.length(place))
            }
            ElementForm::Wedge { .. } | ElementForm::Pyramid { .. } => {
                DVec2::new(2.0 * self.half_width(place, self.edge(place)), self.length(place))
            }
        }
    }

    /// Whether two elements with their middles `apart` overlap.
    pub(crate) fn overlap(&self, places: [f64; 2], apart: DVec2) -> bool {
        let [one, other] = places.map(|place| self.size(place));
        let room = 0.5 * (one + other) * (1.0 - 1e-12);
        match &self.form {
            ElementForm::Cap { .. } => apart.length() < room.max_element(),
            ElementForm::Wedge { .. } | ElementForm::Pyramid { .. } => {
                apart.x.abs() < room.x && apart.y.abs() < room.y
            }
        }
    }

    /// Length along the guide of the footprint of an element of a row, mm.
    pub(crate) fn length(&self, place: f64) -> f64 {
        match &self.form {
            ElementForm::Cap { size, height } => 2.0 * Cap::new(size, height, place).rim,
            ElementForm::Wedge { height, slopes, .. } => height.at(place) * (slopes[0] + slopes[1]),
            ElementForm::Pyramid { length, .. } => *length,
        }
    }

    /// Position of the edge or the top of an element of a row along the guide, from its middle, mm.
    pub fn edge(&self, place: f64) -> f64 {
        match &self.form {
            ElementForm::Wedge { height, slopes, .. } => {
                0.5 * height.at(place) * (slopes[0] - slopes[1])
            }
            ElementForm::Cap { .. } | ElementForm::Pyramid { .. } => 0.0,
        }
    }

    /// Half of the width of the footprint of an element of a row, mm, at a distance along the guide
    /// from its middle; below 0 where there is none.
    pub(crate) fn half_width(&self, place: f64, v: f64) -> f64 {
        if 2.0 * v.abs() > self.length(place) {
            return -1.0;
        }
        match &self.form {
            ElementForm::Cap { size, height } => {
                let cap = Cap::new(size, height, place);
                let half = ((cap.rim - v) * (cap.rim + v)).max(0.0).sqrt();
                match self.round {
                    None => half,
                    // The sphere contains the points at u with v² + 4 R c sin²(u/2R) <= rim².
                    Some(wall) => {
                        let c = cap.center_from_axis(wall, self.way);
                        2.0 * wall * (0.5 * half / (wall * c).sqrt()).min(1.0).asin()
                    }
                }
            }
            ElementForm::Wedge { slopes, span, .. } => match (span, self.round) {
                (WedgeSpan::Ring, _) => f64::INFINITY,
                (WedgeSpan::Through(_), Some(wall)) => {
                    let height = self.wedge_height(place, v, slopes);
                    2.0 * wall * (0.5 * height / wall).clamp(0.0, 1.0).sqrt().asin()
                }
                // Slightly more, so that rounding leaves no strip of the wall at its sides.
                (WedgeSpan::Through(width), None) => 0.5 * width * (1.0 + 1e-9),
                (WedgeSpan::Within(width), _) => 0.5 * width,
            },
            ElementForm::Pyramid { width, .. } => 0.5 * width,
        }
    }

    /// Extent of a wedge from the wall at a distance along the guide from its middle, mm.
    fn wedge_height(&self, place: f64, v: f64, slopes: &[f64; 2]) -> f64 {
        let from_edge = v - self.edge(place);
        let slope = if from_edge < 0.0 { slopes[0] } else { slopes[1] };
        let fallen = if from_edge == 0.0 { 0.0 } else { from_edge.abs() / slope };
        self.height(place) - fallen
    }

    /// Half of the width that a cap sunk into a round wall needs below it, mm around the wall.
    fn half_width_inside(&self, place: f64) -> f64 {
        let (Some(wall), Some(cap), Way::Into) = (self.round, self.cap(place), self.way) else {
            return 0.0;
        };
        let c = cap.center_from_axis(wall, self.way);
        let tangent = (c - cap.radius) * (c + cap.radius);
        if tangent < wall * wall { wall * (cap.radius / c).min(1.0).asin() } else { 0.0 }
    }

    /// Whether the footprint of an element of a row contains a point of the wall at `from` its
    /// middle, mm.
    #[inline]
    pub(crate) fn contains(&self, place: f64, from: DVec2) -> bool {
        from.x.abs() <= self.half_width(place, from.y)
    }

    /// Whether a wedge of a row passes through a point at a distance along the guide from its
    /// middle, at a depth below the wall, mm: its cut in the sides of the guide.
    pub(crate) fn cuts_side(&self, place: f64, along: f64, depth: f64) -> bool {
        match &self.form {
            ElementForm::Wedge { height, slopes, .. } => {
                let (left, from_edge) = (height.at(place) - depth, along - self.edge(place));
                depth >= 0.0
                    && left >= 0.0
                    && from_edge >= -left * slopes[0]
                    && from_edge <= left * slopes[1]
            }
            ElementForm::Cap { .. } | ElementForm::Pyramid { .. } => false,
        }
    }

    /// The corners of a section of an element of a row along the guide, mm: along it from its middle, and out of the wall.
    pub(crate) fn section(&self, place: f64) -> [DVec2; 3] {
        let (half, top) = (0.5 * self.length(place), self.way.sign() * self.height(place));
        [DVec2::new(-half, 0.0), DVec2::new(self.edge(place), top), DVec2::new(half, 0.0)]
    }
}
