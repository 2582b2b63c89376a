//! Reliefs: dimples, bumps, grooves, ridges and pyramids on the wall of a solid, as parts of its own boundary.
//!
//! Sunk elements are removed from the solid, raised ones are added. An element replaces the wall: a
//! rule decides where ([`ElementField`]), however many elements there are. Their surfaces are separate
//! patches, which end at the wall by the same numbers. A relief knows only geometry, not its
//! finish.

mod amounts;
mod ground;
pub(super) mod surfaces;
#[cfg(test)]
mod tests;

pub use crate::scene::pattern::element::{Cap, CapSize, Element, ElementForm, Way, WedgeSpan};
pub use ground::{ReliefWall, Site};

use crate::scene::FaceId;
use crate::scene::pattern::{ElementField, ElementOutline};
use crate::scene::shape::ChartRect;
use glam::{DVec2, DVec3};
use lumiduct_base::math::planar::{clip, edges, signed_area};
use std::ops::Range;
use std::sync::Arc;

/// Elements with relief on one wall of a solid.
#[derive(Debug, Clone)]
pub struct Relief {
    /// Dotted name of the face formed by its elements.
    pub name: String,
    /// The wall.
    pub wall: FaceId,
    /// Positions of its elements.
    pub field: ElementField,
    /// Shape of an element.
    pub element: Element,
    /// The wall in space.
    pub ground: ReliefWall,
    /// How far its longest element extends along the guide, mm.
    reach: f64,
}

/// Limits of a patch in addition to the edges of its shape; all must hold.
#[derive(Debug, Clone)]
pub struct Trim {
    /// The conditions.
    pub(super) cuts: Vec<PatchCut>,
}

/// A condition for the points of a patch.
#[derive(Debug, Clone)]
pub(super) enum PatchCut {
    /// A wall, where no element replaces it.
    Wall(Arc<Relief>),
    /// A side of the guide, where no groove of another wall cuts it.
    Side {
        /// The grooves.
        relief: Arc<Relief>,
        /// The side.
        side: ReliefWall,
    },
    /// A surface of an element on a round wall, on its side of the wall.
    Round {
        /// The wall.
        ground: ReliefWall,
        /// The side on which the element is.
        way: Way,
        /// Allowed reach beyond the wall for rounding, mm.
        lap: f64,
    },
}

impl Trim {
    /// Whether a point of the patch exists.
    pub(crate) fn keeps(&self, p: DVec3) -> bool {
        self.cuts.iter().all(|cut| cut.keeps(p))
    }

    /// Whether it limits a surface of an element on a round wall.
    pub(super) fn is_of_element(&self) -> bool {
        self.cuts.iter().any(|cut| match cut {
            PatchCut::Round { .. } => true,
            PatchCut::Wall(_) | PatchCut::Side { .. } => false,
        })
    }

    /// Area, mm², that reliefs remove from the part of a patch whose chart lies in `rect`.
    pub(super) fn area_in(&self, rect: ChartRect) -> f64 {
        self.cuts
            .iter()
            .map(|cut| match cut {
                PatchCut::Wall(relief) => relief.area_in(rect),
                PatchCut::Side { relief, side } => relief.side_area_in(side, rect),
                PatchCut::Round { .. } => 0.0,
            })
            .sum()
    }
}

impl PatchCut {
    fn keeps(&self, p: DVec3) -> bool {
        match self {
            Self::Wall(relief) => !relief.field.contains(relief.ground.unroll(p).truncate()),
            Self::Side { relief, .. } => !relief.cuts_side(p),
            Self::Round { ground, way, lap } => {
                let height = ground.unroll(p).z;
                match way {
                    Way::Into => height <= *lap,
                    Way::OutOf => height >= -lap,
                }
            }
        }
    }
}

impl Relief {
    /// A relief of `element`s in the rows and columns of a field on a wall.
    pub fn new(
        name: String,
        wall: FaceId,
        element: Element,
        field: ElementField,
        ground: ReliefWall,
    ) -> Self {
        let field =
            ElementField { outline: ElementOutline::Relief(Box::new(element.clone())), ..field };
        let rows = (0..field.rows.count()).map(|row| field.rows.place(row));
        let longest = rows.map(|place| element.size(place).y).fold(0.0, f64::max);
        // Slightly more, for rows that end at the edge of the query.
        let reach = 0.5 * longest * (1.0 + 1e-9);
        Self { name, wall, field, element, ground, reach }
    }

