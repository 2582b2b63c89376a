//! Holes, dots and patches on a face, in its unrolled coordinates: u around or across, v along.
//!
//! A pattern is a rule, not a list: whether a point lies in an element is computed from its rows
//! and columns, so ten million elements cost no more than ten. It knows the positions of elements;
//! finishes are only ids here.

pub(crate) mod along;
mod apart;
pub(crate) mod element;
mod rows;

pub use crate::scene::pattern::along::TableAlong;
pub use rows::{Graded, RowPositions};

use crate::scene::pattern::element::Element;
use crate::scene::shape::ChartRect;
use crate::scene::{FaceId, FinishId};
use glam::DVec2;

/// Elements on a face that replace its finish.
#[derive(Debug, Clone, PartialEq)]
pub struct Pattern {
    /// Name in the scene file.
    pub name: String,
    /// The face it lies on.
    pub face: FaceId,
    /// Positions of its elements.
    pub field: ElementField,
    /// Finish of the elements met from the front.
    pub front: FinishId,
    /// Finish of the elements met from the back.
    pub back: FinishId,
    /// The wall that the elements are holes through, if its thickness matters.
    pub wall: Option<HoleWall>,
}

/// A wall of some thickness around holes. The face is its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoleWall {
    /// Thickness, mm.
    pub thickness: f64,
    /// The absorber that light meets on the side of a hole.
    pub bore: FinishId,
}

/// The acting part at a point of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ActingPart {
    /// The face itself.
    Face,
    /// An element of a pattern, by the pattern's number.
    Element(usize),
    /// The side of a hole of a pattern.
    Bore(usize),
}

/// Elements in rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct ElementField {
    /// Positions of the rows.
    pub rows: RowPositions,
    /// Positions of the elements of a row.
    pub columns: Columns,
    /// Shape of an element.
    pub outline: ElementOutline,
    /// Circumference of a closed face, mm.
    pub period: Option<f64>,
}

/// The positions of the elements of a row across a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Columns {
    /// Position of the first element of the first row, mm.
    pub first: f64,
    /// Distance between neighbours, mm; arbitrary where there is only one.
    pub pitch: f64,
    /// Number of elements.
    pub count: usize,
    /// Shift of every other row, mm.
    pub shift: f64,
}

impl Columns {
    /// Position of an element of a row across the face, mm.
    pub fn place(&self, row: usize, column: usize) -> f64 {
        let first = if row % 2 == 1 { self.first + self.shift } else { self.first };
        first + column as f64 * self.pitch
    }
}

/// The outline of an element.
#[derive(Debug, Clone, PartialEq)]
pub enum ElementOutline {
    /// A circle.
    Circle {
        /// Its diameter, mm, along the face.
        diameter: TableAlong,
    },
    /// A rectangle.
    Rectangle {
        /// Width across the face, mm.
        width: f64,
        /// Length along the face, mm.
        length: f64,
    },
    /// Footprint of an element with relief on its wall.
    Relief(Box<Element>),
}

impl ElementOutline {
    /// Width and length of the elements of a row, mm.
    pub fn size(&self, place: f64) -> DVec2 {
        match self {
            Self::Circle { diameter } => DVec2::splat(diameter.at(place)),
            Self::Rectangle { width, length } => DVec2::new(*width, *length),
            Self::Relief(element) => element.size(place),
        }
    }

    /// Area of an element of a row, mm².
    pub(crate) fn area(&self, place: f64) -> f64 {
        match self {
            Self::Circle { diameter } => 0.25 * std::f64::consts::PI * diameter.at(place).powi(2),
            Self::Rectangle { width, length } => width * length,
            Self::Relief(element) => element.area(place),
        }
    }

    /// Whether an element of a row contains a point at `from` its centre, mm.
    #[inline]
    fn contains(&self, place: f64, from: DVec2) -> bool {
        match self {
            Self::Circle { diameter } => {
                let radius = 0.5 * diameter.at(place);
                from.length_squared() <= radius * radius
            }
            Self::Rectangle { width, length } => {
                from.x.abs() <= 0.5 * width && from.y.abs() <= 0.5 * length
            }
            Self::Relief(element) => element.contains(place, from),
        }
    }

    /// Whether two elements with their centres `apart` share more than an edge.
    fn overlap(&self, places: [f64; 2], apart: DVec2) -> bool {
        let [one, other] = places.map(|place| self.size(place));
        let room = 0.5 * (one + other) * (1.0 - 1e-12);
        match self {
            Self::Circle { .. } => apart.length() < room.x,
            Self::Rectangle { .. } => apart.x.abs() < room.x && apart.y.abs() < room.y,
            Self::Relief(element) => element.overlap(places, apart),
        }
    }
}

