//! Whether the elements of two fields on one face stay apart: every pair that could meet is tested.

use crate::scene::pattern::{Columns, ElementField, ElementOutline};
use glam::DVec2;

/// Overlap of touching elements that is accepted as rounding, as a share of their sizes, 1.
const TOUCHING: f64 = 1e-12;

/// The footprint of an element on its face.
#[derive(Debug, Clone, Copy)]
enum Footprint {
    /// A disk of some radius, mm.
    Disk(f64),
    /// A rectangle by half of its sides across and along, mm.
    Rectangle(DVec2),
}

impl Footprint {
    fn of(outline: &ElementOutline, place: f64) -> Self {
        let half = 0.5 * outline.size(place);
        match outline {
            ElementOutline::Circle { .. } => Self::Disk(half.x),
            ElementOutline::Rectangle { .. } => Self::Rectangle(half),
            // Below a round wall a ball is wider around than along: the disk about both.
            ElementOutline::Relief(element) if element.cap(place).is_some() => {
                Self::Disk(half.max_element())
            }
            ElementOutline::Relief(_) => Self::Rectangle(half),
        }
    }

    /// Half of the sides of the rectangle around it, mm.
    fn half(self) -> DVec2 {
        match self {
            Self::Disk(radius) => DVec2::splat(radius),
            Self::Rectangle(half) => half,
        }
    }

    /// Whether it shares more than an edge with another one at `apart` from its own middle.
    fn meets(self, other: Self, apart: DVec2) -> bool {
        let apart = apart.abs();
        match (self, other) {
            (Self::Disk(one), Self::Disk(two)) => apart.length() < (one + two) * (1.0 - TOUCHING),
            (Self::Rectangle(one), Self::Rectangle(two)) => {
                apart.cmplt((one + two) * (1.0 - TOUCHING)).all()
            }
            (Self::Disk(radius), Self::Rectangle(half))
            | (Self::Rectangle(half), Self::Disk(radius)) => {
                (apart - half).max(DVec2::ZERO).length() < radius * (1.0 - TOUCHING)
            }
        }
    }
}

impl ElementField {
    /// The middle, mm of the unrolled face, of the first element that overlaps one of another field
    /// on the same face.
    pub fn first_met(&self, other: &Self) -> Option<DVec2> {
        let rows = 0..other.rows.count();
        let widest = rows.map(|row| Footprint::of(&other.outline, other.rows.place(row)).half());
        let widest = widest.fold(DVec2::ZERO, DVec2::max);
        let found = self.places().find(|(place, middle)| {
            let own = Footprint::of(&self.outline, *place);
            let reach = own.half() + widest;
            other.near(*middle, reach).any(|(row, across)| {
                let place = other.rows.place(row);
                let apart = DVec2::new(across, place - middle.y);
                own.meets(Footprint::of(&other.outline, place), apart)
            })
        });
        found.map(|(_, middle)| middle)
    }

    /// The elements with middles closer to a position than `reach` across and along: their rows,
    /// and their distance across, mm.
    fn near(&self, at: DVec2, reach: DVec2) -> impl Iterator<Item = (usize, f64)> {
        let rows = self.rows.between(at.y - reach.y, at.y + reach.y);
        // Around a closed face an element is near in either direction.
        let turns = match self.period {
            Some(period) => [0.0, period, -period],
            None => [0.0, f64::NAN, f64::NAN],
        };
        rows.flat_map(move |row| turns.into_iter().map(move |turn| (row, turn))).flat_map(
            move |(row, turn)| {
                let Columns { pitch, count, .. } = self.columns;
                let first = self.columns.place(row, 0) + turn - at.x;
                let found = columns_between(-reach.x - first, reach.x - first, pitch, count);
                found.map(move |column| (row, first + pitch * column as f64))
            },
        )
    }
}

/// The columns, numbered from 0 up to `count`, at multiples of a pitch between two positions; none
/// for non-finite positions.
fn columns_between(from: f64, to: f64, pitch: f64, count: usize) -> std::ops::Range<usize> {
    if from.is_nan() || to.is_nan() {
        return 0..0;
    }
    let most = count as f64;
    let first = (from / pitch).ceil().clamp(0.0, most);
    let past = ((to / pitch).floor() + 1.0).clamp(first, most);
    first as usize..past as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::pattern::{RowPositions, TableAlong};

    fn field(outline: ElementOutline, first: DVec2, pitch: f64) -> ElementField {
        let rows = RowPositions::Even { first: first.y, pitch, count: 5 };
        let columns = Columns { first: first.x, pitch, count: 4, shift: 0.0 };
        ElementField { rows, columns, outline, period: None }
    }

    fn disks(diameter: f64) -> ElementOutline {
        ElementOutline::Circle { diameter: TableAlong::constant(diameter) }
    }

    #[test]
    fn fields_meet_where_their_elements_share_more_than_an_edge() {
        let own = field(disks(2.0), DVec2::ZERO, 10.0);
        let bars = ElementOutline::Rectangle { width: 1.0, length: 6.0 };
        for (outline, from, meets) in [
            (disks(1.0), DVec2::new(1.499, 0.0), true),
            (disks(1.0), DVec2::new(1.5, 0.0), false),
            (disks(1.0), DVec2::new(1.07, 1.07), false),
            (disks(1.0), DVec2::new(1.05, 1.05), true),
            (bars.clone(), DVec2::new(1.499, 2.9), true),
            (bars.clone(), DVec2::new(1.5, 2.9), false),
            // The corner of the bar and the rim of the disk.
            (bars.clone(), DVec2::new(1.22, 3.69), true),
            (bars, DVec2::new(1.22, 3.70), false),
        ] {
            let other = field(outline, from, 10.0);
            assert_eq!(own.first_met(&other).is_some(), meets, "{other:?}");
            assert_eq!(other.first_met(&own).is_some(), meets, "{other:?}");
        }
    }

    #[test]
    fn around_a_closed_face_elements_meet_over_the_seam() {
        let at = |u: f64| ElementField {
            period: Some(30.0),
            ..field(disks(2.0), DVec2::new(u, 0.0), 100.0)
        };
        let one = |u: f64| ElementField { columns: Columns { count: 1, ..at(u).columns }, ..at(u) };
        assert!(one(0.5).first_met(&one(29.0)).is_some());
        assert!(one(29.0).first_met(&one(0.5)).is_some());
        assert!(one(0.5).first_met(&one(28.0)).is_none());
    }
}