    /// Volume that is removed from the solid (below 0) or added to it, mm³.
    pub fn volume(&self) -> f64 {
        let rows = (0..self.field.rows.count()).map(|row| self.field.rows.place(row));
        let sum: f64 = rows.map(|place| self.element.volume(place)).sum();
        self.element.way.sign() * sum * self.field.columns.count as f64
    }

    /// The smallest and the largest (u, v, height over the wall) of its elements, mm.
    pub fn extent(&self) -> [DVec3; 2] {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for (place, middle) in self.field.places() {
            let half = 0.5 * self.element.size(place);
            let top = self.element.way.sign() * self.element.height(place);
            min = min.min((middle - half).extend(top.min(0.0)));
            max = max.max((middle + half).extend(top.max(0.0)));
        }
        [min, max]
    }

    /// The largest height of its elements, mm.
    pub fn height(&self) -> f64 {
        let rows = (0..self.field.rows.count()).map(|row| self.field.rows.place(row));
        rows.map(|place| self.element.height(place)).fold(0.0, f64::max)
    }

    /// Whether a groove cuts through a point of a side of the guide.
    fn cuts_side(&self, p: DVec3) -> bool {
        let at = self.ground.unroll(p);
        let rows = &self.field.rows;
        rows.near(at.y).any(|row| {
            let place = rows.place(row);
            self.element.cuts_side(place, at.y - place, -at.z)
        })
    }

    /// Area that grooves remove from the part of a side of the guide whose chart lies in `rect`,
    /// mm².
    fn side_area_in(&self, side: &ReliefWall, rect: ChartRect) -> f64 {
        let mut cell = rect.corners().map(|corner| {
            let local = self.ground.unroll(side.site(corner).origin);
            DVec2::new(local.y, local.z)
        });
        if signed_area(&cell) < 0.0 {
            cell.reverse();
        }
        let [from, to] = [f64::min, f64::max].map(|pick| {
            let all = cell.iter().map(|corner| corner.x);
            all.reduce(pick).unwrap_or_default()
        });
        let rows = self.rows_in(from, to).map(|row| self.field.rows.place(row));
        rows.map(|place| {
            let section = self.element.section(place).map(|p| p + DVec2::new(place, 0.0));
            let part = edges(&cell).fold(section.to_vec(), |part, (from, to)| {
                let outward = -(to - from).perp();
                clip(&part, outward, outward.dot(from))
            });
            signed_area(&part).abs()
        })
        .sum()
    }

    /// Area of the footprints of the elements in the part of the wall in `rect`, mm².
    fn area_in(&self, rect: ChartRect) -> f64 {
        let ElementField { rows, columns, period, .. } = &self.field;
        // Around a closed wall an element may lie on both sides of the seam.
        let turns = period.map_or([0.0; 3], |period| [0.0, -period, period]);
        let turns = &turns[..if period.is_some() { 3 } else { 1 }];
        let mut sum = 0.0;
        for row in self.rows_in(rect.min.y, rect.max.y) {
            let place = rows.place(row);
            if self.element.span() == Some(WedgeSpan::Ring) {
                let at = DVec2::new(0.5 * (rect.min.x + rect.max.x), place);
                sum += self.element.area_in(place, at, rect);
                continue;
            }
            let half = 0.5 * self.element.size(place).x;
            for turn in turns {
                let first = columns.place(row, 0) + turn;
                let from = ((rect.min.x - half - first) / columns.pitch).ceil().max(0.0) as usize;
                let past = ((rect.max.x + half - first) / columns.pitch + 1.0).floor().max(0.0);
                for column in from..(past as usize).min(columns.count) {
                    let at = DVec2::new(columns.place(row, column) + turn, place);
                    sum += self.element.area_in(place, at, rect);
                }
            }
        }
        sum
    }

    /// The rows whose elements may reach into a part of the wall along the guide, mm.
    fn rows_in(&self, from: f64, to: f64) -> Range<usize> {
        self.field.rows.between(from - self.reach, to + self.reach)
    }
}