impl ElementField {
    /// Whether a point of the face, mm, lies in an element.
    pub(crate) fn contains(&self, at: DVec2) -> bool {
        self.element(at).is_some()
    }

    /// Row and column of the element that contains a point of the face, mm.
    #[inline]
    pub(crate) fn element(&self, at: DVec2) -> Option<(usize, usize)> {
        self.rows.near(at.y).find_map(|row| {
            let place = self.rows.place(row);
            let (column, across) = self.nearest(at.x, row);
            let from = DVec2::new(across, at.y - place);
            self.outline.contains(place, from).then_some((row, column))
        })
    }

    /// The nearest element of a row and the distance across from it, mm.
    #[inline]
    fn nearest(&self, u: f64, row: usize) -> (usize, f64) {
        let Columns { first, pitch, count, shift } = self.columns;
        let first = if row % 2 == 1 { first + shift } else { first };
        let half = 0.5 * pitch * (count.max(1) - 1) as f64;
        let from_middle = u - first - half;
        let from_middle = match self.period {
            // Reduced to one turn about the middle of the row.
            Some(period) => from_middle - period * (from_middle / period).round(),
            None => from_middle,
        };
        let from_first = from_middle + half;
        let column = (from_first / pitch).round().clamp(0.0, (count.max(1) - 1) as f64);
        (column as usize, from_first - pitch * column)
    }

    /// Every element: the position of its row, mm, and of its middle.
    pub fn places(&self) -> impl Iterator<Item = (f64, DVec2)> + '_ {
        let columns = self.columns;
        (0..self.rows.count()).flat_map(move |row| {
            let place = self.rows.place(row);
            (0..columns.count)
                .map(move |column| (place, DVec2::new(columns.place(row, column), place)))
        })
    }

    /// Number of elements.
    pub fn count(&self) -> u64 {
        (self.rows.count() as u64).saturating_mul(self.columns.count as u64)
    }

    /// Area of all elements, mm².
    pub fn area(&self) -> f64 {
        let rows = (0..self.rows.count()).map(|row| self.outline.area(self.rows.place(row)));
        rows.sum::<f64>() * self.columns.count as f64
    }

    /// The first row with an element that overlaps another one in its row or the next two.
    pub fn first_overlap(&self) -> Option<usize> {
        let Columns { pitch, count, shift, .. } = self.columns;
        (0..self.rows.count()).find(|&row| {
            let place = self.rows.place(row);
            let beside = count > 1 && self.outline.overlap([place; 2], DVec2::new(pitch, 0.0));
            beside
                || [1, 2].into_iter().filter(|by| row + by < self.rows.count()).any(|by| {
                    let next = self.rows.place(row + by);
                    let across = if by == 1 { shift } else { 0.0 };
                    self.outline.overlap([place, next], DVec2::new(across, next - place))
                })
        })
    }

    /// The first row with an element that reaches beyond a rectangle of the face, and by how much, mm.
    pub fn first_outside(&self, rect: ChartRect) -> Option<(usize, f64)> {
        let Columns { first, pitch, count, shift } = self.columns;
        // Allows for rounding of a field that fills its face.
        let least = 1e-9 * (rect.max - rect.min).max_element();
        (0..self.rows.count()).find_map(|row| {
            let place = self.rows.place(row);
            let half = 0.5 * self.outline.size(place);
            let from = if row % 2 == 1 { first + shift } else { first };
            let to = from + pitch * (count.max(1) - 1) as f64;
            let along = (rect.min.y - (place - half.y)).max(place + half.y - rect.max.y);
            let across = match self.period {
                // Rings go around and are no wider than the circumference.
                Some(period) if half.x.is_finite() => 2.0 * half.x - period,
                Some(_) => 0.0,
                None => (rect.min.x - (from - half.x)).max(to + half.x - rect.max.x),
            };
            let beyond = along.max(across);
            (beyond > least).then_some((row, beyond))
        })
    }
}

impl Pattern {
    /// The acting part at a point of the face for light that travels by `slope` across it per mm
    /// through it, mm/mm; `None` for the face itself.
    #[inline]
    pub(crate) fn part(
        &self,
        number: usize,
        at: DVec2,
        slope: impl Fn() -> DVec2,
    ) -> Option<ActingPart> {
        let Some(wall) = &self.wall else {
            return self.field.contains(at).then_some(ActingPart::Element(number));
        };
        // The face is the middle of the wall, so that a path is the same both ways. Light passes
        // where both ends of its path, and therefore the middle, are in one element.
        let middle = self.field.element(at)?;
        let half = 0.5 * wall.thickness * slope();
        let passes =
            [at - half, at + half].iter().all(|end| self.field.element(*end) == Some(middle));
        Some(if passes { ActingPart::Element(number) } else { ActingPart::Bore(number) })
    }
}

#[cfg(test)]
mod tests;
